//! A part of a file, read piece by piece: records are parsed in place.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};

/// Number of bytes read at once; records are a hundredth of it.
const PIECE_BYTES: usize = 1 << 20;

/// Bytes of a file that are in memory, from a place that only moves forward.
#[derive(Debug)]
pub(super) struct Window {
    file: File,
    bytes: Vec<u8>,
    /// Position in `bytes` of the next record, and of the end of the records.
    begin: usize,
    end: usize,
    /// File offset of `begin`.
    offset: u64,
}

impl Window {
    /// The file from byte `offset` on.
    pub(super) fn at(mut file: File, offset: u64) -> io::Result<Self> {
        file.seek(SeekFrom::Start(offset))?;
        Ok(Self {
            file,
            bytes: Vec::new(),
            begin: 0,
            end: 0,
            offset,
        })
    }

    /// Returns the file offset of the next byte.
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// The next `count` bytes, which stay next; fewer at the end of the file. Precondition: the caller has checked
    /// `count`, as memory is taken for it.
    pub(super) fn peek(&mut self, count: usize) -> io::Result<&[u8]> {
        if self.end - self.begin < count {
            self.fill(count)?;
        }
        let end = self.end.min(self.begin + count);
        Ok(&self.bytes[self.begin..end])
    }

    fn fill(&mut self, count: usize) -> io::Result<()> {
        self.bytes.copy_within(self.begin..self.end, 0);
        self.end -= self.begin;
        self.begin = 0;
        let length = count.max(PIECE_BYTES);
        if self.bytes.len() < length {
            self.bytes.resize(length, 0);
        }
        while self.end < count {
            match self.file.read(&mut self.bytes[self.end..]) {
                Ok(0) => break,
                Ok(read) => self.end += read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Goes over the next `count` bytes, of those that were peeked at.
    pub(super) fn take(&mut self, count: usize) {
        let begin = self.begin;
        self.begin = self.end.min(begin + count);
        self.offset += (self.begin - begin) as u64;
    }

    /// The `count` bytes that were taken last, until more is peeked at.
    pub(super) fn taken(&self, count: usize) -> &[u8] {
        &self.bytes[self.begin.saturating_sub(count)..self.begin]
    }

    /// Goes over the next `count` bytes, whether they are in memory or not.
    pub(super) fn skip(&mut self, count: u64) -> io::Result<()> {
        let there = (self.end - self.begin) as u64;
        if count <= there {
            self.begin += count as usize;
        } else {
            let beyond = i64::try_from(count - there).map_err(io::Error::other)?;
            self.file.seek_relative(beyond)?;
            self.begin = 0;
            self.end = 0;
        }
        self.offset += count;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_delivered_once_and_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bytes");
        let bytes: Vec<u8> = (0..3 * PIECE_BYTES).map(|index| (index % 251) as u8).collect();
        std::fs::write(&path, &bytes).unwrap();
        let mut window = Window::at(File::open(&path).unwrap(), 7).unwrap();
        let mut at = 7;
        for count in [1, 100_000, PIECE_BYTES, PIECE_BYTES / 2 + 3, 5, PIECE_BYTES] {
            let there = count.min(bytes.len() - at);
            assert_eq!(window.peek(count).unwrap(), &bytes[at..at + there]);
            window.take(count);
            assert_eq!(window.taken(there), &bytes[at..at + there]);
            at += there;
            assert_eq!(window.offset(), at as u64);
            window.skip(11).unwrap();
            at += 11;
            if at >= bytes.len() {
                assert!(window.peek(1).unwrap().is_empty());
                break;
            }
        }
        let mut window = Window::at(File::open(&path).unwrap(), 0).unwrap();
        window.peek(3).unwrap();
        window.skip(2 * PIECE_BYTES as u64 + 17).unwrap();
        assert_eq!(
            window.peek(2).unwrap(),
            &bytes[2 * PIECE_BYTES + 17..2 * PIECE_BYTES + 19]
        );
    }
}
