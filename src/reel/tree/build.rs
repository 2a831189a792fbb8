//! Masks from cells, and cells from masks.

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

/// The Morton codes of the children of nodes.
pub(in crate::reel) fn cells_below(cells: &[u64], masks: &[u8]) -> Vec<u64> {
    let count = masks.iter().map(|mask| mask.count_ones() as usize).sum();
    let mut below = Vec::with_capacity(count);
    for (cell, &mask) in cells.iter().zip(masks) {
        let mut octants = mask;
        while octants != 0 {
            below.push(cell << 3 | u64::from(octants.trailing_zeros()));
            octants &= octants - 1;
        }
    }
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
        fn masks_lead_back_to_the_cells(mut cells in prop::collection::vec(0u64..1 << 15, 1..200)) {
            cells.sort_unstable();
            cells.dedup();
            let masks = masks_of_cells(&cells, 5);
            let back = masks.iter().fold(vec![0], |nodes, masks| cells_below(&nodes, masks));
            prop_assert_eq!(back, cells);
        }
    }
}
