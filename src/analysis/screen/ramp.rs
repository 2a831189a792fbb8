//! Surfaces that are seen from the side: what is nearer there covers nothing, it is the same surface.
//!
//! **How it works.** On a plane the inverse of the depth is linear in the pixels of a picture. So a plane is fitted, by
//! least squares, to the nearest points of the pixels around a point, of those that are nearer than itself. Where they
//! are before it because the surface rises towards the eye, their plane meets the point; where they hide it, their
//! plane is before it. A point is the nearest of its pixel, but nobody knows where in it: so what is within half a
//! pixel's slope of the plane is on it.
//!
//! What is deeper than the point is left out. Behind the end of a floor there is a wall or nothing, and through the
//! gaps of a sparse surface one sees what is behind it.
//!
//! **When it wins.** Without it a surface hides itself beyond some 77 degrees: there a step of the width of a point is
//! deeper than the radius of neighbourhoods. A bound on the slope alone, as shadow maps have one, would let points
//! through at each silhouette, where depths step as they do on a steep surface.

use super::lanes::{LANES, total};
use super::view::MOST_REACH_PX;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// Fewer nearer pixels are no plane.
const FEWEST: f32 = 4.0;

/// Pixels of a row, from the one in the middle.
const COLUMNS: [f32; LANES] = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0];

/// Rows and columns of the window: those that squares reach.
const WINDOW: usize = 2 * MOST_REACH_PX + 1;

/// The pixels around a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around<'a> {
    /// Depths from the first pixel of the window on, infinite where nothing is.
    pub(super) depths: &'a [f32],
    /// From one row to the next.
    pub(super) stride: usize,
    /// Where the point is, from the middle of its pixel.
    pub(super) place_px: [f32; 2],
    /// Its depth.
    pub(super) depth: f32,
}

/// Sums over the nearer pixels of a window: how many, of columns and rows and their products, of the values and theirs.
struct Sums {
    count: f32,
    column: f32,
    row: f32,
    columns: f32,
    rows: f32,
    mixed: f32,
    value: f32,
    value_column: f32,
    value_row: f32,
}

impl Around<'_> {
    /// Whether a point that something covers lies on the plane of what is nearer than itself by more than `spacing`:
    /// no more than `radius` behind it.
    #[inline(always)]
    pub(super) fn is_on_plane_of_nearer<S: Simd>(&self, simd: S, spacing: f32, radius: f32) -> bool {
        if self.is_enclosed(radius) {
            return false;
        }
        let sums = self.sums(simd, self.depth - spacing);
        let Some([column_slope, row_slope, before]) = sums.plane(self.place_px) else {
            return false;
        };
        before - 0.5 * (column_slope.abs() + row_slope.abs()) <= radius / self.depth
    }

    /// Whether it is covered on all sides, as most points are that are hidden: known without a plane.
    #[inline(always)]
    fn is_enclosed(&self, radius: f32) -> bool {
        let limit = self.depth - radius;
        let (middle, last) = (MOST_REACH_PX, WINDOW - 1);
        let ends = [0, middle, last].map(|row| row * self.stride);
        let [first, own, end] = ends;
        let places = [
            first,
            first + middle,
            first + last,
            own,
            own + last,
            end,
            end + middle,
            end + last,
        ];
        places.into_iter().all(|place| self.depths[place] < limit)
    }

    /// Of the inverse depths in units of the point's own, less one.
    #[inline(always)]
    fn sums<S: Simd>(&self, simd: S, limit: f32) -> Sums {
        let splat = |value: f32| f32x8::splat(simd, value);
        let (zero, one) = (splat(0.0), splat(1.0));
        let columns = f32x8::from_slice(simd, &COLUMNS);
        // The last lane is beside the window.
        let mut limits = [limit; LANES];
        limits[WINDOW] = 0.0;
        let limits = f32x8::from_slice(simd, &limits);
        let depth = splat(self.depth);
        let (mut count, mut row_sum, mut rows) = (zero, zero, zero);
        let (mut value, mut value_row) = (zero, zero);
        for row in 0..WINDOW {
            let start = row * self.stride;
            let depths = f32x8::from_slice(simd, &self.depths[start..start + LANES]);
            let is_nearer = depths.simd_lt(limits);
            let counted = simd.select_f32x8(is_nearer, one, zero);
            let values = simd.select_f32x8(is_nearer, depth / depths - one, zero);
            let offset = splat(row as f32 - MOST_REACH_PX as f32);
            count += counted;
            row_sum += counted * offset;
            rows += counted * (offset * offset);
            value += values;
            value_row += values * offset;
        }
        // What is of columns is in the lanes.
        Sums {
            count: total(simd, count),
            column: total(simd, count * columns),
            row: total(simd, row_sum),
            columns: total(simd, count * columns * columns),
            rows: total(simd, rows),
            mixed: total(simd, row_sum * columns),
            value: total(simd, value),
            value_column: total(simd, value * columns),
            value_row: total(simd, value_row),
        }
    }
}

impl Sums {
    /// Slopes along columns and rows of the plane through all, and its value at a place; `None` where there are few or
    /// all are in a line.
    #[inline(always)]
    fn plane(&self, [column, row]: [f32; 2]) -> Option<[f32; 3]> {
        let count = self.count;
        if count < FEWEST {
            return None;
        }
        // Whole numbers, so a line has no spread at all.
        let columns = count * self.columns - self.column * self.column;
        let rows = count * self.rows - self.row * self.row;
        let mixed = count * self.mixed - self.column * self.row;
        let spread = columns * rows - mixed * mixed;
        if spread < 1.0 {
            return None;
        }
        let by_column = count * self.value_column - self.column * self.value;
        let by_row = count * self.value_row - self.row * self.value;
        let column_slope = (by_column * rows - by_row * mixed) / spread;
        let row_slope = (by_row * columns - by_column * mixed) / spread;
        let middle = (self.value - column_slope * self.column - row_slope * self.row) / count;
        Some([column_slope, row_slope, middle + column_slope * column + row_slope * row])
    }
}
