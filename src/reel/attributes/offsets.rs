//! Offsets along the normal from the middle of a cell to the surface (paper 001 §5.1), in a few bits.
//!
//! How it works: where a neighbour's surface is known, and the own normal, the plane through its point meets the line
//! through the own middle at a place that is told by one scalar product. The mean of what the neighbours say chooses
//! the models of the bits.

use super::normal_grid::{MISSING, NormalGrid};
use crate::reel::coder::{BitCoder, BitModel, divided};
use crate::reel::tree::{Known, NONE};

/// Offsets are within this part of a cell's edge to both sides, in 1024ths: half the diagonal, rounded up.
const LARGEST: i32 = 896;

/// Classes of predictions; the last is none.
const CLASSES: usize = 33;

/// What is known of offsets by what is predicted.
#[derive(Debug, Clone)]
pub(in crate::reel) struct OffsetModels {
    /// For each class the bits of an offset as a tree.
    bits: Vec<[BitModel; 16]>,
}

impl Default for OffsetModels {
    fn default() -> Self {
        Self {
            bits: vec![[BitModel::default(); 16]; CLASSES],
        }
    }
}

/// The offset that a code of `bits` bits stands for, in 1024ths of the cell's edge.
fn offset_of_code(code: u8, bits: u8) -> i32 {
    (((2 * i32::from(code) + 1) * LARGEST) >> bits) - LARGEST
}

/// The offset that a code of `bits` bits stands for, in edges of the cell.
pub(in crate::reel) fn offset_edges(code: u8, bits: u8) -> f64 {
    f64::from(offset_of_code(code, bits)) / 1024.0
}

/// The way from the middle of a cell that an offset along a normal stands for, in parts of the cell of which 2ᵇⁱᵗˢ are
/// its edge.
pub(in crate::reel) fn offset_parts(
    grid: &NormalGrid,
    normal: [i16; 2],
    code: u8,
    bits: u8,
    part_bits: u32,
) -> [i32; 3] {
    let offset = i64::from(offset_of_code(code, bits));
    // Both are in 1024ths.
    grid.direction(normal)
        .map(|along| ((((offset * i64::from(along)) << part_bits) + (1 << 19)) >> 20) as i32)
}

/// The code of an offset in edges of the cell.
pub(in crate::reel) fn offset_of(edges: f64, bits: u8) -> u8 {
    let steps = f64::from(1u32 << bits);
    let largest = f64::from(LARGEST) / 1024.0;
    ((edges / largest + 1.0) * 0.5 * steps).floor().clamp(0.0, steps - 1.0) as u8
}

/// Codes the offsets of the nodes of the deepest level, of `bits` bits (1 to 4).
pub(in crate::reel) fn code_offsets<C: BitCoder>(
    coder: &mut C,
    models: &mut OffsetModels,
    grid: &NormalGrid,
    bits: u8,
    plan: &[Known],
    normals: &[[i16; 2]],
    offsets: &mut [u8],
) {
    for (node, known) in plan.iter().enumerate() {
        let class = class_of(grid, bits, known, normals[node], offsets);
        let tree = &mut models.bits[class];
        let mut code = 1;
        for place in (0..bits).rev() {
            let bit = coder.bit(&mut tree[code], offsets[node] >> place & 1 != 0);
            code = 2 * code + usize::from(bit);
        }
        offsets[node] = (code - (1 << bits)) as u8;
    }
}

fn class_of(grid: &NormalGrid, bits: u8, known: &Known, normal: [i16; 2], offsets: &[u8]) -> usize {
    if normal == MISSING || known.beside[0] == NONE {
        return CLASSES - 1;
    }
    let beside = known.beside.iter().zip(known.directions);
    let beside = beside.take_while(|&(&neighbour, _)| neighbour != NONE);
    offset_class(
        grid,
        bits,
        normal,
        beside.map(|(&neighbour, step)| {
            let step = i32::from(step);
            (
                offsets[neighbour as usize],
                [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1],
            )
        }),
    )
}

/// The class, below 32, of the offset that nodes beside a node foretell: their codes, and the ways to them in cells.
/// Precondition: there is one of them, and the node has a normal.
#[inline(always)]
pub(in crate::reel) fn offset_class(
    grid: &NormalGrid,
    bits: u8,
    normal: [i16; 2],
    beside: impl Iterator<Item = (u8, [i32; 3])>,
) -> usize {
    let direction = grid.direction(normal);
    let (mut sum, mut count) = (0, 0);
    for (code, way) in beside {
        let along: i32 = way
            .iter()
            .zip(direction)
            .map(|(way, along)| way * i32::from(along))
            .sum();
        sum += offset_of_code(code, bits) + along;
        count += 1;
    }
    let predicted = divided(sum, count).clamp(-LARGEST, LARGEST - 1);
    ((predicted + LARGEST) * (CLASSES as i32 - 1) / (2 * LARGEST)) as usize
}
