//! What is done when all tiles are drawn: eye-dome lighting, gaps and rims, which look beyond them, and the grid on the
//! ground.
//!
//! How it works: tiles leave reversed depths beside the picture, and opacities in place of its alpha. Then rows are
//! gone through once more, eight pixels at a time, in place; most of them are in a cache still. Without such steps no
//! depths are kept and nothing is gone through.
//!
//! Opacities are needed since the background is in the picture already, and is not shaded. Of a colour `c` that covers
//! a pixel by `a` there is `a · c + (1 - a) · background`; with the shade `s` it is to be `s · a · c + (1 - a) ·
//! background`, which is `s · picture + (1 - s) · (1 - a) · background`.

use super::eye_dome::EyeDome;
use super::finish::Gradient;
use super::grid::Grid;
use super::photographs::Projected;
use super::pixels::{make_opaque, repack, unpacked};
use super::rims::cover_rims;
use super::tile::LANES;
use super::view::PixelView;
use crate::scene::{EyeDomeLight, ScenePacket, gap_px, rim_px};
use fearless_simd::{Level, Simd, SimdFloat, dispatch, f32x8};
use rayon::prelude::*;

/// Rows that a thread goes through before the next ones: halos around them are read from the second cache.
const ROWS_PER_TASK: usize = 32;

/// Which of the steps that go from row to row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Steps {
    All,
    /// Light.
    BeforeGaps,
    /// What is before and behind the surface.
    AfterGaps,
}

/// The steps of a packet.
pub(super) struct Screen {
    view: PixelView,
    eye_dome: Option<EyeDomeLight>,
    grid: Option<Grid>,
    gradient: Gradient,
    /// How wide rims are at most through which others shine; 0: none.
    rim_px: u32,
}

impl Screen {
    /// `None` where nothing is to be done.
    pub(super) fn of(packet: &ScenePacket) -> Option<Self> {
        let eye_dome = EyeDomeLight::of(packet);
        let ground = packet.ground.map(|ground| ground.seen_by(&packet.view));
        let rim_px = rim_px(packet);
        let looks_around = rim_px > 0 || gap_px(packet) > 0;
        (eye_dome.is_some() || ground.is_some() || looks_around).then(|| Self {
            view: PixelView::new(packet),
            eye_dome,
            grid: ground.map(|ground| Grid::new(ground, packet)),
            gradient: Gradient::of(packet),
            rim_px,
        })
    }

    /// Finishes a picture with its reversed depths. Gaps are closed by `photographs`.
    pub(super) fn draw(&self, image: &mut [u8], depths: &[f32], photographs: Option<&Projected<'_>>) {
        let photographs = photographs.filter(|photographs| photographs.closes_gaps());
        if photographs.is_none() && self.rim_px == 0 {
            self.draw_steps(Steps::All, image, depths);
            return;
        }
        if self.eye_dome.is_some() {
            self.draw_steps(Steps::BeforeGaps, image, depths);
        }
        match photographs {
            Some(photographs) => photographs.close_gaps(&self.view, self.rim_px, &self.gradient, image, depths),
            None => cover_rims(self.view.size_px, self.rim_px, &self.gradient, image, depths),
        }
        self.draw_steps(Steps::AfterGaps, image, depths);
    }

    fn draw_steps(&self, steps: Steps, image: &mut [u8], depths: &[f32]) {
        let width = self.view.size_px[0] as usize;
        let level = Level::new();
        let tasks = image.par_chunks_mut(4 * width * ROWS_PER_TASK).enumerate();
        tasks.for_each(|(task, rows)| {
            dispatch!(level, simd => {
                simd.vectorize(
                    #[inline(always)]
                    || self.draw_rows(simd, steps, ROWS_PER_TASK * task, rows, depths),
                );
            });
        });
    }

    #[inline(always)]
    fn draw_rows<S: Simd>(&self, simd: S, steps: Steps, first: usize, rows: &mut [u8], depths: &[f32]) {
        let size = self.view.size_px.map(|edge| edge as usize);
        for (y, row) in (first..).zip(rows.chunks_exact_mut(4 * size[0])) {
            let (pixels, _) = row.as_chunks_mut::<4>();
            let depths_of_row = &depths[size[0] * y..size[0] * (y + 1)];
            if let Some(light) = self.eye_dome.as_ref().filter(|_| steps != Steps::AfterGaps) {
                let background = self.gradient.at_row(y as i32);
                let eye_dome = EyeDome::of_row(light, size, depths, y);
                for (chunk, pixels) in pixels.chunks_mut(LANES).enumerate() {
                    let place = LANES * chunk;
                    if let Some(shade) = eye_dome.shades(simd, place) {
                        shaded(simd, pixels, shade, background);
                    }
                }
            }
            match &self.grid {
                _ if steps == Steps::BeforeGaps => {}
                Some(grid) => grid.draw_row(simd, y, depths_of_row, pixels),
                None => make_opaque(pixels),
            }
        }
    }
}

/// Multiplies what covers the background by up to eight shades.
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
    // Gaps and rims follow, and ask for opacities.
    repack(simd, colors, pixels);
}
