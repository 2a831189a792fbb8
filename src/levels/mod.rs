//! Levels of detail: structures that choose, for a view, the nodes that represent a cloud.
//!
//! A structure implements [`Levels`]: it cuts itself for a view and writes the records of the cut's nodes.
//! [`Lod`] is the policy that says how fine a cut is wanted, whatever the structure.

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
