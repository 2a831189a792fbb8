//! Fast approximate antialiasing (Lottes 2009) on the CPU (`shaders/effects/fxaa.wgsl`).
//!
//! **How it works.** For pixels whose luma differs from that of their neighbours, second derivatives determine if an
//! edge runs along the row or the column, and the greater difference on which side of the pixel it is. Both of its ends
//! are searched for: there the mean luma of the two pixels adjacent to it changes. An edge between two ends is taken
//! for a straight line that crosses the row of pixels; if its nearer end turns towards the pixel, the line covers a
//! part of it, depending on the position between the ends. That fraction of the neighbour is mixed in. Details of
//! single pixels are mixed with their surroundings.
//!
//! Fractions count pixel centres between the ends, so that straight edges are covered exactly; Lottes counts from their
//! borders.

use crate::render::constants::{
    FXAA_BLUE, FXAA_DETAIL, FXAA_END_OF_EDGE, FXAA_GREEN, FXAA_MAX_BLENDED, FXAA_MIN_CONTRAST, FXAA_MIN_SHARE, FXAA_RED,
};
use crate::scene::Antialiasing;
use glam::Vec3;
use image::RgbaImage;
use rayon::prelude::*;

/// The drawn image.
struct AliasedPicture<'a> {
    pixels: &'a [[u8; 4]],
    lumas: &'a [f32],
    size_px: [i32; 2],
}

/// The luma of a pixel, and of those above, below, left and right of it.
struct Cross {
    center: f32,
    sides: [f32; 4],
}

/// Makes `shown`, of the same size, of `drawn`.
pub(super) fn smooth(drawn: &RgbaImage, shown: &mut RgbaImage) {
    let size_px @ [width, height] = [drawn.width(), drawn.height()].map(|edge| edge as i32);
    let (pixels, _) = drawn.as_chunks();
    let lumas: Vec<f32> = pixels.par_iter().map(|&pixel| luma(color(pixel))).collect();
    let drawn = AliasedPicture {
        pixels,
        lumas: &lumas,
        size_px,
    };
    let rows = shown.par_chunks_exact_mut(4 * width as usize);
    rows.enumerate().for_each(|(y, row)| {
        let y = y as i32;
        let own = drawn.row_of_lumas(y);
        let (above, below) = (
            drawn.row_of_lumas((y - 1).max(0)),
            drawn.row_of_lumas((y + 1).min(height - 1)),
        );
        for (x, pixel) in row.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let cross = Cross {
                center: own[x],
                sides: [
                    above[x],
                    below[x],
                    own[x.saturating_sub(1)],
                    own[(x + 1).min(own.len() - 1)],
                ],
            };
            let place = [x as i32, y];
            *pixel = match cross.contrast() {
                Some(contrast) => drawn.smoothed(place, &cross, contrast),
                None => drawn.pixel(place),
            };
        }
    });
}

impl Cross {
    /// Between the lightest and the darkest of them; `None` where that is too little for an edge.
    fn contrast(&self) -> Option<f32> {
        let max = self.sides.iter().copied().fold(self.center, f32::max);
        let contrast = max - self.sides.iter().copied().fold(self.center, f32::min);
        (contrast >= FXAA_MIN_CONTRAST.max(FXAA_MIN_SHARE * max)).then_some(contrast)
    }
}

