//! What all trees of one cloud share: its points in Morton order, and what one scan over them tells of every level.

use super::stop::OccupiedCells;
use super::voxels::{self, ColorSum};
use crate::math::{
    Cube,
    morton::{self, LEVELS},
    sort_codes,
};
use glam::Vec3;
use rayon::prelude::*;

/// The points of a cloud in Morton order.
#[derive(Debug, PartialEq)]
pub(super) struct SortedPoints {
    /// Their codes, ascending.
    pub(super) codes: Vec<u64>,
    /// The level at which each code parts from the one before it, and is thus the first of its cell there and below; 0 for
    /// the first.
    pub(super) partings: Vec<u8>,
    /// Cells of every level that hold a point.
    pub(super) occupied: OccupiedCells,
    /// Colours summed over the points before each, and over all of them.
    pub(super) colors_before: Vec<ColorSum>,
}

impl SortedPoints {
    /// Sorts points with these colours; beside the sums of the colours, `then` is done with all else. Precondition: `cube` is
    /// the one around them.
    pub(super) fn sorted_and<T: Send>(
        cube: &Cube,
        positions: &[Vec3],
        colors: &[[u8; 4]],
        then: impl FnOnce(&Self) -> T + Send,
    ) -> (Self, T) {
        let sorted = sort_codes(cube.codes(positions));
        let colors = sorted.order.iter().map(|&index| colors[index as usize]);
        let shape = || {
            let partings = parting_levels(&sorted.codes);
            let points = Self {
                occupied: occupied_cells(&partings),
                partings,
                codes: sorted.codes,
                colors_before: Vec::new(),
            };
            let answer = then(&points);
            (points, answer)
        };
        let ((mut points, answer), colors_before) =
            rayon::join(shape, || voxels::running_sums(colors));
        points.colors_before = colors_before;
        (points, answer)
    }

    /// Points that stand in Morton order already. Precondition: ascending codes of 63 bits, a colour for each.
    pub(super) fn from_sorted(codes: Vec<u64>, colors: &[[u8; 3]]) -> Self {
        let partings = parting_levels(&codes);
        let colors = colors
            .iter()
            .map(|&[red, green, blue]| [red, green, blue, 0]);
        Self {
            occupied: occupied_cells(&partings),
            partings,
            codes,
            colors_before: voxels::running_sums(colors),
        }
    }

    /// Bytes held in memory.
    pub(super) fn byte_size(&self) -> usize {
        size_of::<Self>()
            + size_of_val(self.codes.as_slice())
            + size_of_val(self.partings.as_slice())
            + size_of_val(self.colors_before.as_slice())
    }
}

/// Below this, codes are not shared out among threads.
const PARALLEL_CODES: usize = 1 << 14;

/// The level at which each sorted code parts from the one before it; 0 for the first.
fn parting_levels(codes: &[u64]) -> Vec<u8> {
    let mut partings = vec![0; codes.len()];
    if let Some((_, partings)) = partings.split_first_mut() {
        partings
            .par_iter_mut()
            .with_min_len(PARALLEL_CODES)
            .zip(codes.par_windows(2))
            .for_each(|(parting, pair)| *parting = morton::parting_level(pair[0], pair[1]));
    }
    partings
}

/// Cells of every level that hold a point: one for each code that parted there or above.
pub(super) fn occupied_cells(partings: &[u8]) -> OccupiedCells {
    // Several counters, because most partings are of few levels, and a count that was just written is slow to read.
    let mut parted = [[0u32; LEVELS as usize + 2]; 4];
    let (chunks, rest) = partings.as_chunks::<4>();
    for partings in chunks {
        for (parted, &level) in parted.iter_mut().zip(partings) {
            parted[level as usize] += 1;
        }
    }
    for &level in rest {
        parted[0][level as usize] += 1;
    }
    let mut total = 0;
    std::array::from_fn(|level| {
        total += parted
            .iter()
            .map(|parted| parted[level] as usize)
            .sum::<usize>();
        total
    })
}
