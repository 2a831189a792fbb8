//! Bounding sphere trees: the structures of Sainz and Pajarola 2004 §3.2 and §3.3, in addition to the octree.
//!
//! All are made of a tree (`tree.rs`) and decide by one rule (`rule.rs`), so that all draw the same nodes of one:
//!
//! - *QSplat* (`qsplat.rs`): six bytes per node, traversed from the root.
//! - *Sequential point trees* (`sequential.rs`): sorted nodes, of which a prefix is tested one by one; as one sequence,
//!   or as a hierarchy of them.
//! - *Sequential point trees as printed* (`printed.rs`): by another rule, which draws more.
//!
//! A leaf is a point. A node is drawn as the disk of its sphere or, where points are ellipses, as an ellipse of that
//! size (`ellipses.rs`). Nodes of QSplat have no space for it.

mod before;
mod bounds;
mod cone;
#[cfg(test)]
mod ellipse_tests;
mod ellipses;
pub(super) mod filter;
mod node_code;
mod order;
mod printed;
mod qsplat;
mod rule;
mod sequential;
mod sphere_code;
mod splat;
mod split;
mod summary;
#[cfg(test)]
mod tests;
mod tree;

use super::cut::{Cut, CutHints, SelectView};
use super::selection::{CachedNodes, NodeRecords, Selection};
use super::structure::{Levels, LevelsSize, RecordBuffers, Records};
use crate::cloud::{PointRecord, ShapeRecord};
use crate::math::Cube;
use filter::Tested;
use printed::PrintedSequence;
use qsplat::QSplat;
use sequential::{HIERARCHY_POINTS, SequentialTree};
use std::sync::{Arc, OnceLock};
use tree::{Precision, SphereTree};

/// Storage kind of a sphere tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SphereKind {
    /// QSplat.
    QSplat,
    /// A sequential point tree.
    Sequential,
    /// A sequential point tree as Sainz and Pajarola 2004 prints it.
    Printed,
    /// A hierarchy of sequential point trees.
    Hierarchical,
}

/// A tree of spheres around the points of a cloud.
#[derive(Debug)]
pub struct SphereLevels {
    kind: SphereKind,
    points: Arc<Vec<PointRecord>>,
    shapes: Arc<Vec<ShapeRecord>>,
    structure: Structure,
    cached: CachedNodes,
    /// Test data of a sequence, once its nodes are cached.
    tested: OnceLock<Tested>,
}

#[derive(Debug)]
enum Structure {
    QSplat(QSplat),
    Sequential(SequentialTree),
    Printed(PrintedSequence),
}

impl SphereLevels {
    /// Builds the tree of these records, on all threads.
    ///
    /// # Panics
    /// Preconditions: the same number of both, in the Morton order of a cube around the points.
    pub fn build(kind: SphereKind, cube: Cube, points: Arc<Vec<PointRecord>>, shapes: Arc<Vec<ShapeRecord>>) -> Self {
        let precision = if kind == SphereKind::QSplat {
            Precision::Coded
        } else {
            Precision::Exact
        };
        let tree = SphereTree::build(&cube, &points, &shapes, precision);
        let structure = match kind {
            SphereKind::QSplat => Structure::QSplat(QSplat::of(&tree, &points, &shapes)),
            SphereKind::Sequential => Structure::Sequential(SequentialTree::of(&tree, usize::MAX)),
            SphereKind::Hierarchical => Structure::Sequential(SequentialTree::of(&tree, HIERARCHY_POINTS)),
            SphereKind::Printed => Structure::Printed(PrintedSequence::of(&tree, &points)),
        };
        Self {
            kind,
            points,
            shapes,
            structure,
            cached: CachedNodes::default(),
            tested: OnceLock::new(),
        }
    }

    /// Maximum number of bytes, with the records of all nodes for selection.
    pub fn max_bytes(&self) -> usize {
        let size = self.size();
        let cached = size_of::<PointRecord>() + size_of::<ShapeRecord>() + size_of::<u32>();
        size.bytes + size.nodes * cached
    }

    /// The records of all nodes, by their names.
    fn node_records(&self) -> NodeRecords {
        let (points, shapes) = (&self.points, &self.shapes);
        let (points, shapes) = match &self.structure {
            Structure::QSplat(qsplat) => qsplat.node_records(),
            Structure::Sequential(sequences) => sequences.node_records(points, shapes),
            Structure::Printed(sequence) => sequence.node_records(points, shapes),
        };
        NodeRecords {
            points: Arc::new(points),
            shapes: Arc::new(shapes),
        }
    }

    /// Returns its storage kind.
    pub fn kind(&self) -> SphereKind {
        self.kind
    }

    /// Returns true if it is the tree of these records.
    pub fn is_of(&self, points: &Arc<Vec<PointRecord>>, shapes: &Arc<Vec<ShapeRecord>>) -> bool {
        Arc::ptr_eq(&self.points, points) && Arc::ptr_eq(&self.shapes, shapes)
    }
}

impl Levels for SphereLevels {
    fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut {
        match &self.structure {
            Structure::QSplat(qsplat) => qsplat.cut(view, hints),
            Structure::Sequential(sequences) => sequences.cut(view, hints),
            Structure::Printed(sequence) => sequence.cut(view, hints),
        }
    }

    fn write(&self, cut: &Cut, _max_records: usize, buffers: RecordBuffers) -> Records {
        let (points, shapes) = (&self.points, &self.shapes);
        match &self.structure {
            Structure::QSplat(qsplat) => qsplat.write(cut, buffers),
            Structure::Sequential(sequences) => sequences.write(cut, points, shapes, buffers),
            Structure::Printed(sequence) => sequence.write(cut, points, shapes, buffers),
        }
    }

    fn select(&self, cut: &Cut, buffers: &mut RecordBuffers) -> Option<Records> {
        let work_out = || self.node_records();
        let nodes = self.cached.records(cut.node_count, self.size().nodes, work_out)?;
        let mut places = std::mem::take(&mut buffers.places);
        places.clear();
        let names = cut.listed.drawn.iter();
        match &self.structure {
            Structure::QSplat(_) => places.extend(names.map(|&name| QSplat::place_of(name))),
            Structure::Sequential(_) | Structure::Printed(_) => places.extend(names),
        }
        Some(Records::Selected {
            nodes: nodes.clone(),
            selection: Selection::At(places),
        })
    }

    fn filter(&self, view: &SelectView, hints: CutHints<'_>) -> Option<Records> {
        let Structure::Sequential(sequences) = &self.structure else {
            return None;
        };
        let nodes = self.cached.known()?;
        let sequence = sequences.only_sequence()?;
        let tested = self.tested.get_or_init(|| sequence.tested());
        Some(Records::Selected {
            nodes: nodes.clone(),
            selection: Selection::Filtered(Box::new(sequence.filter(tested, view, hints)?)),
        })
    }

    fn size(&self) -> LevelsSize {
        match &self.structure {
            Structure::QSplat(qsplat) => qsplat.size(),
            Structure::Sequential(sequences) => sequences.size(),
            Structure::Printed(sequence) => sequence.size(),
        }
    }
}
