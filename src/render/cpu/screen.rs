//! Screen-space steps after all tiles are drawn: effects that look beyond tiles, such as eye-dome lighting and the
//! ground grid, and the filling of gaps and splat edges.
//!
//! How it works: tiles leave reversed depths next to the image, and opacities instead of its alpha. Then rows are
//! processed once more, step after step, in place; most of them are still in a cache. Without such steps no depths are
//! stored and no rows are processed again.
//!
//! Opacities are needed since the background is in the image already, and is not shaded. A colour `c` that covers a
//! pixel by `a` gives `a · c + (1 - a) · background`; with the shade `s` it should be `s · a · c + (1 - a) ·
//! background`, which is `s · picture + (1 - s) · (1 - a) · background`.

use super::photos::Projected;
use super::pixels::make_opaque;
use super::rims::cover_rims;
use super::view::PixelView;
use crate::render::effects::background::cpu::Gradient;
use crate::render::effects::{self, OnCpu, PictureRow, RowStep, Stage};
use crate::scene::{ScenePacket, gap_px, rim_px};
use fearless_simd::Level;
use rayon::prelude::*;

/// Rows that a thread goes through before the next ones: halos around them are read from the second cache.
const ROWS_PER_TASK: usize = 32;

/// The steps of a packet.
pub(super) struct Screen {
    view: PixelView,
    /// Steps on the drawn scene, before gaps and splat edges let other surfaces through.
    drawn: Vec<Box<dyn RowStep>>,
    /// Steps on the finished image.
    picture: Vec<Box<dyn RowStep>>,
    gradient: Gradient,
    /// Maximum width of the splat edges through which other surfaces shine; 0: none.
    rim_px: u32,
}

impl Screen {
    /// `None` where nothing is to be done.
    pub(super) fn of(packet: &ScenePacket) -> Option<Self> {
        let [drawn, picture] = [Stage::Drawn, Stage::Picture].map(|stage| steps(packet, stage));
        let rim_px = rim_px(packet);
        let looks_around = rim_px > 0 || gap_px(packet) > 0;
        (!drawn.is_empty() || !picture.is_empty() || looks_around).then(|| Self {
            view: PixelView::new(packet),
            drawn,
            picture,
            gradient: Gradient::of(packet),
            rim_px,
        })
    }

    /// Finishes an image with its reversed depths. Gaps are closed by `posed_images`.
    pub(super) fn draw(&self, image: &mut [u8], depths: &[f32], posed_images: Option<&Projected<'_>>) {
        let posed_images = posed_images.filter(|posed_images| posed_images.closes_gaps());
        if posed_images.is_none() && self.rim_px == 0 {
            self.draw_rows([&self.drawn, &self.picture], image, depths, make_opaque);
            return;
        }
        if !self.drawn.is_empty() {
            self.draw_rows([&self.drawn, &[]], image, depths, |_| {});
        }
        match posed_images {
            Some(posed_images) => posed_images.close_gaps(&self.view, self.rim_px, &self.gradient, image, depths),
            None => cover_rims(self.view.size_px, self.rim_px, &self.gradient, image, depths),
        }
        self.draw_rows([&[], &self.picture], image, depths, make_opaque);
    }

    /// Takes rows through steps, and then through the last one.
    fn draw_rows(
        &self,
        steps: [&[Box<dyn RowStep>]; 2],
        image: &mut [u8],
        depths: &[f32],
        last: impl Fn(&mut [[u8; 4]]) + Sync,
    ) {
        let size_px = self.view.size_px.map(|edge| edge as usize);
        let row_bytes = 4 * size_px[0];
        let level = Level::new();
        let tasks = image.par_chunks_mut(row_bytes * ROWS_PER_TASK).enumerate();
        tasks.for_each(|(task, rows)| {
            for (y, row) in (ROWS_PER_TASK * task..).zip(rows.chunks_exact_mut(row_bytes)) {
                let (pixels, _) = row.as_chunks_mut::<4>();
                let mut row = PictureRow {
                    level,
                    y,
                    size_px,
                    pixels,
                    depths,
                };
                steps.into_iter().flatten().for_each(|step| step.draw(&mut row));
                last(row.pixels);
            }
        });
    }
}

/// Returns the row steps of a stage.
fn steps(packet: &ScenePacket, stage: Stage) -> Vec<Box<dyn RowStep>> {
    let of_stage = effects::of_stage(packet, stage);
    let steps = of_stage.filter_map(|effect| match effect.on_cpu {
        OnCpu::Rows(step) => step(packet),
        OnCpu::InTiles | OnCpu::Shown(_) => None,
    });
    steps.collect()
}
