//! Neighbour links between the nodes of a level, found from the level above: no search, no hash.

use super::window::{CENTER, CUBE_OF_27, DIRECTIONS, OWNERS, PLACED, shift_of};
use fearless_simd::{Level, dispatch};

/// No node is there.
pub(in crate::reel) const NONE: u32 = u32::MAX;

/// Neighbours of a node by direction, with the node itself at the centre.
pub(in crate::reel) type Neighbours = [u32; DIRECTIONS];

/// A level whose child nodes are queried.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) struct Links<'a> {
    /// For each node.
    pub(in crate::reel) neighbours: &'a [Neighbours],
    /// For each node.
    pub(in crate::reel) masks: &'a [u8],
    /// For each node, and the end.
    pub(in crate::reel) first: &'a [u32],
}

/// The neighbours of the root.
pub(in crate::reel) const ALONE: Neighbours = {
    let mut alone = [NONE; DIRECTIONS];
    alone[CENTER] = 0;
    alone
};

impl Links<'_> {
    /// The cells of the level below around a node's, as a window.
    #[inline(always)]
    pub(in crate::reel) fn window(&self, node: usize) -> u64 {
        self.window_of(node, NONE)
    }

    /// Variant of [`Links::window`] limited to cells of the surrounding nodes that come before a node.
    #[inline(always)]
    pub(in crate::reel) fn window_before(&self, node: usize) -> u64 {
        self.window_of(node, node as u32)
    }

    #[inline(always)]
    fn window_of(&self, node: usize, end: u32) -> u64 {
        let neighbours = &self.neighbours[node];
        let mut window = 0;
        for direction in 0..DIRECTIONS {
            let neighbour = neighbours[direction];
            // No branch: it would be unpredictable.
            let is_there = neighbour < end;
            let mask = self.masks[if is_there { neighbour as usize } else { 0 }];
            window |= PLACED[direction][usize::from(mask) * usize::from(is_there)];
        }
        window
    }

    /// The node in a cell of the window around a node. Precondition: there is one.
    #[inline(always)]
    pub(in crate::reel) fn in_window(&self, node: usize, cell: u32) -> u32 {
        let (direction, octant) = OWNERS[cell as usize & 63];
        let parent = self.neighbours[node][direction as usize] as usize;
        let before = self.masks[parent] & ((1 << octant) - 1) as u8;
        self.first[parent] + before.count_ones()
    }

    /// The neighbours of the child of a node in an octant, from the window around that node.
    #[inline(always)]
    pub(in crate::reel) fn neighbours_of_child(&self, node: usize, window: u64, octant: usize) -> Neighbours {
        let mut neighbours = [NONE; DIRECTIONS];
        let shift = shift_of(octant);
        let mut cells = window >> shift & CUBE_OF_27;
        while cells != 0 {
            let cell = cells.trailing_zeros();
            cells &= cells - 1;
            // Without a search, as this is done for every node: searching neighbours took 140 ns per node, a third of
            // the decoding time of version 1.
            let place = (cell & 3) + (cell >> 2 & 3) * 3 + (cell >> 4) * 9;
            neighbours[place as usize] = self.in_window(node, cell + shift);
        }
        neighbours
    }
}

/// The neighbours of every child of the nodes of a level.
pub(in crate::reel) fn neighbours_below(links: Links<'_>) -> Vec<Neighbours> {
    // Bit counting needs instructions that not every CPU has.
    dispatch!(Level::new(), _simd => below(links))
}

#[inline(always)]
fn below(links: Links<'_>) -> Vec<Neighbours> {
    let mut below = Vec::with_capacity(links.first.last().map_or(0, |&end| end as usize));
    for (node, &mask) in links.masks.iter().enumerate() {
        let window = links.window(node);
        let mut octants = mask;
        while octants != 0 {
            below.push(links.neighbours_of_child(node, window, octants.trailing_zeros() as usize));
            octants &= octants - 1;
        }
    }
    below
}
