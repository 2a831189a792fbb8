//! Anisotropic extents of a splat in 32 bits.
//!
//! An ellipse is a direction in the tangent plane and the ratio of its half axes; its size is that of the splat.
//! The *quadratic mean* of both half axes is the radius, so that a circle is the ellipse of ratio 1, and the
//! farthest corner of a rectangle that is as long as the ellipse in proportion is as far from the middle for both:
//! where a circle just covers a rectangular cell, so does the ellipse. (An ellipse within the circle does not cover
//! the corner unless it is the circle.) The longer half axis is up to √2 radii.
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
    /// The longer and the shorter half axis, in the unit of `radius`.
    pub fn half_axes(&self, radius: f32) -> [f32; 2] {
        let longer = radius * (2.0 / (1.0 + self.ratio * self.ratio)).sqrt();
        [longer, self.ratio * longer]
    }
}

/// Steps of both numbers.
pub(crate) const ELLIPSE_STEPS: f32 = u16::MAX as f32;

/// Packs an ellipse in the tangent plane of a packed normal; without one, a circle, which is 0.
///
/// Errors: the direction below 0.002 degrees, the ratio below 10⁻⁵ (and none is smaller than 1/65535). A part of the
/// axis along the normal is dropped; an axis along the normal, or a ratio of 1, has no direction.
pub fn encode_ellipse(normal: [i16; 2], ellipse: Option<Ellipse>) -> u32 {
    let Some(Ellipse { axis, ratio }) = ellipse else {
        return 0;
    };
    let [x, y] = tangent_basis(oct_decode(normal)).map(|tangent| tangent.dot(axis));
    let x = if y < 0.0 { -x } else { x };
    let norm1 = x.abs() + y.abs();
    let direction = if norm1 > 0.0 { x / norm1 } else { 1.0 };
    let direction = (0.5 * (direction + 1.0) * ELLIPSE_STEPS).round() as u32;
    let ratio = (ratio * ELLIPSE_STEPS).round().clamp(1.0, ELLIPSE_STEPS) as u32;
    direction << 16 | ratio
}

/// The ellipse that [`encode_ellipse`] packed; `None` for a circle.
pub fn decode_ellipse(normal: [i16; 2], packed: u32) -> Option<Ellipse> {
    if packed == 0 {
        return None;
    }
    let x = 2.0 * (packed >> 16) as f32 / ELLIPSE_STEPS - 1.0;
    let y = 1.0 - x.abs();
    let [tangent, bitangent] = tangent_basis(oct_decode(normal));
    Some(Ellipse {
        axis: (tangent * x + bitangent * y).normalize(),
        ratio: (packed & 0xffff) as f32 / ELLIPSE_STEPS,
    })
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
        fn ellipses_survive_packing(
            packed_normal in prop::array::uniform2(-32767i16..=32767),
            along in prop::array::uniform3(-1.0f32..1.0),
            ratio in 1e-4f32..=1.0,
        ) {
            let normal = oct_decode(packed_normal);
            let axis = Vec3::from_array(along).reject_from(normal);
            prop_assume!(axis.length() > 1e-2);
            let axis = axis.normalize();
            let packed = encode_ellipse(packed_normal, Some(Ellipse { axis, ratio }));
            let found = decode_ellipse(packed_normal, packed).unwrap();
            let off = found.axis.cross(axis).length().to_degrees();
            prop_assert!(off < 0.002, "{off} degrees");
            prop_assert!((found.ratio - ratio).abs() < 1e-5);
            prop_assert!(found.axis.dot(normal).abs() < 1e-5);
            prop_assert_eq!(encode_ellipse(packed_normal, Some(Ellipse { axis: -axis, ratio })), packed);
        }
    }

    #[test]
    fn circles_are_zero() {
        for normal in [Vec3::Z, Vec3::NEG_Z, Vec3::X] {
            let normal = oct_encode(normal);
            assert_eq!(encode_ellipse(normal, None), 0);
            assert_eq!(decode_ellipse(normal, 0), None);
            // The thinnest is not taken for one.
            let axis = tangent_basis(oct_decode(normal))[0];
            for axis in [axis, -axis] {
                assert_ne!(encode_ellipse(normal, Some(Ellipse { axis, ratio: 0.0 })), 0);
            }
        }
    }

    #[test]
    fn the_radius_is_the_quadratic_mean_of_the_half_axes() {
        for ratio in [0.0, 0.2, 1.0] {
            let axis = Vec3::X;
            let [longer, shorter] = Ellipse { axis, ratio }.half_axes(3.0);
            assert!((0.5 * (longer * longer + shorter * shorter) - 9.0).abs() < 1e-5);
            assert!((shorter - ratio * longer).abs() < 1e-6);
        }
    }
}
