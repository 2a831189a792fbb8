//! Filtered splats that reach less than a pixel from their middles: where hundreds share a pixel, all of them do.
//!
//! How it works: such a splat covers the middles of two by two pixels at most. On the screen it is, as if it was flat
//! there, the ellipse `sᵀ·K⁻¹·s ≤ 1` with `K = J·A·Jᵀ`, which has no division by the area of a splat (`ewa.rs`). So the
//! masks of four pixels are worked out for eight splats at a time, and no patch is set up whose functions are those of
//! a whole row of pixels. Depths are those of the plane, as those of patches are.
//!
//! They are added once the depths of the tile are known. Until then only their numbers are kept: what is worked out of
//! eight of them is 500 bytes, and to write those of a million and read them again took longer than to begin anew.

use super::eight::Vectors;
use super::ewa::OnScreen;
use super::facet::Canvas;
use super::raster::{gaussian, head_light_of};
use super::tile::{LANES, Tile, WIDTH};
use super::view::PixelView;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use glam::Vec3;

/// Pixels of a splat: two columns of two rows.
const PIXELS: usize = 4;

/// Determinants of K are not taken for less: what is seen edge-on is a line.
const LEAST_DETERMINANT: f32 = 1e-9;

/// A splat on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct SmallSplat {
    /// Place in the tile of its upper left pixel; that may be outside, where its weight is 0.
    at: i32,
    weights: [f32; PIXELS],
    depths: [f32; PIXELS],
    /// Lit.
    color: [f32; 3],
    /// Towards the eye; where light falls on the blended surface.
    normal: Vec3,
}

/// Eight splats, a property in each row, a splat in each lane.
#[derive(Debug)]
pub(super) struct SmallSplats {
    /// Column and row of the upper left pixel.
    places: [[f32; LANES]; 2],
    weights: [[f32; LANES]; PIXELS],
    depths: [[f32; LANES]; PIXELS],
    /// Factor on the colour, and white that is added.
    light: [[f32; LANES]; 2],
    /// The product of normal and middle: positive where the normal points away.
    facing: [f32; LANES],
}

/// Eight small splats as they are seen.
pub(super) struct Seen<'a, S: Simd> {
    pub(super) canvas: &'a Canvas<'a>,
    pub(super) on_screen: &'a OnScreen<S>,
    pub(super) centers: Vectors<S>,
    pub(super) normals: Vectors<S>,
    /// Lanes with a splat that may be in the picture.
    pub(super) may_touch: mask32x8<S>,
    pub(super) is_lit: bool,
}

/// Whether all splats are small, whatever of them is in the picture.
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
    /// Of eight that are small.
    #[inline(always)]
    pub(super) fn of<S: Simd>(simd: S, seen: &Seen<'_, S>) -> Self {
        let splat = |value: f32| f32x8::splat(simd, value);
        let Seen {
            canvas,
            on_screen,
            centers,
            normals,
            ..
        } = *seen;
        let (view, clip) = (canvas.view, canvas.clip);
        let [xx, xy, yy] = on_screen.covariance();
        let per_determinant = 1.0 / xx.mul_sub(yy, xy * xy).max(splat(LEAST_DETERMINANT));
        let (a, b, c) = (yy * per_determinant, xy * per_determinant * -2.0, xx * per_determinant);
        let per_distance = -1.0 / centers.z;
        let x = (centers.x * per_distance).mul_add(splat(view.px_per_slope[0]), splat(view.middle_px[0]));
        let y = (centers.y * per_distance).mul_add(splat(view.px_per_slope[1]), splat(view.middle_px[1]));
        let (left, top) = ((x - xx.sqrt() - 0.5).ceil(), (y - yy.sqrt() - 0.5).ceil());

        let facing = normals.dot(centers);
        let distance = centers.dot(centers).sqrt();
        let mut are_seen = seen.may_touch & facing.abs().simd_gt(distance * 1e-6);
        if canvas.cull_back_faces {
            are_seen &= facing.simd_le(splat(0.0));
        }
        let depth = per_distance * view.near;
        let per_facing = splat(view.near) / facing;
        let per_right = normals.x * per_facing * (1.0 / view.px_per_slope[0]);
        let per_down = normals.y * per_facing * (1.0 / view.px_per_slope[1]);
        let [factor, white] = if seen.is_lit {
            head_light_of(simd, facing.abs() / distance)
        } else {
            [splat(1.0), splat(0.0)]
        };

        let mut small = Self {
            places: [*left, *top],
            weights: [[0.0; LANES]; PIXELS],
            depths: [[0.0; LANES]; PIXELS],
            light: [*factor, *white],
            facing: *facing,
        };
        let (first, end) = (clip.start.map(|px| px as f32), clip.end.map(|px| px as f32));
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
            small.weights[pixel] = *simd.select_f32x8(is_inside, mask, splat(0.0));
            small.depths[pixel] = *per_right.mul_add(right, per_down.mul_add(down, depth));
        }
        small
    }

    /// The splat of a lane, which is of this colour, if something of it is in the picture; whether its normal points
    /// away from the eye decides about both.
    #[inline(always)]
    pub(super) fn get(
        &self,
        lane: usize,
        origin: [i32; 2],
        color_and_normal: impl FnOnce(bool) -> ([f32; 3], Vec3),
    ) -> Option<SmallSplat> {
        let weights = [0, 1, 2, 3].map(|pixel: usize| self.weights[pixel][lane]);
        if weights == [0.0; PIXELS] {
            return None;
        }
        let (color, normal) = color_and_normal(self.facing[lane] > 0.0);
        let [factor, white] = [self.light[0][lane], self.light[1][lane]];
        let [column, row] = [0, 1].map(|axis: usize| self.places[axis][lane] as i32 - origin[axis]);
        Some(SmallSplat {
            at: row * WIDTH as i32 + column,
            weights,
            depths: [0, 1, 2, 3].map(|pixel: usize| self.depths[pixel][lane]),
            color: color.map(|channel| (channel * factor + white).min(1.0)),
            normal,
        })
    }
}

impl SmallSplat {
    /// Sums its weighted colour where it is not behind the depths that are there; its normal, if light is to fall on
    /// these.
    #[inline(always)]
    pub(super) fn attribute(&self, tile: &mut Tile, has_normals: bool) {
        const STEPS: [i32; PIXELS] = [0, 1, WIDTH as i32, WIDTH as i32 + 1];
        for (pixel, step) in STEPS.into_iter().enumerate() {
            let (weight, depth) = (self.weights[pixel], self.depths[pixel]);
            if weight == 0.0 {
                continue;
            }
            // What has a weight is in the tile.
            let at = (self.at + step) as usize;
            if depth < tile.depth[at] || depth > 1.0 {
                continue;
            }
            for (sums, channel) in tile.colors.iter_mut().zip(self.color) {
                sums[at] += channel * weight;
            }
            tile.weight[at] += weight;
            if has_normals {
                let Vec3 { x, y, z } = self.normal;
                for (sums, value) in tile.surfaces.iter_mut().zip([x, y, z, depth]) {
                    sums[at] += value * weight;
                }
            }
        }
    }
}
