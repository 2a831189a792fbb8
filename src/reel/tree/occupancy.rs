//! The masks of a level, each bit by what is known around its cell.
//!
//! How it works: masks come in Morton order. When bit *j* of a node is coded, all nodes of its level are known, and of
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

/// What is known so far of how masks follow from what is around them.
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

/// Not on the stack, not for a moment: those of other threads are small.
#[expect(clippy::unnecessary_box_returns, reason = "a place on the heap is what it is for")]
fn new_models<const COUNT: usize>() -> Box<[BitModel; COUNT]> {
    let models = vec![BitModel::default(); COUNT].into_boxed_slice();
    models.try_into().expect("there are as many as asked for")
}

/// Nodes that are worth a part of their own, and most parts. Each part learns its models alone: for the bumpy torus of
/// a million points at 10 bits, four parts take 1 % more bits than one.
const NODES_PER_PART: usize = 1 << 16;
const MOST_PARTS: usize = 8;

/// Parts that the masks of a level of so many nodes are coded in, at the same time.
pub(in crate::reel) fn parts_of(nodes: usize) -> usize {
    (nodes / NODES_PER_PART).clamp(1, MOST_PARTS)
}

/// Codes the masks of a level, of which the nodes above are `links`, each part by a coder of its own, and hands over
/// the neighbours of its nodes, if they are wanted. Models go on from those of the level above. Precondition: as many
/// masks as there are nodes.
pub(in crate::reel) fn code_masks<C: BitCoder + Send>(
    coders: &mut [C],
    models: &mut Vec<OccupancyModels>,
    links: Links<'_>,
    masks: &mut [u8],
    wants_neighbours: bool,
) -> Vec<Neighbours> {
    let (parts, before) = (coders.len(), models.len());
    *models = (0..parts).map(|part| models[part * before / parts].clone()).collect();
    let mut neighbours = vec![ALONE; if wants_neighbours { masks.len() } else { 0 }];
    let parents = links.masks.len();
    let (mut masks, mut rest) = (masks, neighbours.as_mut_slice());
    let mut tasks = Vec::with_capacity(parts);
    for ((part, coder), models) in coders.iter_mut().enumerate().zip(models) {
        let parents = parents * part / parts..parents * (part + 1) / parts;
        let nodes = (links.first[parents.end] - links.first[parents.start]) as usize;
        let own;
        (own, masks) = std::mem::take(&mut masks).split_at_mut(nodes);
        let neighbours;
        (neighbours, rest) = std::mem::take(&mut rest).split_at_mut(if wants_neighbours { nodes } else { 0 });
        tasks.push(Part {
            coder,
            models,
            parents,
            masks: own,
            neighbours,
        });
    }
    // Bits are counted by instructions that not every processor has.
    tasks
        .into_par_iter()
        .for_each(|part| dispatch!(Level::new(), _simd => part.code(links)));
    neighbours
}

/// The nodes below some parents that follow each other.
struct Part<'a, C> {
    coder: &'a mut C,
    models: &'a mut OccupancyModels,
    parents: Range<usize>,
    masks: &'a mut [u8],
    /// Empty if they are not wanted.
    neighbours: &'a mut [Neighbours],
}

impl<C: BitCoder> Part<'_, C> {
    #[inline(always)]
    fn code(self, links: Links<'_>) {
        let models = self.models;
        // Not behind a reference: what it keeps stays in registers.
        let mut coder = std::mem::take(self.coder);
        // What is known of the level below, for each parent of this part.
        let mut blocks = vec![0u64; self.parents.len()];
        let mut node = 0;
        for parent in self.parents.clone() {
            let window = links.window(parent);
            let neighbours = &links.neighbours[parent];
            let mut octants = links.masks[parent];
            while octants != 0 {
                let octant = octants.trailing_zeros() as usize;
                octants &= octants - 1;
                let near = window::around(window, octant);
                let known = window::of_blocks(octant, |direction| {
                    // Nothing is known of another part, as of a node that is not there.
                    let block = (neighbours[direction] as usize).wrapping_sub(self.parents.start);
                    blocks.get(block).copied().unwrap_or(0)
                });
                let around = Around {
                    near,
                    possible: window::refined(near),
                    known,
                    coded: 0,
                };
                let mask = &mut self.masks[node];
                *mask = around.code_mask(&mut coder, models, *mask);
                blocks[parent - self.parents.start] |= window::in_block(octant, *mask);
                if let Some(neighbours) = self.neighbours.get_mut(node) {
                    *neighbours = links.neighbours_of_child(parent, window, octant);
                }
                node += 1;
            }
        }
        *self.coder = coder;
    }
}

