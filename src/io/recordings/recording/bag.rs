//! ROS 1 bags, version 2.0: records of a header with named fields, and data; <http://wiki.ros.org/Bags/Format/2.0>.
//!
//! Connections (topics) and the index of a chunk follow the chunks, so one walk over the heads of the records meets
//! them. A bag that was not closed has neither: then its chunks are looked into.

use super::bytes::Bytes;
use super::chunk::MessageChunk;
use super::found::{FoundMessages, Wanted};
use super::message::MessagePlace;
use super::walk::Walk;
use crate::io::error::{Fault, Place};
use crate::io::files::unpack::Packing;
use crate::io::options::ReadOptions;
use std::time::Duration;

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
/// Headers are a few short fields.
const MAX_HEADER_BYTES: u64 = 1 << 20;
/// A connection carries the definition of its type.
const MAX_TEXT_BYTES: u64 = 16 << 20;
/// Sequence number and time stamp.
const START_BYTES: u64 = 16;

const MESSAGE: u8 = 0x02;
const BAG: u8 = 0x03;
const INDEX: u8 = 0x04;
const CHUNK: u8 = 0x05;
const CONNECTION: u8 = 0x07;

/// The used fields of a header.
#[derive(Default)]
struct RecordHeader {
    op: u8,
    connection: Option<u32>,
    time: Option<Duration>,
    topic: Option<String>,
    kind: Option<String>,
    compression: Option<String>,
    unpacked_bytes: Option<u32>,
    /// Messages of a connection in a chunk.
    count: Option<u32>,
    /// File offset of the index of the whole bag; 0 until it is closed.
    index_at: Option<u64>,
    /// Chunks of the whole bag, and connections in its index.
    chunks: Option<u32>,
    connections: Option<u32>,
}

impl RecordHeader {
    fn parse(bytes: &[u8]) -> Option<Self> {
        let mut header = Self::default();
        let mut fields = Bytes::new(bytes);
        while !fields.is_empty() {
            let field = fields.counted()?;
            let split = field.iter().position(|&byte| byte == b'=')?;
            let (name, value) = (&field[..split], &field[split + 1..]);
            let text = || Some(String::from_utf8_lossy(value).into_owned());
            let mut number = Bytes::new(value);
            match name {
                b"op" => header.op = number.u8()?,
                b"conn" => header.connection = number.u32(),
                b"time" => {
                    header.time = number
                        .u32()
                        .zip(number.u32())
                        .map(|(seconds, nanos)| time(seconds, nanos));
                }
                b"topic" => header.topic = text(),
                b"type" => header.kind = text(),
                b"compression" => header.compression = text(),
                b"count" => header.count = number.u32(),
                b"index_pos" => header.index_at = number.u64(),
                b"conn_count" => header.connections = number.u32(),
                b"chunk_count" => header.chunks = number.u32(),
                b"size" => header.unpacked_bytes = number.u32(),
                _ => {}
            }
        }
        Some(header)
    }
}

fn time(seconds: u32, nanos: u32) -> Duration {
    Duration::from_secs(seconds.into()) + Duration::from_nanos(nanos.into())
}

/// Finds the wanted messages of the file that `walk` is at the start of.
pub(super) fn find(walk: &mut Walk, wanted: Wanted, options: &ReadOptions) -> Result<FoundMessages, Fault> {
    let magic = walk.take(MAGIC.len() as u64).unwrap_or_default();
    if magic != MAGIC {
        return Err(Fault::new(
            Place::Byte(0),
            "only bags of version 2.0 are read: convert it with `rosbag migrate`, or to MCAP",
        ));
    }
    let mut found = FoundMessages::new(wanted);
    let mut chunks: Vec<(MessageChunk, Vec<u32>)> = Vec::new();
    let mut closing = Closing::default();
    while walk.left() > 0 {
        let start = walk.position();
        if record(walk, &mut found, &mut chunks, &mut closing).is_none() {
            closing.is_cut = true;
            found.skip(format!(
                "the bag ends early, in the record at byte {start}: the messages before it are read"
            ));
            break;
        }
    }
    if let Some(damage) = closing.damage(walk.position()) {
        found.skip(damage);
    }
    for (chunk, connections) in chunks {
        if found.is_complete() {
            break;
        }
        if !found.may_be_in_chunk(&connections) {
            continue;
        }
        match walk.unpack(&chunk, options) {
            Ok(bytes) => records_of(&bytes, chunk, connections.is_empty(), &mut found),
            Err(problem) => found.skip(format!(
                "the messages in the chunk at byte {} are skipped: {problem}",
                chunk.offset
            )),
        }
    }
    Ok(found)
}

/// Claims of a bag's header, which is rewritten when it is closed, compared with the records that were met.
#[derive(Debug, Default)]
struct Closing {
    /// Claimed file offset of the index, and number of chunks.
    claimed: Option<(u64, u32)>,
    chunks: u32,
    /// Connections in the index that are claimed, and those that were met.
    connections: [u32; 2],
    /// The last record is cut, which is said already.
    is_cut: bool,
}

