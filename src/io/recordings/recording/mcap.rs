//! MCAP: records of a kind (one byte), a length and a body; <https://mcap.dev/spec>.
//!
//! Only lengths, numbers and strings are read here; the available crate would read whole files from memory, or unpack
//! every chunk to find a channel. Schemas and channels are also in the summary at the end, so one walk over the heads
//! of the records meets them all, with or without a summary.

use super::bytes::Bytes;
use super::chunk::MessageChunk;
use super::found::{FoundMessages, Wanted};
use super::message::MessagePlace;
use super::walk::Walk;
use crate::io::error::{Fault, Place};
use crate::io::files::unpack::Packing;
use crate::io::options::ReadOptions;
use std::collections::HashMap;
use std::time::Duration;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Kind and length.
const HEAD_BYTES: u64 = 9;
/// Schemas and channels are text; more is none that is needed here.
const MAX_TEXT_BYTES: u64 = 16 << 20;
/// Number of bytes that cover a record's header: for a chunk, everything before its data; for a message, everything
/// before its own data, plus its timestamp, even in words.
const START_BYTES: u64 = 256;
/// Size of an index entry in bytes: time and offset.
const INDEX_ENTRY_BYTES: u32 = 16;
/// Channel, sequence, two times.
const MESSAGE_HEAD_BYTES: u64 = 22;

const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
const MESSAGE_INDEX: u8 = 0x07;

/// Schemas by their number, and found messages.
struct Finder {
    schemas: HashMap<u16, String>,
    found: FoundMessages,
}

/// Finds the wanted messages of the file that `walk` is at the start of.
pub(super) fn find(walk: &mut Walk, wanted: Wanted, options: &ReadOptions) -> Result<FoundMessages, Fault> {
    if walk.take(MAGIC.len() as u64).as_deref() != Some(MAGIC) {
        return Err(Fault::new(
            Place::Byte(0),
            "this is not an MCAP file: its first bytes differ",
        ));
    }
    let mut finder = Finder {
        schemas: HashMap::new(),
        found: FoundMessages::new(wanted),
    };
    let mut chunks: Vec<(MessageChunk, Vec<u32>)> = Vec::new();
    loop {
        let start = walk.position();
        let read = finder.record(walk, &mut chunks);
        match read {
            Some(FOOTER) => {
                if walk.take(MAGIC.len() as u64).as_deref() != Some(MAGIC) {
                    finder.found.skip(format!(
                        "the file ends at byte {}, within its closing bytes: it was cut, and all of its messages are \
                         read",
                        walk.position() + walk.left()
                    ));
                }
                break;
            }
            Some(_) => {}
            None => {
                finder.found.skip(format!(
                    "the file ends early, in the record at byte {start}: the messages before it are read"
                ));
                break;
            }
        }
    }
    for (chunk, channels) in chunks {
        if finder.found.is_complete() {
            break;
        }
        if !finder.found.may_be_in_chunk(&channels) {
            continue;
        }
        match walk.unpack(&chunk, options) {
            Ok(bytes) => finder.records_of(&bytes, chunk, channels.is_empty()),
            Err(problem) => finder.found.skip(format!(
                "the messages in the chunk at byte {} are skipped: {problem}",
                chunk.offset
            )),
        }
    }
    Ok(finder.found)
}

impl Finder {
    /// Reads the record that `walk` is at and goes to the next one; `None` where it is cut.
    fn record(&mut self, walk: &mut Walk, chunks: &mut Vec<(MessageChunk, Vec<u32>)>) -> Option<u8> {
        let head = walk.take(HEAD_BYTES)?;
        let mut head = Bytes::new(&head);
        let (kind, length) = (head.u8()?, head.u64()?);
        let body = walk.position();
        let end = body.checked_add(length)?;
        // Zeros are not records, and a sparse file may contain terabytes of them.
        if length > walk.left() || kind == 0 {
            return None;
        }
        match kind {
            SCHEMA | CHANNEL if length <= MAX_TEXT_BYTES => {
                let bytes = walk.take(length)?;
                self.text_record(kind, &bytes);
            }
            MESSAGE => {
                let bytes = walk.take(length.min(START_BYTES))?;
                self.count(&bytes);
                self.message(&bytes, |head| MessagePlace::File {
                    offset: body + head,
                    byte_count: length - head,
                });
            }
            CHUNK => {
                let bytes = walk.take(length.min(START_BYTES))?;
                match chunk(&bytes, body, length) {
                    Ok(Some(chunk)) => chunks.push((chunk, Vec::new())),
                    Ok(None) => {}
                    Err(problem) => self.found.skip(problem),
                }
            }
            MESSAGE_INDEX => {
                let bytes = walk.take(length.min(START_BYTES))?;
                let mut index = Bytes::new(&bytes);
                if let (Some((_, channels)), Some(channel)) = (chunks.last_mut(), index.u16()) {
                    channels.push(u32::from(channel));
                    let entries_bytes = index.u32().unwrap_or(0);
                    self.found
                        .count(u32::from(channel), u64::from(entries_bytes / INDEX_ENTRY_BYTES));
                }
            }
            _ => {}
        }
        walk.go_to(end)?;
        Some(kind)
    }

