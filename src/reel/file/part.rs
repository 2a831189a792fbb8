//! Part of a conversion: the frames that a file has, so that parts that were written by several machines are
//! concatenated in the right order.

use super::bytes::{ByteReader, ByteWriter};
use crate::reel::error::Fault;
use std::ops::Range;

/// Part of a conversion: the frames of it that a file has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilePart {
    /// Index of the part, from 0.
    pub index: u64,
    /// Number of parts; 1 for a file with all frames.
    pub count: u64,
    /// Its frames among those of the conversion, including unreadable ones.
    pub frames: Range<u64>,
    /// Frames of the conversion.
    pub of_frames: u64,
    /// Source of the conversion and its options: the same for all parts.
    pub made_of: String,
}

impl FilePart {
    /// "part 2 of 3".
    pub fn name(&self) -> String {
        format!("part {} of {}", self.index + 1, self.count)
    }

    /// The file that all parts are joined to.
    pub(in crate::reel) fn whole(&self) -> Self {
        Self {
            index: 0,
            count: 1,
            frames: 0..self.of_frames,
            ..self.clone()
        }
    }

    pub(super) fn write(&self, writer: &mut ByteWriter) {
        for number in [
            self.index,
            self.count,
            self.frames.start,
            self.frames.end,
            self.of_frames,
        ] {
            writer.number(number);
        }
        writer.text(&self.made_of);
    }

    pub(super) fn read(reader: &mut ByteReader<'_>) -> Result<Self, Fault> {
        let part = Self {
            index: reader.number()?,
            count: reader.number()?,
            frames: reader.number()?..reader.number()?,
            of_frames: reader.number()?,
            made_of: reader.text()?,
        };
        let is_possible =
            part.index < part.count && part.frames.start <= part.frames.end && part.frames.end <= part.of_frames;
        if is_possible {
            Ok(part)
        } else {
            Err(Fault::new("a part of a conversion that cannot be"))
        }
    }
}
