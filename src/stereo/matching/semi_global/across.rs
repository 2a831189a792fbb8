//! The three paths that lead down (or up) from line to line: straight and along both diagonals.

use super::penalties::Table;
use super::step::{BORDERS, Before, step};
use crate::stereo::GrayImage;
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// Direction of travel through the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    Down,
    Up,
}

/// Costs of three paths at every pixel of a line.
#[derive(Debug, Clone)]
pub(super) struct Paths {
    /// Path costs of each pixel on three paths: from the left, straight and from the right. Before the first pixel and
    /// after the last one are costs of 0, which add nothing.
    costs: Vec<u8>,
    /// The smallest of each.
    min: Vec<[u8; 3]>,
}

/// Three paths on their way through the image.
#[derive(Debug)]
pub(super) struct Across {
    way: Way,
    count: usize,
    now: Paths,
    /// Memory for the next line.
    next: Paths,
}

impl Across {
    /// Before the first line.
    pub(super) fn new(width: usize, count: usize, way: Way) -> Self {
        let pixel = 3 * (count + BORDERS);
        let now = Paths {
            costs: vec![0; (width + 2) * pixel],
            min: vec![[0; 3]; width + 2],
        };
        let next = now.clone();
        Self { way, count, now, next }
    }

    /// The costs at the last line.
    pub(super) fn paths(&self) -> &Paths {
        &self.now
    }

    /// Goes back to a line.
    pub(super) fn return_to(&mut self, paths: Paths) {
        self.now = paths;
    }

    /// Goes on to line `y`, and adds to its sums if they are there. Preconditions: `y` is the line after that of
    /// [`Self::paths`]; costs and sums cover all its pixels.
    pub(super) fn advance(
        &mut self,
        guide: &GrayImage,
        y: usize,
        table: &Table,
        costs: &[u8],
        sums: Option<&mut [u16]>,
    ) {
        let before = match self.way {
            Way::Down => y.saturating_sub(1),
            Way::Up => (y + 1).min(guide.height() - 1),
        };
        let line = Line {
            before: &self.now,
            brightness_before: guide.row(before),
            brightness: guide.row(y),
            table,
            count: self.count,
            costs,
        };
        let pixel = 3 * (self.count + BORDERS);
        let columns = guide.width().div_ceil(rayon::current_num_threads());
        let inner = pixel..(guide.width() + 1) * pixel;
        let paths = self.next.costs[inner].chunks_mut(columns * pixel);
        let min = self.next.min[1..=guide.width()].chunks_mut(columns);
        let strips = (0..).step_by(columns).zip(paths.zip(min));
        if let Some(sums) = sums {
            let strips: Vec<_> = strips.zip(sums.chunks_mut(columns * self.count)).collect();
            strips.into_par_iter().for_each(|((from, (paths, min)), sums)| {
                dispatch!(Level::new(), simd => line.advance::<_, true>(simd, from, paths, min, sums));
            });
        } else {
            let strips: Vec<_> = strips.collect();
            strips.into_par_iter().for_each(|(from, (paths, min))| {
                dispatch!(Level::new(), simd => line.advance::<_, false>(simd, from, paths, min, &mut []));
            });
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }
}

/// Inputs of one step.
struct Line<'a> {
    before: &'a Paths,
    brightness_before: &'a [u8],
    brightness: &'a [u8],
    table: &'a Table,
    count: usize,
    costs: &'a [u8],
}

impl Line<'_> {
    /// The columns from `from` on, one per entry of `min`.
    #[inline(always)]
    fn advance<S: Simd, const IS_SUMMED: bool>(
        &self,
        simd: S,
        from: usize,
        paths: &mut [u8],
        min: &mut [[u8; 3]],
        sums: &mut [u16],
    ) {
        let each = self.count + BORDERS;
        let last = self.brightness.len() - 1;
        let never = u8::MAX - self.table.p1;
        for (at, (after, min)) in paths.chunks_exact_mut(3 * each).zip(min).enumerate() {
            let x = from + at;
            let neighbours = [x.saturating_sub(1), x, (x + 1).min(last)];
            let before = [0, 1, 2].map(|path| {
                // Pixel x is at index x + 1.
                let place = 3 * (x + path) + path;
                Before {
                    costs: &self.before.costs[place * each..(place + 1) * each],
                    min: self.before.min[x + path][path],
                    p2: self
                        .table
                        .p2(self.brightness_before[neighbours[path]], self.brightness[x]),
                }
            });
            let (left, others) = after.split_at_mut(each);
            let (straight, right) = others.split_at_mut(each);
            let mut after = [left, straight, right];
            for path in &mut after {
                path[0] = never;
                path[each - 1] = never;
            }
            let costs = &self.costs[x * self.count..(x + 1) * self.count];
            let sums = if IS_SUMMED {
                &mut sums[at * self.count..(at + 1) * self.count]
            } else {
                &mut *sums
            };
            *min = step::<_, 3, IS_SUMMED>(simd, costs, self.table.p1, before, &mut after, sums);
        }
    }
}
