//! Pyramid of image cells with the visible points: the neighbourhood of a place spans at most 64 cells, whatever its
//! size in the image; 256 in a second search.
//!
//! **How it works.** A cell of level L is 2^L pixels wide. It has the nearest of the points in it, the first of equally
//! near ones, and the number of all. Only the finest level is filled from points; a cell of each other one takes the
//! nearest of four. Coordinates are apart from one another and rows have a border, so that eight cells of a row are
//! read at once from anywhere in the image. A cell without points is too far away for any neighbourhood.

use super::constants::{CELLS_BEFORE, CELLS_OF_WINDOW, MAX_LEVELS, MAX_REACH_CELLS, MIN_RADIUS_PX, WIDE_WINDOW};
use super::view::{ScreenPoint, ScreenView};
use rayon::prelude::*;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// Cells after the last one of a row, and rows after the last.
const BORDER_AFTER: usize = WIDE_WINDOW * CELLS_OF_WINDOW;

/// No point is there.
const EMPTY: u64 = u64::MAX;

/// Coordinate of cells without points.
const NOWHERE: f32 = 1e30;

/// The pyramid.
#[derive(Debug, Default)]
pub(super) struct Cells {
    finest: u32,
    levels: Vec<CellLevel>,
    /// Depth and place of the nearest point, as they are found.
    nearest: Vec<AtomicU64>,
    counts: Vec<AtomicU32>,
}

/// One level.
#[derive(Debug, Default)]
pub(super) struct CellLevel {
    size: [usize; 2],
    stride: usize,
    /// Position of the nearest points, relative to the eye.
    pub(super) places: [Vec<f32>; 3],
    /// Number of points per cell.
    pub(super) counts: Vec<f32>,
    /// Depth and place of the nearest point; without a border.
    winners: Vec<u64>,
}

/// The cells around a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window<'a> {
    pub(super) level: &'a CellLevel,
    /// Index of the first cell.
    pub(super) first: usize,
    /// Column and row of the first cell, with the border before them.
    start: [usize; 2],
    pub(super) rows: usize,
    /// Number of groups of eight cells per row.
    pub(super) eights: usize,
    pub(super) stride: usize,
}

/// The level whose windows hold a radius.
pub(super) fn level_of(radius_px: f32) -> u32 {
    // Cells grow with the radius: a window of fixed size in pixels would be empty up close and a single point from
    // afar. Hofer et al. 2018 leaves radius and window open.
    let cells = radius_px / MAX_REACH_CELLS;
    (0..MAX_LEVELS)
        .find(|&level| cells <= (1_u32 << level) as f32)
        .unwrap_or(MAX_LEVELS)
}

/// The levels that points of these depths have neighbours in, twice as far away as the radius as well.
pub(super) fn levels_for(view: &ScreenView, radius: f32, [nearest, farthest]: [f32; 2]) -> RangeInclusive<u32> {
    let radius_px = |depth: f32| (radius * view.px_per_unit() / depth).max(MIN_RADIUS_PX);
    level_of(radius_px(farthest))..=level_of(2.0 * radius_px(nearest))
}

impl Cells {
    /// Puts points into the levels of an image of `size_px`.
    pub(super) fn build(&mut self, size_px: [usize; 2], levels: RangeInclusive<u32>, seen: &[ScreenPoint]) {
        self.finest = *levels.start();
        let count = (levels.end() + 1 - self.finest) as usize;
        self.levels.resize_with(count, CellLevel::default);
        let mut size = size_px.map(|edge| (edge >> self.finest) + 1);
        self.count_points(size, seen);
        for level in 0..count {
            let (finer, rest) = self.levels.split_at_mut(level);
            let level = &mut rest[0];
            level.resize(size);
            match finer.last() {
                None => level.take_counted(&self.nearest, &self.counts),
                Some(finer) => level.take_coarser(finer),
            }
            level.place(seen);
            size = size.map(|edge| edge.div_ceil(2));
        }
    }

    fn count_points(&mut self, size: [usize; 2], seen: &[ScreenPoint]) {
        let [width, height] = size;
        self.nearest.resize_with(width * height, AtomicU64::default);
        self.counts.resize_with(width * height, AtomicU32::default);
        let cells = self.nearest.par_iter_mut().zip(&mut self.counts);
        cells.with_min_len(1 << 16).for_each(|(nearest, count)| {
            *nearest.get_mut() = EMPTY;
            *count.get_mut() = 0;
        });
        let (nearest, counts) = (&self.nearest, &self.counts);
        let tasks = seen.par_iter().enumerate().with_min_len(1 << 13);
        tasks.for_each(|(place, seen)| {
            let [column, row] = seen.place_px.map(|px| px as usize >> self.finest);
            let cell = row * width + column;
            let key = u64::from(seen.depth.to_bits()) << 32 | place as u64;
            nearest[cell].fetch_min(key, Ordering::Relaxed);
            counts[cell].fetch_add(1, Ordering::Relaxed);
        });
    }

