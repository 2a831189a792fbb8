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

mod budget;
mod bytes;
mod calibration;
mod depth_file;
mod draft;
mod error;
mod files;
mod gains;
mod json;
mod lens;
mod loading;
mod mips;
mod npy_table;
mod photo;
mod photo_image;
mod photographs;
mod picture_file;
mod points;
mod prepared;
mod readers;
mod rig;
mod shared_points;
mod text;
mod texture;
mod undistort;
mod unread;
mod view_set;

pub use budget::{halvings_within, texture_bytes};
pub use calibration::Calibration;
pub use depth_file::{DepthCamera, DepthFile, DepthKind};
pub use error::PhotosError;
pub use files::is_picture;
pub use gains::gains;
pub use loading::LoadedPhotographs;
pub use mips::{halved, mips};
pub use photo::{Photo, center_of, resized};
pub use photo_image::PhotoImage;
pub use photographs::{PhotoSurface, Photograph, Photographs};
pub use points::{Observation, SparsePoints};
pub use prepared::PreparedPhoto;
pub use readers::colmap::colmap_depth;
pub use readers::{FoundSet, find};
pub use rig::Rig;
pub use texture::Texture;
pub use undistort::{Extent, pinhole_of, undistort};
pub use unread::{is_beside_photographs, unread};
pub use view_set::{Neighbour, ReprojectionError, ViewSet};
