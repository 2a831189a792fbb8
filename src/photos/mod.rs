//! Sets of calibrated images with sparse points: the output of photogrammetry programs (COLMAP and others), prepared
//! for drawing. Poses are used as they are in the files.
//!
//! [`find`] reports the contents of a folder, and [`FoundSet::read`] reads it into a [`ViewSet`], the same for all
//! formats: cameras have x to the right, y down, z forward, poses take the world to the camera, and centres of pixels
//! are at integers.
//!
//! Readers (`readers`, one row each) record the contents of a file (`draft`), in its own pixels; `draft` then finds the
//! images, checks their sizes, and creates cameras (`lens`) and poses from them. A problem with one image affects only
//! that one, and a note of the set reports it.
//!
//! A [`Calibration`] is the listing of a file before that. If it lists cameras of a multi-view video, it is a [`Rig`],
//! and each time step becomes a set.
//!
//! [`PreparedPhoto`] is an image as drawing takes it: masked, undistorted to a pinhole, and halved the number of times
//! that [`halvings_within`] determines for a memory budget. [`gains`] makes images of different exposures agree.
//! [`LoadedPhotos`] are all of a set, with the levels of their [`Texture`]s.

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
pub use images::loading::LoadedPhotos;
pub use images::mips::{halved, mips};
pub use images::photo_image::PhotoImage;
pub use images::photos::{PhotoSurface, PosedImage, PosedImages};
pub use images::prepared::PreparedPhoto;
pub use images::texture::Texture;
pub use images::undistort::{Extent, pinhole_of, undistort};
pub use readers::colmap::colmap_depth;
pub use readers::unread::{is_outside_photos, unread};
pub use readers::{FoundSet, find};
pub use sets::photo::{Photo, center_of, resized};
pub use sets::points::{Observation, SparsePoints};
pub use sets::view_set::{Neighbour, ReprojectionError, ViewSet};