    /// Counts a message that begins with `start`.
    fn count(&mut self, start: &[u8]) {
        if let Some(channel) = Bytes::new(start).u16() {
            self.found.count(u32::from(channel), 1);
        }
    }

    /// Reads the records in a chunk; counts its messages where no index does.
    fn records_of(&mut self, bytes: &[u8], chunk: MessageChunk, is_unindexed: bool) {
        let mut records = Bytes::new(bytes);
        while !records.is_empty() {
            let mut next = || {
                let (kind, length) = (records.u8()?, records.u64()?);
                let start = records.position() as u64;
                // Zeros are not records.
                (kind != 0).then_some(())?;
                Some((kind, start, records.take(usize::try_from(length).ok()?)?))
            };
            let Some((kind, start, body)) = next() else {
                self.found.skip(format!(
                    "the chunk at byte {} ends early: the messages before that are read",
                    chunk.offset
                ));
                return;
            };
            match kind {
                SCHEMA | CHANNEL => {
                    self.text_record(kind, body);
                }
                MESSAGE => {
                    if is_unindexed {
                        self.count(body);
                    }
                    self.message(body, |head| MessagePlace::Chunk {
                        chunk,
                        offset: start + head,
                        byte_count: body.len() as u64 - head,
                    });
                }
                _ => {}
            }
        }
    }

    fn text_record(&mut self, kind: u8, body: &[u8]) -> Option<()> {
        let mut body = Bytes::new(body);
        let id = body.u16()?;
        if kind == SCHEMA {
            let name = body.text()?;
            self.schemas.insert(id, name);
            return Some(());
        }
        let schema = body.u16()?;
        let (topic, encoding) = (body.text()?, body.text()?);
        let kind = self.schemas.get(&schema).map_or("", String::as_str);
        self.found.add_topic(u32::from(id), &topic, kind, &encoding);
        Some(())
    }

    /// Records a message that begins with `start`; `place` computes its location from the size of the bytes before its
    /// own.
    fn message(&mut self, start: &[u8], place: impl FnOnce(u64) -> MessagePlace) -> Option<()> {
        let mut head = Bytes::new(start);
        let channel = head.u16()?;
        let _sequence = head.u32()?;
        let log_time = Duration::from_nanos(head.u64()?);
        let _publish_time = head.u64()?;
        let own = start.get(MESSAGE_HEAD_BYTES as usize..)?;
        self.found
            .add(u32::from(channel), log_time, own, place(MESSAGE_HEAD_BYTES));
        Some(())
    }
}

/// The chunk whose record's body begins at `body` with `start`; `None` where it is cut.
///
/// # Errors
/// The method that it is packed by, where that is not known, as a sentence.
fn chunk(start: &[u8], body: u64, length: u64) -> Result<Option<MessageChunk>, String> {
    let Some((chunk, compression)) = chunk_head(start, body, length) else {
        return Ok(None);
    };
    let packing = match compression.as_str() {
        "" => Packing::Stored,
        "lz4" => Packing::Lz4,
        "zstd" => Packing::Zstd,
        other => {
            return Err(format!(
                "the messages in the chunk at byte {body} are skipped: it is packed by {}, expected lz4, zstd or none",
                other.escape_default()
            ));
        }
    };
    Ok(Some(MessageChunk { packing, ..chunk }))
}

/// The chunk, and the name of the method that it is packed by.
fn chunk_head(start: &[u8], body: u64, length: u64) -> Option<(MessageChunk, String)> {
    let mut head = Bytes::new(start);
    let _times = (head.u64()?, head.u64()?);
    let unpacked_bytes = head.u64()?;
    let crc = head.u32()?;
    let compression = head.text()?;
    let packed_bytes = head.u64()?;
    let offset = body + head.position() as u64;
    let chunk = MessageChunk {
        offset,
        packed_bytes,
        unpacked_bytes,
        packing: Packing::Stored,
        crc,
    };
    (packed_bytes <= length - head.position() as u64).then_some((chunk, compression))
}
