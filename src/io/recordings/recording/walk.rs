//! Steps over the records of a file, reading only requested bytes.

use super::chunk::MessageChunk;
use crate::io::files::long_walk::LongWalk;
use crate::io::options::ReadOptions;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

/// A place in a file that moves forward.
pub(in crate::io) struct Walk {
    file: BufReader<File>,
    at: u64,
    end: u64,
    long: LongWalk,
}

impl Walk {
    pub(in crate::io) fn new(file: File, path: &Path) -> io::Result<Self> {
        let end = file.metadata()?.len();
        Ok(Self {
            file: BufReader::new(file),
            at: 0,
            end,
            long: LongWalk::new(path, end),
        })
    }

    pub(in crate::io) fn position(&self) -> u64 {
        self.at
    }

    /// Bytes up to the end of the file.
    pub(in crate::io) fn left(&self) -> u64 {
        self.end.saturating_sub(self.at)
    }

    /// The next `count` bytes; `None` where there are fewer.
    pub(in crate::io) fn take(&mut self, count: u64) -> Option<Vec<u8>> {
        if count > self.left() {
            return None;
        }
        let mut bytes = vec![0; usize::try_from(count).ok()?];
        self.file.read_exact(&mut bytes).ok()?;
        self.at += count;
        Some(bytes)
    }

    /// Goes on at byte `position`, which is none before this one.
    pub(in crate::io) fn go_to(&mut self, position: u64) -> Option<()> {
        if position > self.end {
            return None;
        }
        let step = i64::try_from(position.checked_sub(self.at)?).ok()?;
        self.file.seek_relative(step).ok()?;
        self.at = position;
        self.long.step(position);
        Some(())
    }

    /// The bytes of a chunk; the place stays.
    pub(super) fn unpack(&mut self, chunk: &MessageChunk, options: &ReadOptions) -> Result<Vec<u8>, String> {
        let unpacked = chunk.unpack(&mut self.file, options);
        self.file
            .seek(SeekFrom::Start(self.at))
            .map_err(|error| error.to_string())?;
        unpacked
    }
}
