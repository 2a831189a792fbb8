//! Face neighbours of each node of a level, found from the level above: a sixth of the work for all 26 neighbours
//! ([`super::links`]), for values that need no more.

use super::links::NONE;

/// The nodes across the faces of a node, below and above along x, along y, along z; [`NONE`] where there is no node.
pub(in crate::reel) type Faces = [u32; 6];

/// Face neighbours of the root: none.
pub(in crate::reel) const NO_FACES: Faces = [NONE; 6];

/// Computes the face neighbours of the children of the nodes of a level, which have these masks and first children.
#[inline(always)]
pub(in crate::reel) fn faces_below(faces: &[Faces], masks: &[u8], first: &[u32]) -> Vec<Faces> {
    let mut below = Vec::with_capacity(first.last().map_or(0, |&end| end as usize));
    for ((node, &mask), faces) in masks.iter().enumerate().zip(faces) {
        // The neighbours across the faces, and the node itself: a missing one has no octants.
        let others = faces.map(|face| {
            if face == NONE {
                (0, 0)
            } else {
                (masks[face as usize], first[face as usize])
            }
        });
        let mut octants = mask;
        while octants != 0 {
            let octant = octants.trailing_zeros() as usize;
            octants &= octants - 1;
            let mut of_child = NO_FACES;
            for axis in 0..3 {
                let upper = octant >> axis & 1;
                let across = octant ^ 1 << axis;
                let (of_other, first_of_other) = others[2 * axis + upper];
                of_child[2 * axis + upper] = child(of_other, first_of_other, across);
                of_child[2 * axis + 1 - upper] = child(mask, first[node], across);
            }
            below.push(of_child);
        }
    }
    below
}

/// The child in an octant of a node with a mask and a first child, if there is one.
#[inline(always)]
fn child(mask: u8, first: u32, octant: usize) -> u32 {
    let before = mask & ((1 << octant) - 1) as u8;
    let number = first.wrapping_add(before.count_ones());
    // No branch: it would be unpredictable.
    if mask >> octant & 1 != 0 { number } else { NONE }
}

#[cfg(test)]
mod tests {
    use super::super::build::{first_children, masks_of_cells};
    use super::*;
    use crate::math::morton;
    use proptest::prelude::*;

    proptest! {
        /// Against a search for every cell.
        #[test]
        fn neighbours_across_faces_are_found(cells in prop::collection::btree_set(0u64..4096, 1..200)) {
            let cells: Vec<u64> = cells.into_iter().collect();
            let masks = masks_of_cells(&cells, 4);
            let below = |faces: Vec<Faces>, masks: &Vec<u8>| faces_below(&faces, masks, &first_children(masks));
            let faces = masks.iter().fold(vec![NO_FACES], below);
            let places: Vec<[u32; 3]> = cells.iter().map(|&cell| morton::decode(cell)).collect();
            prop_assert_eq!(faces.len(), cells.len());
            for (place, faces) in places.iter().zip(&faces) {
                for (face, &found) in faces.iter().enumerate() {
                    let mut across = *place;
                    across[face / 2] = across[face / 2].wrapping_add(if face % 2 == 0 { u32::MAX } else { 1 });
                    let expected = places.iter().position(|other| *other == across);
                    prop_assert_eq!(found, expected.map_or(NONE, |node| node as u32));
                }
            }
        }
    }
}
