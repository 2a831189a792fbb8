//! Morphological closing of the cells of a level, as far as they touch leaves.
//!
//! How it works: a cell without points between two that hold some, opposite each other across a face, an edge or a
//! corner of it (13 directions), is closed; then those between closed ones are, which makes holes of several cells
//! disappear.
//!
//! Sixty-four cells (4×4×4) are a block, and one word. The words of the 27 blocks around one are shifted along each
//! axis, after which 13 comparisons close all cells of the block.
//!
//! When it wins: blocks around are looked up once, so a cell costs about as much as a few comparisons. Blocks without
//! adjacent leaves are not tested.

use super::gap::Gap;
use super::sorted_points::SortedPoints;
use super::stop::LeafRun;
use crate::math::morton;
use rayon::prelude::*;

/// Number of closing steps: holes of up to this many cells along each axis disappear.
const PASSES: usize = 3;

/// Blocks that are worth handing to another thread.
const BLOCKS_PER_TASK: usize = 64;

/// Cells along an edge of a block.
const EDGE: u32 = 4;

/// Along each axis: the distance to the next cell in the word of a block, and the cells on its lower side.
const AXES: [(u32, u64); 3] = [
    (1, 0x1111_1111_1111_1111),
    (EDGE, 0x000f_000f_000f_000f),
    (EDGE * EDGE, 0xffff),
];

/// Along each axis: the distance to the next block, or direction, among 27.
const STEPS: [usize; 3] = [1, 3, 9];

/// Cell masks of a block and of its neighbours, x fastest: cells, bit `x + 4y + 16z`.
type BlockNeighbourhood = [u64; 27];

/// Index of the centre block among the 27.
const CENTER: usize = 13;

/// Directions to the six faces, the twelve edges and the eight corners of a cell.
const NEAREST_FIRST: [usize; 26] = [
    4, 10, 12, 14, 16, 22, 1, 3, 5, 7, 9, 11, 15, 17, 19, 21, 23, 25, 0, 2, 6, 8, 18, 20, 24, 26,
];

/// All cells of a level that hold points.
pub(super) struct LevelCells {
    level: u8,
    /// The first point of each, and the number of points.
    firsts: Vec<u32>,
    /// The first stands for all absent blocks.
    blocks: Vec<OccupancyBlock>,
    /// Numbers of blocks by their positions; 0 where there is none.
    table: Vec<u32>,
}

#[derive(Debug, Clone, Default)]
struct OccupancyBlock {
    place: [u32; 3],
    /// The number of its first cell.
    first_cell: u32,
    /// Cells that hold points.
    occupied: u64,
    /// Those that are leaves.
    leaves: u64,
    /// The occupied ones in Morton order.
    in_morton_order: u64,
}

/// A block that may have gaps.
struct Site {
    /// The blocks around it and itself.
    around: [u32; 27],
    /// Cells without points that touch a leaf.
    candidates: u64,
}

impl LevelCells {
    /// Collects the cells of `level`. The leaves of the tree are in `runs`, of this level and others.
    pub(super) fn of_level(points: &SortedPoints, level: u32, runs: &[LeafRun]) -> Self {
        let partings = (0..).zip(&points.partings);
        let begins = partings.filter(|&(_, &parting)| u32::from(parting) <= level);
        let mut firsts: Vec<u32> = begins.map(|(point, _)| point).collect();
        let mut blocks = vec![OccupancyBlock::default()];
        let mut run = 0;
        for (number, &first) in (0..).zip(&firsts) {
            while runs[run].end <= first {
                run += 1;
            }
            let finest = points.cells[first as usize];
            let cell = [0, 1, 2].map(|axis| finest.coordinate(axis, level));
            let place = cell.map(|coordinate| coordinate / EDGE);
            let last = blocks.len() - 1;
            if last == 0 || blocks[last].place != place {
                blocks.push(OccupancyBlock {
                    place,
                    first_cell: number,
                    ..OccupancyBlock::default()
                });
            }
            if let Some(block) = blocks.last_mut() {
                let bit = bit_of(cell);
                block.occupied |= 1 << bit;
                block.leaves |= u64::from(runs[run].level == level) << bit;
                block.in_morton_order |= 1 << MORTON[bit as usize];
            }
        }
        firsts.push(points.len() as u32);
        Self {
            level: level as u8,
            firsts,
            table: table_of(&blocks),
            blocks,
        }
    }

