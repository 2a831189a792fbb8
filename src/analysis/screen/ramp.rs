//! Surfaces at a grazing angle: nearer points there hide nothing, as they are on the same surface.
//!
//! **How it works.** On a plane the inverse of the depth is linear in the pixels of an image. So a plane is fitted, by
//! least squares, to the nearest points of the surrounding pixels that are nearer than the point itself. Where they are
//! in front of it because the surface rises towards the eye, their plane meets the point; where they hide it, their
//! plane is in front of it. A point is the nearest of its pixel, but its position within the pixel is unknown: so
//! points within half a pixel's slope of the plane are on it. Where points are so far apart that there are few around,
//! a wider window is used.
//!
//! Points deeper than the point are ignored. Behind the end of a floor there is a wall or nothing, and gaps of a sparse
//! surface show the surface behind it.
//!
//! **When it wins.** Without it a surface hides itself beyond some 77 degrees: there a step of the width of a point is
//! deeper than the neighbourhood radius. A bound on the slope alone, as in shadow maps, would let points through at
//! each silhouette, where depths step as they do on a steep surface.

use super::constants::{BORDER_PX, MAX_REACH_PX, MIN_OF_RAMP};
use super::lanes::{LANES, total};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// Pixels of eight lanes, from the first of them.
const LANE_COLUMNS: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The pixels around a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around<'a> {
    /// Depths from the first pixel of the widest window on, infinite where nothing is.
    pub(super) depths: &'a [f32],
    /// From one row to the next.
    pub(super) stride: usize,
    /// Position of the point relative to the centre of its pixel.
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
    /// Returns true if a covered point lies on the plane of the points nearer than itself by more than `spacing`: no
    /// more than `radius` behind it.
    #[inline(always)]
    pub(super) fn is_on_plane_of_nearer<S: Simd>(&self, simd: S, spacing: f32, radius: f32) -> bool {
        if self.is_enclosed(radius) {
            return false;
        }
        let limit = self.depth - spacing;
        let mut sums = self.sums(simd, limit, MAX_REACH_PX);
        if sums.count < MIN_OF_RAMP {
            sums = self.sums(simd, limit, BORDER_PX);
        }
        let Some([column_slope, row_slope, before]) = sums.plane(self.place_px) else {
            return false;
        };
        // Half a pixel's slope is allowed, as the position of the fitted points within their pixels is unknown.
        before - 0.5 * (column_slope.abs() + row_slope.abs()) <= radius / self.depth
    }

    /// Returns true if the point is covered on all sides, as most hidden points are: known without a plane.
    #[inline(always)]
    fn is_enclosed(&self, radius: f32) -> bool {
        const REACH: usize = MAX_REACH_PX;
        const AROUND: [[usize; 2]; 8] = [
            [0, 0],
            [REACH, 0],
            [2 * REACH, 0],
            [0, REACH],
            [2 * REACH, REACH],
            [0, 2 * REACH],
            [REACH, 2 * REACH],
            [2 * REACH, 2 * REACH],
        ];
        let limit = self.depth - radius;
        let first = (BORDER_PX - REACH) * (self.stride + 1);
        AROUND
            .into_iter()
            .all(|[column, row]| self.depths[first + row * self.stride + column] < limit)
    }

    /// Sums the inverse depths, in units of the point's own, less one; in a window that reaches `reach` pixels.
    #[inline(always)]
    fn sums<S: Simd>(&self, simd: S, limit: f32, reach: usize) -> Sums {
        let mut sums = Sums::NONE;
        let first = BORDER_PX - reach;
        // The last lanes are outside the window.
        for begin in (0..=2 * reach).step_by(LANES) {
            let lanes = (2 * reach + 1 - begin).min(LANES);
            let mut limits = [limit; LANES];
            limits[lanes..].fill(0.0);
            let limits = f32x8::from_slice(simd, &limits);
            let column = begin as f32 - reach as f32;
            sums.add(&self.sums_of_lanes(simd, limits, reach, first + begin, column));
        }
        sums
    }

    /// Sums the inverse depths of eight columns: `first` is the index of the first of them in `depths`, `column` its
    /// offset from the point.
    #[inline(always)]
    fn sums_of_lanes<S: Simd>(&self, simd: S, limits: f32x8<S>, reach: usize, first: usize, column: f32) -> Sums {
        let splat = |value: f32| f32x8::splat(simd, value);
        let (zero, one) = (splat(0.0), splat(1.0));
        let depth = splat(self.depth);
        let (mut count, mut row_sum, mut rows) = (zero, zero, zero);
        let (mut value, mut value_row) = (zero, zero);
        for row in 0..=2 * reach {
            let start = (BORDER_PX - reach + row) * self.stride + first;
            let depths = f32x8::from_slice(simd, &self.depths[start..start + LANES]);
            let is_nearer = depths.simd_lt(limits);
            let counted = simd.select_f32x8(is_nearer, one, zero);
            // Inverse depths, as these are linear in pixels on a plane.
            let values = simd.select_f32x8(is_nearer, depth / depths - one, zero);
            let offset = splat(row as f32 - reach as f32);
            count += counted;
            row_sum += counted * offset;
            rows += counted * (offset * offset);
            value += values;
            value_row += values * offset;
        }
        // A lane is a column.
        let columns = f32x8::from_slice(simd, &LANE_COLUMNS) + splat(column);
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
    const NONE: Self = Self {
        count: 0.0,
        column: 0.0,
        row: 0.0,
        columns: 0.0,
        rows: 0.0,
        mixed: 0.0,
        value: 0.0,
        value_column: 0.0,
        value_row: 0.0,
    };

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.column += other.column;
        self.row += other.row;
        self.columns += other.columns;
        self.rows += other.rows;
        self.mixed += other.mixed;
        self.value += other.value;
        self.value_column += other.value_column;
        self.value_row += other.value_row;
    }

    /// Slopes along columns and rows of the plane through all, and its value at a place; `None` where there are few or
    /// all are in a line.
    #[inline(always)]
    fn plane(&self, [column, row]: [f32; 2]) -> Option<[f32; 3]> {
        let count = self.count;
        if count < MIN_OF_RAMP {
            return None;
        }
        let columns = count * self.columns - self.column * self.column;
        let rows = count * self.rows - self.row * self.row;
        let mixed = count * self.mixed - self.column * self.row;
        // Integer arithmetic, so a line has exactly zero spread.
        let spread = columns * rows - mixed * mixed;
        if spread < 1.0 {
            return None;
        }
        let by_column = count * self.value_column - self.column * self.value;
        let by_row = count * self.value_row - self.row * self.value;
        let column_slope = (by_column * rows - by_row * mixed) / spread;
        let row_slope = (by_row * columns - by_column * mixed) / spread;
        let center = (self.value - column_slope * self.column - row_slope * self.row) / count;
        let at_place = center + column_slope * column + row_slope * row;
        Some([column_slope, row_slope, at_place])
    }
}
