//! The nodes of a level by their parents.

/// How many children the nodes of the level above have, one after the other; then nodes without siblings whose parent
/// is the first of that level, as points outside of all cells.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) enum Families<'a> {
    /// By the masks of the parents.
    Masks(&'a [u8]),
    /// By numbers, and how many are outside.
    Counts(&'a [u32], usize),
}

/// Parents and the numbers of their children, by masks.
#[inline(always)]
pub(super) fn of_masks(masks: &[u8]) -> impl Iterator<Item = (usize, usize)> {
    masks.iter().map(|mask| mask.count_ones() as usize).enumerate()
}

/// The same by numbers.
#[inline(always)]
pub(super) fn of_counts(counts: &[u32], outside: usize) -> impl Iterator<Item = (usize, usize)> {
    let placed = counts.iter().map(|&count| count as usize).enumerate();
    placed.chain(std::iter::repeat_n((0, 1), outside))
}
