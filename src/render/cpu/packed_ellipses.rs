//! Eight ellipses at a time, out of their code.

use super::eight::Vectors;
use crate::cloud::ELLIPSE_STEPS;
use fearless_simd::{Bytes, Simd, SimdBase, SimdFloat, f32x8, i32x8};

/// Eight ellipses, in the planes across eight normals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ellipses<S: Simd> {
    /// Unit vectors along the longer axes.
    pub(super) axes: Vectors<S>,
    /// The shorter half axes over the longer ones.
    ratios: f32x8<S>,
}

impl<S: Simd> Ellipses<S> {
    /// The longer and the shorter half axes where the radius is 1: see
    /// [`Ellipse::half_axes_of_quadratic_mean`](crate::cloud::Ellipse::half_axes_of_quadratic_mean).
    #[inline(always)]
    pub(super) fn half_axes(&self, simd: S) -> [f32x8<S>; 2] {
        let longer = longer_half_axes(simd, self.ratios);
        [longer, self.ratios * longer]
    }
}

/// Returns the reach of ellipses for radius 1, i.e. their longer half axes, without unpacking the rest.
#[inline(always)]
pub(super) fn reach_each<S: Simd>(simd: S, packed: f32x8<S>) -> f32x8<S> {
    longer_half_axes(simd, ratios_of(simd, packed.bitcast()))
}

#[inline(always)]
fn longer_half_axes<S: Simd>(simd: S, ratios: f32x8<S>) -> f32x8<S> {
    (2.0 / ratios.mul_add(ratios, f32x8::splat(simd, 1.0))).sqrt()
}

/// The low half is the ratio, 0 for circles: no ellipse is so thin that it is 0.
#[inline(always)]
fn ratios_of<S: Simd>(simd: S, packed: i32x8<S>) -> f32x8<S> {
    let ratios = share(simd, packed);
    let is_circle = ratios.simd_le(f32x8::splat(simd, 0.0));
    simd.select_f32x8(is_circle, f32x8::splat(simd, 1.0), ratios)
}

/// Returns the value of the low half, from 0 to 1.
#[inline(always)]
fn share<S: Simd>(simd: S, packed: i32x8<S>) -> f32x8<S> {
    simd.cvt_f32_i32x8(packed & i32x8::splat(simd, 0xffff)) * (1.0 / ELLIPSE_STEPS)
}

/// As [`decode_ellipse`](crate::cloud::decode_ellipse), but that a circle is an ellipse of ratio 1.
#[inline(always)]
pub(super) fn decode_each<S: Simd>(simd: S, normals: Vectors<S>, packed: f32x8<S>) -> Ellipses<S> {
    let splat = |value: f32| f32x8::splat(simd, value);
    let packed: i32x8<S> = packed.bitcast();
    let direction = share(simd, packed >> 16);
    let x = direction.mul_sub(splat(2.0), splat(1.0));
    let y = 1.0 - x.abs();
    let [tangents, bitangents] = tangent_bases(simd, normals);
    let axes = tangents.times(x).plus(bitangents.times(y));
    Ellipses {
        axes: axes.times(1.0 / axes.dot(axes).sqrt()),
        ratios: ratios_of(simd, packed),
    }
}

/// Two unit vectors across each normal and across each other (Duff et al. 2017).
#[inline(always)]
fn tangent_bases<S: Simd>(simd: S, Vectors { x, y, z }: Vectors<S>) -> [Vectors<S>; 2] {
    let one = f32x8::splat(simd, 1.0);
    let sign = one.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [
        Vectors {
            x: (sign * x * x).mul_add(a, one),
            y: sign * b,
            z: -(sign * x),
        },
        Vectors {
            x: b,
            y: (y * y).mul_add(a, sign),
            z: -y,
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::super::tile::LANES;
    use super::*;
    use crate::cloud::{decode_ellipse, oct_decode};
    use fearless_simd::{Level, dispatch};
    use glam::Vec3;
    use proptest::prelude::*;

    /// The axis and the half axes of one ellipse, decoded in a lane among circles.
    fn decoded(normal: Vec3, packed: u32, lane: usize) -> (Vec3, [f32; 2]) {
        let mut words = [0.0; LANES];
        words[lane] = f32::from_bits(packed);
        dispatch!(Level::new(), simd => {
            let normals = Vectors::splat(simd, normal);
            let ellipses = decode_each(simd, normals, f32x8::from_slice(simd, &words));
            let half_axes = ellipses.half_axes(simd).map(|lengths| lengths[lane]);
            (ellipses.axes.lane(lane), half_axes)
        })
    }

    proptest! {
        #[test]
        fn unpacked_ellipses_match_the_scalar_decoder(
            packed_normal in prop::array::uniform2(-32767i16..=32767),
            direction in 0u32..=0xffff,
            ratio in 1u32..=0xffff,
            lane in 0..LANES,
        ) {
            let packed = direction << 16 | ratio;
            let normal = oct_decode(packed_normal);
            let expected = decode_ellipse(packed_normal, packed);
            let (axis, half_axes) = decoded(normal, packed, lane);
            prop_assert!((axis - expected.axis).length() < 1e-5, "{axis} for {}", expected.axis);
            let reach = dispatch!(Level::new(), simd => {
                reach_each(simd, f32x8::splat(simd, f32::from_bits(packed)))[lane]
            });
            prop_assert_eq!(reach, half_axes[0]);
            for (found, expected) in half_axes.into_iter().zip(expected.half_axes_of_quadratic_mean(1.0)) {
                prop_assert!((found - expected).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn circles_have_equal_axes() {
        for normal in [Vec3::Z, Vec3::NEG_Z, Vec3::X] {
            let (axis, half_axes) = decoded(normal, 0, 3);
            assert!(axis.is_normalized() && axis.dot(normal).abs() < 1e-6);
            assert_eq!(half_axes, [1.0; 2]);
        }
    }
}
