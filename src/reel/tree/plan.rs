//! Prediction plan for the values of a node: its parent, and adjacent nodes that are known before it.

use super::links::{Links, NONE};
use super::window::{CENTER, OWNERS, PLACED, cell_of, shift_of};
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Maximum number of adjacent nodes that a node is predicted from.
pub(in crate::reel) const MAX_KNOWN: usize = 3;

/// Context known of a node when its value is coded: level by level in Morton order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) struct Known {
    /// Its parent.
    pub(in crate::reel) parent: u32,
    /// Nodes before it that share a face with it, or else an edge; [`NONE`] behind the last.
    pub(in crate::reel) adjacent: [u32; MAX_KNOWN],
    /// In which direction each is.
    pub(in crate::reel) directions: [u8; MAX_KNOWN],
    /// Children of its parent from it on, itself counted.
    pub(in crate::reel) left: u8,
}

/// Directions across faces, then across edges: nearest first, lower ones (which mostly come first) before upper ones.
const BY_DISTANCE: [u8; 18] = [12, 10, 4, 14, 16, 22, 9, 3, 1, 11, 5, 15, 7, 21, 19, 17, 23, 25];

/// Nodes that are worth handing to another thread.
const NODES_PER_TASK: usize = 1 << 12;

/// Returns the prediction plan for every child of the nodes of a level.
pub(in crate::reel) fn plan(links: Links<'_>) -> Vec<Known> {
    let nodes = links.masks.len();
    let parts: Vec<Vec<Known>> = (0..nodes.div_ceil(NODES_PER_TASK))
        .into_par_iter()
        .map(|part| {
            let range = part * NODES_PER_TASK..nodes.min((part + 1) * NODES_PER_TASK);
            let children = (links.first[range.end] - links.first[range.start]) as usize;
            let mut known = Vec::with_capacity(children);
            // Bit counting needs instructions that not every CPU has.
            dispatch!(Level::new(), _simd => range.for_each(|node| known_of_children(links, node, &mut known)));
            known
        })
        .collect();
    parts.concat()
}

/// For an octant and a place in [`BY_DISTANCE`], the node around its parent whose child is there, which of its octants
/// come before that child, and the direction.
#[derive(Clone, Copy)]
struct Adjacent {
    parent: u8,
    before: u8,
    direction: u8,
}

/// Places in [`BY_DISTANCE`] go on to the number of zeros below a word without bits.
const PLACES: usize = 33;

static ADJACENT: [[Adjacent; PLACES]; 8] = adjacent();

const fn adjacent() -> [[Adjacent; PLACES]; 8] {
    let nobody = Adjacent {
        parent: CENTER as u8,
        before: 0,
        direction: 0,
    };
    let mut table = [[nobody; PLACES]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut place = 0;
        while place < BY_DISTANCE.len() {
            let direction = BY_DISTANCE[place];
            let (parent, of_parent) = OWNERS[(cell_of(direction) + shift_of(octant)) as usize];
            table[octant][place] = Adjacent {
                parent,
                before: ((1u32 << of_parent) - 1) as u8,
                direction,
            };
            place += 1;
        }
        octant += 1;
    }
    table
}

/// For each plane of 3 × 3 cells around a cell, and each pattern in it, the places in [`BY_DISTANCE`] that are
/// occupied.
static PLACES_OF: [[u32; 512]; 3] = places_of();

const fn places_of() -> [[u32; 512]; 3] {
    let mut table = [[0; 512]; 3];
    let mut place = 0;
    while place < BY_DISTANCE.len() {
        let direction = BY_DISTANCE[place] as usize;
        let mut pattern = 0;
        while pattern < 512 {
            if pattern >> (direction % 9) & 1 != 0 {
                table[direction / 9][pattern] |= 1 << place;
            }
            pattern += 1;
        }
        place += 1;
    }
    table
}

/// The places in [`BY_DISTANCE`] of the cells around the one at (1, 1, 1) of a window that are occupied.
#[inline(always)]
fn places_around(window: u64) -> u32 {
    let plane = |z: usize| {
        let cells = window >> (16 * z);
        let pattern = cells & 7 | cells >> 1 & 0x38 | cells >> 2 & 0x1c0;
        PLACES_OF[z][pattern as usize]
    };
    plane(0) | plane(1) | plane(2)
}

#[inline(always)]
fn known_of_children(links: Links<'_>, node: usize, known: &mut Vec<Known>) {
    let before = links.window_before(node);
    let neighbours = &links.neighbours[node];
    let mask = links.masks[node];
    let mut octants = mask;
    while octants != 0 {
        let octant = octants.trailing_zeros() as usize;
        // Siblings that come before it are known as well.
        let sisters = PLACED[CENTER][usize::from(mask) & ((1 << octant) - 1)];
        let mut places = places_around((before | sisters) >> shift_of(octant));
        let mut of_child = Known {
            parent: node as u32,
            adjacent: [NONE; MAX_KNOWN],
            directions: [0; MAX_KNOWN],
            left: octants.count_ones() as u8,
        };
        for (neighbour, direction) in of_child.adjacent.iter_mut().zip(&mut of_child.directions) {
            // No branch: their number is unpredictable.
            let is_there = places != 0;
            let adjacent = ADJACENT[octant][places.trailing_zeros() as usize];
            places &= places.wrapping_sub(1);
            let parent = neighbours[usize::from(adjacent.parent)] as usize;
            let children = links.masks[parent] & adjacent.before;
            let found = links.first[parent] + children.count_ones();
            *neighbour = if is_there { found } else { NONE };
            *direction = adjacent.direction;
        }
        known.push(of_child);
        octants &= octants - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::{first_children, masks_of_cells};
    use super::super::links::{ALONE, neighbours_below};
    use super::*;
    use crate::math::morton;
    use proptest::prelude::*;

    proptest! {
        /// Against a search for every cell.
        #[test]
        fn adjacent_and_preceding_cells_are_found(cells in prop::collection::btree_set(0u64..4096, 1..200)) {
            let depth = 4;
            let cells: Vec<u64> = cells.into_iter().collect();
            let masks = masks_of_cells(&cells, depth);
            let mut neighbours = vec![ALONE];
            let mut above: &[u8] = &[1];
            let mut plans = Vec::new();
            for level in 0..=depth as usize {
                let first = first_children(above);
                let links = Links { neighbours: &neighbours, masks: above, first: &first };
                plans.push(plan(links));
                neighbours = neighbours_below(links);
                above = masks.get(level).map_or(&[], Vec::as_slice);
            }
            let places: Vec<[u32; 3]> = cells.iter().map(|&cell| morton::decode(cell)).collect();
            let of_deepest = &plans[depth as usize];
            prop_assert_eq!(of_deepest.len(), cells.len());
            for (node, known) in of_deepest.iter().enumerate() {
                let mut expected = BY_DISTANCE.iter().filter_map(|&direction| {
                    let way = [direction % 3, direction / 3 % 3, direction / 9];
                    let way = way.map(|along| u32::from(along).wrapping_sub(1));
                    let place: [u32; 3] = std::array::from_fn(|axis| places[node][axis].wrapping_add(way[axis]));
                    let found = places[..node].iter().position(|other| *other == place)?;
                    Some((found as u32, direction))
                });
                for (&found, &direction) in known.adjacent.iter().zip(&known.directions) {
                    let expected = expected.next().unwrap_or((NONE, direction));
                    prop_assert_eq!((found, direction), expected);
                }
                let sisters = cells[node..].iter().take_while(|&&cell| cell >> 3 == cells[node] >> 3);
                prop_assert_eq!(usize::from(known.left), sisters.count());
            }
        }
    }
}
