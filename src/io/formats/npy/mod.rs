//! Arrays of numpy: NPY, one array, and NPZ, a ZIP archive of named ones.
//!
//! The header is read by `binary`, as cameras in arrays have the same (`photos`). Numbers are read in place, whatever
//! their type, byte order and order of rows and columns.
//!
//! An array of T × N × 3 is a sequence, and so are arrays whose names differ in their numbers alone, as
//! `numpy.savez(file, *frames)` names them. One of H × W × 3 whose rows are strips of a scene is an image of points
//! ([`looks`]). Folders may have a hundred thousand NPY files: listing these opens none of them unless the first one
//! holds a sequence.

use crate::io::format::{Format, Holding, Magic, Traits};

mod cloud;
mod frames;
mod header;
mod layers;
mod looks;

pub(in crate::io) use cloud::{decode, decode_archive};
pub(in crate::io) use frames::{Arrays, list, list_array};
pub(in crate::io) use layers::layer_of;

/// An array of numpy.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "NPY",
    extensions: &["npy"],
    magic: &[Magic::start(b"\x93NUMPY")],
    holds: Holding::Layers,
    ..Traits::PLAIN
});

/// Named arrays of numpy. They are ZIP archives, which only their name tells from others.
pub(in crate::io) const ARCHIVE: Format = Format::new(&Traits {
    name: "NPZ",
    extensions: &["npz"],
    magic: &[Magic::start(b"PK\x03\x04"), Magic::start(b"PK\x05\x06")],
    needs_extension: true,
    holds: Holding::Layers,
    ..Traits::PLAIN
});
