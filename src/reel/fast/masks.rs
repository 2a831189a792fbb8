//! The masks of a level as symbols, each in the context of its parent's mask as it is seen from it.

use super::views::{SEEN, UNSEEN, VIEW, VIEWS};
use crate::reel::coder::{LANES, SymbolCoder};

/// Contexts of masks.
pub(in crate::reel) const MASK_CONTEXTS: usize = VIEWS;

/// The mask above the root, of which that is the only octant.
pub(in crate::reel) const ABOVE_ROOT: u8 = 1;

/// Codes the masks of a level, of which the nodes above have the masks `above`. Precondition: as many masks as those
/// have octants.
#[inline(always)]
pub(in crate::reel) fn code_masks<C: SymbolCoder>(coder: &mut C, above: &[u8], masks: &mut [u8]) {
    // Not behind a reference: what it keeps stays in registers.
    let mut own = std::mem::take(coder);
    let mut masks = masks.iter_mut().enumerate();
    for &parent in above {
        let views = &VIEW[usize::from(parent)];
        let mut octants = parent;
        while octants != 0
            && let Some((node, mask)) = masks.next()
        {
            let view = views[octants.trailing_zeros() as usize];
            octants &= octants - 1;
            let symmetry = usize::from(view.symmetry);
            let seen = own.symbol(
                node % LANES,
                usize::from(view.context),
                SEEN[symmetry][usize::from(*mask)],
            );
            *mask = UNSEEN[symmetry][usize::from(seen)];
        }
    }
    *coder = own;
}
