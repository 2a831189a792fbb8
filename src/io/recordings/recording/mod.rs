//! Recordings of robots: messages with point clouds, or with images of depth cameras, and their times.
//!
//! A recording is a list of messages on topics, most of them packed together into chunks. [`list`] walks over the heads
//! of its records once, unpacks only chunks with point clouds (by their index; chunks without one are scanned), and
//! records the location of each cloud. [`read`] then touches one message, or the one chunk it is packed in. MCAP and
//! bags differ only in how their records are written ([`mcap`], [`bag`]); a ROS 2 bag in `SQLite` is queried by
//! `rusqlite` ([`db3`]). Camera messages are found by the same walk ([`cameras`], [`camera`]).

mod bag;
mod bytes;
pub(crate) mod camera;
mod chunk;
#[cfg_attr(not(feature = "sqlite"), path = "no_db3.rs")]
mod db3;
mod encoding;
mod found;
mod foxglove;
mod kind;
mod livox;
mod mcap;
mod message;
mod pointcloud2;
mod protobuf;
mod serialisation;
mod unread;
pub(in crate::io) mod walk;

pub use message::Message;

use super::containers;
use crate::cloud::RawCloud;
use crate::io::contents::Contents;
use crate::io::error::{Fault, IoError, Place};
use crate::io::files::unpack::{Packing, unpack};
use crate::io::format::Format;
use crate::io::options::ReadOptions;
use crate::raster::Raster;
use camera::{CameraMessage, CameraTopics};
use encoding::Encoding;
use found::{FoundMessages, Wanted};
use kind::{Find, Kind};
use message::MessagePlace;
use serialisation::Serialisation;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// Kinds of recordings.
const KINDS: &[Kind] = &[
    Kind {
        format: containers::MCAP,
        find: Find::Walk(mcap::find),
        known_as: |_| None,
    },
    Kind {
        format: containers::BAG,
        find: Find::Walk(bag::find),
        known_as: |_| None,
    },
    Kind {
        format: containers::DB3,
        find: Find::Ask(db3::find),
        known_as: db3::foreign_kind,
    },
];

/// The topics of the recording at `path`, and the point clouds of `topic` (of the one that has the most, if `None`) in
/// the order of their time.
pub(in crate::io) fn list(
    path: &Path,
    format: Format,
    topic: Option<&str>,
    options: &ReadOptions,
) -> Result<Contents, IoError> {
    Ok(find(path, format, Wanted::Clouds, options)?.contents(topic))
}

/// Returns the camera topics of the recording at `path`; nothing if it has point clouds, unless cameras are requested
/// with `with_clouds`.
pub(in crate::io) fn cameras(
    path: &Path,
    format: Format,
    with_clouds: bool,
    options: &ReadOptions,
) -> Result<CameraTopics, IoError> {
    let found = find(path, format, Wanted::Cameras { with_clouds }, options)?;
    if found.is_complete() {
        return Ok(CameraTopics::default());
    }
    Ok(found.cameras())
}

fn find(path: &Path, format: Format, wanted: Wanted, options: &ReadOptions) -> Result<FoundMessages, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let Some(kind) = KINDS.iter().find(|kind| kind.format == format) else {
        return Ok(FoundMessages::new(wanted));
    };
    let found = match kind.find {
        Find::Ask(find) => find(path, wanted),
        Find::Walk(find) => {
            let file = File::open(path).map_err(failed)?;
            find(&mut walk::Walk::new(file, path).map_err(failed)?, wanted, options)
        }
    };
    found.map_err(|fault| match (kind.known_as)(path) {
        Some(kind) => IoError::Foreign {
            path: path.to_owned(),
            kind,
        },
        None => fault.of(path, format),
    })
}

/// The point cloud of a message.
pub(in crate::io) fn read(path: &Path, message: &Message, options: &ReadOptions) -> Result<RawCloud, IoError> {
    let bytes = message_bytes(path, message, options)?;
    let (format, place) = place_of(path, message);
    // For a message in a chunk, this is the capacity of the chunk.
    let options = options.holding(bytes.capacity());
    let cloud = message.encoding.decode(&bytes, &options).map_err(|fault| {
        let problem = format!("the point cloud: {}", fault.problem);
        Fault::new(place, problem).of(path, format)
    })?;
    Ok(RawCloud {
        unit: format.unit(),
        ..cloud
    })
}