    /// Cells without points that are closed and touch a leaf.
    pub(super) fn gaps(&mut self) -> Vec<Gap> {
        let numbers = self.blocks_with_leaves_and_beside();
        let sites: Vec<Site> = numbers
            .par_iter()
            .with_min_len(BLOCKS_PER_TASK)
            .map(|&number| self.site(number))
            .collect();
        let mut closed = vec![0; self.blocks.len()];
        for _ in 0..PASSES {
            let pass: Vec<u64> = sites
                .par_iter()
                .with_min_len(BLOCKS_PER_TASK)
                .map(|site| self.closed(site, &closed))
                .collect();
            for (&number, cells) in numbers.iter().zip(pass) {
                closed[number as usize] = cells;
            }
        }
        let found = sites
            .par_iter()
            .with_min_len(BLOCKS_PER_TASK)
            .fold(Vec::new, |mut gaps, site| {
                self.add_gaps(site, closed[site.around[CENTER] as usize], &mut gaps);
                gaps
            });
        found.flatten().collect()
    }

    /// The number of the block at a position; 0 if there is none.
    fn number_at(&self, place: [u32; 3]) -> u32 {
        let mut slot = slot_of(place, self.table.len());
        loop {
            let number = self.table[slot];
            if number == 0 || self.blocks[number as usize].place == place {
                return number;
            }
            slot = (slot + 1) & (self.table.len() - 1);
        }
    }

    /// Numbers of blocks that have leaves or touch some. Those without points are made.
    fn blocks_with_leaves_and_beside(&mut self) -> Vec<u32> {
        let adjacent = |block: &OccupancyBlock| {
            let leaves = block.leaves;
            let place = block.place;
            let touched = (0..27).filter(move |&direction| leaves & border(direction) != 0);
            let places = touched.filter_map(move |direction| neighbour(place, direction));
            places.filter(|&place| self.blocks[self.number_at(place) as usize].leaves == 0)
        };
        let blocks = self.blocks.par_iter().with_min_len(BLOCKS_PER_TASK);
        let mut places: Vec<[u32; 3]> = blocks.flat_map_iter(adjacent).collect();
        places.par_sort_unstable();
        places.dedup();
        let with_leaves = (0..).zip(&self.blocks).filter(|(_, block)| block.leaves != 0);
        let mut numbers: Vec<u32> = with_leaves.map(|(number, _)| number).collect();
        for place in places {
            let mut number = self.number_at(place);
            if number == 0 {
                number = self.blocks.len() as u32;
                self.blocks.push(OccupancyBlock {
                    place,
                    ..OccupancyBlock::default()
                });
            }
            numbers.push(number);
        }
        self.table = table_of(&self.blocks);
        numbers
    }

    fn site(&self, number: u32) -> Site {
        let block = &self.blocks[number as usize];
        let at = |direction| neighbour(block.place, direction).map_or(0, |place| self.number_at(place));
        let around = std::array::from_fn(at);
        let touch_leaf = adjacent(self.leaves(&around))
            .iter()
            .fold(0, |cells, word| cells | word);
        Site {
            around,
            candidates: touch_leaf & !block.occupied,
        }
    }

    fn leaves(&self, around: &[u32; 27]) -> BlockNeighbourhood {
        around.map(|number| self.blocks[number as usize].leaves)
    }

    /// Candidates between two opposite cells that hold points or are `closed`, of each block.
    fn closed(&self, site: &Site, closed: &[u64]) -> u64 {
        if site.candidates == 0 {
            return 0;
        }
        let filled = |number: u32| self.blocks[number as usize].occupied | closed[number as usize];
        let adjacent = adjacent(site.around.map(filled));
        let opposite = (0..CENTER).map(|direction| adjacent[direction] & adjacent[2 * CENTER - direction]);
        site.candidates & opposite.fold(0, |cells, word| cells | word)
    }

    /// Adds the closed cells of a block, each with the nearest leaf.
    fn add_gaps(&self, site: &Site, closed: u64, gaps: &mut Vec<Gap>) {
        if closed == 0 {
            return;
        }
        let leaves = adjacent(self.leaves(&site.around));
        let mut left = closed;
        for direction in NEAREST_FIRST {
            let mut found = left & leaves[direction];
            left &= !found;
            while found != 0 {
                let bit = found.trailing_zeros();
                found &= found - 1;
                if let Some(leaf) = self.leaf_adjacent(site, bit, direction) {
                    gaps.push(Gap {
                        leaf,
                        level: self.level,
                        direction: (2 * CENTER - direction) as u8,
                    });
                }
            }
        }
    }

