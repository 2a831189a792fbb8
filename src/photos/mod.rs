//! Sets of calibrated photographs with sparse points: what programs of reconstruction write, made ready to be drawn.
//!
//! [`find`] says what a folder holds, and [`FoundSet::read`] reads it into a [`ViewSet`], whatever the format: cameras
//! have x to the right, y down, z forward, poses take the world to the camera, and centres of pixels are at integers.
//!
//! Readers (`readers`, a row each) write down what a file says (`draft`), in its own pixels; `draft` then finds the
//! photographs, looks at their sizes, and makes cameras (`lens`) and poses of them. What is wrong with one photograph
//! costs that one, and a note of the set says so.
//!
//! A [`Calibration`] is what a file lists before that. Where it lists cameras that filmed, it is a [`Rig`], and each
//! moment becomes a set.
//!
//! [`PreparedPhoto`] is a photograph as drawing takes it: masked, undistorted to a pinhole, and halved as often as
//! [`halvings_within`] a budget of memory says. [`gains`] makes photographs of different exposures agree.
//! [`LoadedPhotographs`] are all of a set, with the levels of their [`Texture`]s.

mod depth_file;
mod error;
mod found;
mod images;
mod parts;
mod readers;
mod sets;

pub use depth_file::{DepthCamera, DepthFile, DepthKind};
pub use error::PhotosError;
pub use found::calibration::Calibration;
pub use found::files::is_picture;
pub use found::rig::Rig;
pub use images::budget::{halvings_within, texture_bytes};
pub use images::gains::gains;
pub use images::loading::LoadedPhotographs;
pub use images::mips::{halved, mips};
pub use images::photo_image::PhotoImage;
pub use images::photographs::{PhotoSurface, Photograph, Photographs};
pub use images::prepared::PreparedPhoto;
pub use images::texture::Texture;
pub use images::undistort::{Extent, pinhole_of, undistort};
pub use readers::colmap::colmap_depth;
pub use readers::unread::{is_beside_photographs, unread};
pub use readers::{FoundSet, find};
pub use sets::photo::{Photo, center_of, resized};
pub use sets::points::{Observation, SparsePoints};
pub use sets::view_set::{Neighbour, ReprojectionError, ViewSet};
