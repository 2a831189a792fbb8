//! Levels of detail: structures that choose the nodes that represent a cloud in a view.
//!
//! A structure implements [`Levels`]: it cuts itself for a view and writes the records of the cut. [`Lod`] is the
//! policy for the fineness of a cut, independent of the structure.

mod cut;
mod key;
mod list;
mod moments;
pub mod octree;
mod policy;
mod selection;
mod set;
mod spheres;
mod structure;

pub use cut::{Cut, CutHints, LodMetric, SelectStats, SelectView};
pub use key::{LevelsKey, LevelsKind};
pub use list::PointList;
pub use policy::{Affordable, Lod};
pub use selection::{NodeRecords, Selection};
pub use set::{CloudRecords, LevelsSet, LevelsWork};
pub use spheres::filter::{NodeBounds, SequenceFilter};
pub use spheres::{SphereKind, SphereLevels};
pub use structure::{Levels, LevelsSize, RecordBuffers, Records};