impl Closing {
    fn damage(&self, end: u64) -> Option<String> {
        match self.claimed.filter(|_| !self.is_cut)? {
            (0, _) => Some(format!(
                "the bag was not closed (it has no index): its messages up to byte {end} are read, later ones were not \
                 written; `rosbag reindex` repairs it"
            )),
            (index_at, chunks) if index_at >= end || self.chunks < chunks => Some(format!(
                "the bag ends at byte {end} before its index: {} of {chunks} chunks are missing, with their messages",
                chunks.saturating_sub(self.chunks)
            )),
            _ if self.connections[1] < self.connections[0] => Some(format!(
                "the bag ends at byte {end} within its index: it was cut, and all of its messages are read"
            )),
            _ => None,
        }
    }
}

/// Reads the record that `walk` is at and goes to the next one; `None` where it is cut.
fn record(
    walk: &mut Walk,
    found: &mut FoundMessages,
    chunks: &mut Vec<(MessageChunk, Vec<u32>)>,
    closing: &mut Closing,
) -> Option<()> {
    let mut length = |max: u64| {
        let length = u64::from(Bytes::new(&walk.take(4)?).u32()?);
        (length <= max).then_some(length)
    };
    // Zeros are not a record, and a sparse file may contain terabytes of them.
    let header_bytes = length(MAX_HEADER_BYTES).filter(|&length| length > 0)?;
    let header = RecordHeader::parse(&walk.take(header_bytes)?)?;
    let data_bytes = u64::from(Bytes::new(&walk.take(4)?).u32()?);
    let offset = walk.position();
    let end = offset + data_bytes;
    if data_bytes > walk.left() {
        return None;
    }
    match header.op {
        BAG => {
            closing.claimed = header.index_at.zip(header.chunks);
            closing.connections[0] = header.connections.unwrap_or(0);
        }
        CONNECTION if data_bytes <= MAX_TEXT_BYTES => {
            let data = walk.take(data_bytes)?;
            closing.connections[1] += 1;
            connection(&header, &data, found);
        }
        MESSAGE => {
            let start = walk.take(data_bytes.min(START_BYTES))?;
            let place = MessagePlace::File {
                offset,
                byte_count: data_bytes,
            };
            found.count(header.connection.unwrap_or_default(), 1);
            message(&header, &start, place, found);
        }
        CHUNK => {
            closing.chunks += 1;
            let packing = match header.compression.as_deref() {
                Some("none") => Some(Packing::Stored),
                Some("lz4") => Some(Packing::Lz4),
                Some("bz2") => Some(Packing::Bzip2),
                other => {
                    found.skip(format!(
                        "the messages in the chunk at byte {offset} are skipped: it is packed by {}, expected lz4, bz2 \
                         or none",
                        other.unwrap_or("a method without a name")
                    ));
                    None
                }
            };
            if let (Some(packing), Some(unpacked_bytes)) = (packing, header.unpacked_bytes) {
                let chunk = MessageChunk {
                    offset,
                    packed_bytes: data_bytes,
                    unpacked_bytes: unpacked_bytes.into(),
                    packing,
                    crc: 0,
                };
                chunks.push((chunk, Vec::new()));
            }
        }
        INDEX => {
            if let (Some((_, connections)), Some(connection)) = (chunks.last_mut(), header.connection) {
                connections.push(connection);
                found.count(connection, header.count.unwrap_or(0).into());
            }
        }
        _ => {}
    }
    walk.go_to(end)
}

/// Reads the records in a chunk; counts its messages where no index does.
fn records_of(bytes: &[u8], chunk: MessageChunk, is_unindexed: bool, found: &mut FoundMessages) {
    let mut records = Bytes::new(bytes);
    while !records.is_empty() {
        let mut next = || {
            let header = RecordHeader::parse(records.counted()?)?;
            let data = records.counted()?;
            Some((header, records.position() - data.len(), data))
        };
        let Some((header, offset, data)) = next() else {
            found.skip(format!(
                "the chunk at byte {} ends early: the messages before that are read",
                chunk.offset
            ));
            return;
        };
        match header.op {
            CONNECTION => connection(&header, data, found),
            MESSAGE => {
                let place = MessagePlace::Chunk {
                    chunk,
                    offset: offset as u64,
                    byte_count: data.len() as u64,
                };
                if is_unindexed {
                    found.count(header.connection.unwrap_or_default(), 1);
                }
                message(&header, data, place, found);
            }
            _ => {}
        }
    }
}

fn connection(header: &RecordHeader, data: &[u8], found: &mut FoundMessages) {
    let kind = RecordHeader::parse(data).and_then(|connection| connection.kind);
    if let (Some(id), Some(kind)) = (header.connection, kind) {
        found.add_topic(id, header.topic.as_deref().unwrap_or_default(), &kind, "ros1");
    }
}

fn message(header: &RecordHeader, start: &[u8], place: MessagePlace, found: &mut FoundMessages) {
    if let (Some(connection), Some(time)) = (header.connection, header.time) {
        found.add(connection, time, start, place);
    }
}
