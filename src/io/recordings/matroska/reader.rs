//! The walk over a file. Segments, clusters and groups of blocks are entered, so that their lengths need not be known:
//! an id identifies an element, wherever it is.

use super::super::recording::walk::Walk;
use super::element::{Head, MAGIC, children, head, leading_number, text, unsigned};
use super::entries;
use super::found::{Attachment, Block, Matroska, MatroskaError, Track};
use std::collections::HashMap;
use std::fs::File;
use std::path::Path;
use std::time::Duration;

const HEADER: u32 = u32::from_be_bytes(MAGIC);
const DOC_TYPE: u32 = 0x4282;
const SEGMENT: u32 = 0x1853_8067;
const INFO: u32 = 0x1549_a966;
const TIMESTAMP_SCALE: u32 = 0x002a_d7b1;
const TRACKS: u32 = 0x1654_ae6b;
const TAGS: u32 = 0x1254_c367;
const ATTACHMENTS: u32 = 0x1941_a469;
const ATTACHED_FILE: u32 = 0x61a7;
const FILE_NAME: u32 = 0x466e;
const FILE_DATA: u32 = 0x465c;
const CLUSTER: u32 = 0x1f43_b675;
const TIMESTAMP: u32 = 0xe7;
const BLOCK_GROUP: u32 = 0xa0;
const BLOCK: u32 = 0xa1;
const SIMPLE_BLOCK: u32 = 0xa3;

/// Default nanoseconds per unit of time.
const USUAL_SCALE_NS: u64 = 1_000_000;

/// Heads, tracks and tags are text and numbers; more is none that is needed here.
const MAX_BODY_BYTES: u64 = 16 << 20;

/// Bytes before the frame of a block: the number of its track, a time, flags, and the number of frames.
const MAX_BLOCK_HEAD_BYTES: u64 = 8 + 2 + 1 + 1;

/// Flags of a block that say how several frames share it.
const LACING: u8 = 0b0000_0110;

impl Matroska {
    /// Reads the contents of the file at `path`.
    ///
    /// # Errors
    /// [`MatroskaError`]: the system's, and where it is not a Matroska file or has no tracks.
    pub(crate) fn read(path: &Path) -> Result<Self, MatroskaError> {
        read_file(File::open(path)?, path)
    }
}

fn read_file(file: File, path: &Path) -> Result<Matroska, MatroskaError> {
    let mut reader = Reader {
        walk: Walk::new(file, path)?,
        found: Matroska::default(),
        scale_ns: USUAL_SCALE_NS,
        cluster_time: 0,
        blocks: HashMap::new(),
    };
    reader.header()?;
    // `matroska-demuxer` reads the bytes of each frame to get to the next, does not know attached files, and rejects
    // truncated files.
    while reader.walk.left() > 0 {
        if reader.element().is_none() {
            reader.found.is_truncated = true;
            break;
        }
    }
    reader.finish()
}

/// Frames of a track, with their times in units, and how many blocks hold several.
#[derive(Debug, Default)]
struct Blocks {
    frames: Vec<(i64, Block)>,
    laced: usize,
}

struct Reader {
    walk: Walk,
    found: Matroska,
    scale_ns: u64,
    /// Timestamp of the current cluster, in units.
    cluster_time: u64,
    /// By the numbers of their tracks, which may come later.
    blocks: HashMap<u64, Blocks>,
}

impl Reader {
    fn header(&mut self) -> Result<(), MatroskaError> {
        let invalid = |problem: String| MatroskaError::Invalid { offset: 0, problem };
        let is_header = |head: &Head| head.id == HEADER;
        let body = head(&mut self.walk)
            .filter(is_header)
            .and_then(|head| self.body(&head))
            .ok_or_else(|| invalid("this is not a Matroska file: its first bytes differ".to_owned()))?;
        let kind = children(&body).find(|&(id, _)| id == DOC_TYPE);
        let kind = kind.map_or_else(|| "matroska".to_owned(), |(_, body)| text(body));
        if !["matroska", "webm"].contains(&kind.as_str()) {
            return Err(invalid(format!(
                "the file is of the kind `{}`, and matroska was expected",
                kind.escape_default()
            )));
        }
        Ok(())
    }

