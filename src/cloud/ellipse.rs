//! Anisotropic extents of a splat, and how they are packed into 32 bits.
//!
//! An ellipse is a direction in the tangent plane and the ratio of its half axes; its size is the splat's, whose radius
//! is the *geometric mean* of both half axes. So a circle is the ellipse of ratio 1, and where disks are drawn instead,
//! each covers the area of its ellipse. The longer half axis is radius / √ratio.
//!
//! The upper 16 bits are the direction, the lower 16 the ratio in steps of 1/65535; 0 is a circle. The direction is `x
//! / (|x| + y)` of its coordinates in the basis of Duff et al. (2017, *Building an Orthonormal Basis, Revisited*) to
//! the normal *as it is decoded*, turned so that y is not negative: from 1 over 0 to −1 for half a turn, in 65535
//! steps. No angle, so that neither side needs a trigonometric function.

use super::record::oct_decode;
use glam::Vec3;

/// Extents of a splat in its tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Unit vector along the longer axis, of any sign.
    pub axis: Vec3,
    /// The shorter half axis over the longer one, in 0..=1.
    pub ratio: f32,
}

impl Ellipse {
    /// As long in every direction.
    pub const CIRCLE: Self = Self {
        axis: Vec3::ZERO,
        ratio: 1.0,
    };

    /// The ellipse with the half diameters `p` and `q`, each parallel to the tangents at the ends of the other: the
    /// image of the half axes of an ellipse under a linear map. A circle where it has no area.
    pub fn of_conjugate_diameters(p: Vec3, q: Vec3) -> Self {
        // The squared length of p cos t + q sin t is its mean plus a wave of 2 t; its maximum is the longer half axis.
        let (mean, x, y) = (
            0.5 * (p.length_squared() + q.length_squared()),
            0.5 * (p.length_squared() - q.length_squared()),
            p.dot(q),
        );
        let (sine, cosine) = (0.5 * y.atan2(x)).sin_cos();
        let longer_squared = mean + x.hypot(y);
        Self {
            axis: (p * cosine + q * sine).normalize_or_zero(),
            // The product of the half axes is the area of the parallelogram.
            ratio: p.cross(q).length() / longer_squared,
        }
        .usable()
    }

    /// The radius of the splat whose half axes have this quadratic mean: no larger, as the ellipse has less area than a
    /// circle of that radius.
    pub fn radius_of_quadratic_mean(&self, mean: f32) -> f32 {
        mean * (2.0 * self.ratio / (1.0 + self.ratio * self.ratio)).sqrt()
    }

    /// The quadratic mean of the half axes of a splat of this radius.
    pub fn quadratic_mean(&self, radius: f32) -> f32 {
        radius / self.radius_of_quadratic_mean(1.0)
    }

    /// The longer and the shorter half axis that have this quadratic mean, in its unit.
    pub fn half_axes_of_quadratic_mean(&self, mean: f32) -> [f32; 2] {
        let longer = mean * (2.0 / (1.0 + self.ratio * self.ratio)).sqrt();
        [longer, self.ratio * longer]
    }

    /// The longer and the shorter half axis of a splat of this radius, in its unit.
    pub fn half_axes(&self, radius: f32) -> [f32; 2] {
        let root = self.ratio.sqrt();
        [radius / root, radius * root]
    }

    /// This ellipse if it is one with an area, else a circle.
    pub(super) fn usable(self) -> Self {
        let axis = self.axis.normalize_or_zero();
        if axis != Vec3::ZERO && self.ratio > 0.0 && self.ratio < 1.0 {
            Self { axis, ..self }
        } else {
            Self::CIRCLE
        }
    }
}

/// Steps of both numbers.
pub(crate) const ELLIPSE_STEPS: f32 = u16::MAX as f32;

/// Packs an ellipse in the tangent plane of a packed normal; a circle is 0.
///
/// Errors: the direction below 0.002 degrees, the ratio below 10⁻⁵ (and none is smaller than 1/65535). A part of the
/// axis along the normal is dropped; an axis along the normal has no direction.
pub fn encode_ellipse(normal: [i16; 2], Ellipse { axis, ratio }: Ellipse) -> u32 {
    if ratio >= 1.0 {
        return 0;
    }
    let [x, y] = tangent_basis(oct_decode(normal)).map(|tangent| tangent.dot(axis));
    let x = if y < 0.0 { -x } else { x };
    let norm1 = x.abs() + y.abs();
    let direction = if norm1 > 0.0 { x / norm1 } else { 1.0 };
    let direction = (0.5 * (direction + 1.0) * ELLIPSE_STEPS).round() as u32;
    let ratio = (ratio * ELLIPSE_STEPS).round().clamp(1.0, ELLIPSE_STEPS) as u32;
    direction << 16 | ratio
}

/// The ellipse that [`encode_ellipse`] packed.
pub fn decode_ellipse(normal: [i16; 2], packed: u32) -> Ellipse {
    if packed == 0 {
        return Ellipse::CIRCLE;
    }
    let x = 2.0 * (packed >> 16) as f32 / ELLIPSE_STEPS - 1.0;
    let y = 1.0 - x.abs();
    let [tangent, bitangent] = tangent_basis(oct_decode(normal));
    Ellipse {
        axis: (tangent * x + bitangent * y).normalize(),
        ratio: (packed & 0xffff) as f32 / ELLIPSE_STEPS,
    }
}

