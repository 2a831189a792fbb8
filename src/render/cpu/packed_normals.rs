//! Eight normals at a time, out of their octahedral code.

use super::eight::Vectors;
use fearless_simd::{Bytes, Simd, SimdBase, SimdFloat, f32x8, i32x8};

/// As [`oct_decode`](crate::cloud::oct_decode).
#[inline(always)]
pub(super) fn oct_decode_each<S: Simd>(simd: S, packed: f32x8<S>) -> Vectors<S> {
    let splat = |value: f32| f32x8::splat(simd, value);
    let packed: i32x8<S> = packed.bitcast();
    let unit = |halves: i32x8<S>| simd.cvt_f32_i32x8(halves >> 16) * (1.0 / f32::from(i16::MAX));
    let (x, y) = (unit(packed << 16), unit(packed));
    let z = 1.0 - x.abs() - y.abs();
    let is_folded = z.simd_lt(splat(0.0));
    let one_like = |value: f32x8<S>| simd.select_f32x8(value.simd_ge(splat(0.0)), splat(1.0), splat(-1.0));
    let folded = Vectors {
        x: simd.select_f32x8(is_folded, (1.0 - y.abs()) * one_like(x), x),
        y: simd.select_f32x8(is_folded, (1.0 - x.abs()) * one_like(y), y),
        z,
    };
    folded.times(1.0 / folded.dot(folded).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::tile::LANES;
    use super::*;
    use crate::cloud::{oct_decode, oct_encode};
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn unpacked_normals_match_the_scalar_decoder(
            normal in prop::array::uniform3(-1.0f32..1.0),
            lane in 0..LANES,
        ) {
            let packed = oct_encode(glam::Vec3::from_array(normal).normalize_or(glam::Vec3::NEG_Z));
            let mut words = [0.0; LANES];
            words[lane] = bytemuck::cast(packed);
            let decoded = dispatch!(Level::new(), simd => {
                oct_decode_each(simd, f32x8::from_slice(simd, &words)).lane(lane)
            });
            prop_assert!((decoded - oct_decode(packed)).length() < 1e-6);
        }
    }
}
