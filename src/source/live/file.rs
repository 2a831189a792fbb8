//! Recording of a live stream: a file with the bytes of the stream.
//!
//! The message heads are walked over once, 44 bytes per frame; a frame then reads its own part of the file. A truncated
//! file, such as one whose writer was terminated, has the frames that are complete.

use super::decoder::{FrameStore, StreamDecoder, group, has_images, raw_images, sensor};
use super::recorder::is_recording;
use super::timeline::Timeline;
use crate::io::files::long_walk::LongWalk;
use crate::locks::lock;
use crate::regular_file;
use crate::rgbd::{Filters, Sensor};
use crate::source::opener::{Name, One};
use crate::source::rgbd::ReceivedFrames;
use crate::source::{
    About, Capabilities, DecodeFailure, Decoder, DepthImages, FrameEntry, Groups, OpenOptions, SequenceError, Source,
};
use crate::wire::{
    FRAME_HEAD_BYTES, Frame, FrameHead, Kind, MESSAGE_HEADER_BYTES, MessageHeader, RawImages, StreamHead, WireError,
    read_message,
};
use std::fs::File;
use std::io::{BufReader, Read as _, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Frames of a recording of a live stream.
#[derive(Debug)]
pub struct RecordedStream {
    recorded: Arc<Recorded>,
    entries: Vec<Arc<FrameEntry>>,
    inputs: [PathBuf; 1],
    notes: Vec<String>,
    fps: f64,
    /// True if frames consist of images, as the first one does.
    has_images: bool,
    received: Arc<ReceivedFrames>,
}

/// State shared by the decoders.
#[derive(Debug)]
struct Recorded {
    file: Mutex<File>,
    /// Byte offset of the message of each frame.
    offsets: Vec<u64>,
    max_bytes: u64,
}

/// A file that a stream was recorded to.
pub(in crate::source) const RECORDING: One = One {
    names: &[Name::File("pointreel-stream", is_recording)],
    open: |input, asked| Ok(Arc::new(RecordedStream::open(input, asked.options)?)),
    sidecar_others: None,
};

impl RecordedStream {
    /// The frames of the file at `path`.
    ///
    /// # Errors
    /// [`SequenceError::Stream`].
    pub fn open(path: &Path, options: &OpenOptions) -> Result<Self, SequenceError> {
        let failed = |problem: String| SequenceError::Stream {
            input: path.display().to_string(),
            problem,
        };
        let unreadable = |error| failed(format!("it cannot be read ({error}): check its permissions"));
        let file = regular_file::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let walked = Walked::over(BufReader::new(file), length, path).map_err(|error| failed(error.to_string()))?;
        if walked.frames.is_empty() {
            return Err(failed("it has no whole frame: record the stream again".to_owned()));
        }
        let entry = |&(_, head, time): &(u64, FrameHead, Duration)| {
            let mut entry = FrameEntry::embedded(path, &[]);
            entry.name = format!("{}: {}", entry.name, head.number);
            entry.number = Some(head.number);
            entry.time = Some(time);
            Arc::new(entry)
        };
        let recorded = Recorded {
            file: Mutex::new(regular_file::open(path).map_err(unreadable)?),
            offsets: walked.frames.iter().map(|(offset, ..)| *offset).collect(),
            max_bytes: options.read.max_memory_bytes,
        };
        Ok(Self {
            entries: walked.frames.iter().map(entry).collect(),
            inputs: [path.to_owned()],
            notes: walked.notes(path),
            fps: walked.head.fps,
            has_images: recorded.frame(0).is_ok_and(|frame| has_images(&frame)),
            recorded: Arc::new(recorded),
            received: Arc::new(ReceivedFrames::new(path, options)),
        })
    }
}

/// Result of a walk over the messages.
struct Walked {
    head: StreamHead,
    /// Offset, head and time of each frame.
    frames: Vec<(u64, FrameHead, Duration)>,
    /// The position and the reason, if the walk ended before the end of the file.
    damage: Option<(u64, WireError)>,
}

impl Walked {
    fn over(mut file: BufReader<File>, length: u64, path: &Path) -> Result<Self, WireError> {
        let head = StreamHead::read(&mut file)?;
        let mut walked = Self {
            head,
            frames: Vec::new(),
            damage: None,
        };
        let mut timeline = Timeline::default();
        let spacing = Duration::try_from_secs_f64(head.fps.recip()).unwrap_or_default();
        let mut offset = file.stream_position().map_err(WireError::Io)?;
        let mut long = LongWalk::new(path, length);
        loop {
            long.step(offset);
            match next(&mut file, offset, length) {
                Ok(None) => return Ok(walked),
                Ok(Some((frame, end))) => {
                    if let Some(frame) = frame {
                        // A restarted server counts from the beginning, which the times reveal.
                        let time = timeline.next(head.session, frame.time_ns, spacing);
                        walked.frames.push((offset, frame, time));
                    }
                    offset = end;
                }
                Err(error) => {
                    walked.damage = Some((offset, error));
                    return Ok(walked);
                }
            }
        }
    }

    fn notes(&self, path: &Path) -> Vec<String> {
        let note = self.damage.as_ref().map(|(offset, error)| {
            format!(
                "{}, byte {offset}: {error}; the {} frames before it are read",
                path.display(),
                self.frames.len()
            )
        });
        note.into_iter().collect()
    }
}

/// The frame in the message at `offset`, if it is one, and where the message ends.
fn next(file: &mut BufReader<File>, offset: u64, length: u64) -> Result<Option<(Option<FrameHead>, u64)>, WireError> {
    let Some(header) = MessageHeader::read(file)? else {
        return Ok(None);
    };
    // Zeros have the right length and checksum, and a sparse file may contain terabytes of them.
    if header.kind == Kind::Other(0) {
        return Err(WireError::Malformed {
            what: "the file",
            reason: "a message is of kind 0, which there is none of".to_owned(),
        });
    }
    let begin = offset + MESSAGE_HEADER_BYTES as u64;
    let end = begin + u64::from(header.payload_bytes);
    if end > length {
        return Err(WireError::IsTruncated { within: "a message" });
    }
    let mut head = None;
    let mut at = begin;
    if header.kind.is_frame() {
        let mut bytes = Vec::with_capacity(FRAME_HEAD_BYTES);
        let wanted = FRAME_HEAD_BYTES as u64;
        let read = file
            .take(wanted.min(u64::from(header.payload_bytes)))
            .read_to_end(&mut bytes);
        at += read.map_err(WireError::Io)? as u64;
        head = Some(FrameHead::parse_begin(&bytes)?.0);
    }
    // Within the buffer where possible: a seek would discard it.
    file.seek_relative((end - at) as i64).map_err(WireError::Io)?;
    Ok(Some((head, end)))
}

impl FrameStore for Recorded {
    fn frame(&self, index: usize) -> Result<Frame, String> {
        let offset = *self.offsets.get(index).ok_or("it is not in the file")?;
        let mut file = lock(&self.file);
        let read = file
            .seek(SeekFrom::Start(offset))
            .map_err(WireError::Io)
            .and_then(|_| read_message(&mut *file, self.max_bytes));
        drop(file);
        let frame = read
            .and_then(Frame::of)
            .map_err(|error| format!("byte {offset}: {error}"))?;
        frame.ok_or_else(|| format!("byte {offset}: it is not a frame any more"))
    }
}

impl Source for RecordedStream {
    fn frames(&self) -> Range<usize> {
        0..self.entries.len()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::clone(&self.entries[index])
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        let store = Arc::clone(&self.recorded);
        Box::new(StreamDecoder::new(store, Arc::clone(&self.received)))
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: &self.inputs,
            fps: Some(self.fps),
            notes: &self.notes,
            // It has no other notes.
            damage: &self.notes,
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            groups: Some(self),
            depth_images: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Groups for RecordedStream {
    fn group(&self, index: usize) -> Range<usize> {
        group(&self.received, index, &self.frames())
    }
}

impl DepthImages for RecordedStream {
    fn sensor(&self, index: usize) -> Option<Sensor> {
        sensor(&self.recorded.frame(index).ok()?)
    }

    fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        let frame = self.recorded.frame(index).map_err(DecodeFailure::from);
        match frame {
            Ok(frame) => raw_images(&frame, self.recorded.max_bytes),
            Err(error) => Some(Err(error)),
        }
    }

    fn filters(&self) -> Option<Filters> {
        self.has_images.then_some(self.received.filters)
    }

    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        self.filters()?;
        Some(Arc::new(Self {
            recorded: Arc::clone(&self.recorded),
            entries: self.entries.clone(),
            inputs: self.inputs.clone(),
            // They were reported already.
            notes: Vec::new(),
            fps: self.fps,
            has_images: self.has_images,
            received: Arc::new(self.received.filtered(filters)),
        }))
    }
}
