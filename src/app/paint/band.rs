//! From layers to pixels, in bands of rows that threads share.
//!
//! **How it works.** A rectangle of a band is painted from the last layer that hides all of it, or from black. If there
//! is much to paint, bands are parallel tasks; nothing is shared between them, and pixels do not depend on their
//! number.

use super::PixelRect;
use super::blend::lay;
use super::canvas::Canvas;
use super::image::Image;
use super::pieces::{Piece, PixelMesh};
use super::textures::SampledTexture;
use super::triangle;
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Rows of a band: a few tasks for each thread, and layers are not traversed too often.
const BAND_ROWS: usize = 64;

/// Smaller areas are painted by one thread. Most of an area is an image, which is copied: 0.13 ms for a million pixels,
/// while on a busy machine another thread may not begin for four.
const WORTH_SHARING_PX: u64 = 4_000_000;

/// A mesh to be painted, with its texture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layer<'a> {
    mesh: &'a PixelMesh,
    source: SampledTexture<'a>,
    /// Pixels that show nothing of the layers before.
    hides: PixelRect,
}

impl<'a> Layer<'a> {
    pub(super) fn new(mesh: &'a PixelMesh, source: SampledTexture<'a>) -> Self {
        let hides = if source.is_opaque() {
            mesh.hidden_by_image
        } else {
            mesh.hidden_by_fill
        };
        Self { mesh, source, hides }
    }

    #[inline(always)]
    fn paint(&self, rect: &PixelRect, canvas: &mut Canvas<'_>) {
        for piece in &self.mesh.pieces {
            let part = piece.area().intersection(rect);
            if part.is_empty() {
                continue;
            }
            match piece {
                Piece::Fill { color, .. } => {
                    for pixels in canvas.spans(&part) {
                        lay(*color, pixels);
                    }
                }
                Piece::Image { area, place, tint } => {
                    let image = Image {
                        source: self.source,
                        place: *place,
                        tint: *tint,
                        area: *area,
                    };
                    image.paint(&part, canvas);
                }
                Piece::Triangle { corners, kind, .. } => {
                    let vertices = &self.mesh.vertices;
                    let vertex = |index: u32| vertices[index as usize];
                    let [a, b, c] = *corners;
                    let corners = [vertex(a), vertex(b), vertex(c)];
                    triangle::paint(&corners, *kind, &self.source, &part, canvas);
                }
            }
        }
    }
}

/// Paints the rectangles, which are in the window.
pub(super) fn paint(layers: &[Layer<'_>], region: &[PixelRect], width_px: u32, target: &mut [u32]) {
    if width_px == 0 {
        return;
    }
    let area_px: u64 = region.iter().map(PixelRect::area_px).sum();
    if area_px < WORTH_SHARING_PX {
        paint_rows(layers, region, width_px, 0, target);
    } else {
        target
            .par_chunks_mut(BAND_ROWS * width_px as usize)
            .enumerate()
            .for_each(|(band, pixels)| {
                let first_row = (BAND_ROWS * band) as u32;
                paint_rows(layers, region, width_px, first_row, pixels);
            });
    }
}

/// Paints the part of the rectangles in some rows.
fn paint_rows(layers: &[Layer<'_>], region: &[PixelRect], width_px: u32, first_row: u32, pixels: &mut [u32]) {
    let rows = (pixels.len() / width_px as usize) as u32;
    let band = PixelRect {
        min: [0, first_row],
        max: [width_px, first_row + rows],
    };
    let mut canvas = Canvas {
        pixels,
        width_px,
        first_row,
    };
    for rect in region {
        let rect = rect.intersection(&band);
        if rect.is_empty() {
            continue;
        }
        dispatch!(Level::new(), _simd => paint_rect(layers, &rect, &mut canvas));
    }
}

#[inline(always)]
fn paint_rect(layers: &[Layer<'_>], rect: &PixelRect, canvas: &mut Canvas<'_>) {
    let hides_all = |layer: &Layer<'_>| layer.hides.holds(rect);
    let first = layers.iter().rposition(hides_all);
    if first.is_none() {
        for pixels in canvas.spans(rect) {
            pixels.fill(0);
        }
    }
    for layer in &layers[first.unwrap_or(0)..] {
        if layer.mesh.bounds.touches(rect) {
            layer.paint(rect, canvas);
        }
    }
}
