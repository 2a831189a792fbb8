//! Bytes that are counted as they are read, until cancelled.

use crate::io::error::IoError;
use crate::progress::Progress;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// Chunk size that is read between two cancellation checks.
const PIECE_BYTES: u64 = 8 << 20;

/// A reader that tells how much was read of it, and fails once that is cancelled.
#[derive(Debug)]
pub(in crate::io) struct Watched<'a, R> {
    pub(in crate::io) reader: R,
    pub(in crate::io) progress: &'a Progress,
}

impl<R: Read> Read for Watched<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.progress.is_cancelled() {
            return Err(cancelled());
        }
        let count = self.reader.read(buffer)?;
        self.progress.advance(count);
        Ok(count)
    }
}

impl<R: Seek> Seek for Watched<'_, R> {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.reader.seek(place)
    }
}

/// All bytes of the file at `path`, in one allocation of its length.
///
/// # Errors
/// A file that cannot be read, and one of more than `max_bytes`: a sparse file takes no disk, and all of that memory.
pub(in crate::io) fn read_file(path: &Path, max_bytes: u64, progress: &Progress) -> Result<Vec<u8>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let mut file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    if length > max_bytes {
        return Err(IoError::TooLarge {
            path: path.to_owned(),
            length,
            allowed: max_bytes,
        });
    }
    read_opened(&mut file, length, progress).map_err(failed)
}

fn read_opened(file: &mut File, length: u64, progress: &Progress) -> io::Result<Vec<u8>> {
    let length = usize::try_from(length).map_err(io::Error::other)?;
    let mut bytes = Vec::new();
    crate::memory::try_reserve(&mut bytes, length)?;
    progress.set(0, length);
    while file.by_ref().take(PIECE_BYTES).read_to_end(&mut bytes)? > 0 {
        if progress.is_cancelled() {
            return Err(cancelled());
        }
        progress.set(bytes.len(), length);
    }
    progress.set(0, 0);
    Ok(bytes)
}

/// Returns the error of a cancelled read, which is never reported.
pub(in crate::io) fn cancelled() -> io::Error {
    io::Error::other("cancelled")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_counted_until_cancelled() {
        let progress = Progress::default();
        progress.set(0, 10);
        let mut watched = Watched {
            reader: io::Cursor::new([7; 10]),
            progress: &progress,
        };
        let mut piece = [0; 4];
        for (read, done) in [(4, 4), (4, 8), (2, 10), (0, 10)] {
            assert_eq!(watched.read(&mut piece).unwrap(), read);
            assert_eq!(progress.done(), done);
        }
        watched.rewind().unwrap();
        progress.cancel();
        assert!(watched.read(&mut piece).is_err());
        assert_eq!(progress.done(), 10);
    }
}
