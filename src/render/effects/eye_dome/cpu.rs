//! Eye-dome lighting on the CPU (`shaders/effects/eye_dome.wgsl`): the shades of eight pixels of a row at a time.
//!
//! How it works: from the row, and from the rows above and below that contain neighbours, the depths of eight pixels
//! are read from where the neighbours begin; one division, and a product and two comparisons for each of them, give the
//! sum of steps. Near the borders of the image neighbours are gathered one by one.

use crate::render::cpu::pixels::{repack, unpacked};
use crate::render::cpu::tile::LANES;
use crate::render::effects::background::cpu::Gradient;
use crate::render::effects::effect::{PictureRow, RowStep};
use crate::scene::{EyeDomeLight, ScenePacket};
use fearless_simd::{Bytes, Simd, SimdBase, SimdFloat, dispatch, f32x8};

/// Shades the surface that covers the background.
#[derive(Debug)]
struct Shading {
    light: EyeDomeLight,
    gradient: Gradient,
}

/// The settings of a packet.
pub(super) fn step(packet: &ScenePacket) -> Option<Box<dyn RowStep>> {
    let light = EyeDomeLight::of(packet)?;
    let gradient = Gradient::of(packet);
    Some(Box::new(Shading { light, gradient }))
}

impl RowStep for Shading {
    fn draw(&self, row: &mut PictureRow<'_>) {
        let background = self.gradient.at_row(row.y as i32);
        dispatch!(row.level, simd => {
            simd.vectorize(
                #[inline(always)]
                || {
                    let eye_dome = EyeDome::of_row(&self.light, row.size_px, row.depths, row.y);
                    for (chunk, pixels) in row.pixels.chunks_mut(LANES).enumerate() {
                        if let Some(shade) = eye_dome.shades(simd, LANES * chunk) {
                            shaded(simd, pixels, shade, background);
                        }
                    }
                },
            );
        });
    }
}

/// A row of an image, and those around it.
struct EyeDome<'a> {
    light: &'a EyeDomeLight,
    row: &'a [f32],
    /// As far above and below as neighbours in a column are.
    straight: [&'a [f32]; 2],
    /// As far above and below as those on diagonals are.
    diagonal: [&'a [f32]; 2],
}

impl<'a> EyeDome<'a> {
    /// Prepares eye-dome lighting for the row `y` of reversed depths.
    #[inline(always)]
    fn of_row(light: &'a EyeDomeLight, [width, height]: [usize; 2], depths: &'a [f32], y: usize) -> Self {
        let row = |y: usize| {
            let y = y.min(height - 1);
            &depths[width * y..width * (y + 1)]
        };
        let [straight, diagonal] = light.reach_px.map(|reach| reach as usize);
        Self {
            light,
            row: row(y),
            straight: [row(y.saturating_sub(straight)), row(y + straight)],
            diagonal: [row(y.saturating_sub(diagonal)), row(y + diagonal)],
        }
    }

    /// The shades of eight pixels from `x` on; `None` where none has a depth. Past the end of the row, of missing
    /// pixels.
    #[inline(always)]
    fn shades<S: Simd>(&self, simd: S, x: usize) -> Option<f32x8<S>> {
        let halo = self.light.halo_px() as usize;
        if x >= halo && x + LANES + halo <= self.row.len() {
            self.shades_of(
                simd,
                #[inline(always)]
                |row: &[f32], to_right: isize| {
                    let first = x.wrapping_add_signed(to_right);
                    f32x8::from_slice(simd, &row[first..first + LANES])
                },
            )
        } else {
            self.shades_of(
                simd,
                #[inline(always)]
                |row: &[f32], to_right: isize| {
                    let mut eight = [0.0; LANES];
                    for (lane, depth) in eight.iter_mut().enumerate() {
                        // The last pixel of the row stands in for all beyond it.
                        let own = (x + lane).min(row.len() - 1);
                        *depth = row[own.saturating_add_signed(to_right).min(row.len() - 1)];
                    }
                    f32x8::from_slice(simd, &eight)
                },
            )
        }
    }

    #[inline(always)]
    fn shades_of<S: Simd>(&self, simd: S, depths_at: impl Fn(&[f32], isize) -> f32x8<S>) -> Option<f32x8<S>> {
        let nothing = f32x8::splat(simd, 0.0);
        let own = depths_at(self.row, 0);
        let is_drawn = own.simd_gt(nothing);
        if !simd.any_true_mask32x8(is_drawn) {
            return None;
        }
        let light = self.light;
        let per_depth = 1.0 / simd.select_f32x8(is_drawn, own, f32x8::splat(simd, 1.0));
        let [straight, diagonal] = light.reach_px.map(|reach| reach as isize);
        let [gain, gain_aslant] = light.gains;
        let in_line = [per_depth * gain, f32x8::splat(simd, gain)];
        let aslant = [per_depth * gain_aslant, f32x8::splat(simd, gain_aslant)];
        let max = f32x8::splat(simd, light.max);
        let mut sums = [nothing; 2];
        add(simd, &mut sums, depths_at(self.row, -straight), in_line, max);
        add(simd, &mut sums, depths_at(self.row, straight), in_line, max);
        for row in self.straight {
            add(simd, &mut sums, depths_at(row, 0), in_line, max);
        }
        for row in self.diagonal {
            add(simd, &mut sums, depths_at(row, -diagonal), aslant, max);
            add(simd, &mut sums, depths_at(row, diagonal), aslant, max);
        }
        let [steps, outside] = sums;
        let edge = outside * (EyeDomeLight::LONE - outside).max(nothing) * light.edge;
        let darkness = steps + edge;
        let shades = exp_of_minus(simd, darkness);
        Some(simd.select_f32x8(is_drawn, shades, f32x8::splat(simd, 1.0)))
    }
}

/// Adds the effect of a neighbour of each of eight pixels: steps, and the share of neighbours without depth.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    [steps, outside]: &mut [f32x8<S>; 2],
    depths: f32x8<S>,
    [scale, gain]: [f32x8<S>; 2],
    max: f32x8<S>,
) {
    let nothing = f32x8::splat(simd, 0.0);
    *steps += depths.mul_sub(scale, gain).max(nothing).min(max);
    let is_there = depths.simd_gt(nothing);
    *outside += simd.select_f32x8(is_there, nothing, f32x8::splat(simd, 0.125));
}

