//! Arrays of numpy: NPY, one array, and NPZ, a ZIP archive of named ones.
//!
//! The header is read by `binary`, as cameras in arrays have the same (`photos`). Numbers stay where they are in the
//! file, whatever their type, byte order and order of rows and columns.
//!
//! An array of T × N × 3 in an NPZ is a sequence. One in an NPY is none: folders may have a hundred thousand of these,
//! a frame each, and none of them is opened before it is shown.

use super::format::{Format, Holding, Magic, Traits};

mod cloud;
mod frames;
mod header;
mod layers;

pub(super) use cloud::{decode, decode_archive};
pub(super) use frames::{Arrays, list};
pub(super) use layers::layer_of;

/// An array of numpy.
pub(super) const FORMAT: Format = Format::new(&Traits {
    name: "NPY",
    extensions: &["npy"],
    magic: &[Magic::start(b"\x93NUMPY")],
    ..Traits::PLAIN
});

/// Named arrays of numpy. They are ZIP archives, which only their name tells from others.
pub(super) const ARCHIVE: Format = Format::new(&Traits {
    name: "NPZ",
    extensions: &["npz"],
    magic: &[Magic::start(b"PK\x03\x04"), Magic::start(b"PK\x05\x06")],
    needs_extension: true,
    holds: Holding::Layers,
    ..Traits::PLAIN
});
