//! Recordings of robots: messages with point clouds and their times.
//!
//! A recording is a list of messages on topics, most of them packed together into chunks. [`list`] walks over the heads
//! of its records once, unpacks only chunks with point clouds (their index says so; chunks without one are looked
//! into), and notes where each cloud is. [`read`] then touches one message, or the one chunk it is packed in. MCAP and
//! bags differ only in how their records are written ([`mcap`], [`bag`]); a ROS 2 bag in `SQLite` is asked by
//! `rusqlite` ([`db3`]).

mod bag;
mod bytes;
mod chunk;
mod db3;
mod encoding;
mod found;
mod foxglove;
mod mcap;
mod message;
mod pointcloud2;
mod protobuf;
mod walk;

pub use message::Message;

use super::containers;
use super::contents::Contents;
use super::error::IoError;
use super::error::{Fault, Place};
use super::format::Format;
use super::options::ReadOptions;
use super::unpack::{Packing, unpack};
use crate::cloud::RawCloud;
use encoding::Encoding;
use message::MessagePlace;
use pointcloud2::Serialisation;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// The topics of the recording at `path`, and the point clouds of `topic` (of the one that has the most, if `None`) in
/// the order of their time.
pub(super) fn list(
    path: &Path,
    format: Format,
    topic: Option<&str>,
    options: &ReadOptions,
) -> Result<Contents, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let found = if format == containers::DB3 {
        db3::find(path)
    } else {
        let mut walk = walk::Walk::new(File::open(path).map_err(failed)?).map_err(failed)?;
        if format == containers::MCAP {
            mcap::find(&mut walk, options)
        } else {
            bag::find(&mut walk, options)
        }
    };
    let found = found.map_err(|fault| fault.of(path, format))?;
    Ok(found.contents(topic))
}

/// The point cloud of a message.
pub(super) fn read(path: &Path, message: &Message, options: &ReadOptions) -> Result<RawCloud, IoError> {
    let (format, place) = match (&message.place, message.encoding) {
        (&MessagePlace::Row(row), _) => (
            containers::DB3,
            Place::Entry {
                list: "message".to_owned(),
                index: row as usize,
            },
        ),
        (&MessagePlace::File { offset, .. } | &MessagePlace::Chunk { offset, .. }, encoding) => (
            // A ROS 1 message may be in an MCAP file, too; the file's name says which.
            match encoding {
                Encoding::Ros(Serialisation::Ros1) if containers::BAG.has_extension_of(path) => containers::BAG,
                _ => containers::MCAP,
            },
            Place::Byte(offset as usize),
        ),
    };
    let invalid = |problem: String| Fault::new(place.clone(), problem).of(path, format);
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let bytes = match &message.place {
        MessagePlace::Row(row) => db3::read(path, *row, options).map_err(invalid)?,
        &MessagePlace::File { offset, byte_count } => {
            let mut file = File::open(path).map_err(failed)?;
            file.seek(SeekFrom::Start(offset)).map_err(failed)?;
            unpack(Packing::Stored, file.take(byte_count), byte_count, options).map_err(invalid)?
        }
        MessagePlace::Chunk {
            chunk,
            offset,
            byte_count,
        } => {
            let mut file = File::open(path).map_err(failed)?;
            let mut unpacked = chunk.unpack(&mut file, options).map_err(invalid)?;
            let end = offset.saturating_add(*byte_count);
            if end > unpacked.len() as u64 {
                return Err(invalid(
                    "the message ends beyond its chunk: the file has changed".to_owned(),
                ));
            }
            unpacked.truncate(end as usize);
            unpacked.drain(..*offset as usize);
            unpacked
        }
    };
    message
        .encoding
        .decode(&bytes, options)
        .map(|cloud| RawCloud {
            unit: format.unit(),
            ..cloud
        })
        .map_err(|fault| invalid(format!("the point cloud: {}", fault.problem)))
}