    /// The next element, or the head of one that others are in; `None` where it is not whole.
    fn element(&mut self) -> Option<()> {
        let head = head(&mut self.walk)?;
        match head.id {
            SEGMENT | CLUSTER | BLOCK_GROUP | ATTACHMENTS => {}
            ATTACHED_FILE => self.found.attachments.push(Attachment::default()),
            INFO => {
                let body = self.body(&head)?;
                let scale = children(&body).find(|&(id, _)| id == TIMESTAMP_SCALE);
                self.scale_ns = scale.map_or(USUAL_SCALE_NS, |(_, body)| unsigned(body));
            }
            TRACKS => {
                let body = self.body(&head)?;
                self.found.tracks.extend(entries::tracks(&body));
            }
            TAGS => {
                let body = self.body(&head)?;
                self.found.tags.extend(entries::tags(&body));
            }
            FILE_NAME => {
                let name = text(&self.body(&head)?);
                if let Some(last) = self.found.attachments.last_mut() {
                    last.name = name;
                }
            }
            FILE_DATA => {
                let content = Block {
                    time: Duration::ZERO,
                    offset: self.walk.position(),
                    byte_count: head.byte_count?,
                };
                self.skip(&head)?;
                if let Some(last) = self.found.attachments.last_mut() {
                    last.content = content;
                }
            }
            TIMESTAMP => self.cluster_time = unsigned(&self.body(&head)?),
            BLOCK | SIMPLE_BLOCK => self.block(&head)?,
            _ => self.skip(&head)?,
        }
        Some(())
    }

    fn skip(&mut self, head: &Head) -> Option<()> {
        let end = self.walk.position().checked_add(head.byte_count?)?;
        self.walk.go_to(end)
    }

    /// The body of a small element.
    fn body(&mut self, head: &Head) -> Option<Vec<u8>> {
        let byte_count = head.byte_count.filter(|&count| count <= MAX_BODY_BYTES)?;
        self.walk.take(byte_count)
    }

    /// Notes where the frame of a block is.
    fn block(&mut self, head: &Head) -> Option<()> {
        let byte_count = head.byte_count?;
        let start = self.walk.position();
        let end = start.checked_add(byte_count)?;
        let bytes = self.walk.take(byte_count.min(MAX_BLOCK_HEAD_BYTES))?;
        self.walk.go_to(end)?;
        let (track, rest) = leading_number(&bytes)?;
        let &[high, low, flags, ref rest @ ..] = rest else {
            return None;
        };
        let is_laced = flags & LACING != 0;
        // A lace with one frame has no lengths: the frame follows the number directly.
        let more_frames = if is_laced { *rest.first()? } else { 0 };
        let before = (bytes.len() - rest.len()) as u64 + u64::from(is_laced);
        let blocks = self.blocks.entry(track).or_default();
        if more_frames > 0 {
            blocks.laced += 1;
            return Some(());
        }
        let since_cluster = i64::from(i16::from_be_bytes([high, low]));
        let time = i64::try_from(self.cluster_time).unwrap_or(i64::MAX);
        let block = Block {
            time: Duration::ZERO,
            offset: start + before,
            byte_count: byte_count - before,
        };
        blocks.frames.push((time.saturating_add(since_cluster), block));
        Some(())
    }

    fn finish(mut self) -> Result<Matroska, MatroskaError> {
        if self.found.tracks.is_empty() {
            return Err(MatroskaError::Invalid {
                offset: self.walk.position(),
                problem: "no track was found up to here: the file is damaged, or was not written to its end".to_owned(),
            });
        }
        for track in &mut self.found.tracks {
            self.blocks
                .remove(&track.number)
                .unwrap_or_default()
                .hand_to(track, self.scale_ns);
        }
        Ok(self.found)
    }
}

impl Blocks {
    fn hand_to(mut self, track: &mut Track, scale_ns: u64) {
        self.frames.sort_by_key(|&(time, _)| time);
        let in_nanos = |(time, block): (i64, Block)| Block {
            time: Duration::from_nanos(time.max(0).unsigned_abs().saturating_mul(scale_ns)),
            ..block
        };
        track.laced = self.laced;
        track.frames = self.frames.into_iter().map(in_nanos).collect();
    }
}
