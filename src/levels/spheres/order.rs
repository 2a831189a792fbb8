//! Nodes of a sequence, sorted by the radius that determines how near they are drawn: `r_max`, the radius of their
//! parents.

use rayon::prelude::*;

/// Sentinel for the parent of a node whose parent is not in its sequence.
pub(super) const NO_PARENT: u32 = u32::MAX;

/// Indices before and after sorting.
#[derive(Debug)]
pub(super) struct Order {
    /// The indices before, in the order of the sequence.
    pub(super) sorted: Vec<u32>,
    /// Position of each of them in the sequence.
    place_of: Vec<u32>,
}

/// A number that is the smaller the larger a radius is, and of equal ones the smaller the index is, which is its lower
/// 32 bits. Precondition: a radius is not negative, so that its bits are in its order.
fn descending_key(radius: f32, place: u32) -> u64 {
    u64::from(!radius.to_bits()) << 32 | u64::from(place)
}

impl Order {
    /// This many nodes, the largest first; of equals the first one is first.
    pub(super) fn of(count: usize, r_max: impl Fn(u32) -> f32 + Sync) -> Self {
        let mut keys: Vec<u64> = (0..count as u32)
            .into_par_iter()
            .map(|place| descending_key(r_max(place), place))
            .collect();
        keys.par_sort_unstable();
        let sorted: Vec<u32> = keys.into_iter().map(|key| key as u32).collect();
        let mut place_of = vec![0; count];
        for (&before, place) in sorted.iter().zip(0..) {
            place_of[before as usize] = place;
        }
        Self { sorted, place_of }
    }

    /// Returns the position of a node in the sequence; [`NO_PARENT`] has none.
    pub(super) fn place_of(&self, before: u32) -> u32 {
        self.place_of.get(before as usize).copied().unwrap_or(NO_PARENT)
    }
}
