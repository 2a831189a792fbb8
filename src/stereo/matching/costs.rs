//! Cost volume that semi-global matching and the local winner choose from: a cost for each pixel and each of its
//! labels.

use super::refine::{Around, NEIGHBOR, NO_COST};
use std::ops::Range;

/// The largest cost: all bits of a census differ.
pub(in crate::stereo) const MAX_COST: u8 = 62;

/// Labels are in steps of the bytes of a register.
pub(in crate::stereo) const LANES: usize = 32;

/// Costs of labels (disparities, or planes of a sweep), worked out some lines at a time, so that they are never all in
/// memory.
pub(in crate::stereo) trait Costs: Sync {
    /// Width and height in pixels, both above 0.
    fn size(&self) -> [usize; 2];

    /// Number of labels, a multiple of [`LANES`] above 0.
    fn count(&self) -> usize;

    /// The costs of `rows`: line by line, pixel by pixel, label by label, none above [`MAX_COST`]. The same for any
    /// division into `rows`. Precondition: `costs` has that number of places.
    fn fill(&self, rows: Range<usize>, costs: &mut [u8]);
}

/// Costs that are all in memory.
#[derive(Debug)]
pub(in crate::stereo) struct Volume {
    pub(in crate::stereo) size: [usize; 2],
    pub(in crate::stereo) count: usize,
    /// Line by line, pixel by pixel, label by label.
    pub(in crate::stereo) costs: Vec<u8>,
}

impl Volume {
    /// The costs that [`super::refine`] requests. Precondition: pixel `at` has a label `label`.
    pub(in crate::stereo) fn around(&self, at: usize, label: usize) -> Around {
        let costs = &self.costs[at * self.count..(at + 1) * self.count];
        let cost = |neighbor: usize| {
            (label + neighbor)
                .checked_sub(NEIGHBOR)
                .and_then(|label| costs.get(label))
        };
        std::array::from_fn(|neighbor| cost(neighbor).copied().unwrap_or(NO_COST))
    }
}

impl Costs for Volume {
    fn size(&self) -> [usize; 2] {
        self.size
    }

    fn count(&self) -> usize {
        self.count
    }

    fn fill(&self, rows: Range<usize>, costs: &mut [u8]) {
        let line = self.size[0] * self.count;
        costs.copy_from_slice(&self.costs[rows.start * line..rows.end * line]);
    }
}

#[cfg(test)]
pub(super) mod test_costs {
    use super::*;

    impl Volume {
        /// Costs without any order, of all sizes.
        pub(in crate::stereo) fn random(size: [usize; 2], count: usize, seed: u64) -> Self {
            let mut random = Random(seed);
            let costs = (0..size[0] * size[1] * count)
                .map(|_| (random.next() % (u32::from(MAX_COST) + 1)) as u8)
                .collect();
            Self { size, count, costs }
        }
    }

    /// Numbers without order, the same in every run (`SplitMix64`).
    pub(in crate::stereo) struct Random(pub(in crate::stereo) u64);

    impl Random {
        pub(in crate::stereo) fn next(&mut self) -> u32 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut bits = self.0;
            bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((bits ^ (bits >> 31)) >> 32) as u32
        }
    }
}
