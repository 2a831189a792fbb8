//! Filtered splats that reach less than a pixel from their centres: where hundreds share a pixel, all of them do.
//!
//! How it works: such a splat covers the centres of two by two pixels at most. On the screen it is, taken as flat
//! there, the ellipse `sᵀ·K⁻¹·s ≤ 1` with `K = J·A·Jᵀ`, which has no division by the area of a splat (`ewa.rs`). So the
//! masks of four pixels are computed for eight splats at a time, and no patch is set up with functions for a whole row
//! of pixels. Depths are the plane's, as for patches.
//!
//! They are added once the depths of the tile are known. Until then only their indices are stored: the values computed
//! for eight of them are 500 bytes, and writing and reading those of a million took longer than recomputing them.

use super::eight::Vectors;
use super::ewa::OnScreen;
use super::facet::Canvas;
use super::raster::{gaussian, headlight_of};
use super::tile::{self, HEIGHT, LANES, Tile, WIDTH};
use super::view::PixelView;
use crate::scene::SplatFilter;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use std::mem;

/// Pixels of a splat: two columns of two rows.
const PIXELS: usize = 4;

/// Maximum reach of small splats from their centres before filtering: K is at most `JJᵀ` and r² along the diagonal, and
/// neither of its squares is to reach 1.
pub(super) const MAX_REACH_OF_SMALL_PX: f32 = 0.49;
const _: () =
    assert!(MAX_REACH_OF_SMALL_PX * MAX_REACH_OF_SMALL_PX + SplatFilter::RADIUS_PX * SplatFilter::RADIUS_PX < 1.0);

/// Minimum determinant of K: a splat seen edge-on is a line.
const MIN_DETERMINANT: f32 = 1e-9;

/// Eight splats, a property in each row, a splat in each lane.
#[derive(Debug)]
struct SmallSplats {
    /// Column and row of the upper left pixel; that may be outside, where its weight is 0.
    places: [[f32; LANES]; 2],
    weights: [[f32; LANES]; PIXELS],
    depths: [[f32; LANES]; PIXELS],
    /// Lit.
    colors: [[f32; LANES]; 3],
    /// Towards the eye.
    normals: [[f32; LANES]; 3],
    /// The lanes of those in the image and in front of the eye.
    lanes: [usize; LANES],
    count: usize,
}

/// Eight small splats as they are seen.
pub(super) struct EightSmall<'a, S: Simd> {
    pub(super) canvas: &'a Canvas<'a>,
    pub(super) on_screen: &'a OnScreen<S>,
    pub(super) centers: Vectors<S>,
    pub(super) normals: Vectors<S>,
    /// From 0 to 1, of their front sides.
    pub(super) colors: [f32x8<S>; 3],
    /// Factor on the colours of their back sides.
    pub(super) back_side: f32,
    /// Lanes with a splat that may be in the image.
    pub(super) may_touch: mask32x8<S>,
    pub(super) is_lit: bool,
}

/// Sums of a tile's small splats. The channels of a pixel are next to one another, so that one addition serves all of
/// them; all are zero between two tiles.
#[derive(Debug, Default)]
pub(super) struct SmallSums {
    /// Weighted red, green, blue, and the weights.
    colors: Vec<[f32; 4]>,
    /// Weighted normals and depths, if the blended surface is lit.
    surfaces: Vec<[f32; 4]>,
    /// The first row of the tile that was added to, and the one after the last.
    rows: [usize; 2],
}

/// Returns true if all splats are small, whichever of them are in the image.
#[inline(always)]
pub(super) fn are_small<S: Simd>(
    simd: S,
    view: &PixelView,
    on_screen: &OnScreen<S>,
    centers: Vectors<S>,
    are_there: mask32x8<S>,
) -> bool {
    let splat = |value: f32| f32x8::splat(simd, value);
    let [xx, _, yy] = on_screen.covariance();
    let is_near = (-centers.z).simd_lt(splat(2.0 * view.near));
    let are_large = xx.max(yy).simd_ge(splat(1.0)) | is_near;
    !simd.any_true_mask32x8(are_large & are_there)
}

