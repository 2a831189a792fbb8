//! Eight pixels of an image: from bytes to colours and back.

use super::tile::LANES;
use fearless_simd::{Bytes, Simd, SimdBase, SimdFloat, f32x8, u32x8};

/// The highest byte of a pixel.
pub(super) const OPAQUE_ALPHA: u32 = 0xff00_0000;

/// Bytes of eight colours, which are 0 to 1: red the lowest.
#[inline(always)]
pub(super) fn opaque<S: Simd>(simd: S, colors: [f32x8<S>; 3]) -> u32x8<S> {
    let [red, green, blue] = colors;
    let (red, green, blue) = (byte(simd, red), byte(simd, green), byte(simd, blue));
    red | (green << 8) | (blue << 16) | u32x8::splat(simd, OPAQUE_ALPHA)
}

#[inline(always)]
fn byte<S: Simd>(simd: S, channel: f32x8<S>) -> u32x8<S> {
    let scaled = channel.mul_add(f32x8::splat(simd, 255.0), f32x8::splat(simd, 0.5));
    let within = scaled.max(f32x8::splat(simd, 0.0)).min(f32x8::splat(simd, 255.0));
    simd.reinterpret_u32_i32x8(simd.cvt_i32_f32x8(within))
}

/// Sets the alpha of an image whose rows are finished to opaque.
#[inline(always)]
pub(in crate::render) fn make_opaque(pixels: &mut [[u8; 4]]) {
    for pixel in pixels {
        *pixel = (u32::from_le_bytes(*pixel) | OPAQUE_ALPHA).to_le_bytes();
    }
}

/// The colours and the fourth bytes of up to eight pixels, 0 to 1.
#[inline(always)]
pub(in crate::render) fn unpacked<S: Simd>(simd: S, pixels: &[[u8; 4]]) -> ([f32x8<S>; 3], f32x8<S>) {
    let mut words = [0u32; LANES];
    for (word, pixel) in words.iter_mut().zip(pixels) {
        *word = u32::from_le_bytes(*pixel);
    }
    let words = u32x8::from_slice(simd, &words);
    let colors = [
        channel(simd, words),
        channel(simd, words >> 8),
        channel(simd, words >> 16),
    ];
    (colors, channel(simd, words >> 24))
}

/// The lowest bytes, 0 to 1.
#[inline(always)]
fn channel<S: Simd>(simd: S, words: u32x8<S>) -> f32x8<S> {
    let byte = words & u32x8::splat(simd, 0xff);
    // Signed numbers are converted by a single instruction.
    simd.cvt_f32_i32x8(byte.bitcast()) * (1.0 / 255.0)
}

/// Writes eight opaque colours to at most that many pixels.
#[inline(always)]
pub(in crate::render) fn pack<S: Simd>(simd: S, colors: [f32x8<S>; 3], pixels: &mut [[u8; 4]]) {
    let eight = opaque(simd, colors);
    for (pixel, &color) in pixels.iter_mut().zip(eight.as_slice()) {
        *pixel = color.to_le_bytes();
    }
}

/// Writes eight colours like [`pack`], keeping the fourth bytes that are there.
#[inline(always)]
pub(in crate::render) fn repack<S: Simd>(simd: S, colors: [f32x8<S>; 3], pixels: &mut [[u8; 4]]) {
    let eight = opaque(simd, colors);
    for (pixel, &color) in pixels.iter_mut().zip(eight.as_slice()) {
        let [red, green, blue, _] = color.to_le_bytes();
        *pixel = [red, green, blue, pixel[3]];
    }
}
