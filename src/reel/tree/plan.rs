//! What the values of a node are predicted from: its parent, and nodes beside it that are known before it.

use super::links::{Links, NONE};
use super::window::{cell_of, shift_of};
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Most nodes beside a node that it is predicted from.
pub(in crate::reel) const MOST_KNOWN: usize = 3;

/// What is known of a node when its value is coded: level by level in Morton order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) struct Known {
    /// Its parent.
    pub(in crate::reel) parent: u32,
    /// Nodes before it that share a face with it, or else an edge; [`NONE`] behind the last.
    pub(in crate::reel) beside: [u32; MOST_KNOWN],
    /// In which direction each is.
    pub(in crate::reel) directions: [u8; MOST_KNOWN],
    /// Children of its parent from it on, itself counted.
    pub(in crate::reel) left: u8,
}

/// Directions across faces, then across edges: nearest first, lower ones (which mostly come first) before upper ones.
const BY_DISTANCE: [u8; 18] = [12, 10, 4, 14, 16, 22, 9, 3, 1, 11, 5, 15, 7, 21, 19, 17, 23, 25];

/// Nodes that are worth handing to another thread.
const NODES_PER_TASK: usize = 1 << 12;

/// What is known of every child of the nodes of a level.
pub(in crate::reel) fn plan(links: Links<'_>) -> Vec<Known> {
    let nodes = links.masks.len();
    let parts: Vec<Vec<Known>> = (0..nodes.div_ceil(NODES_PER_TASK))
        .into_par_iter()
        .map(|part| {
            let range = part * NODES_PER_TASK..nodes.min((part + 1) * NODES_PER_TASK);
            let children = (links.first[range.end] - links.first[range.start]) as usize;
            let mut known = Vec::with_capacity(children);
            // Bits are counted by instructions that not every processor has.
            dispatch!(Level::new(), _simd => range.for_each(|node| known_of_children(links, node, &mut known)));
            known
        })
        .collect();
    parts.concat()
}

#[inline(always)]
fn known_of_children(links: Links<'_>, node: usize, known: &mut Vec<Known>) {
    let window = links.window(node);
    let mut octants = links.masks[node];
    let mut child = links.first[node];
    while octants != 0 {
        let octant = octants.trailing_zeros() as usize;
        let shift = shift_of(octant);
        let around = window >> shift;
        let mut of_child = Known {
            parent: node as u32,
            beside: [NONE; MOST_KNOWN],
            directions: [0; MOST_KNOWN],
            left: octants.count_ones() as u8,
        };
        let mut count = 0;
        for direction in BY_DISTANCE {
            let cell = cell_of(direction);
            if around >> cell & 1 == 0 {
                continue;
            }
            let neighbour = links.in_window(node, cell + shift);
            if neighbour < child {
                of_child.beside[count] = neighbour;
                of_child.directions[count] = direction;
                count += 1;
                if count == MOST_KNOWN {
                    break;
                }
            }
        }
        known.push(of_child);
        octants &= octants - 1;
        child += 1;
    }
}
