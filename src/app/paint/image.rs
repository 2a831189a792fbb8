//! Images: parts of textures whose rows and columns match the window's.
//!
//! **How it works.** Glyphs and the 3-D image lie texel on pixel; then linear sampling and the nearest texel are the
//! same, and rows are taken as they are. An image's row is swizzled and copied, a glyph's texel is mostly coverage, the
//! same in all channels, which takes two products for the colour and two for the background. Linear scaling is in
//! `scaled`.

use super::PixelRect;
use super::blend::{OPAQUE, alpha, dimmed, over, times};
use super::canvas::Canvas;
use super::pieces::TexturePlacement;
use super::scaled;
use super::textures::{SampledTexture, Texels, swizzled};

/// Maximum distance of texels from pixels, in texels: a 1024th changes no channel by a step.
const ON_PIXEL: f32 = 1.0 / 1024.0;

/// An image to paint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Image<'a> {
    pub(super) source: SampledTexture<'a>,
    pub(super) place: TexturePlacement,
    pub(super) tint: u32,
    /// All pixels it covers: the result must not depend on which of them are painted.
    pub(super) area: PixelRect,
}

impl Image<'_> {
    /// Paints the pixels of `area`, the part of the image's area that is on the canvas.
    #[inline(always)]
    pub(super) fn paint(&self, area: &PixelRect, canvas: &mut Canvas<'_>) {
        match [self.first_texel(0), self.first_texel(1)] {
            [Some(left), Some(top)] => {
                let right_by = (area.min[0] - self.area.min[0]) as usize;
                let down_by = (area.min[1] - self.area.min[1]) as usize;
                self.paint_unscaled([left + right_by, top + down_by], area, canvas);
            }
            _ if self.source.is_linear => {
                scaled::paint(&self.source, &self.place, self.tint, area, canvas);
            }
            _ => self.paint_nearest(area, canvas),
        }
    }

    /// The texel of the first pixel along an axis, if the others follow one by one.
    fn first_texel(&self, axis: usize) -> Option<usize> {
        let edge = self.source.size[axis];
        let at = |pixel: u32| self.place.texel_at(axis, pixel, edge);
        let (first, last) = (at(self.area.min[axis]), at(self.area.max[axis] - 1));
        let steps = (self.area.max[axis] - 1 - self.area.min[axis]) as f32;
        // With nearest filtering the texel does not change while the position stays away from the texel's edges.
        let tolerance = if self.source.is_linear { ON_PIXEL } else { 0.25 };
        let is_on_texel = |at: f32| (at - at.floor() - 0.5).abs() <= tolerance;
        let is_unscaled = (last - first - steps).abs() <= tolerance;
        let is_inside = first >= 0.0 && last < edge as f32;
        (is_unscaled && is_inside && is_on_texel(first) && is_on_texel(last)).then_some(first as usize)
    }

    #[inline(always)]
    fn paint_unscaled(&self, first: [usize; 2], area: &PixelRect, canvas: &mut Canvas<'_>) {
        let width = self.source.size[0];
        for (y, pixels) in (first[1]..).zip(canvas.spans(area)) {
            let from = width * y + first[0];
            match self.source.texels {
                Texels::Picture(texels) => {
                    let texels = &texels[from..from + pixels.len()];
                    if self.tint == u32::MAX {
                        copy(texels, pixels);
                    } else {
                        for (pixel, &texel) in pixels.iter_mut().zip(texels) {
                            *pixel = over(times(swizzled(texel) | OPAQUE, self.tint), *pixel);
                        }
                    }
                }
                Texels::Words(texels) => {
                    let texels = &texels[from..from + pixels.len()];
                    cover(texels, self.tint, pixels);
                }
            }
        }
    }

    fn paint_nearest(&self, area: &PixelRect, canvas: &mut Canvas<'_>) {
        let Self { source, place, .. } = self;
        let texel_at = |axis: usize, pixel: u32| {
            let at = place.texel_at(axis, pixel, source.size[axis]);
            source.nearest(axis, at)
        };
        let columns: Vec<usize> = (area.min[0]..area.max[0]).map(|x| texel_at(0, x)).collect();
        for (y, pixels) in (area.min[1]..).zip(canvas.spans(area)) {
            let row = texel_at(1, y);
            for (pixel, &column) in pixels.iter_mut().zip(&columns) {
                *pixel = over(times(source.texel(column, row), self.tint), *pixel);
            }
        }
    }
}

/// Copies a row of an image.
#[inline(always)]
fn copy(texels: &[[u8; 4]], pixels: &mut [u32]) {
    for (pixel, &texel) in pixels.iter_mut().zip(texels) {
        *pixel = swizzled(texel);
    }
}

/// Lays a row of tinted texels over pixels.
#[inline(always)]
fn cover(texels: &[u32], tint: u32, pixels: &mut [u32]) {
    for (pixel, &texel) in pixels.iter_mut().zip(texels) {
        if texel == 0 {
            continue;
        }
        let coverage = texel & 255;
        let fragment = if texel == coverage * 0x0101_0101 {
            dimmed(tint, coverage)
        } else {
            times(texel, tint)
        };
        *pixel = if alpha(fragment) == 255 {
            fragment & !OPAQUE
        } else {
            over(fragment, *pixel)
        };
    }
}
