//! The nodes that stand for a cloud in a view, and what a traversal may know beside the view.

use super::{LodSurfels, NodeRange, select::SelectStats};

/// Nodes of an octree that stand for the cloud in one view: they cover every leaf that can be seen, none twice.
///
/// Nodes come in Morton order within every octant of the root's octants, and those nearest first.
#[derive(Debug, Clone, Default)]
pub struct Cut {
    pub(super) ranges: Vec<NodeRange>,
    pub(super) tested: Tested,
    pub(super) node_count: usize,
    pub(super) lod_px: f32,
}

/// What a traversal looked at.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tested {
    pub(super) nodes: usize,
    /// Those of them that were emitted.
    pub(super) emitted: usize,
}

impl Cut {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// The LOD threshold that it was made with, in pixels.
    pub fn lod_px(&self) -> f32 {
        self.lod_px
    }

    /// What it took to find them; where one was chosen of several cuts, the nodes visited for all of them.
    pub fn stats(&self) -> SelectStats {
        SelectStats {
            visited_nodes: self.tested.nodes + self.node_count - self.tested.emitted,
            emitted: self.node_count,
        }
    }

    /// Emits nodes; those that follow upon the last emitted ones join them.
    pub(super) fn emit(&mut self, nodes: NodeRange) {
        match self.ranges.last_mut() {
            Some(last) if last.level == nodes.level && last.points.end == nodes.points.start => {
                last.points.end = nodes.points.end;
            }
            _ => self.ranges.push(nodes),
        }
    }

    /// Emits all that another traversal emitted.
    pub(super) fn append(&mut self, other: Self) {
        let mut ranges = other.ranges.into_iter();
        if let Some(first) = ranges.next() {
            self.emit(first);
        }
        self.ranges.extend(ranges);
        self.tested.nodes += other.tested.nodes;
        self.tested.emitted += other.tested.emitted;
    }
}

/// What a traversal may know beside the view.
#[derive(Debug, Clone, Copy, Default)]
pub struct CutHints<'a> {
    /// Nodes whose points all face away from the eye are dropped; these know it.
    pub back_faces: Option<&'a LodSurfels>,
    /// The cut of the view before, of the same points: near the threshold, what was divided stays so, and what was not
    /// stays whole. Without it a node is divided or not by the threshold alone.
    pub before: Option<&'a Cut>,
}

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
        let after = self
            .ranges
            .partition_point(|range| range.points.start <= point);
        let range = self.ranges[after.checked_sub(1)?];
        (point < range.points.end).then_some(range)
    }
}