    /// The cells within `radius_px` of a place, of the level that is meant for that, or the finer one in a wide window;
    /// of the coarsest there is where they would be too many, which are fewer then.
    #[inline(always)]
    pub(super) fn window(&self, place_px: [f32; 2], radius_px: f32, is_wide: bool) -> Window<'_> {
        let eights = if is_wide { WIDE_WINDOW } else { 1 };
        let wanted = level_of(radius_px / eights as f32).clamp(self.finest, self.coarsest());
        let level = &self.levels[(wanted - self.finest) as usize];
        let per_px = 1.0 / (1_u32 << wanted) as f32;
        let reach = (radius_px * per_px).min(MAX_REACH_CELLS * eights as f32);
        // The border makes them positive.
        let start = place_px.map(|px| (px * per_px - reach + CELLS_BEFORE as f32).max(0.0) as usize);
        let last_row = (place_px[1] * per_px + reach) as usize + CELLS_BEFORE;
        let rows = (last_row + 1).saturating_sub(start[1]).min(eights * CELLS_OF_WINDOW);
        Window {
            level,
            first: start[1] * level.stride + start[0],
            start,
            rows,
            eights,
            stride: level.stride,
        }
    }

    /// The coarsest level that there is.
    fn coarsest(&self) -> u32 {
        self.finest + (self.levels.len() as u32).saturating_sub(1)
    }

    /// The largest radius that windows hold.
    pub(super) fn max_radius_px(&self) -> f32 {
        MAX_REACH_CELLS * (1_u32 << self.coarsest()) as f32
    }
}

impl Window<'_> {
    /// The nearest points of its cells: their places among the visible ones, row by row.
    pub(super) fn points(&self) -> impl Iterator<Item = usize> {
        let [width, height] = self.level.size;
        let inside = |start: usize, count: usize, size: usize| {
            let without_border = |cell: usize| cell.saturating_sub(CELLS_BEFORE).min(size);
            without_border(start)..without_border(start + count)
        };
        let columns = inside(self.start[0], self.eights * CELLS_OF_WINDOW, width);
        let rows = inside(self.start[1], self.rows, height);
        let cells = rows.flat_map(move |row| columns.clone().map(move |column| row * width + column));
        let winners = cells.map(|cell| self.level.winners[cell]);
        // The lower half is an index.
        winners
            .filter(|&winner| winner != EMPTY)
            .map(|winner| winner as u32 as usize)
    }
}

impl CellLevel {
    fn resize(&mut self, size: [usize; 2]) {
        let [width, height] = size;
        self.size = size;
        self.stride = width + CELLS_BEFORE + BORDER_AFTER;
        let cells = self.stride * (height + CELLS_BEFORE + BORDER_AFTER);
        for axis in &mut self.places {
            axis.clear();
            axis.resize(cells, NOWHERE);
        }
        self.counts.clear();
        self.counts.resize(cells, 0.0);
        self.winners.resize(width * height, EMPTY);
    }

    fn take_counted(&mut self, nearest: &[AtomicU64], counts: &[AtomicU32]) {
        let width = self.size[0];
        let winners = self.winners.par_iter_mut().zip(nearest);
        winners
            .with_min_len(1 << 16)
            .for_each(|(winner, nearest)| *winner = nearest.load(Ordering::Relaxed));
        let rows = self.counts.par_chunks_mut(self.stride).skip(CELLS_BEFORE);
        rows.zip(counts.par_chunks(width)).for_each(|(row, counts)| {
            for (sum, count) in row[CELLS_BEFORE..].iter_mut().zip(counts) {
                *sum = count.load(Ordering::Relaxed) as f32;
            }
        });
    }

    fn take_coarser(&mut self, finer: &Self) {
        let (width, [finer_width, finer_height]) = (self.size[0], finer.size);
        let rows = self.counts.par_chunks_mut(self.stride).skip(CELLS_BEFORE);
        let rows = rows.zip(self.winners.par_chunks_mut(width)).enumerate();
        rows.for_each(|(row, (counts, winners))| {
            for (column, (count, winner)) in counts[CELLS_BEFORE..].iter_mut().zip(winners).enumerate() {
                (*count, *winner) = (0.0, EMPTY);
                for row in 2 * row..(2 * row + 2).min(finer_height) {
                    for column in 2 * column..(2 * column + 2).min(finer_width) {
                        *count += finer.counts[(row + CELLS_BEFORE) * finer.stride + column + CELLS_BEFORE];
                        *winner = (*winner).min(finer.winners[row * finer_width + column]);
                    }
                }
            }
        });
    }

    /// Writes where the nearest points are.
    fn place(&mut self, seen: &[ScreenPoint]) {
        let width = self.size[0];
        let [x, y, z] = &mut self.places;
        let x_rows = x.par_chunks_mut(self.stride).skip(CELLS_BEFORE);
        let y_rows = y.par_chunks_mut(self.stride).skip(CELLS_BEFORE);
        let z_rows = z.par_chunks_mut(self.stride).skip(CELLS_BEFORE);
        let rows = x_rows.zip(y_rows).zip(z_rows).zip(self.winners.par_chunks(width));
        rows.for_each(|(((x, y), z), winners)| {
            for (column, &winner) in (CELLS_BEFORE..).zip(winners) {
                // The lower half is an index.
                if winner != EMPTY {
                    let place = seen[winner as u32 as usize].offset;
                    (x[column], y[column], z[column]) = (place.x, place.y, place.z);
                }
            }
        });
    }
}
