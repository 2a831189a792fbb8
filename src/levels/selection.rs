//! Node selection by index among the records of all nodes, for renderers that keep these.
//!
//! How it works: if nodes have records that are the same from cut to cut, the GPU keeps the records, and a cut is four
//! bytes per node, or merely a step for the plain list and a rule for a sequence, whose nodes it tests. Elsewhere, and
//! if they do not fit, the drawn records of a cut are *gathered*.
//!
//! When it wins: for a view that moves about a frame. For a frame that is seen once, all records are more than the
//! cut's. So structures return indices once they have written the same number of records as they have nodes
//! ([`CachedNodes`]).

use super::spheres::filter::SequenceFilter;
use crate::cloud::{PointRecord, ShapeRecord};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

/// Nodes that are worth handing to another thread.
const NODES_PER_TASK: usize = 1 << 12;

/// Records of all nodes of a structure: the same number of both.
#[derive(Debug, Clone)]
pub struct NodeRecords {
    /// Positions and colours.
    pub points: Arc<Vec<PointRecord>>,
    /// Normals and radii.
    pub shapes: Arc<Vec<ShapeRecord>>,
}

/// Selection of the records that are drawn, in this order.
#[derive(Debug)]
pub enum Selection {
    /// Those at these indices.
    At(Vec<u32>),
    /// Candidates of a sequence that pass a test.
    Filtered(Box<SequenceFilter>),
    /// Every one whose index is a multiple of a step, with wider disks.
    Every {
        /// From one to the next; at least 1.
        step: u32,
        /// Number of selected records.
        count: u32,
        /// On the radii.
        radius_factor: f32,
    },
}

impl Selection {
    /// Returns the number of records drawn; an upper bound for those that are tested.
    pub fn len(&self) -> usize {
        match self {
            Self::At(places) => places.len(),
            Self::Filtered(filter) => filter.len(),
            Self::Every { count, .. } => *count as usize,
        }
    }

    /// Counts the records that are drawn, testing them one by one if necessary.
    pub fn count_drawn(&self) -> usize {
        match self {
            Self::At(_) | Self::Every { .. } => self.len(),
            Self::Filtered(filter) => {
                let candidates = (0..filter.len() as u32).into_par_iter().with_min_len(NODES_PER_TASK);
                candidates.filter(|&candidate| filter.draws(candidate)).count()
            }
        }
    }

    /// Returns true if no records are selected.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The records that are drawn, in the memory of these.
    ///
    /// # Panics
    /// Precondition: the indices are those of `nodes`.
    pub fn gathered(
        &self,
        nodes: &NodeRecords,
        mut points: Vec<PointRecord>,
        mut shapes: Vec<ShapeRecord>,
    ) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
        match *self {
            Self::At(ref places) => {
                let places = places.par_iter().with_min_len(NODES_PER_TASK);
                places
                    .map(|&place| (nodes.points[place as usize], nodes.shapes[place as usize]))
                    .unzip_into_vecs(&mut points, &mut shapes);
            }
            Self::Filtered(ref filter) => {
                let candidates = (0..filter.len() as u32).into_par_iter().with_min_len(NODES_PER_TASK);
                let drawn = candidates.filter(|&candidate| filter.draws(candidate));
                (points, shapes) = drawn
                    .map(|candidate| filter.name(candidate) as usize)
                    .map(|place| (nodes.points[place], nodes.shapes[place]))
                    .unzip();
            }
            Self::Every {
                step,
                count,
                radius_factor,
            } => {
                points.clear();
                shapes.clear();
                let (step, count) = (step as usize, count as usize);
                points.extend(nodes.points.iter().step_by(step).take(count));
                shapes.extend(nodes.shapes.iter().step_by(step).take(count).map(|&shape| ShapeRecord {
                    radius: radius_factor * shape.radius,
                    ..shape
                }));
            }
        }
        (points, shapes)
    }
}

/// The records of all nodes of a structure, once they are worth it.
#[derive(Debug, Default)]
pub(super) struct CachedNodes {
    written: AtomicUsize,
    records: OnceLock<NodeRecords>,
}

impl CachedNodes {
    /// The records of all nodes, if they are cached.
    pub(super) fn known(&self) -> Option<&NodeRecords> {
        self.records.get()
    }

    /// The records of all of `node_count` nodes, where as many were written before: a moving view has then paid at most
    /// twice, and a frame that is seen once pays for its cut.
    pub(super) fn records(
        &self,
        about_to_be_written: usize,
        node_count: usize,
        work_out: impl FnOnce() -> NodeRecords,
    ) -> Option<&NodeRecords> {
        if let Some(records) = self.records.get() {
            return Some(records);
        }
        if self.written.fetch_add(about_to_be_written, Ordering::Relaxed) < node_count {
            return None;
        }
        // Not inside `get_or_init`: a thread that waits for its share may pick up other work, and end up here again.
        let worked_out = work_out();
        Some(self.records.get_or_init(|| worked_out))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(count: usize) -> NodeRecords {
        let point = |i: usize| PointRecord {
            position: [i as f32, 0.0, 0.0],
            color: [i as u8; 4],
        };
        let shape = |i: usize| ShapeRecord {
            normal: [0, 0],
            radius: 1.0 + i as f32,
            ellipse: 0,
            scalar: i as f32,
        };
        NodeRecords {
            points: Arc::new((0..count).map(point).collect()),
            shapes: Arc::new((0..count).map(shape).collect()),
        }
    }

    #[test]
    fn records_are_gathered_in_index_order() {
        let nodes = nodes(10);
        let scalars = |selection: &Selection| -> Vec<(f32, f32, f32)> {
            let (points, shapes) = selection.gathered(&nodes, Vec::new(), Vec::new());
            assert_eq!((points.len(), shapes.len()), (selection.len(), selection.len()));
            let both = points.iter().zip(&shapes);
            both.map(|(point, shape)| (point.position[0], shape.scalar, shape.radius))
                .collect()
        };
        assert_eq!(
            scalars(&Selection::At(vec![7, 0, 7])),
            [(7.0, 7.0, 8.0), (0.0, 0.0, 1.0), (7.0, 7.0, 8.0)]
        );
        let every = Selection::Every {
            step: 4,
            count: 3,
            radius_factor: 2.0,
        };
        assert_eq!(scalars(&every), [(0.0, 0.0, 2.0), (4.0, 4.0, 10.0), (8.0, 8.0, 18.0)]);
        assert!(Selection::At(Vec::new()).is_empty());
    }

    #[test]
    fn records_are_cached_once_the_same_number_has_been_written() {
        let cached = CachedNodes::default();
        assert!(cached.records(6, 10, || panic!("not yet")).is_none());
        assert!(cached.records(6, 10, || panic!("not yet")).is_none());
        assert!(cached.records(1, 10, || nodes(10)).is_some());
        assert!(cached.records(1, 10, || panic!("they are known")).is_some());
    }
}