/// The image of a message of `kind`.
pub(crate) fn read_image(
    path: &Path,
    message: &Message,
    kind: CameraMessage,
    options: &ReadOptions,
) -> Result<Raster, IoError> {
    let bytes = message_bytes(path, message, options)?;
    let max_bytes = options.holding(bytes.capacity()).left_bytes();
    camera::image(&bytes, message, kind, max_bytes).map_err(|problem| {
        let (format, place) = place_of(path, message);
        Fault::new(place, format!("the image: {problem}")).of(path, format)
    })
}

/// Reads a message of a camera by `parse`, which is one of [`camera`]; `None` where it is damaged.
pub(crate) fn read_parsed<T>(
    path: &Path,
    message: &Message,
    options: &ReadOptions,
    parse: impl FnOnce(&[u8], &Message) -> Option<T>,
) -> Option<T> {
    parse(&message_bytes(path, message, options).ok()?, message)
}

/// Reads many small messages of a camera by `parse`, and unpacks data shared by neighbours once. Damaged messages are
/// skipped.
pub(crate) fn read_all_parsed<'a, T>(
    path: &Path,
    messages: impl Iterator<Item = &'a Message>,
    options: &ReadOptions,
    parse: impl Fn(&[u8], &Message) -> Option<T>,
) -> Vec<T> {
    let mut unpacked: Option<(chunk::MessageChunk, Vec<u8>)> = None;
    let mut rows = None;
    let mut read = |message: &Message| match &message.place {
        &MessagePlace::Chunk {
            chunk,
            offset,
            byte_count,
        } => {
            if unpacked.as_ref().is_none_or(|(known, _)| *known != chunk) {
                let mut file = File::open(path).ok()?;
                // If it cannot be unpacked, that is not tried again for each of its messages.
                let bytes = chunk.unpack(&mut file, options).unwrap_or_default();
                unpacked = Some((chunk, bytes));
            }
            let (_, bytes) = unpacked.as_ref()?;
            let end = usize::try_from(offset.checked_add(byte_count)?).ok()?;
            parse(bytes.get(usize::try_from(offset).ok()?..end)?, message)
        }
        &MessagePlace::Row(row) => {
            if rows.is_none() {
                rows = db3::Messages::open(path).ok();
            }
            parse(&rows.as_ref()?.read(row, options).ok()?, message)
        }
        MessagePlace::File { .. } => read_parsed(path, message, options, &parse),
    };
    messages.filter_map(&mut read).collect()
}

/// The format of a recording, and where in it a message is.
fn place_of(path: &Path, message: &Message) -> (Format, Place) {
    match (&message.place, message.encoding) {
        (&MessagePlace::Row(row), _) => (
            containers::DB3,
            Place::Entry {
                list: "message".to_owned(),
                index: row as usize,
            },
        ),
        (&MessagePlace::File { offset, .. } | &MessagePlace::Chunk { offset, .. }, encoding) => (
            // A ROS 1 message may be in an MCAP file, too; the name of the file decides.
            match encoding {
                Encoding::Ros(Serialisation::Ros1) | Encoding::Livox(Serialisation::Ros1)
                    if containers::BAG.has_extension_of(path) =>
                {
                    containers::BAG
                }
                _ => containers::MCAP,
            },
            Place::Byte(offset as usize),
        ),
    }
}

fn message_bytes(path: &Path, message: &Message, options: &ReadOptions) -> Result<Vec<u8>, IoError> {
    let invalid = |problem: String| {
        let (format, place) = place_of(path, message);
        Fault::new(place, problem).of(path, format)
    };
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    match &message.place {
        MessagePlace::Row(row) => db3::Messages::open(path)
            .and_then(|messages| messages.read(*row, options))
            .map_err(invalid),
        &MessagePlace::File { offset, byte_count } => {
            let mut file = File::open(path).map_err(failed)?;
            file.seek(SeekFrom::Start(offset)).map_err(failed)?;
            unpack(Packing::Stored, file.take(byte_count), byte_count, options).map_err(invalid)
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
            Ok(unpacked)
        }
    }
}
