//! A mask as it is seen from one of its octants: turned and mirrored so that masks that are alike are the same.
//!
//! How it works: a cube has 48 symmetries. For an octant of a mask, the symmetries are used that bring it to the corner
//! of octant 0: mirror along the axes on which it is above, then order the axes. Of the six orders the one counts that
//! makes the mask the least number. So 1,024 pairs of a mask and an octant in it are 40 contexts, and the subtree of
//! that octant is turned along with it.

/// Contexts of a mask below another one.
// 4.36 bits per voxel for the bumpy torus at 10 bits; a single table takes 5.2.
pub(super) const VIEWS: usize = 40;

/// Axis permutations: the source axis of each axis.
const ORDERS: [[u32; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

const SYMMETRIES: usize = 48;

/// View of a mask from an octant.
#[derive(Debug, Clone, Copy)]
struct View {
    /// Index among the masks that are the least of their kind.
    context: u8,
    /// The symmetry that makes it that.
    symmetry: u8,
}

/// Returns the octant that a symmetry maps an octant to: mirrored by the lowest three bits, the axes ordered by the
/// others.
const fn inter(symmetry: usize, octant: usize) -> usize {
    let order = ORDERS[symmetry >> 3];
    let mirrored = octant ^ symmetry & 7;
    mirrored >> order[0] & 1 | (mirrored >> order[1] & 1) << 1 | (mirrored >> order[2] & 1) << 2
}

/// `SEEN[s][m]`: the mask by a symmetry.
pub(super) static SEEN: [[u8; 256]; SYMMETRIES] = BOTH.0;

/// The inverse of [`SEEN`].
pub(super) static UNSEEN: [[u8; 256]; SYMMETRIES] = BOTH.1;

const BOTH: ([[u8; 256]; SYMMETRIES], [[u8; 256]; SYMMETRIES]) = {
    let (mut seen, mut unseen) = ([[0; 256]; SYMMETRIES], [[0; 256]; SYMMETRIES]);
    let mut symmetry = 0;
    while symmetry < SYMMETRIES {
        let mut mask = 1;
        while mask < 256usize {
            // The result for the mask without its lowest octant is already known.
            let octant = mask.trailing_zeros() as usize;
            seen[symmetry][mask] = seen[symmetry][mask & (mask - 1)] | 1 << inter(symmetry, octant);
            unseen[symmetry][seen[symmetry][mask] as usize] = mask as u8;
            mask += 1;
        }
        symmetry += 1;
    }
    (seen, unseen)
};

/// `VIEW[m][o]`: how a mask is seen from an octant in it.
const VIEW: [[View; 8]; 256] = views();

/// `BELOW[m]`: the contexts of the nodes in the octants of a mask, one after the other, and their symmetries.
pub(super) static BELOW: [[[u8; 8]; 2]; 256] = below();

const fn below() -> [[[u8; 8]; 2]; 256] {
    let mut table = [[[0; 8]; 2]; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut octants: usize = mask;
        let mut place = 0;
        while octants != 0 {
            let view = VIEW[mask][octants.trailing_zeros() as usize];
            table[mask][0][place] = view.context;
            table[mask][1][place] = view.symmetry;
            octants &= octants - 1;
            place += 1;
        }
        mask += 1;
    }
    table
}

const fn views() -> [[View; 8]; 256] {
    let mut min = [[(0u8, 0u8); 8]; 256];
    let mut contexts = [u8::MAX; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut octant = 0;
        while octant < 8 {
            let (mut best, mut symmetry_of_best) = (u8::MAX, octant as u8);
            let mut order = 0;
            while order < ORDERS.len() {
                let symmetry = order << 3 | octant;
                let seen = BOTH.0[symmetry][mask];
                if seen < best {
                    (best, symmetry_of_best) = (seen, symmetry as u8);
                }
                order += 1;
            }
            min[mask][octant] = (best, symmetry_of_best);
            if mask >> octant & 1 != 0 {
                contexts[best as usize] = 0;
            }
            octant += 1;
        }
        mask += 1;
    }
    let (mut next, mut mask) = (0, 0);
    while mask < 256 {
        if contexts[mask] == 0 {
            contexts[mask] = next;
            next += 1;
        }
        mask += 1;
    }
    assert!(next as usize == VIEWS);
    let mut views = [[View {
        context: 0,
        symmetry: 0,
    }; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut octant = 0;
        while octant < 8 {
            let (seen, symmetry) = min[mask][octant];
            if mask >> octant & 1 != 0 {
                views[mask][octant] = View {
                    context: contexts[seen as usize],
                    symmetry,
                };
            }
            octant += 1;
        }
        mask += 1;
    }
    views
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetries_of_masks_are_reversible() {
        for symmetry in 0..SYMMETRIES {
            for mask in 0..=255u8 {
                let seen = SEEN[symmetry][usize::from(mask)];
                assert_eq!(seen.count_ones(), mask.count_ones());
                assert_eq!(UNSEEN[symmetry][usize::from(seen)], mask);
            }
        }
    }

    /// Cells that share a face, an edge or a corner do so however they are seen.
    #[test]
    fn symmetries_preserve_adjacency() {
        for symmetry in 0..SYMMETRIES {
            for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
                let apart = (inter(symmetry, a) ^ inter(symmetry, b)).count_ones();
                assert_eq!(apart, (a ^ b).count_ones());
            }
        }
    }

    /// Masks have one context if, and only if, a symmetry makes one the other and moves the octant along.
    #[test]
    fn symmetric_masks_share_one_view() {
        for (mask, octant) in (1..=255u8).flat_map(|mask| (0..8).map(move |octant| (mask, octant))) {
            if mask >> octant & 1 == 0 {
                continue;
            }
            let view = VIEW[usize::from(mask)][octant];
            assert_eq!(inter(usize::from(view.symmetry), octant), 0);
            for symmetry in 0..SYMMETRIES {
                let other = VIEW[usize::from(SEEN[symmetry][usize::from(mask)])][inter(symmetry, octant)];
                assert_eq!(other.context, view.context);
            }
        }
        let mut contexts: Vec<u8> = (1..=255usize)
            .flat_map(|mask| {
                (0..8)
                    .filter(move |octant| mask >> octant & 1 != 0)
                    .map(move |octant| (mask, octant))
            })
            .map(|(mask, octant)| VIEW[mask][octant].context)
            .collect();
        contexts.sort_unstable();
        contexts.dedup();
        assert_eq!(contexts.len(), VIEWS);
    }
}
