//! What semi-global matching and the local winner choose from: a cost for each pixel and each of its labels.

use std::ops::Range;

/// The largest cost: all bits of a census differ.
pub(super) const MAX_COST: u8 = 62;

/// Labels are in steps of as many as a register has bytes.
pub(super) const LANES: usize = 32;

/// Costs of labels (disparities, or planes of a sweep), worked out some lines at a time, so that they are never all in
/// memory.
pub(super) trait Costs: Sync {
    /// Width and height in pixels, both above 0.
    fn size(&self) -> [usize; 2];

    /// Number of labels, a multiple of [`LANES`] above 0.
    fn count(&self) -> usize;

    /// The costs of `rows`: line by line, pixel by pixel, label by label, none above [`MAX_COST`]. The same for any
    /// division into `rows`. Precondition: `costs` has as many places.
    fn fill(&self, rows: Range<usize>, costs: &mut [u8]);
}
