//! Recorder that writes incoming data to a file.
//!
//! The file gets its name with its first frame, so that an existing recording is not lost to a stream that sends
//! nothing. From then on it is a valid recording at any time: each frame is handed to the system at once, and any end
//! of the program leaves the frames before.
//!
//! The file has the bytes of the stream: a head, and the messages that are frames. So nothing is unpacked, packed or
//! lost on the way, filters can be chosen later, and a truncated recording is read up to its end. A sequence file
//! (`.reel`) would have prepared points instead of images, coded while frames come; `pointreel convert` makes one of a
//! recording afterwards.

use crate::persist::Partial;
use crate::regular_file;
use crate::wire::{MAGIC, Message, StreamHead};
use std::fs::File;
use std::io::{self, BufWriter, Read as _, Write as _};
use std::path::{Path, PathBuf};

/// Returns true if the file at `path` begins with the signature of a recording.
pub(super) fn is_recording(path: &Path) -> bool {
    let mut begin = [0; MAGIC.len()];
    let read = regular_file::open(path).and_then(|mut file| file.read_exact(&mut begin));
    read.is_ok() && begin == MAGIC
}

/// Summary of the recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StreamRecording {
    /// The file.
    pub path: PathBuf,
    /// Frames in it.
    pub frames: u64,
    /// Its size.
    pub bytes: u64,
}

/// A file that is written.
#[derive(Debug)]
pub(super) struct Recorder {
    file: BufWriter<File>,
    /// The file until it has a frame.
    hidden: Option<Partial>,
    written: StreamRecording,
}

impl Recorder {
    /// Creates a new file at `path` for a stream with this head, replacing any recording that exists there.
    pub(super) fn create(path: &Path, head: &StreamHead) -> io::Result<Self> {
        let has_bytes = path.metadata().is_ok_and(|there| !there.is_file() || there.len() > 0);
        if has_bytes && !is_recording(path) {
            return Err(io::Error::other("it already exists and is not a recording of a stream"));
        }
        let (hidden, file) = Partial::create(path)?;
        let mut file = BufWriter::with_capacity(1 << 16, file);
        let head = head.encode();
        file.write_all(&head)?;
        Ok(Self {
            file,
            hidden: Some(hidden),
            written: StreamRecording {
                path: path.to_owned(),
                frames: 0,
                bytes: head.len() as u64,
            },
        })
    }

    /// Writes a frame.
    pub(super) fn add(&mut self, message: &Message) -> io::Result<()> {
        let header = message.header();
        self.file.write_all(&header)?;
        self.file.write_all(&message.payload)?;
        self.file.flush()?;
        if let Some(hidden) = self.hidden.take() {
            hidden.finish()?;
        }
        self.written.frames += 1;
        self.written.bytes += (header.len() + message.payload.len()) as u64;
        Ok(())
    }

    pub(super) fn written(&self) -> &StreamRecording {
        &self.written
    }

    /// Writes the rest. Without a frame it replaces no other recording.
    pub(super) fn finish(mut self) -> io::Result<StreamRecording> {
        self.file.flush()?;
        if let Some(hidden) = self.hidden.take()
            && !self.written.path.exists()
        {
            hidden.finish()?;
        }
        self.file.get_ref().sync_data()?;
        Ok(self.written)
    }
}
