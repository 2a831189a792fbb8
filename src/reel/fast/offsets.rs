//! Offsets along the normal, each by the plane of the node before in the same family.

use crate::reel::attributes::{MISSING, NormalGrid, offset_class};
use crate::reel::coder::{LANES, SymbolCoder};

/// Contexts of offsets: what is foretold, and where nothing is.
pub(in crate::reel) const OFFSET_CONTEXTS: usize = 33;

/// Codes the offsets of the nodes of the deepest level, of `bits` bits (1 to 4), below nodes with the masks `above`.
#[inline(always)]
pub(in crate::reel) fn code_offsets<C: SymbolCoder>(
    coder: &mut C,
    grid: &NormalGrid,
    bits: u8,
    above: &[u8],
    normals: &[[i16; 2]],
    offsets: &mut [u8],
) {
    // Not behind a reference: what it keeps stays in registers.
    let mut own = std::mem::take(coder);
    let mut nodes = offsets.iter_mut().zip(normals).enumerate();
    for &mask in above {
        let mut octants = mask;
        let mut before: Option<(u8, u8)> = None;
        while octants != 0
            && let Some((node, (offset, &normal))) = nodes.next()
        {
            let octant = octants.trailing_zeros() as u8;
            octants &= octants - 1;
            let context = match before {
                Some((last, offset)) if normal != MISSING => {
                    let way = [0, 1, 2].map(|axis| i32::from(last >> axis & 1) - i32::from(octant >> axis & 1));
                    offset_class(grid, bits, normal, [(offset, way)].into_iter())
                }
                _ => OFFSET_CONTEXTS - 1,
            };
            *offset = own.symbol(node % LANES, context, *offset) & ((1 << bits) - 1);
            before = Some((octant, *offset));
        }
    }
    *coder = own;
}
