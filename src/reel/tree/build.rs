//! Masks from cells, and cells from masks.

use fearless_simd::{Level, dispatch};

/// The masks of all levels above `depth` over its cells: Morton codes of `3 · depth` bits, ascending, no two alike.
/// `masks[l]` has a byte for each node of level `l`, none of them 0.
pub(in crate::reel) fn masks_of_cells(cells: &[u64], depth: u32) -> Vec<Vec<u8>> {
    let mut masks = vec![Vec::new(); depth as usize];
    let mut below: Vec<u64> = cells.to_vec();
    for of_level in masks.iter_mut().rev() {
        let mut last = None;
        let mut count = 0;
        for index in 0..below.len() {
            let octant = 1u8 << (below[index] & 7);
            let parent = below[index] >> 3;
            if last == Some(parent) {
                of_level[count - 1] |= octant;
            } else {
                of_level.push(octant);
                below[count] = parent;
                count += 1;
                last = Some(parent);
            }
        }
        below.truncate(count);
    }
    masks
}

/// `OCTANTS[m]`: the octants of a mask, one after the other, then any.
pub(in crate::reel) static OCTANTS: [[u8; 8]; 256] = octants();

const fn octants() -> [[u8; 8]; 256] {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut octants: usize = mask;
        let mut place = 0;
        while octants != 0 {
            table[mask][place] = octants.trailing_zeros() as u8;
            octants &= octants - 1;
            place += 1;
        }
        mask += 1;
    }
    table
}

/// The Morton codes of the children of nodes.
pub(in crate::reel) fn cells_below(cells: &[u64], masks: &[u8]) -> Vec<u64> {
    // Bit counting and lane shuffles need instructions that not every CPU has.
    dispatch!(Level::new(), _simd => below(cells, masks))
}

#[inline(always)]
fn below(cells: &[u64], masks: &[u8]) -> Vec<u64> {
    let count: usize = masks.iter().map(|mask| mask.count_ones() as usize).sum();
    // Always eight at a time: their number is unpredictable.
    let mut below = vec![0; count + 8];
    let mut next = 0;
    for (cell, &mask) in cells.iter().zip(masks) {
        let Some(children) = below.get_mut(next..next + 8) else {
            break;
        };
        for (child, &octant) in children.iter_mut().zip(&OCTANTS[usize::from(mask)]) {
            *child = cell << 3 | u64::from(octant);
        }
        next += mask.count_ones() as usize;
    }
    below.truncate(count);
    below
}

/// The number of the first child of each node of a level, and at last the number of children.
pub(in crate::reel) fn first_children(masks: &[u8]) -> Vec<u32> {
    let mut next = 0;
    let mut first = Vec::with_capacity(masks.len() + 1);
    first.push(0);
    first.extend(masks.iter().map(|mask| {
        next += mask.count_ones();
        next
    }));
    first
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn masks_reproduce_the_cells(mut cells in prop::collection::vec(0u64..1 << 15, 1..200)) {
            cells.sort_unstable();
            cells.dedup();
            let masks = masks_of_cells(&cells, 5);
            let back = masks.iter().fold(vec![0], |nodes, masks| cells_below(&nodes, masks));
            prop_assert_eq!(back, cells);
        }
    }
}