/// What is known of a node, and of the cells in it.
struct Around {
    /// Of the 27 nodes around.
    near: u64,
    /// Cells that may be occupied, as a window.
    possible: u64,
    /// Cells that are known to be, as a window.
    known: u64,
    /// The cells of the node itself.
    coded: u8,
}

impl Around {
    #[inline(always)]
    fn code_mask<C: BitCoder>(mut self, coder: &mut C, models: &mut OccupancyModels, mask: u8) -> u8 {
        if self.near == SELF && coder.bit(&mut models.lone, mask.is_power_of_two()) {
            return 1 << coder.even_bits(3, u64::from(mask.trailing_zeros()) & 7);
        }
        // Each its own code: what depends on the octant alone is worked out by the compiler.
        self.code_cell::<C, 0>(coder, models, mask);
        self.code_cell::<C, 1>(coder, models, mask);
        self.code_cell::<C, 2>(coder, models, mask);
        self.code_cell::<C, 3>(coder, models, mask);
        self.code_cell::<C, 4>(coder, models, mask);
        self.code_cell::<C, 5>(coder, models, mask);
        self.code_cell::<C, 6>(coder, models, mask);
        if self.coded == 0 {
            return 1 << 7;
        }
        self.code_cell::<C, 7>(coder, models, mask);
        self.coded
    }

    #[inline(always)]
    fn code_cell<C: BitCoder, const OCTANT: usize>(&mut self, coder: &mut C, models: &mut OccupancyModels, mask: u8) {
        let shift = window::shift_of(OCTANT);
        let occupied = self.known >> shift;
        let edges = (occupied & EDGES).count_ones().min(3) as usize;
        let possible_edges = ((self.possible >> shift & EDGES).count_ones() / 2).min(3) as usize;
        let across = face_bits(occupied) << 3 | outer_faces(self.near, OCTANT);
        let faces = (OCTANT << 9 | across) << 4 | edges << 2 | possible_edges;
        let outer = usize::from(self.coded) << 8 | outer_nodes(self.near, OCTANT);
        let of_cell = [
            &mut models.faces[faces & (FACES_MODELS - 1)],
            &mut models.outer[(1 << (8 + OCTANT) | outer) & (OUTER_MODELS - 1)],
        ];
        let mixed = OCTANT << 3 | self.coded.count_ones() as usize;
        let bit = mask >> OCTANT & 1 != 0;
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

/// Which of the six cells that share a face with the middle of 27 there are.
#[inline(always)]
fn face_bits(around: u64) -> usize {
    let bits = around & FACES;
    (bits >> 5 & 1 | bits >> 16 & 2 | bits >> 18 & 4 | bits >> 19 & 8 | bits >> 21 & 16 | bits >> 32 & 32) as usize
}

/// Which of the three nodes there are that share a face of the cell at an octant.
#[inline(always)]
fn outer_faces(near: u64, octant: usize) -> usize {
    let x = near >> (20 + 2 * (octant & 1)) & 1;
    let y = near >> (17 + 8 * (octant >> 1 & 1)) & 1;
    let z = near >> (5 + 32 * (octant >> 2)) & 1;
    (x | y << 1 | z << 2) as usize
}

const _: () = assert!(CORNERS | EDGES | FACES | SELF == CUBE_OF_27);