/// Two unit vectors across a unit vector and across each other.
fn tangent_basis(normal: Vec3) -> [Vec3; 2] {
    let Vec3 { x, y, z } = normal;
    let sign = 1f32.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [
        Vec3::new(1.0 + sign * x * x * a, sign * b, -sign * x),
        Vec3::new(b, sign + y * y * a, -y),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::record::oct_encode;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ellipses_round_trip_through_packing(
            packed_normal in prop::array::uniform2(-32767i16..=32767),
            along in prop::array::uniform3(-1.0f32..1.0),
            ratio in 1e-4f32..1.0,
        ) {
            let normal = oct_decode(packed_normal);
            let axis = Vec3::from_array(along).reject_from(normal);
            prop_assume!(axis.length() > 1e-2);
            let axis = axis.normalize();
            let packed = encode_ellipse(packed_normal, Ellipse { axis, ratio });
            let found = decode_ellipse(packed_normal, packed);
            let off = found.axis.cross(axis).length().to_degrees();
            prop_assert!(off < 0.002, "{off} degrees");
            prop_assert!((found.ratio - ratio).abs() < 1e-5);
            prop_assert!(found.axis.dot(normal).abs() < 1e-5);
            prop_assert_eq!(encode_ellipse(packed_normal, Ellipse { axis: -axis, ratio }), packed);
        }

        /// The farthest and the nearest of many places on the outline are the ends of the half axes.
        #[test]
        fn conjugate_diameters_and_semi_axes_describe_one_ellipse(
            p in prop::array::uniform3(-1.0f32..1.0),
            q in prop::array::uniform3(-1.0f32..1.0),
        ) {
            const STEPS: usize = 3600;
            let (p, q) = (Vec3::from_array(p), Vec3::from_array(q));
            let area = p.cross(q).length();
            prop_assume!(area > 1e-2);
            let rim = (0..STEPS).map(|step| {
                let (sine, cosine) = (std::f32::consts::TAU * step as f32 / STEPS as f32).sin_cos();
                p * cosine + q * sine
            });
            let ellipse = Ellipse::of_conjugate_diameters(p, q);
            let [longer, shorter] = ellipse.half_axes(area.sqrt());
            let (mut nearest, mut farthest) = (f32::INFINITY, 0f32);
            for place in rim {
                (nearest, farthest) = (nearest.min(place.length()), farthest.max(place.length()));
                let along = place.dot(ellipse.axis);
                let across = place.reject_from(ellipse.axis).length();
                let norm = if ellipse == Ellipse::CIRCLE {
                    (place.length() / longer).powi(2)
                } else {
                    (along / longer).powi(2) + (across / shorter).powi(2)
                };
                prop_assert!((norm - 1.0).abs() < 1e-2, "{norm}");
            }
            prop_assert!((farthest / longer - 1.0).abs() < 1e-3, "{farthest} {longer}");
            // The nearest position is missed by at most half a step, which is longer the longer the ellipse is.
            let passed = shorter.hypot(longer * std::f32::consts::PI / STEPS as f32);
            prop_assert!(nearest > 0.999 * shorter && nearest < 1.001 * passed, "{nearest} {shorter}");
        }
    }

    #[test]
    fn circles_pack_to_zero() {
        for normal in [Vec3::Z, Vec3::NEG_Z, Vec3::X] {
            let normal = oct_encode(normal);
            assert_eq!(encode_ellipse(normal, Ellipse::CIRCLE), 0);
            assert_eq!(decode_ellipse(normal, 0), Ellipse::CIRCLE);
            // The thinnest ellipse is not mistaken for a circle.
            let axis = tangent_basis(oct_decode(normal))[0];
            for axis in [axis, -axis] {
                assert_ne!(encode_ellipse(normal, Ellipse { axis, ratio: 0.0 }), 0);
            }
        }
    }

    #[test]
    fn an_ellipse_has_the_area_of_the_disk_of_its_radius() {
        for ratio in [0.01, 0.2, 1.0] {
            let ellipse = Ellipse { axis: Vec3::X, ratio };
            let [longer, shorter] = ellipse.half_axes(3.0);
            assert!((longer * shorter - 9.0).abs() < 1e-5);
            assert!((shorter - ratio * longer).abs() < 1e-5);
            let mean = (0.5 * (longer * longer + shorter * shorter)).sqrt();
            assert!((ellipse.radius_of_quadratic_mean(mean) - 3.0).abs() < 1e-5);
        }
    }

    #[test]
    fn ellipses_without_area_or_axis_are_circles() {
        for (axis, ratio) in [
            (Vec3::ZERO, 0.5),
            (Vec3::NAN, 0.5),
            (Vec3::X, 0.0),
            (Vec3::X, f32::NAN),
            (Vec3::X, 2.0),
        ] {
            assert_eq!(Ellipse { axis, ratio }.usable(), Ellipse::CIRCLE);
        }
        assert_eq!(
            Ellipse {
                axis: Vec3::X * 3.0,
                ratio: 0.5
            }
            .usable(),
            Ellipse {
                axis: Vec3::X,
                ratio: 0.5
            }
        );
        assert_eq!(Ellipse::of_conjugate_diameters(Vec3::X, Vec3::ZERO), Ellipse::CIRCLE);
    }
}
