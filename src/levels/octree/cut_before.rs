//! The cut of the previous view, as a traversal queries it.

use crate::levels::cut::{Cut, NodeRange};

/// The nodes of a cut by the points they have.
#[derive(Debug)]
pub(super) struct CutByPoints<'a> {
    ranges: Vec<&'a NodeRange>,
}

impl<'a> CutByPoints<'a> {
    pub(super) fn new(cut: &'a Cut) -> Self {
        let mut ranges: Vec<&NodeRange> = cut.ranges.iter().collect();
        ranges.sort_unstable_by_key(|range| range.points.start);
        Self { ranges }
    }

    /// The nodes among which is the one that has a point.
    pub(super) fn at(&self, point: usize) -> Option<&'a NodeRange> {
        let after = self.ranges.partition_point(|range| range.points.start <= point);
        let range = self.ranges[after.checked_sub(1)?];
        (point < range.points.end).then_some(range)
    }
}
