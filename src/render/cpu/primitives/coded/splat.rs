//! Splatting of masks to the pixels of a tile: the two passes, with weights that are looked up.
//!
//! How it works: eight pixels at a time, which begin at a multiple of eight, so that one splat writes and the next
//! reads the same words; the weights are read at their offset (`masks.rs`). Depth follows the splat's plane, whose
//! inverse is affine in pixels, but is not farther from the centre's depth than the splat reaches (the paper takes the
//! same depth everywhere, and needs a larger ε for it). Written without explicit registers: loops over eight numbers
//! are compiled to them.

use super::masks::{FULL_WEIGHT, Mask, Masks};
use crate::render::cpu::tile::{LANES, Tile, WIDTH};
use crate::render::cpu::view::PixelRect;

/// Position of a splat, and its depth gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct SplatPlacement {
    /// Pixel that contains its centre.
    pub(super) pixel: [i32; 2],
    /// Reversed depth, `near/distance`, at the centre of that pixel.
    pub(super) depth: f32,
    /// Depth gradient per pixel to the right, and downwards.
    pub(super) depth_per_px: [f32; 2],
    /// Depths of the splat's farthest and nearest point at most.
    pub(super) depths: [f32; 2],
}

/// A splat of the attribute pass that waits for the visibility pass to end.
#[derive(Debug, Clone, Copy)]
pub(super) struct WaitingMask {
    pub(super) place: SplatPlacement,
    pub(super) mask: Mask,
    /// Lit red, green and blue, 0 to 1.
    pub(super) color: [f32; 3],
}

/// Calls `visit` with the number of every eight pixels of a tile that a mask may cover, with their weights and the
/// depth of the first.
#[inline(always)]
fn for_each_eight(
    masks: &Masks,
    mask: &Mask,
    place: &SplatPlacement,
    tile_rect: PixelRect,
    mut visit: impl FnMut(usize, &[u8; LANES], f32),
) {
    let [tile_x, tile_y] = tile_rect.start;
    let left = place.pixel[0] - tile_x + i32::from(mask.left);
    let top = place.pixel[1] - tile_y + i32::from(mask.top);
    let width = (tile_rect.end[0] - tile_x).min(left + i32::from(mask.width));
    let height = (tile_rect.end[1] - tile_y).min(top + i32::from(mask.height));
    let lanes = LANES as i32;
    // Divisions that round down, of non-negative numbers.
    let first_eight = left.max(0) / lanes;
    let end_eight = (width + lanes - 1) / lanes;
    let [per_column, per_row] = place.depth_per_px;
    for y in top.max(0)..height {
        let row = (y - top) as usize;
        let down = (y + tile_y - place.pixel[1]) as f32;
        let depth_of_row = place.depth + per_row * down;
        for eight in first_eight..end_eight {
            let x = eight * lanes;
            let weights = masks.eight(mask, row, (x - left) as isize);
            let right = (x + tile_x - place.pixel[0]) as f32;
            let at = y as usize * (WIDTH / LANES) + eight as usize;
            visit(at, weights, depth_of_row + per_column * right);
        }
    }
}

/// The depth of the nearest surface, pushed back: depths are multiplied with `push_back`.
#[inline(always)]
pub(super) fn visibility(masks: &Masks, tile: &mut Tile, mask: &Mask, place: &SplatPlacement, push_back: f32) {
    let rect = tile.rect();
    let (there, _) = tile.depth.as_chunks_mut::<LANES>();
    let [farthest, nearest] = place.depths;
    let per_column = place.depth_per_px[0];
    for_each_eight(masks, mask, place, rect, |at, weights, first| {
        let there = &mut there[at];
        for lane in 0..LANES {
            let depth = clamped(first + per_column * lane as f32, farthest, nearest) * push_back;
            let drawn = if weights[lane] > 0 { depth } else { 0.0 };
            let drawn = if depth <= 1.0 { drawn } else { 0.0 };
            there[lane] = if drawn > there[lane] { drawn } else { there[lane] };
        }
    });
}

/// Sums weighted colours of fragments that are not behind the existing depths.
#[inline(always)]
pub(super) fn attribute(masks: &Masks, tile: &mut Tile, splat: &WaitingMask) {
    let WaitingMask { place, mask, color } = splat;
    let rect = tile.rect();
    let (depths, _) = tile.depth.as_chunks::<LANES>();
    let (sums, _) = tile.weight.as_chunks_mut::<LANES>();
    let [red, green, blue] = &mut tile.colors;
    let (red, _) = red.as_chunks_mut::<LANES>();
    let (green, _) = green.as_chunks_mut::<LANES>();
    let (blue, _) = blue.as_chunks_mut::<LANES>();
    let [farthest, nearest] = place.depths;
    let per_column = place.depth_per_px[0];
    for_each_eight(masks, mask, place, rect, |at, weights, first| {
        let there = &depths[at];
        let mut weight = [0.0; LANES];
        for lane in 0..LANES {
            let depth = clamped(first + per_column * lane as f32, farthest, nearest);
            let whole = f32::from(weights[lane]) * (1.0 / FULL_WEIGHT);
            let seen = if depth >= there[lane] { whole } else { 0.0 };
            weight[lane] = if depth <= 1.0 { seen } else { 0.0 };
        }
        add(&mut sums[at], &weight, 1.0);
        add(&mut red[at], &weight, color[0]);
        add(&mut green[at], &weight, color[1]);
        add(&mut blue[at], &weight, color[2]);
    });
}

#[inline(always)]
fn add(sums: &mut [f32; LANES], weight: &[f32; LANES], value: f32) {
    for lane in 0..LANES {
        sums[lane] += weight[lane] * value;
    }
}

/// Between two numbers; `f32::clamp` tests if they are in order.
#[inline(always)]
fn clamped(value: f32, low: f32, high: f32) -> f32 {
    let value = if value > high { high } else { value };
    if value < low { low } else { value }
}
