//! Sets of calibrated photographs with sparse points.

mod photo;
mod points;
mod view_set;

pub use photo::{DepthFile, DepthKind, Photo, resized};
pub use points::{Observation, SparsePoints};
pub use view_set::{Neighbour, ReprojectionError, ViewSet};

/// Placeholder of the reader that is written next.
pub fn colmap_depth() {}