impl AliasedPicture<'_> {
    fn row_of_lumas(&self, y: i32) -> &[f32] {
        let width = self.size_px[0] as usize;
        &self.lumas[width * y as usize..width * (y as usize + 1)]
    }

    /// Returns the index of a pixel, clamped to the border of the image.
    fn index(&self, [x, y]: [i32; 2]) -> usize {
        let [width, height] = self.size_px;
        let [x, y] = [x.clamp(0, width - 1), y.clamp(0, height - 1)];
        (y * width + x) as usize
    }

    fn pixel(&self, place: [i32; 2]) -> [u8; 4] {
        self.pixels[self.index(place)]
    }

    fn luma(&self, place: [i32; 2]) -> f32 {
        self.lumas[self.index(place)]
    }

    fn smoothed(&self, place @ [x, y]: [i32; 2], cross: &Cross, contrast: f32) -> [u8; 4] {
        let Cross {
            center,
            sides: [north, south, west, east],
        } = *cross;
        let own = color(self.pixel(place));
        let sides = [[x, y - 1], [x, y + 1], [x - 1, y], [x + 1, y]].map(|side| color(self.pixel(side)));
        let corners = [[-1, -1], [1, -1], [-1, 1], [1, 1]].map(|[right, down]| [x + right, y + down]);
        let [north_west, north_east, south_west, south_east] = corners.map(|corner| self.luma(corner));
        let corners = corners.map(|corner| color(self.pixel(corner)));
        let across_rows = (north_west + south_west - 2.0 * west).abs()
            + 2.0 * (north + south - 2.0 * center).abs()
            + (north_east + south_east - 2.0 * east).abs();
        let across_columns = (north_west + north_east - 2.0 * north).abs()
            + 2.0 * (west + east - 2.0 * center).abs()
            + (south_west + south_east - 2.0 * south).abs();
        let (along, [before, after]) = if across_rows >= across_columns {
            ([1, 0], [north, south])
        } else {
            ([0, 1], [west, east])
        };
        let [right, down] = along;
        let (neighbor, other) = if (before - center).abs() >= (after - center).abs() {
            ([-down, -right], before)
        } else {
            ([down, right], after)
        };
        let share = self.covered(place, center, other, neighbor, along);
        let smooth_edge = own.lerp(color(self.pixel(sum(place, neighbor))), share);
        let detail = (0.25 * (north + south + west + east) - center).abs() / contrast - FXAA_DETAIL;
        let blended = (detail / (1.0 - FXAA_DETAIL)).clamp(0.0, FXAA_MAX_BLENDED);
        let around = (own + sides.iter().sum::<Vec3>() + corners.iter().sum::<Vec3>()) / 9.0;
        let smooth = smooth_edge.lerp(around, blended) * 255.0 + 0.5;
        let [red, green, blue] = smooth.to_array().map(|channel| channel as u8);
        [red, green, blue, 255]
    }

    /// The share of the pixel at `place`, whose luma is `center`, that is beyond the edge between it and its neighbour
    /// `neighbor` it, whose luma is `other`.
    fn covered(&self, place: [i32; 2], center: f32, other: f32, neighbor: [i32; 2], along: [i32; 2]) -> f32 {
        let border = 0.5 * (center + other);
        let limit = FXAA_END_OF_EDGE * (other - center).abs();
        // The distance in pixels to the end of the edge, and how much lighter both sides are there.
        let end = |direction: i32| {
            let (mut steps, mut difference) = (0, 0.0f32);
            while steps < Antialiasing::FXAA_SEARCH_STEPS as i32 && difference.abs() < limit {
                steps += 1;
                let there = sum(place, along.map(|axis| axis * direction * steps));
                difference = 0.5 * (self.luma(there) + self.luma(sum(there, neighbor))) - border;
            }
            (steps as f32, difference)
        };
        let (back, ahead) = (end(-1), end(1));
        let (nearest, difference) = if back.0 < ahead.0 { back } else { ahead };
        // The edge turns towards this pixel where its nearer end has the luma of the other side.
        if (difference < 0.0) == (center < border) {
            return 0.0;
        }
        // The error on the outline of a cube is 0.06 of a pixel on average; four samples per pixel 0.09, no
        // antialiasing 0.25.
        0.5 - (nearest - 0.5) / (back.0 + ahead.0 - 1.0)
    }
}

fn color(pixel: [u8; 4]) -> Vec3 {
    let [red, green, blue, _] = pixel.map(f32::from);
    Vec3::new(red, green, blue) / 255.0
}

fn luma(color: Vec3) -> f32 {
    color.dot(Vec3::new(FXAA_RED, FXAA_GREEN, FXAA_BLUE))
}

fn sum([x, y]: [i32; 2], [right, down]: [i32; 2]) -> [i32; 2] {
    [x + right, y + down]
}
