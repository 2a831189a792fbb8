//! Colours of 8 bits per channel, and blending.
//!
//! **How it works.** A colour is one word, `0xAARRGGBB`, premultiplied as in egui. Two channels are computed at a time
//! in lanes of 16 bits. A fragment is rounded to 8 bits before it is blended, and the colour below is divided by 255 as
//! in lavapipe: so even many blended layers give the same image. Channels are added with saturation, because colours
//! that only add light have more colour than alpha.

use egui::Color32;

/// Two channels of a word, each with space for a product.
const LANES: u32 = 0x00ff_00ff;

/// Half of 256 in both lanes.
const HALVES: u32 = 0x0080_0080;

/// Not transparent.
pub(super) const OPAQUE: u32 = 0xff00_0000;

/// egui's colour as a word.
#[inline(always)]
pub(super) fn packed(color: Color32) -> u32 {
    let [red, green, blue, alpha] = color.to_array();
    u32::from_be_bytes([alpha, red, green, blue])
}

/// Opacity, 0 to 255.
#[inline(always)]
pub(super) fn alpha(color: u32) -> u32 {
    color >> 24
}

/// Both lanes divided by 255, to the nearest.
#[inline(always)]
fn per_255(lanes: u32) -> u32 {
    let lanes = lanes + HALVES;
    ((lanes + ((lanes >> 8) & LANES)) >> 8) & LANES
}

/// Divides blended values by 255 as lavapipe blends: up to a hundredth farther from the quotient than the nearest.
#[inline(always)]
fn per_255_blended(lanes: u32) -> u32 {
    ((lanes + ((lanes >> 8) & LANES) + HALVES) >> 8) & LANES
}

/// All channels times `share` of 255.
#[inline(always)]
pub(super) fn dimmed(color: u32, share: u32) -> u32 {
    let even = per_255((color & LANES) * share);
    let odd = per_255(((color >> 8) & LANES) * share);
    even | odd << 8
}

/// Channels times channels.
#[inline(always)]
pub(super) fn times(a: u32, b: u32) -> u32 {
    let channel = |shift: u32| {
        let product = (a >> shift & 255) * (b >> shift & 255) + 128;
        ((product + (product >> 8)) >> 8) << shift
    };
    channel(0) | channel(8) | channel(16) | channel(24)
}

/// Both lanes of `a` and `b` added, 255 at most.
#[inline(always)]
fn added(a: u32, b: u32) -> u32 {
    let sum = a + b;
    let over = sum & 0x0100_0100;
    (sum | (over - (over >> 8))) & LANES
}

/// `fragment` over a pixel; the result has no alpha.
#[inline(always)]
pub(super) fn over(fragment: u32, pixel: u32) -> u32 {
    let shows_through = 255 - alpha(fragment);
    let even = per_255_blended((pixel & LANES) * shows_through);
    let green = per_255_blended((pixel >> 8 & 0xff) * shows_through);
    added(even, fragment & LANES) | added(green, fragment >> 8 & 0xff) << 8
}

/// Lays one colour over all of `pixels`.
#[inline(always)]
pub(super) fn lay(color: u32, pixels: &mut [u32]) {
    if color == 0 {
        return;
    }
    if alpha(color) == 255 {
        pixels.fill(color & !OPAQUE);
    } else {
        for pixel in pixels {
            *pixel = over(color, *pixel);
        }
    }
}

/// Channels of 0 to 255, rounded; values outside are clamped, and NaN is 0.
#[inline(always)]
pub(super) fn rounded(channels: [f32; 4]) -> u32 {
    /// Added to a number below 2²², it leaves the nearest integer in the lowest bits.
    const INTEGER: f32 = 12_582_912.0;
    let byte = |channel: f32| {
        // NaN passes through a clamp, but not through this.
        let positive = channel.max(0.0);
        (positive.min(255.0) + INTEGER).to_bits() & 255
    };
    let [red, green, blue, alpha] = channels;
    byte(alpha) << 24 | byte(red) << 16 | byte(green) << 8 | byte(blue)
}

/// Channels of 0 to 255.
#[inline(always)]
pub(super) fn channels(color: u32) -> [f32; 4] {
    let channel = |shift: u32| (color >> shift & 255) as f32;
    [channel(16), channel(8), channel(0), channel(24)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_correctly_rounded() {
        for a in 0..=255_u32 {
            for b in 0..=255_u32 {
                let exact = f64::from(a * b) / 255.0;
                let product = dimmed(a * 0x0101_0101, b);
                assert_eq!(product, (product & 255) * 0x0101_0101, "lanes are alike");
                assert_eq!(product, times(a * 0x0101_0101, b * 0x0101_0101));
                assert!((f64::from(product & 255) - exact).abs() <= 0.5, "{a} {b}");
                let blended = f64::from(over(a << 24, b));
                let exact = f64::from((255 - a) * b) / 255.0;
                assert!((blended - exact).abs() <= 0.51, "{a} {b}");
            }
        }
    }

    #[test]
    fn opaque_and_transparent_are_exact() {
        for pixel in [0, 0x0012_3456, 0x00ff_ffff, 0x00fe_01ff] {
            assert_eq!(over(0, pixel), pixel);
            assert_eq!(over(0xff65_4321, pixel), 0x0065_4321);
            assert_eq!(over(0x00ff_ffff, pixel), 0x00ff_ffff, "light is added");
        }
        assert_eq!(dimmed(0xfedc_ba98, 255), 0xfedc_ba98);
        assert_eq!(dimmed(0xfedc_ba98, 0), 0);
    }

    #[test]
    fn floats_are_converted_to_bytes() {
        assert_eq!(rounded([0.4, 0.6, 254.6, 300.0]), 0xff00_01ff);
        assert_eq!(rounded([f32::NAN, -5.0, f32::INFINITY, 128.0]), 0x8000_00ff);
        for color in [0x0102_0304, 0xfffe_8001] {
            assert_eq!(rounded(channels(color)), color);
        }
    }
}
