//! Points in Morton order, shared by all trees of one cloud, and the statistics of every level from one scan over them.

use super::cached_levels::CachedLevels;
use super::color_sums::{self, ColorSum};
use super::stop::OccupiedCells;
use crate::cloud::VoxelRecord;
use crate::math::{
    Cube, few_codes,
    morton::{LEVELS, PackedCell},
    morton_sort::Buckets,
};
use fearless_simd::{Level, dispatch};
use glam::Vec3;
use rayon::prelude::*;

/// The points of a cloud in Morton order.
#[derive(Debug)]
pub(super) struct SortedPoints {
    /// Their finest cells, by ascending code.
    pub(super) cells: Vec<PackedCell>,
    /// The level at which each cell parts from the one before it: the point is the first of its cell there and below; 0
    /// for the first.
    pub(super) partings: Vec<u8>,
    /// Cells of every level that hold a point.
    pub(super) occupied: OccupiedCells,
    /// Colours summed over the points before each, and over all of them.
    pub(super) colors_before: Vec<ColorSum>,
    /// Voxels of coarse levels that are drawn repeatedly.
    pub(super) voxels: CachedLevels<VoxelRecord>,
    /// True if the points were given in this order.
    pub(super) are_as_given: bool,
}

impl PartialEq for SortedPoints {
    /// All else follows from these.
    fn eq(&self, other: &Self) -> bool {
        self.cells == other.cells && self.colors_before == other.colors_before
    }
}

impl SortedPoints {
    /// Sorts points with these colours. Precondition: points inside the cube.
    pub(super) fn new(cube: &Cube, positions: &[Vec3], colors: &[[u8; 4]]) -> Self {
        let in_order = |positions| {
            let cells = cube.cells(positions);
            partings_in_order(&cells).map(|partings| (cells, partings))
        };
        // Checking some of them first is mostly enough.
        let some = &positions[..positions.len().min(1000)];
        if in_order(some).is_some()
            && let Some((cells, partings)) = in_order(positions)
        {
            return Self::in_order(cells, partings, colors);
        }
        let (cells, colors) = if positions.len() <= few_codes::MAX {
            sorted_few(cube, positions, colors)
        } else {
            sorted(cube, positions, colors)
        };
        let partings = partings_in_order(&cells).expect("cells were sorted");
        Self {
            are_as_given: false,
            ..Self::in_order(cells, partings, &colors)
        }
    }

