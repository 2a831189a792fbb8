//! Eight display-referred channels to linear light and back, after the curves of sRGB (IEC 61966-2-1).
//!
//! How it works: where the curves are powers, polynomials stand for them, of the channel and of the root of the light.
//! Both are off by less than a twentieth of a byte's step (`shaders/common/linear.wgsl` takes the powers).

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// Below it channels are proportional to light, and light below the other.
const LINEAR_CHANNEL: f32 = 0.040_45;
const LINEAR_LIGHT: f32 = 0.003_130_8;
const CHANNEL_PER_LIGHT: f32 = 12.92;

/// The light of channels from 0 to 1.
#[inline(always)]
pub(super) fn to_linear<S: Simd>(simd: S, channel: f32x8<S>) -> f32x8<S> {
    let splat = |value: f32| f32x8::splat(simd, value);
    let series = channel.mul_add(splat(0.087_275_94), splat(-0.307_363_55));
    let series = channel.mul_add(series, splat(0.667_150_3));
    let series = channel.mul_add(series, splat(0.519_385));
    let series = channel.mul_add(series, splat(0.032_745_763));
    let series = channel.mul_add(series, splat(0.000_916_900_1));
    let is_small = channel.simd_le(splat(LINEAR_CHANNEL));
    simd.select_f32x8(is_small, channel * (1.0 / CHANNEL_PER_LIGHT), series)
}

/// The channels of light from 0 to 1.
#[inline(always)]
pub(super) fn to_display<S: Simd>(simd: S, light: f32x8<S>) -> f32x8<S> {
    let splat = |value: f32| f32x8::splat(simd, value);
    let root = light.sqrt();
    let series = root.mul_add(splat(-0.947_427_45), splat(3.417_941_6));
    let series = root.mul_add(series, splat(-5.002_302_6));
    let series = root.mul_add(series, splat(3.897_965_4));
    let series = root.mul_add(series, splat(-1.899_350_8));
    let series = root.mul_add(series, splat(1.575_256_5));
    let series = root.mul_add(series, splat(-0.042_231_426));
    let is_small = light.simd_le(splat(LINEAR_LIGHT));
    simd.select_f32x8(is_small, light * CHANNEL_PER_LIGHT, series)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    fn light_of(channel: f64) -> f64 {
        if channel <= 0.04045 {
            channel / 12.92
        } else {
            ((channel + 0.055) / 1.055).powf(2.4)
        }
    }

    fn channel_of(light: f64) -> f64 {
        if light <= 0.003_130_8 {
            light * 12.92
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        }
    }

    /// A twentieth of a step of bytes.
    const OFF: f64 = 0.05 / 255.0;

    proptest! {
        #[test]
        fn transfer_curves_match_the_standard(channel in 0.0f32..=1.0) {
            let exact = light_of(f64::from(channel));
            let (light, back) = dispatch!(Level::new(), simd => {
                let light = to_linear(simd, f32x8::splat(simd, channel));
                (light[0], to_display(simd, f32x8::splat(simd, exact as f32))[0])
            });
            prop_assert!((channel_of(f64::from(light)) - f64::from(channel)).abs() < OFF, "{channel}: {light} {exact}");
            prop_assert!((f64::from(back) - f64::from(channel)).abs() < OFF, "{exact}: {back} {channel}");
        }
    }

    #[test]
    fn every_byte_round_trips() {
        for byte in 0..=255u8 {
            let channel = f32::from(byte) / 255.0;
            let back = dispatch!(Level::new(), simd => {
                to_display(simd, to_linear(simd, f32x8::splat(simd, channel)))[0]
            });
            assert!((back * 255.0 - f32::from(byte)).abs() < 0.1, "{byte}: {}", back * 255.0);
        }
    }
}
