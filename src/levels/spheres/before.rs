//! Record of the nodes that the previous view divided, for hysteresis.

use crate::levels::cut::Cut;

/// The nodes that were divided, a bit each, as far as there were any.
#[derive(Debug)]
pub(super) struct WasDivided(Vec<u64>);

impl WasDivided {
    /// Creates the set of divided nodes of a cut; none without one.
    pub(super) fn new(before: Option<&Cut>) -> Self {
        let divided = before.map_or(&[][..], |cut| &cut.listed.divided);
        let max = divided.iter().max().map_or(0, |&node| node as usize + 1);
        let mut bits = vec![0; max.div_ceil(64)];
        for &node in divided {
            bits[node as usize / 64] |= 1 << (node % 64);
        }
        Self(bits)
    }

    /// Returns true if a node is known to have been divided.
    #[inline(always)]
    pub(super) fn at(&self, node: usize) -> bool {
        self.0.get(node / 64).is_some_and(|bits| bits >> (node % 64) & 1 == 1)
    }
}
