//! Offsets along the normal, predicted from the surrounding cells and from the plane of the previous node in the
//! family.
//!
//! How it works: cells are occupied where the surface is, so their centres lie around it. The mean of the centres that
//! touch a cell, along its normal, is approximately on the surface; it is known before any offset. The plane through
//! the point of the previous node meets the line through the node's own centre at a position with three times the
//! weight. Both together choose the table of a symbol.

use super::families::{Above, Families};
use super::steps_to::{BEYOND, WITHIN, sums};
use crate::reel::attributes::{LARGEST_OFFSET, MISSING, NormalGrid, offset_of_code};
use crate::reel::coder::{LANES, SymbolCoder, divided};
use crate::reel::tree::{NO_FACES, NONE};

/// Context classes of the predicted surface position, for nodes behind another one of the family and for the first.
const CLASSES: usize = 32;
const FIRST: usize = CLASSES;

/// Contexts of offsets.
pub(in crate::reel) const OFFSET_CONTEXTS: usize = 2 * CLASSES;

/// Codes the offsets of the nodes of the deepest level, of `bits` bits (1 to 4).
#[inline(always)]
pub(in crate::reel) fn code_offsets<C: SymbolCoder>(
    coder: &mut C,
    grid: &NormalGrid,
    bits: u8,
    above: Above<'_>,
    normals: &[[i16; 2]],
    offsets: &mut [u8],
) {
    let Families::Masks(masks) = above.families else { return };
    // A local copy, not a reference: its state stays in registers.
    let mut own = std::mem::take(coder);
    let mut nodes = offsets.iter_mut().zip(normals).enumerate();
    for (parent, &mask) in masks.iter().enumerate() {
        let faces = above.faces.get(parent).copied().unwrap_or(NO_FACES);
        let beyond = faces.map(|face| {
            if face == NONE {
                0
            } else {
                usize::from(masks[face as usize])
            }
        });
        let mut octants = mask;
        // Offsets are predicted from their siblings only: 1.2 bits for the torus. Predicted from three neighbouring
        // nodes they took 0.7, but each waited for the one before.
        let mut before: Option<(usize, u8)> = None;
        while octants != 0
            && let Some((node, (offset, &normal))) = nodes.next()
        {
            let octant = octants.trailing_zeros() as usize;
            octants &= octants - 1;
            let mut context = CLASSES / 2 + FIRST;
            if normal != MISSING {
                let direction = grid.direction(normal).map(i32::from);
                let mut steps_to = WITHIN[octant][usize::from(mask)];
                for axis in 0..3 {
                    steps_to += BEYOND[octant][axis][beyond[2 * axis + (octant >> axis & 1)]];
                }
                let along = |way: [i32; 3]| {
                    way.into_iter()
                        .zip(direction)
                        .map(|(way, along)| way * along)
                        .sum::<i32>()
                };
                let (way, count) = sums(steps_to);
                let around = divided(along(way), count + 1);
                context = match before {
                    Some((last, code)) => {
                        let way = [0, 1, 2].map(|axis| (last >> axis & 1) as i32 - (octant >> axis & 1) as i32);
                        class((3 * (offset_of_code(code, bits) + along(way)) + around) >> 2)
                    }
                    None => FIRST + class(around),
                };
            }
            *offset = own.symbol(node % LANES, context, *offset) & ((1 << bits) - 1);
            before = Some((octant, *offset));
        }
    }
    *coder = own;
}

/// The class of a place along the normal, in 1024ths of the cell's edge.
#[inline(always)]
fn class(place: i32) -> usize {
    let within = place.clamp(-LARGEST_OFFSET, LARGEST_OFFSET - 1);
    ((within + LARGEST_OFFSET) as u32 * CLASSES as u32 / (2 * LARGEST_OFFSET) as u32) as usize
}
