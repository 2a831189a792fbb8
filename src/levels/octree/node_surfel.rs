//! The surfel of one node: the mean of its points, a disk that covers theirs, and the cone of their normals.
//!
//! Where points are ellipses, so is the node: its axes are the principal axes of the points' covariance in its plane,
//! in which each ellipse counts as evenly filled.

use crate::cloud::{PointRecord, ShapeRecord, oct_decode, oct_encode};
use crate::levels::moments::{OF_HALF_AXIS, PlaneMoments, half_axes};
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};

/// The surfel of a node.
#[derive(Debug, Clone, Copy, PartialEq, Zeroable)]
#[repr(C)]
pub struct NodeSurfel {
    /// Mean position and colour of the points.
    pub point: PointRecord,
    /// Mean normal and scalar, and the radius that covers the points' disks.
    pub shape: ShapeRecord,
    /// Cosine of the largest angle between the mean normal and the normal of a point; −1 where there is no mean.
    pub cone_cosine: f32,
    /// Number of points.
    pub point_count: u32,
}

/// Rounding of normals to octahedral coordinates and of cosines to f32, in radians, rounded up.
const CONE_SLACK: f32 = 1e-3;

impl NodeSurfel {
    /// Computes the surfel of a node with these points, which are disks unless `are_ellipses`. Precondition: there is
    /// one.
    #[inline(always)]
    pub(super) fn of(points: &[PointRecord], shapes: &[ShapeRecord], are_ellipses: bool) -> Self {
        if let ([point], [shape]) = (points, shapes) {
            return Self {
                point: *point,
                shape: *shape,
                cone_cosine: 1.0,
                point_count: 1,
            };
        }
        // In f64: sums over many points would lose the last digits.
        let share = 1.0 / points.len() as f64;
        let mut sum = DVec3::ZERO;
        let mut colors = [0; 4];
        for point in points {
            sum += Vec3::from_array(point.position).as_dvec3();
            for (sum, channel) in colors.iter_mut().zip(point.color) {
                *sum += u64::from(channel);
            }
        }
        let mut normal = Vec3::ZERO;
        let mut scalar = 0.0;
        for shape in shapes {
            normal += oct_decode(shape.normal);
            scalar += f64::from(shape.scalar);
        }
        let center = (sum * share).as_vec3();
        let (normal, has_mean) = match normal.try_normalize() {
            Some(normal) => (normal, true),
            None => (oct_decode(shapes[0].normal), false),
        };
        let (mut radius, mut cone_cosine) = (0f32, 1f32);
        for (point, shape) in points.iter().zip(shapes) {
            let offset = Vec3::from_array(point.position) - center;
            let in_plane = offset - normal * offset.dot(normal);
            radius = radius.max(in_plane.length() + shape.radius);
            cone_cosine = cone_cosine.min(normal.dot(oct_decode(shape.normal)));
        }
        Self {
            point: PointRecord {
                position: center.to_array(),
                color: colors.map(|sum| (sum as f64 * share).round() as u8),
            },
            shape: ShapeRecord {
                normal: oct_encode(normal),
                radius,
                ellipse: if are_ellipses {
                    merged_ellipse(points, shapes, center, normal)
                } else {
                    0
                },
                scalar: (scalar * share) as f32,
            },
            cone_cosine: if has_mean { cone_cosine } else { -1.0 },
            point_count: points.len() as u32,
        }
    }

    /// Returns true if all normals of a node face away from an eye, if the node is in a sphere around a point that is
    /// `from_eye` away.
    ///
    /// A point faces away when the angle between its normal and the line of sight is below 90°. The line of sight to
    /// any point of the sphere is within β of that to its centre, `sin β = radius/distance`, and all normals are within
    /// α of the mean. So all face away when the angle between the mean normal and the line of sight is below 90° − α −
    /// β.
    pub(super) fn faces_away(&self, from_eye: Vec3, sphere_radius: f32) -> bool {
        let distance = from_eye.length();
        if distance <= sphere_radius || self.cone_cosine <= 0.0 {
            return false;
        }
        let alpha = self.cone_cosine.min(1.0).acos();
        let beta = (sphere_radius / distance).asin();
        let between = oct_decode(self.shape.normal).dot(from_eye) / distance;
        let limit = alpha + beta + CONE_SLACK;
        limit < std::f32::consts::FRAC_PI_2 && between > limit.sin()
    }
}

/// Returns the packed ellipse of the covariance of ellipses around `center`, in the plane perpendicular to `normal`.
fn merged_ellipse(points: &[PointRecord], shapes: &[ShapeRecord], center: Vec3, normal: Vec3) -> u32 {
    let mut moments = PlaneMoments::across(normal);
    for (point, shape) in points.iter().zip(shapes) {
        moments.add(Vec3::from_array(point.position) - center, 1.0);
        for axis in half_axes(shape) {
            moments.add(axis, OF_HALF_AXIS);
        }
    }
    moments.packed_ellipse()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Ellipse, decode_ellipse, encode_ellipse};

    /// Two ellipses on the x axis with half axes of these lengths, this far from the centre.
    fn merged(apart: f32, along: f32, across: f32) -> [f32; 2] {
        let normal = oct_encode(Vec3::Z);
        let ratio = across / along;
        let radius = (0.5 * (along * along + across * across)).sqrt();
        let ellipse = encode_ellipse(normal, Ellipse { axis: Vec3::X, ratio });
        let at = |x: f32| PointRecord {
            position: [x, 0.0, 0.0],
            color: [255; 4],
        };
        let shape = ShapeRecord {
            normal,
            radius,
            ellipse,
            scalar: 0.0,
        };
        let surfel = NodeSurfel::of(&[at(-apart), at(apart)], &[shape; 2], true);
        assert_eq!(
            NodeSurfel::of(&[at(-apart), at(apart)], &[shape; 2], false)
                .shape
                .ellipse,
            0
        );
        let ellipse = decode_ellipse(surfel.shape.normal, surfel.shape.ellipse);
        [ellipse.axis.x.abs(), ellipse.ratio]
    }

    #[test]
    fn second_moments_of_ellipses_add_up() {
        // Along x: a quarter of 4 and the square of 3; across: a quarter of 1.
        let [x, ratio] = merged(3.0, 2.0, 1.0);
        assert!((x - 1.0).abs() < 1e-4);
        assert!((ratio - (0.25f32 / 10.0).sqrt()).abs() < 1e-4, "{ratio}");
        let [x, ratio] = merged(0.0, 2.0, 0.5);
        assert!((x - 1.0).abs() < 1e-4);
        assert!((ratio - 0.25).abs() < 1e-4, "{ratio}");
    }
}