    fn in_order(cells: Vec<PackedCell>, partings: Vec<u8>, colors: &[[u8; 4]]) -> Self {
        let count = || occupied_cells(&partings);
        // No nodes are stored. Masks and first points of all nodes, level by level, took a third of the build time and
        // 34 bytes per point instead of 17, and traversing them was not faster.
        let (occupied, colors_before) = rayon::join(count, || color_sums::running_sums(colors));
        Self {
            cells,
            partings,
            occupied,
            colors_before,
            voxels: CachedLevels::default(),
            are_as_given: true,
        }
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Maximum number of bytes held in memory, with all voxels that may be cached.
    pub(super) fn byte_size(&self) -> usize {
        size_of::<Self>()
            + CachedLevels::<VoxelRecord>::max_bytes(self.coarse_levels(), self.len())
            + size_of_val(self.cells.as_slice())
            + size_of_val(self.partings.as_slice())
            + size_of_val(self.colors_before.as_slice())
    }
}

/// The cells of at most [`few_codes::MAX`] points in the order of their codes, and colours with them.
fn sorted_few(cube: &Cube, positions: &[Vec3], colors: &[[u8; 4]]) -> (Vec<PackedCell>, Vec<[u8; 4]>) {
    let (cells, mut items) = cube.cells_and_codes(positions);
    few_codes::make_items(&mut items);
    let mut scratch = vec![0; items.len()];
    few_codes::sort(&mut items, &mut scratch, |index| cells[index].code());
    let mut sorted_cells: Vec<PackedCell> = bytemuck::cast_vec(scratch);
    let mut sorted_colors = vec![[0; 4]; items.len()];
    let places = sorted_cells.iter_mut().zip(&mut sorted_colors);
    for (&item, (cell, color)) in items.iter().zip(places) {
        let index = few_codes::index_of(item);
        *cell = cells[index];
        *color = colors[index];
    }
    (sorted_cells, sorted_colors)
}

/// Sorts any number of points, with the same result.
fn sorted(cube: &Cube, positions: &[Vec3], colors: &[[u8; 4]]) -> (Vec<PackedCell>, Vec<[u8; 4]>) {
    let write_codes = |range, codes: &mut [u64]| cube.write_codes(&positions[range], codes);
    // Clearing memory takes as long as a few chunks of points, so it becomes one task among theirs.
    let (buckets, (mut cells, mut colors)) = rayon::join(
        || Buckets::new(positions.len(), write_codes, |point| colors[point]),
        || {
            let cells = vec![PackedCell::new([0; 3]); positions.len()];
            (cells, vec![[0; 4]; positions.len()])
        },
    );
    let places = buckets.places(&mut cells);
    buckets.sort_each(&mut colors, places, |codes, cells| {
        dispatch!(Level::new(), _simd => write_cells(codes, cells));
    });
    (cells, colors)
}

#[inline(always)]
fn write_cells(codes: &[u64], cells: &mut [PackedCell]) {
    for (cell, &code) in cells.iter_mut().zip(codes) {
        // Packed coordinates, not codes: the traversal needs coordinates, and two packed cells are compared just as
        // fast.
        *cell = PackedCell::from_code(code);
    }
}

/// Cells that are worth handing to another thread.
const CELLS_PER_TASK: usize = 1 << 14;

/// The level at which each cell parts from the one before it, 0 for the first; `None` if their codes do not ascend.
fn partings_in_order(cells: &[PackedCell]) -> Option<Vec<u8>> {
    let mut partings = vec![0; cells.len()];
    let Some((_, to_be_written)) = partings.split_first_mut() else {
        return Some(partings);
    };
    let tasks = to_be_written.par_chunks_mut(CELLS_PER_TASK).enumerate();
    let are_in_order = tasks.all(|(task, partings)| {
        let cells = &cells[CELLS_PER_TASK * task..];
        write_partings(cells, partings)
    });
    are_in_order.then_some(partings)
}

/// Writes the levels at which all but the first of `cells` part from the ones before them, as far as they are asked
/// for, or to where their codes do not ascend; whether they do.
fn write_partings(cells: &[PackedCell], partings: &mut [u8]) -> bool {
    dispatch!(Level::new(), _simd => {
        let mut cells = cells;
        partings.chunks_mut(BLOCK).all(|partings| {
            let pairs = &cells[..=partings.len()];
            cells = &cells[partings.len()..];
            write_partings_of_block(pairs, partings)
        })
    })
}

/// Number of points tested before the check whether they ascend.
const BLOCK: usize = 256;

#[inline(always)]
fn write_partings_of_block(cells: &[PackedCell], partings: &mut [u8]) -> bool {
    let mut descend = false;
    for (parting, (before, cell)) in partings.iter_mut().zip(cells.iter().zip(&cells[1..])) {
        let ascends;
        (*parting, ascends) = before.parting(*cell);
        descend |= !ascends;
    }
    !descend
}

/// Cells of every level that hold a point: one for each code that parted there or above.
fn occupied_cells(partings: &[u8]) -> OccupiedCells {
    let add = |mut sums: [u32; LEVELS as usize + 2], counts: [u32; LEVELS as usize + 2]| {
        for (sum, count) in sums.iter_mut().zip(counts) {
            *sum += count;
        }
        sums
    };
    let parted = partings
        .par_chunks(4 * CELLS_PER_TASK)
        .map(count_partings)
        .reduce(|| [0; LEVELS as usize + 2], add);
    let mut total = 0;
    std::array::from_fn(|level| {
        total += parted[level] as usize;
        total
    })
}

/// Counts the points that part at each level.
fn count_partings(partings: &[u8]) -> [u32; LEVELS as usize + 2] {
    // Several counters, because most partings are at few levels, and a count that was just written is slow to read
    // back.
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
    std::array::from_fn(|level| parted.iter().map(|parted| parted[level]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_shapes::Random;

    #[test]
    fn small_and_large_cloud_sorts_agree() {
        let mut random = Random(22);
        let mut positions: Vec<Vec3> = (0..80_000).map(|_| random.cube()).collect();
        positions.extend_from_within(..2000);
        let colors: Vec<[u8; 4]> = (0..positions.len() as u32).map(u32::to_le_bytes).collect();
        let cube = Cube::around(&positions).unwrap();
        let few = sorted_few(&cube, &positions, &colors);
        assert!(few == sorted(&cube, &positions, &colors));
        assert_eq!(few.0.len(), 82_000);
    }
}
