//! Recordings of robots: messages with point clouds and their times.
//!
//! A recording is a list of messages on topics, most of them packed together into chunks. [`list`] walks over the heads
//! of its records once, unpacks only chunks with point clouds (their index says so; chunks without one are looked
//! into), and notes where each cloud is. [`read`] then touches one message, or the one chunk it is packed in. MCAP and
//! bags differ only in how their records are written ([`mcap`], [`bag`]); a ROS 2 bag in `SQLite` is asked by
//! `rusqlite` ([`db3`]).

mod bag;
mod bytes;
mod db3;
mod found;
mod foxglove;
mod mcap;
mod pointcloud2;
mod protobuf;
mod walk;

use super::error::{Fault, Place};
use super::unpack::{Packing, unpack};
use super::{Contents, Format, IoError, ReadOptions};
use crate::cloud::RawCloud;
use found::Found;
use pointcloud2::Serialisation;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;
use std::time::Duration;

/// A message with a point cloud.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    place: MessagePlace,
    encoding: Encoding,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum MessagePlace {
    /// So many bytes from there on in the file.
    File { offset: u64, byte_count: u64 },
    /// The same within an unpacked chunk.
    Chunk {
        chunk: Chunk,
        offset: u64,
        byte_count: u64,
    },
    /// The row with this id in the table of messages.
    Row(i64),
}

/// Where many messages are packed together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Chunk {
    offset: u64,
    packed_bytes: u64,
    unpacked_bytes: u64,
    packing: Packing,
    /// Zero where there is none.
    crc: u32,
}

/// What a message with a point cloud is, and how its fields are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    /// `sensor_msgs/PointCloud2` as ROS writes it.
    Ros(Serialisation),
    /// `foxglove.PointCloud` in Protocol Buffers.
    Protobuf,
    /// `foxglove.PointCloud` in JSON.
    Json,
}

impl Encoding {
    /// When the cloud was taken, if `start`, the first bytes of the message, says so.
    fn stamp(self, start: &[u8]) -> Option<Duration> {
        match self {
            Self::Ros(serialisation) => pointcloud2::stamp(start, serialisation),
            Self::Protobuf => foxglove::protobuf_stamp(start),
            Self::Json => foxglove::json_stamp(start),
        }
    }

    /// The cloud of a message.
    fn decode(self, message: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
        match self {
            Self::Ros(serialisation) => pointcloud2::decode(message, serialisation, options),
            Self::Protobuf => foxglove::decode_protobuf(message, options),
            Self::Json => foxglove::decode_json(message, options),
        }
    }
}

/// The encoding of messages of type `kind`, if they are point clouds; names are those of ROS 1, of ROS 2 and of
/// Foxglove.
fn encoding_of(kind: &str, encoding: &str) -> Option<Encoding> {
    let is_ros = ["sensor_msgs/PointCloud2", "sensor_msgs/msg/PointCloud2"].contains(&kind);
    let is_foxglove = kind == "foxglove.PointCloud";
    match encoding {
        "ros1" if is_ros => Some(Encoding::Ros(Serialisation::Ros1)),
        "cdr" if is_ros => Some(Encoding::Ros(Serialisation::Cdr)),
        "protobuf" if is_foxglove => Some(Encoding::Protobuf),
        "json" if is_foxglove => Some(Encoding::Json),
        _ => None,
    }
}

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
    let found = if format == Format::Db3 {
        db3::find(path)
    } else {
        let mut walk = walk::Walk::new(File::open(path).map_err(failed)?).map_err(failed)?;
        match format {
            Format::Mcap => mcap::find(&mut walk, options),
            _ => bag::find(&mut walk, options),
        }
    };
    let found = found.map_err(|fault| fault.of(path, format))?;
    Ok(found.contents(topic))
}

/// The point cloud of a message.
pub(super) fn read(
    path: &Path,
    message: &Message,
    options: &ReadOptions,
) -> Result<RawCloud, IoError> {
    let (format, place) = match (&message.place, message.encoding) {
        (&MessagePlace::Row(row), _) => (
            Format::Db3,
            Place::Entry {
                list: "message".to_owned(),
                index: row as usize,
            },
        ),
        (&MessagePlace::File { offset, .. } | &MessagePlace::Chunk { offset, .. }, encoding) => (
            // A ROS 1 message may be in an MCAP file, too; the file's name says which.
            match (encoding, Format::of_extension(path)) {
                (Encoding::Ros(Serialisation::Ros1), Some(Format::Bag)) => Format::Bag,
                _ => Format::Mcap,
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

impl Chunk {
    /// The chunk's bytes; the error is a sentence without its place.
    fn unpack(
        &self,
        file: &mut (impl std::io::Read + std::io::Seek),
        options: &ReadOptions,
    ) -> Result<Vec<u8>, String> {
        file.seek(SeekFrom::Start(self.offset))
            .map_err(|error| error.to_string())?;
        let bytes = unpack(
            self.packing,
            file.by_ref().take(self.packed_bytes),
            self.unpacked_bytes,
            options,
        )
        .map_err(|problem| format!("the chunk: {problem}"))?;
        if self.crc != 0 && crc32fast::hash(&bytes) != self.crc {
            return Err("the chunk's checksum is wrong: it is damaged".to_owned());
        }
        Ok(bytes)
    }
}