/// `exp(-x)` for x from 0 up, to a part in 100,000: far below the precision of a byte.
#[inline(always)]
fn exp_of_minus<S: Simd>(simd: S, x: f32x8<S>) -> f32x8<S> {
    let y = (x * -std::f32::consts::LOG2_E).max(-60.0);
    let whole = y.floor();
    let part = y - whole;
    // 2^part for 0 to 1, exact at both ends: the polynomial with the smallest relative error, 3.3e-6.
    let series = part.mul_add(0.013_555_74, 0.052_032_36);
    let series = part.mul_add(series, 0.241_379_78);
    let series = part.mul_add(series, 0.693_032_1);
    let series = part.mul_add(series, 1.0);
    // The exponent's bits are above the 23 bits of the mantissa.
    let exponent = (simd.cvt_i32_f32x8(whole) + 127) << 23;
    series * exponent.bitcast::<f32x8<S>>()
}

/// Multiplies the surface that covers the background by up to eight shades.
#[inline(always)]
fn shaded<S: Simd>(simd: S, pixels: &mut [[u8; 4]], shade: f32x8<S>, background: [f32; 3]) {
    let ([red, green, blue], opacity) = unpacked(simd, pixels);
    let behind = (1.0 - shade) * (1.0 - opacity);
    let [behind_red, behind_green, behind_blue] = background;
    let colors = [
        red.mul_add(shade, behind * behind_red),
        green.mul_add(shade, behind * behind_green),
        blue.mul_add(shade, behind * behind_blue),
    ];
    // Gap filling and soft edges follow, and need opacities.
    repack(simd, colors, pixels);
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    /// Sums according to the doc of [`EyeDomeLight`], pixel by pixel.
    fn by_definition(light: &EyeDomeLight, [width, height]: [usize; 2], depths: &[f32], [x, y]: [usize; 2]) -> f32 {
        let own = depths[width * y + x];
        if own == 0.0 {
            return 1.0;
        }
        let (mut steps, mut outside) = (0.0, 0.0);
        for (right, down) in [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (-1, 1), (1, -1), (1, 1)] {
            let way = usize::from(right != 0 && down != 0);
            let reach = light.reach_px[way] as i32;
            let x = (x as i32 + right * reach).clamp(0, width as i32 - 1) as usize;
            let y = (y as i32 + down * reach).clamp(0, height as i32 - 1) as usize;
            let depth = depths[width * y + x];
            steps += (light.gains[way] * (depth / own - 1.0)).clamp(0.0, light.max);
            outside += if depth == 0.0 { 0.125 } else { 0.0 };
        }
        (-(steps + light.edge * outside * (EyeDomeLight::LONE - outside).max(0.0))).exp()
    }

    fn light(reach_px: [u32; 2]) -> EyeDomeLight {
        EyeDomeLight {
            reach_px,
            gains: [37.5, 30.0],
            max: 0.9,
            edge: 5.0,
        }
    }

    fn shade_at(light: &EyeDomeLight, size: [usize; 2], depths: &[f32], [x, y]: [usize; 2]) -> f32 {
        dispatch!(Level::new(), simd => {
            let row = EyeDome::of_row(light, size, depths, y);
            let first = x - x % LANES;
            row.shades(simd, first).map_or(1.0, |shades| shades[x - first])
        })
    }

    proptest! {
        #[test]
        fn shading_matches_the_definition_at_every_pixel(
            depths in prop::collection::vec(prop_oneof![Just(0.0f32), 0.4f32..0.5], 37 * 9),
            reach_px in prop::array::uniform2(1u32..12),
        ) {
            let (size, light) = ([37, 9], light(reach_px));
            for place in 0..37 * 9 {
                let at = [place % 37, place / 37];
                let expected = by_definition(&light, size, &depths, at);
                let shade = shade_at(&light, size, &depths, at);
                prop_assert!((shade - expected).abs() < 1e-4, "{:?}: {} {}", at, shade, expected);
            }
        }

        #[test]
        fn exponentials_are_accurate(x in 0.0f32..30.0) {
            let power = dispatch!(Level::new(), simd => exp_of_minus(simd, f32x8::splat(simd, x))[0]);
            prop_assert!((power - (-x).exp()).abs() < 1e-5 * (-x).exp() + 1e-12, "{} {}", power, (-x).exp());
        }
    }
}
