//! The masks of a level as symbols, each in the context of its parent's mask as it is seen from it.

use super::views::{BELOW, SEEN, UNSEEN, VIEWS};
use crate::reel::coder::SymbolCoder;

/// Contexts of masks.
pub(in crate::reel) const MASK_CONTEXTS: usize = VIEWS;

/// The mask above the root, with the root as its only octant.
pub(in crate::reel) const ABOVE_ROOT: u8 = 1;

/// Codes the masks of a level, whose parents have the masks `above`. Precondition: one mask per octant of those.
#[inline(always)]
pub(in crate::reel) fn code_masks<C: SymbolCoder>(coder: &mut C, above: &[u8], masks: &mut [u8]) {
    // Always eight at a time: their number is unpredictable.
    let mut contexts = vec![0; masks.len() + 8];
    let mut symmetries = vec![0; masks.len() + 8];
    let mut next = 0;
    for &parent in above {
        let (Some(context), Some(symmetry)) = (
            contexts.get_mut(next..).and_then(<[u8]>::first_chunk_mut),
            symmetries.get_mut(next..).and_then(<[u8]>::first_chunk_mut),
        ) else {
            break;
        };
        [*context, *symmetry] = BELOW[usize::from(parent)];
        next += parent.count_ones() as usize;
    }
    // There are no symmetries after the last one.
    let symmetry = |of: &u8| usize::from(*of) % SEEN.len();
    if !C::DECODES {
        for (mask, of) in masks.iter_mut().zip(&symmetries) {
            *mask = SEEN[symmetry(of)][usize::from(*mask)];
        }
    }
    contexts.truncate(masks.len());
    // A local copy, not a reference: its state stays in registers.
    let mut own = std::mem::take(coder);
    own.symbols(&contexts, masks);
    *coder = own;
    for (mask, of) in masks.iter_mut().zip(&symmetries) {
        *mask = UNSEEN[symmetry(of)][usize::from(*mask)];
    }
}
