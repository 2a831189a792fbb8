//! The masks of a level, each bit by the known cells around its own.
//!
//! How it works: masks come in Morton order. When bit *j* of a node is coded, all nodes of its level are known, and in
//! the level below the cells of all nodes before it and of its own octants before *j*. Two models look at that from
//! different sides, and a mixer weighs them:
//!
//! - *faces*: which of the six cells that share a face with the one in question are occupied already, whether the nodes
//!   behind the three outer ones exist, and how many cells across edges are occupied and may be;
//! - *outer*: the mask so far, and which of the seven nodes exist that touch the corner of the node at *j*.
//!
//! This is the idea of the neighbour-dependent contexts of G-PCC (ISO/IEC 23090-9), with a mixer where that has a
//! table.
//!
//! When it wins: surfaces. Where a node has no neighbour at all, as far out in the sweep of a scanner, it mostly has
//! one child, and its octant is coded as three even bits.
//!
//! What it costs: the two look-ups, their product with the weights, and the bit itself wait for one another, as the
//! next bit needs this one. So the code has no branch that depends on a bit, and large levels are parts that do not
//! wait for each other.

use super::links::{ALONE, Links, Neighbours};
use super::window::{self, CORNERS, CUBE_OF_27, EDGES, FACES, SELF};
use crate::reel::coder::{BitCoder, BitModel, Mixer};
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use std::ops::Range;

const FACES_MODELS: usize = 1 << 16;
const OUTER_MODELS: usize = 1 << 16;

/// Adaptive models of occupancy masks, given their surroundings.
#[derive(Debug, Clone)]
pub(in crate::reel) struct OccupancyModels {
    faces: Box<[BitModel; FACES_MODELS]>,
    outer: Box<[BitModel; OUTER_MODELS]>,
    mixer: Mixer<2>,
    lone: BitModel,
}

impl Default for OccupancyModels {
    fn default() -> Self {
        Self {
            faces: new_models(),
            outer: new_models(),
            mixer: Mixer::new(8 * 8),
            lone: BitModel::default(),
        }
    }
}

/// Allocates models directly on the heap, never on the stack: the stacks of other threads are small.
#[expect(clippy::unnecessary_box_returns, reason = "a place on the heap is what it is for")]
fn new_models<const COUNT: usize>() -> Box<[BitModel; COUNT]> {
    let models = vec![BitModel::default(); COUNT].into_boxed_slice();
    models.try_into().expect("the slice has the length of the array")
}

/// Nodes that are worth a part of their own, and most parts. Each part learns its models alone: for the bumpy torus of
/// a million points at 10 bits, four parts take 1 % more bits than one.
const NODES_PER_PART: usize = 1 << 16;
const MAX_PARTS: usize = 8;

/// Number of nodes from which a part has two halves.
const NODES_OF_HALVES: usize = 1 << 10;

/// Coders of the masks of a level with this number of nodes: one for each half of each part, or a single one.
pub(in crate::reel) fn coders_of(nodes: usize) -> usize {
    if nodes < NODES_OF_HALVES {
        1
    } else {
        2 * (nodes / NODES_PER_PART).clamp(1, MAX_PARTS)
    }
}

/// Codes the masks of a level, with `links` as the nodes above, each half of a part by a coder of its own, and hands
/// over the neighbours of its nodes, if wanted. Models continue those of the level above. Precondition: one mask per
/// node.
pub(in crate::reel) fn code_masks<C: BitCoder + Send>(
    coders: &mut [C],
    models: &mut Vec<OccupancyModels>,
    links: Links<'_>,
    masks: &mut [u8],
    wants_neighbours: bool,
) -> Vec<Neighbours> {
    let halves = coders.len();
    let (parts, before) = (halves.div_ceil(2), models.len());
    *models = (0..parts).map(|part| models[part * before / parts].clone()).collect();
    let mut neighbours = vec![ALONE; if wants_neighbours { masks.len() } else { 0 }];
    let parents = links.masks.len();
    let (mut masks, mut rest) = (masks, neighbours.as_mut_slice());
    let mut walks = Vec::with_capacity(halves);
    for (half, coder) in coders.iter_mut().enumerate() {
        let parents = parents * half / halves..parents * (half + 1) / halves;
        let nodes = (links.first[parents.end] - links.first[parents.start]) as usize;
        let own;
        (own, masks) = std::mem::take(&mut masks).split_at_mut(nodes);
        let neighbours;
        (neighbours, rest) = std::mem::take(&mut rest).split_at_mut(if wants_neighbours { nodes } else { 0 });
        walks.push(Walk::new(coder, links, parents, own, neighbours));
    }
    // Bit counting needs instructions that not every CPU has.
    walks
        .par_chunks_mut(2)
        .zip(models)
        .for_each(|(halves, models)| dispatch!(Level::new(), _simd => code_part(halves, models)));
    neighbours
}