    /// Returns the points of the leaf in the given direction from a cell of the centre block.
    fn leaf_adjacent(&self, site: &Site, bit: u32, direction: usize) -> Option<[u32; 2]> {
        // Relative to the lowest cell of the preceding blocks.
        let cell = bit_place(bit).map(|coordinate| coordinate + EDGE);
        let cell = neighbour(cell, direction)?;
        let [x, y, z] = cell.map(|coordinate| (coordinate / EDGE) as usize);
        let number = site.around[x * STEPS[0] + y * STEPS[1] + z * STEPS[2]];
        let block = &self.blocks[number as usize];
        let before = block.in_morton_order & ((1 << MORTON[bit_of(cell) as usize]) - 1);
        let cell = (block.first_cell + before.count_ones()) as usize;
        Some([self.firsts[cell], self.firsts[cell + 1]])
    }
}

/// Numbers of blocks by their positions: open addressing with at least twice as many slots as blocks.
fn table_of(blocks: &[OccupancyBlock]) -> Vec<u32> {
    let slots = (2 * blocks.len()).next_power_of_two();
    let mut table = vec![0; slots];
    for (number, block) in (0..).zip(blocks).skip(1) {
        let mut slot = slot_of(block.place, slots);
        while table[slot] != 0 {
            slot = (slot + 1) & (slots - 1);
        }
        table[slot] = number;
    }
    table
}

/// Precondition: a power of two of slots.
fn slot_of([x, y, z]: [u32; 3], slots: usize) -> usize {
    let key = u64::from(x) | u64::from(y) << 20 | u64::from(z) << 40;
    // Fibonacci hashing (Knuth, The Art of Computer Programming, volume 3, section 6.4).
    (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & (slots - 1)
}

/// The bit of a cell in the word of its block.
const fn bit_of([x, y, z]: [u32; 3]) -> u32 {
    x % EDGE + EDGE * (y % EDGE) + EDGE * EDGE * (z % EDGE)
}

/// The position in its block of the cell of a bit.
const fn bit_place(bit: u32) -> [u32; 3] {
    [bit % EDGE, bit / EDGE % EDGE, bit / (EDGE * EDGE)]
}

/// The positions of bits in Morton order.
const MORTON: [u8; 64] = {
    let mut places = [0; 64];
    let mut bit = 0;
    while bit < 64 {
        places[bit as usize] = morton::encode(bit_place(bit)) as u8;
        bit += 1;
    }
    places
};

/// Returns the neighbour of a cell position in one of 27 directions, of which the central one is none; `None` below
/// zero.
pub(super) fn neighbour(place: [u32; 3], direction: usize) -> Option<[u32; 3]> {
    let [x, y, z] = STEPS.map(|step| (direction / step % 3) as i32 - 1);
    Some([
        place[0].checked_add_signed(x)?,
        place[1].checked_add_signed(y)?,
        place[2].checked_add_signed(z)?,
    ])
}

/// The cells of a block that touch the one in a direction.
fn border(direction: usize) -> u64 {
    let sides = AXES.iter().zip(STEPS);
    sides.fold(u64::MAX, |cells, (&(step, low), count)| {
        cells
            & match direction / count % 3 {
                0 => low,
                1 => u64::MAX,
                _ => low << ((EDGE - 1) * step),
            }
    })
}

/// Returns, for each direction, the cells of the centre block whose neighbour in it is one of these.
#[inline(always)]
fn adjacent(words: BlockNeighbourhood) -> BlockNeighbourhood {
    shifted::<2>(shifted::<1>(shifted::<0>(words)))
}

/// Returns, for each line of three blocks along an axis, the shifted words: the cells one below each cell of the centre
/// block, the centre block itself, and the cells one above.
#[inline(always)]
fn shifted<const AXIS: usize>(words: BlockNeighbourhood) -> BlockNeighbourhood {
    let ((step, low), count) = (AXES[AXIS], STEPS[AXIS]);
    let across = (EDGE - 1) * step;
    let high = low << across;
    let mut out = words;
    for line in 0..9 {
        let first = line % count + line / count * 3 * count;
        let [before, here, after] = [0, 1, 2].map(|side| words[first + side * count]);
        out[first] = (here & !high) << step | (before & high) >> across;
        out[first + 2 * count] = (here & !low) >> step | (after & low) << across;
    }
    out
}
