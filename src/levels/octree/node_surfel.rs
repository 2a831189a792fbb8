//! The surfel of one node: the mean of its points, a disk that covers theirs, and the cone of their normals.

use crate::cloud::{PointRecord, ShapeRecord, oct_decode, oct_encode};
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
    /// Cosine of the largest angle between the mean normal and that of a point; −1 where there is no mean.
    pub cone_cosine: f32,
    /// Number of points.
    pub point_count: u32,
}

/// Rounding of normals to octahedral coordinates and of cosines to f32, in radians, rounded up.
const CONE_SLACK: f32 = 1e-3;

impl NodeSurfel {
    /// Of a node with these points. Precondition: there is one.
    #[inline(always)]
    pub(super) fn of(points: &[PointRecord], shapes: &[ShapeRecord]) -> Self {
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
                ellipse: 0,
                scalar: (scalar * share) as f32,
            },
            cone_cosine: if has_mean { cone_cosine } else { -1.0 },
            point_count: points.len() as u32,
        }
    }

    /// Whether all normals of a node face away from an eye, if the node is in a sphere around a point that is
    /// `from_eye` away.
    ///
    /// A point faces away when the angle between its normal and the line of sight is below 90°. The line of sight to
    /// any point of the sphere is within β of that to its middle, `sin β = radius/distance`, and all normals are within
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
