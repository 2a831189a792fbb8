//! Index of groups and frames, at the end of the file: it is listed and drawn before any directory is read.

use super::bytes::{ByteReader, ByteWriter};
use super::directory::{Directory, time_number};
use crate::reel::error::Fault;
use crate::reel::frame::StreamKind;
use std::ops::Range;
use std::time::Duration;

/// Bytes at the end of a file that was finished.
pub(in crate::reel) const TRAILER_BYTES: usize = 20;

/// End marker of the file.
const END: [u8; 8] = *b"reel-end";

/// Trailer with the offset of the index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) struct Trailer {
    pub(in crate::reel) index_offset: u64,
}

impl Trailer {
    pub(in crate::reel) fn to_bytes(self) -> Vec<u8> {
        let mut bytes = self.index_offset.to_le_bytes().to_vec();
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes.extend(END);
        bytes
    }

    /// `None` where a file was not finished.
    pub(in crate::reel) fn read(bytes: &[u8; TRAILER_BYTES]) -> Option<Self> {
        let (offset, rest) = bytes.split_first_chunk::<8>()?;
        let (crc, end) = rest.split_first_chunk::<4>()?;
        let is_whole = end == END && u32::from_le_bytes(*crc) == crc32fast::hash(offset);
        is_whole.then(|| Self {
            index_offset: u64::from_le_bytes(*offset),
        })
    }
}

/// Index entry of a frame.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct FrameEntry {
    pub(in crate::reel) name: String,
    pub(in crate::reel) time: Option<Duration>,
    pub(in crate::reel) points_written: u64,
    /// Points of each choice of how much to decode, ascending; the last is all.
    pub(in crate::reel) level_points: Vec<usize>,
    pub(in crate::reel) bytes: [u64; StreamKind::ALL.len()],
}

/// Index entry of a group.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct GroupEntry {
    /// Byte offset of its chunk.
    pub(in crate::reel) offset: u64,
    /// Its frames.
    pub(in crate::reel) frames: Range<usize>,
}

/// All groups and frames in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct Index {
    pub(in crate::reel) groups: Vec<GroupEntry>,
    pub(in crate::reel) frames: Vec<FrameEntry>,
}

impl Index {
    /// Adds the group of a chunk.
    pub(in crate::reel) fn push(&mut self, offset: u64, directory: &Directory) {
        let start = self.frames.len();
        for frame in &directory.frames {
            let mut level_points = frame.counts_there().to_vec();
            if frame.has_points() {
                level_points.push(frame.all_points());
            }
            self.frames.push(FrameEntry {
                name: frame.name.clone(),
                time: frame.time,
                points_written: frame.points_written,
                level_points,
                bytes: frame.bytes_by_stream(),
            });
        }
        self.groups.push(GroupEntry {
            offset,
            frames: start..self.frames.len(),
        });
    }

    /// Forgets the last group.
    pub(in crate::reel) fn pop(&mut self) {
        if let Some(group) = self.groups.pop() {
            self.frames.truncate(group.frames.start);
        }
    }

    pub(in crate::reel) fn to_bytes(&self) -> Vec<u8> {
        let mut writer = ByteWriter::default();
        writer.number(self.groups.len() as u64);
        for group in &self.groups {
            writer.number(group.offset);
            writer.number(group.frames.len() as u64);
        }
        for frame in &self.frames {
            writer.text(&frame.name);
            writer.number(time_number(frame.time));
            writer.number(frame.points_written);
            writer.number(frame.level_points.len() as u64);
            for &points in &frame.level_points {
                writer.number(points as u64);
            }
            for bytes in frame.bytes {
                writer.number(bytes);
            }
        }
        writer.bytes
    }

    pub(in crate::reel) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let mut reader = ByteReader::new(bytes);
        let mut index = Self::default();
        let mut next = 0usize;
        for _ in 0..reader.count("groups")? {
            let offset = reader.number()?;
            let count = reader.count("frames")?;
            index.groups.push(GroupEntry {
                offset,
                frames: next..next + count,
            });
            next += count;
        }
        for _ in 0..next {
            let name = reader.text()?;
            let time = reader.number()?.checked_sub(1).map(Duration::from_nanos);
            let points_written = reader.number()?;
            let mut level_points = Vec::new();
            for _ in 0..reader.count("levels")? {
                level_points.push(reader.number()? as usize);
            }
            let mut bytes = [0; StreamKind::ALL.len()];
            for bytes in &mut bytes {
                *bytes = reader.number()?;
            }
            index.frames.push(FrameEntry {
                name,
                time,
                points_written,
                level_points,
                bytes,
            });
        }
        reader.end()?;
        Ok(index)
    }
}
