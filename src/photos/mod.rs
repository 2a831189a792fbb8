//! Sets of calibrated photographs with sparse points: what programs of reconstruction write, made ready to be drawn.
//!
//! [`find`] says what a folder holds, and [`Found::read`] reads it into a [`ViewSet`], whatever the format: cameras have
//! x to the right, y down, z forward, poses take the world to the camera, and centres of pixels are at integers.
//!
//! Readers write down what a file says (`draft`), in its own pixels; `draft` then finds the photographs, looks at their
//! sizes, and makes cameras (`lens`) and poses of them. What is wrong with one photograph costs that one, and a note of
//! the set says so.

mod bundler;
mod bytes;
mod colmap;
mod draft;
mod error;
mod files;
mod find;
mod json;
mod lens;
mod meshroom;
mod middlebury;
mod nvm;
mod photo;
mod points;
mod text;
mod transforms;
mod view_set;

pub use colmap::colmap_depth;
pub use error::PhotosError;
pub use find::{Format, Found, find};
pub use photo::{DepthFile, DepthKind, Photo, resized};
pub use points::{Observation, SparsePoints};
pub use view_set::{Neighbour, ReprojectionError, ViewSet};