impl SmallSplats {
    /// Computes the masks of eight small splats.
    #[inline(always)]
    fn of<S: Simd>(simd: S, eight: &EightSmall<'_, S>) -> Self {
        let splat = |value: f32| f32x8::splat(simd, value);
        let EightSmall {
            canvas,
            on_screen,
            centers,
            normals,
            ..
        } = *eight;
        let (view, clip) = (canvas.view, canvas.clip);
        let [xx, xy, yy] = on_screen.covariance();
        let per_determinant = 1.0 / xx.mul_sub(yy, xy * xy).max(splat(MIN_DETERMINANT));
        let (a, b, c) = (yy * per_determinant, xy * per_determinant * -2.0, xx * per_determinant);
        let per_distance = -1.0 / centers.z;
        let x = (centers.x * per_distance).mul_add(splat(view.px_per_slope[0]), splat(view.center_px[0]));
        let y = (centers.y * per_distance).mul_add(splat(view.px_per_slope[1]), splat(view.center_px[1]));
        let (left, top) = ((x - xx.sqrt() - 0.5).ceil(), (y - yy.sqrt() - 0.5).ceil());

        let facing = normals.dot(centers);
        let distance = centers.dot(centers).sqrt();
        let faces_away = facing.simd_gt(splat(0.0));
        let mut are_seen = eight.may_touch & facing.abs().simd_gt(distance * 1e-6);
        if canvas.cull_back_faces {
            are_seen &= facing.simd_le(splat(0.0));
        }
        let depth = per_distance * view.near;
        let per_facing = splat(view.near) / facing;
        let per_right = normals.x * per_facing * (1.0 / view.px_per_slope[0]);
        let per_down = normals.y * per_facing * (1.0 / view.px_per_slope[1]);
        let [factor, white] = if eight.is_lit {
            headlight_of(simd, facing.abs() / distance)
        } else {
            [splat(1.0), splat(0.0)]
        };
        let side = simd.select_f32x8(faces_away, splat(eight.back_side), splat(1.0));
        let turned = simd.select_f32x8(faces_away, splat(-1.0), splat(1.0));

        let mut small = Self {
            places: [*left, *top],
            weights: [[0.0; LANES]; PIXELS],
            depths: [[0.0; LANES]; PIXELS],
            colors: [[0.0; LANES]; 3],
            normals: [*(normals.x * turned), *(normals.y * turned), *(normals.z * turned)],
            lanes: [0; LANES],
            count: 0,
        };
        // Not by `map`: see `raster.rs`.
        for (lit, channel) in small.colors.iter_mut().zip(eight.colors) {
            *lit = *(channel * side * factor + white).min(splat(1.0));
        }
        let (first, end) = (clip.start.map(|px| px as f32), clip.end.map(|px| px as f32));
        let mut sums = splat(0.0);
        for pixel in 0..PIXELS {
            let column = left + (pixel % 2) as f32;
            let row = top + (pixel / 2) as f32;
            let (right, down) = (column + 0.5 - x, row + 0.5 - y);
            let radius2 = right.mul_add(a.mul_add(right, b * down), c * down * down);
            let is_in_clip = column.simd_ge(splat(first[0]))
                & column.simd_lt(splat(end[0]))
                & row.simd_ge(splat(first[1]))
                & row.simd_lt(splat(end[1]));
            let is_inside = radius2.simd_le(splat(1.0)) & is_in_clip & are_seen;
            let mask = gaussian(simd, radius2.max(splat(0.0)).min(splat(1.0))) * on_screen.weights();
            let depths = per_right.mul_add(right, per_down.mul_add(down, depth));
            let weights = simd.select_f32x8(is_inside & depths.simd_le(splat(1.0)), mask, splat(0.0));
            sums += weights;
            small.weights[pixel] = *weights;
            small.depths[pixel] = *depths;
        }
        // Which ones are in the image is random: a loop over these alone is predictable, a branch is not.
        for (lane, &weight) in sums.iter().enumerate() {
            small.lanes[small.count] = lane;
            small.count += usize::from(weight > 0.0);
        }
        small
    }
}

impl SmallSums {
    /// Allocates the sums of a tile.
    pub(super) fn begin(&mut self, has_normals: bool) {
        self.colors.resize(tile::PIXELS, [0.0; 4]);
        if has_normals {
            self.surfaces.resize(tile::PIXELS, [0.0; 4]);
        }
    }

    /// Sums weighted colours of eight where they are not behind the depths of the tile; their normals, if light is to
    /// fall on these. Precondition: [`SmallSums::begin`] was called for these.
    #[inline(always)]
    pub(super) fn add<S: Simd>(&mut self, simd: S, tile: &Tile, eight: &EightSmall<'_, S>, has_normals: bool) {
        const STEPS: [i32; PIXELS] = [0, 1, WIDTH as i32, WIDTH as i32 + 1];
        let small = SmallSplats::of(simd, eight);
        for &lane in &small.lanes[..small.count] {
            let column = small.places[0][lane] as i32 - tile.origin[0];
            let row = small.places[1][lane] as i32 - tile.origin[1];
            self.touch(row);
            let [red, green, blue] = &small.colors;
            let color = [red[lane], green[lane], blue[lane], 1.0];
            let [x, y, z] = &small.normals;
            let [x, y, z] = [x[lane], y[lane], z[lane]];
            for (pixel, step) in STEPS.into_iter().enumerate() {
                // Pixels with a weight are in the tile, and those without change nothing anywhere.
                let at = (row * WIDTH as i32 + column + step) as usize % tile::PIXELS;
                let depth = small.depths[pixel][lane];
                let is_behind = depth < tile.depth[at];
                let weight = if is_behind { 0.0 } else { small.weights[pixel][lane] };
                add_to(&mut self.colors[at], color, weight);
                if has_normals {
                    add_to(&mut self.surfaces[at], [x, y, z, depth], weight);
                }
            }
        }
    }

    /// Row and the one below are added to, as far as they are in the tile.
    #[inline(always)]
    fn touch(&mut self, row: i32) {
        let (first, end) = (row.max(0) as usize, (row + 2).max(0) as usize);
        self.rows = [self.rows[0].min(first), self.rows[1].max(end)];
    }

    /// Adds the sums to the tile's, and resets them.
    pub(super) fn finish(&mut self, tile: &mut Tile, has_normals: bool) {
        let [first, end] = mem::replace(&mut self.rows, [HEIGHT, 0]);
        for at in first * WIDTH..end.min(HEIGHT) * WIDTH {
            let [red, green, blue, weight] = mem::take(&mut self.colors[at]);
            for (sums, sum) in tile.colors.iter_mut().zip([red, green, blue]) {
                sums[at] += sum;
            }
            tile.weight[at] += weight;
            if has_normals {
                for (sums, sum) in tile.surfaces.iter_mut().zip(mem::take(&mut self.surfaces[at])) {
                    sums[at] += sum;
                }
            }
        }
    }
}

#[inline(always)]
fn add_to(sums: &mut [f32; 4], values: [f32; 4], weight: f32) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value * weight;
    }
}