/// Codes both halves of a part, in turns, or the only one.
///
/// A bit waits for the one before, as that may have seen the same models. Another octant has other models. So one half
/// is four octants behind the other, and the CPU works on both. To the models that is as if the nodes of both halves
/// came in turns.
#[inline(always)]
fn code_part<C: BitCoder>(halves: &mut [Walk<'_, C>], models: &mut OccupancyModels) {
    let [first, second] = halves else {
        for walk in halves {
            let coder = std::mem::take(walk.coder);
            *walk.coder = code_rest(walk, coder, models);
        }
        return;
    };
    // Local copies, not references: their state stays in registers.
    let mut coders = (std::mem::take(first.coder), std::mem::take(second.coder));
    let mut other: Option<Around> = None;
    loop {
        let one = first.next(&mut coders.0, models);
        let Some(mut one) = one else {
            if let Some(mut other) = other {
                other.code_upper(&mut coders.1, models);
                second.put(other.coded);
            }
            coders.1 = code_rest(second, coders.1, models);
            break;
        };
        match &mut other {
            Some(other) => {
                other.code_upper_adjacent(&mut coders.1, &mut one, &mut coders.0, models);
                second.put(other.coded);
            }
            None => one.code_lower(&mut coders.0, models),
        }
        other = second.next(&mut coders.1, models);
        if let Some(other) = &mut other {
            one.code_upper_adjacent(&mut coders.0, other, &mut coders.1, models);
            first.put(one.coded);
        } else {
            one.code_upper(&mut coders.0, models);
            first.put(one.coded);
            coders.0 = code_rest(first, coders.0, models);
            break;
        }
    }
    (*first.coder, *second.coder) = coders;
}

/// Codes the nodes that are left of a half, and hands back its coder.
#[inline(always)]
fn code_rest<C: BitCoder>(walk: &mut Walk<'_, C>, mut coder: C, models: &mut OccupancyModels) -> C {
    while let Some(mut around) = walk.next(&mut coder, models) {
        around.code_lower(&mut coder, models);
        around.code_upper(&mut coder, models);
        walk.put(around.coded);
    }
    coder
}

/// The nodes below some parents that follow each other.
struct Walk<'a, C> {
    coder: &'a mut C,
    links: Links<'a>,
    parents: Range<usize>,
    masks: &'a mut [u8],
    /// Empty if they are not wanted.
    neighbours: &'a mut [Neighbours],
    /// Known cells of the level below, for each parent.
    blocks: Vec<u64>,
    /// The parent of the next node, its octants from that node on, and its window.
    parent: usize,
    octants: u8,
    window: u64,
    /// The octant of this node.
    octant: usize,
    /// The number of the next node.
    node: usize,
}

impl<'a, C: BitCoder> Walk<'a, C> {
    fn new(
        coder: &'a mut C,
        links: Links<'a>,
        parents: Range<usize>,
        masks: &'a mut [u8],
        neighbours: &'a mut [Neighbours],
    ) -> Self {
        Self {
            coder,
            links,
            masks,
            neighbours,
            blocks: vec![0; parents.len()],
            parent: parents.start.wrapping_sub(1),
            parents,
            octants: 0,
            window: 0,
            octant: 0,
            node: 0,
        }
    }

    /// Returns the next node, skipping those that are coded by a single raw number.
    #[inline(always)]
    fn next(&mut self, coder: &mut C, models: &mut OccupancyModels) -> Option<Around> {
        while self.node < self.masks.len() {
            while self.octants == 0 {
                self.parent = self.parent.wrapping_add(1);
                self.octants = self.links.masks[self.parent];
                self.window = self.links.window(self.parent);
            }
            self.octant = self.octants.trailing_zeros() as usize;
            self.octants &= self.octants - 1;
            let around = self.around();
            if let Some(neighbours) = self.neighbours.get_mut(self.node) {
                *neighbours = self.links.neighbours_of_child(self.parent, self.window, self.octant);
            }
            self.node += 1;
            let mask = around.given;
            if around.near == SELF && coder.bit(&mut models.lone, mask.is_power_of_two()) {
                self.put(1 << coder.even_bits(3, u64::from(mask.trailing_zeros()) & 7));
                continue;
            }
            return Some(around);
        }
        None
    }

    #[inline(always)]
    fn around(&self) -> Around {
        let near = window::around(self.window, self.octant);
        let neighbours = &self.links.neighbours[self.parent];
        let known = window::of_blocks(self.octant, |direction| {
            // Another half is unknown, like a node that does not exist.
            let block = (neighbours[direction] as usize).wrapping_sub(self.parents.start);
            // No branch: it would be unpredictable.
            let is_there = block < self.blocks.len();
            self.blocks[if is_there { block } else { 0 }] & u64::from(is_there).wrapping_neg()
        });
        Around {
            near,
            possible: window::refined(near),
            known,
            given: self.masks[self.node],
            coded: 0,
        }
    }

    /// The mask of the last node.
    #[inline(always)]
    fn put(&mut self, mask: u8) {
        self.masks[self.node - 1] = mask;
        self.blocks[self.parent - self.parents.start] |= window::in_block(self.octant, mask);
    }
}

