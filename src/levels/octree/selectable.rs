//! Concatenated surfels of the cached levels, for renderers that keep them on the GPU.
//!
//! How it works: once all levels of a cut are cached (`cached_levels.rs`), their surfels and, where leaves are drawn,
//! the points are one array, and a node is an index into it. A level that is cached later makes a new array, so at most
//! one array per drawn level is uploaded.
//!
//! When it wins: where a camera moves about a frame.

use super::cached_levels::{CachedLevels, LEVEL_COUNT};
use super::node_surfel::NodeSurfel;
use super::sorted_points::SortedPoints;
use crate::cloud::{PointRecord, ShapeRecord};
use crate::levels::cut::NodeRange;
use crate::levels::selection::NodeRecords;
use crate::locks::lock;
use std::sync::{Arc, Mutex};

/// Drawn parts of a cut: whole levels, and the points themselves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Parts {
    /// A bit for each level.
    pub(super) levels: u32,
    pub(super) has_leaves: bool,
}

impl Parts {
    fn hold(self, other: Self) -> bool {
        self.levels & other.levels == other.levels && (self.has_leaves || !other.has_leaves)
    }

    fn with(self, other: Self) -> Self {
        Self {
            levels: self.levels | other.levels,
            has_leaves: self.has_leaves || other.has_leaves,
        }
    }

    fn has_level(self, level: usize) -> bool {
        self.levels >> level & 1 == 1
    }
}

/// The array of all requested parts.
#[derive(Debug, Default)]
pub(super) struct Selectable(Mutex<Option<SideBySide>>);

/// Surfels of several levels, and where each begins. Leaves are the first.
#[derive(Debug, Clone)]
pub(super) struct SideBySide {
    parts: Parts,
    level_starts: [u32; LEVEL_COUNT],
    pub(super) nodes: NodeRecords,
}

impl Selectable {
    /// An array with these parts at least, the leaves with these records; `None` where a level of them is not cached.
    pub(super) fn with_parts(
        &self,
        parts: Parts,
        cached: &CachedLevels<NodeSurfel>,
        points: &[PointRecord],
        shapes: &[ShapeRecord],
    ) -> Option<SideBySide> {
        let mut known = lock(&self.0);
        if let Some(known) = known.as_ref().filter(|known| known.parts.hold(parts)) {
            return Some(known.clone());
        }
        let parts = known.as_ref().map_or(parts, |known| known.parts.with(parts));
        let made = SideBySide::of(parts, cached, points, shapes)?;
        *known = Some(made.clone());
        Some(made)
    }
}

impl SideBySide {
    fn of(
        parts: Parts,
        cached: &CachedLevels<NodeSurfel>,
        leaf_points: &[PointRecord],
        leaf_shapes: &[ShapeRecord],
    ) -> Option<Self> {
        let (mut points, mut shapes) = (Vec::new(), Vec::new());
        if parts.has_leaves {
            points.extend_from_slice(leaf_points);
            shapes.extend_from_slice(leaf_shapes);
        }
        let mut level_starts = [0; LEVEL_COUNT];
        for level in (0..LEVEL_COUNT).filter(|&level| parts.has_level(level)) {
            let surfels = &cached.known(level)?.records;
            level_starts[level] = u32::try_from(points.len()).ok()?;
            points.extend(surfels.iter().map(|surfel| surfel.point));
            shapes.extend(surfels.iter().map(|surfel| surfel.shape));
        }
        Some(Self {
            parts,
            level_starts,
            nodes: NodeRecords {
                points: Arc::new(points),
                shapes: Arc::new(shapes),
            },
        })
    }

    /// Adds the indices of consecutive nodes of a level. Precondition: it is among the parts.
    pub(super) fn extend_places(
        &self,
        range: &NodeRange,
        cached: &CachedLevels<NodeSurfel>,
        sorted: &SortedPoints,
        places: &mut Vec<u32>,
    ) {
        if let Some(level) = cached.known(range.level as usize) {
            let start = self.level_starts[range.level as usize];
            let nodes = level.places(range, sorted);
            places.extend(nodes.map(|node| start + node as u32));
        }
    }
}
