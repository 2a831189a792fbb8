//! The masks of a level, each bit by what is known around its cell.
//!
//! How it works: masks come in Morton order. When bit *j* of a node is coded, all nodes of its level are known, and of
//! the level below the cells of all nodes before it and of its own octants before *j*. Three models look at that from
//! different distances, and a mixer weighs them:
//!
//! - *faces*: which of the six cells that share a face with the one in question are occupied already, whether the nodes
//!   behind the three outer ones exist, and how many cells across edges are occupied and may be;
//! - *counts*: how many of the 26 cells around are occupied already, and how many may be;
//! - *pattern*: which of the 26 nodes around this node exist, hashed to 16 bits.
//!
//! This is the idea of the neighbour-dependent contexts of G-PCC (ISO/IEC 23090-9), with a mixer where that has a
//! table: on a surface sampled at random the first two models alone need 10 and 12 % more bits.
//!
//! When it wins: surfaces. Where a node has no neighbour at all, as far out in the sweep of a scanner, it mostly has
//! one child, and its octant is coded as three even bits.

use super::links::{Links, NONE, Neighbours};
use super::window::{self, CORNERS, CUBE_OF_27, EDGES, FACES, SELF};
use crate::reel::coder::{BitCoder, BitModel, Mixer};
use fearless_simd::{Level, dispatch};

const FACES_MODELS: usize = 1 << 16;
const COUNTS_MODELS: usize = 1 << 15;
const PATTERN_MODELS: usize = 1 << 19;

/// What is known so far of how masks follow from what is around them.
#[derive(Debug, Clone)]
pub(in crate::reel) struct OccupancyModels {
    models: Vec<BitModel>,
    mixer: Mixer<3>,
    lone: [BitModel; 2],
}

impl Default for OccupancyModels {
    fn default() -> Self {
        Self {
            models: vec![BitModel::default(); FACES_MODELS + COUNTS_MODELS + PATTERN_MODELS],
            mixer: Mixer::new(8 * 8),
            lone: Default::default(),
        }
    }
}

/// Codes the masks of a level, of which the nodes above are `links`, and hands over the neighbours of its nodes, if they
/// are wanted. Precondition: as many masks as there are nodes.
pub(in crate::reel) fn code_masks<C: BitCoder>(
    coder: &mut C,
    models: &mut OccupancyModels,
    links: Links<'_>,
    masks: &mut [u8],
    wants_neighbours: bool,
) -> Vec<Neighbours> {
    // Bits are counted by instructions that not every processor has.
    dispatch!(Level::new(), _simd => code_masks_in_order(coder, models, links, masks, wants_neighbours))
}

#[inline(always)]
fn code_masks_in_order<C: BitCoder>(
    coder: &mut C,
    models: &mut OccupancyModels,
    links: Links<'_>,
    masks: &mut [u8],
    wants_neighbours: bool,
) -> Vec<Neighbours> {
    let mut blocks = vec![0u64; links.masks.len()];
    let mut of_level = Vec::with_capacity(if wants_neighbours { masks.len() } else { 0 });
    let mut node = 0;
    for parent in 0..links.masks.len() {
        let window = links.window(parent);
        let neighbours = &links.neighbours[parent];
        let mut octants = links.masks[parent];
        while octants != 0 {
            let octant = octants.trailing_zeros() as usize;
            octants &= octants - 1;
            let near = window::around(window, octant);
            let mask = &mut masks[node];
            node += 1;
            *mask = if near == SELF {
                code_lone(coder, models, near, *mask)
            } else {
                let fine = window::of_blocks(octant, |direction| match neighbours[direction] {
                    NONE => 0,
                    block => blocks[block as usize],
                });
                code_mask(coder, models, near, fine, *mask)
            };
            blocks[parent] |= window::in_block(octant, *mask);
            if wants_neighbours {
                of_level.push(links.neighbours_of_child(parent, window, octant));
            }
        }
    }
    of_level
}

/// A node without neighbours.
#[inline(always)]
fn code_lone<C: BitCoder>(coder: &mut C, models: &mut OccupancyModels, near: u64, mask: u8) -> u8 {
    if coder.bit(&mut models.lone[0], mask.is_power_of_two()) {
        1 << coder.even_bits(3, u64::from(mask.trailing_zeros()) & 7)
    } else {
        code_mask(coder, models, near, 0, mask)
    }
}

/// One mask by the nodes around the node and the cells below them that are known.
#[inline(always)]
fn code_mask<C: BitCoder>(coder: &mut C, models: &mut OccupancyModels, near: u64, fine: u64, mask: u8) -> u8 {
    let possible = window::refined(near);
    let pattern = FACES_MODELS + COUNTS_MODELS + 8 * (near.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48) as usize;
    let mut known = fine;
    let mut coded = 0u8;
    for octant in 0..8usize {
        if octant == 7 && coded == 0 {
            return 1 << 7;
        }
        let shift = window::shift_of(octant);
        let occupied_around = known >> shift & CUBE_OF_27;
        let possible_around = possible >> shift & CUBE_OF_27;
        let faces = face_bits(occupied_around);
        let outer = outer_faces(face_bits(possible_around), octant);
        let edges = (occupied_around & EDGES).count_ones().min(3) as usize;
        let possible_edges = ((possible_around & EDGES).count_ones() / 2).min(3) as usize;
        let siblings = coded.count_ones() as usize;
        let occupied = (occupied_around & !SELF).count_ones().min(15) as usize;
        let places = [
            (octant << 9 | faces << 3 | outer) << 4 | edges << 2 | possible_edges,
            FACES_MODELS + (((octant << 5 | possible_around.count_ones() as usize) << 4 | occupied) << 3 | siblings),
            pattern + octant,
        ];
        let bit = mask >> octant & 1 != 0;
        let mixed = octant << 3 | siblings;
        if models.mixer.code(coder, mixed, &mut models.models, places, bit) {
            coded |= 1 << octant;
            known |= SELF << shift;
        }
    }
    coded
}

/// The six faces of the cells around as bits: z, y, x below, then x, y, z above.
#[inline(always)]
fn face_bits(around: u64) -> usize {
    let bits = around & FACES;
    (bits >> 5 & 1 | bits >> 16 & 2 | bits >> 18 & 4 | bits >> 19 & 8 | bits >> 21 & 16 | bits >> 32 & 32) as usize
}

/// Of those the three that lead out of the node from an octant.
#[inline(always)]
fn outer_faces(faces: usize, octant: usize) -> usize {
    let x = faces >> (2 + (octant & 1));
    let y = faces >> (1 + 3 * (octant >> 1 & 1));
    let z = faces >> (5 * (octant >> 2));
    x & 1 | (y & 1) << 1 | (z & 1) << 2
}

const _: () = assert!(CORNERS | EDGES | FACES | SELF == CUBE_OF_27);