/// Context of a node, and of the cells in it.
struct Around {
    /// Occupancy of the 27 nodes around.
    near: u64,
    /// Cells that may be occupied, as a window.
    possible: u64,
    /// Cells that are known to be, as a window.
    known: u64,
    /// The cells of the node itself: the mask that there is, or nothing; and those that are coded.
    given: u8,
    coded: u8,
}

impl Around {
    /// Codes the first four cells.
    #[inline(always)]
    fn code_lower<C: BitCoder>(&mut self, coder: &mut C, models: &mut OccupancyModels) {
        // Separate code for each: the compiler computes everything that depends on the octant alone.
        self.code_cell::<C, 0>(coder, models);
        self.code_cell::<C, 1>(coder, models);
        self.code_cell::<C, 2>(coder, models);
        self.code_cell::<C, 3>(coder, models);
    }

    /// Codes the others.
    #[inline(always)]
    fn code_upper<C: BitCoder>(&mut self, coder: &mut C, models: &mut OccupancyModels) {
        self.code_cell::<C, 4>(coder, models);
        self.code_cell::<C, 5>(coder, models);
        self.code_cell::<C, 6>(coder, models);
        self.code_last(coder, models);
    }

    /// Codes the upper cells of this node, and the lower ones of another.
    #[inline(always)]
    fn code_upper_adjacent<C: BitCoder>(
        &mut self,
        coder: &mut C,
        other: &mut Self,
        of_other: &mut C,
        models: &mut OccupancyModels,
    ) {
        self.code_cell::<C, 4>(coder, models);
        other.code_cell::<C, 0>(of_other, models);
        self.code_cell::<C, 5>(coder, models);
        other.code_cell::<C, 1>(of_other, models);
        self.code_cell::<C, 6>(coder, models);
        other.code_cell::<C, 2>(of_other, models);
        self.code_last(coder, models);
        other.code_cell::<C, 3>(of_other, models);
    }

    /// No mask is empty.
    #[inline(always)]
    fn code_last<C: BitCoder>(&mut self, coder: &mut C, models: &mut OccupancyModels) {
        if self.coded == 0 {
            self.coded = 1 << 7;
        } else {
            self.code_cell::<C, 7>(coder, models);
        }
    }

    #[inline(always)]
    fn code_cell<C: BitCoder, const OCTANT: usize>(&mut self, coder: &mut C, models: &mut OccupancyModels) {
        let shift = window::shift_of(OCTANT);
        let occupied = self.known >> shift;
        let edges = (occupied & EDGES).count_ones().min(3) as usize;
        let possible_edges = ((self.possible >> shift & EDGES).count_ones() / 2).min(3) as usize;
        let across = face_bits(occupied) << 3 | outer_faces(self.near, OCTANT);
        let faces = (OCTANT << 9 | across) << 4 | edges << 2 | possible_edges;
        let outer = usize::from(self.coded) << 8 | outer_nodes(self.near, OCTANT);
        // Two models, mixed: 3.82 bits per voxel (bumpy torus of 1 M points, 10 bits). Three, of faces, of counts and
        // of the 26 surrounding nodes, took 3.87 bits, and half as long again.
        let of_cell = [
            &mut models.faces[faces & (FACES_MODELS - 1)],
            &mut models.outer[(1 << (8 + OCTANT) | outer) & (OUTER_MODELS - 1)],
        ];
        let mixed = OCTANT << 3 | self.coded.count_ones() as usize;
        let bit = self.given >> OCTANT & 1 != 0;
        let bit = models.mixer.code(coder, mixed, of_cell, bit);
        self.coded |= u8::from(bit) << OCTANT;
        self.known |= u64::from(bit) << (SELF.trailing_zeros() + shift);
    }
}

/// The 2 × 2 × 2 nodes that touch the corner of the node at an octant, itself among them, as bits.
#[inline(always)]
fn outer_nodes(near: u64, octant: usize) -> usize {
    let nodes = near >> window::shift_of(octant) & 0x0033_0033;
    let rows = nodes | nodes >> 2;
    ((rows & 0xf) | (rows >> 12 & 0xf0)) as usize
}

/// Returns the occupancy bits of the six cells that share a face with the centre of 27.
#[inline(always)]
fn face_bits(around: u64) -> usize {
    let bits = around & FACES;
    (bits >> 5 & 1 | bits >> 16 & 2 | bits >> 18 & 4 | bits >> 19 & 8 | bits >> 21 & 16 | bits >> 32 & 32) as usize
}

/// Returns the occupancy bits of the three nodes that share a face of the cell at an octant.
#[inline(always)]
fn outer_faces(near: u64, octant: usize) -> usize {
    let x = near >> (20 + 2 * (octant & 1)) & 1;
    let y = near >> (17 + 8 * (octant >> 1 & 1)) & 1;
    let z = near >> (5 + 32 * (octant >> 2)) & 1;
    (x | y << 1 | z << 2) as usize
}

const _: () = assert!(CORNERS | EDGES | FACES | SELF == CUBE_OF_27);
