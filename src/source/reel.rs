//! Sequence files ([`crate::reel`]): all frames in one file, each of them by levels.

use super::files::number;
use super::http::HttpFile;
use super::opener::{Name, One};
use super::{About, Capabilities, Groups, Growth, Samples, SequenceError, Source};
use super::{DecodeFailure, DecodedFrame, DecodedLevel, Decoder, FrameEntry, FrameSample, OpenOptions};
use crate::deadlines::ClientDeadlines;
use crate::io::ReadOptions;
use crate::locks::{lock, read, write};
use crate::printable;
use crate::progress::Progress;
use crate::reel::{MAGIC, ReadAt, ReelDecoder, ReelError, ReelFile};
use crate::regular_file;
use std::io::Read as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, RwLock};

/// Frames of one sequence file, which may still be written.
#[derive(Debug)]
pub struct Reel {
    shared: Arc<Shared>,
    inputs: [PathBuf; 1],
    notes: Vec<String>,
    /// Held while checking for more frames.
    looking: Mutex<()>,
    /// True if it is embedded in the program.
    is_embedded: bool,
}

/// State shared between the decoders and the source.
#[derive(Debug)]
struct Shared {
    opened: RwLock<Opened>,
    max_memory_bytes: u64,
}

/// The file at the last check.
#[derive(Debug)]
struct Opened {
    file: Arc<ReelFile>,
    entries: Vec<Arc<FrameEntry>>,
}

/// Before an address on the web; the latter is refused in a sentence.
const HTTP: Name = Name::Scheme("http://");
const HTTPS: Name = Name::Scheme("https://");

/// A sequence file, here or on the web.
pub(super) const FILE_OR_ADDRESS: One = One {
    names: &[HTTP, HTTPS, Name::File("reel", Reel::is_one)],
    open: |input, asked| Ok(Arc::new(Reel::open(input, asked.options)?)),
    sidecar_others: Some(|input| SequenceError::NotAlone { path: input.to_owned() }),
};

impl Reel {
    /// Returns true if the file at `path` begins with the signature of a sequence file.
    fn is_one(path: &Path) -> bool {
        let mut begin = [0; MAGIC.len()];
        let read = regular_file::open(path).and_then(|mut file| file.read_exact(&mut begin));
        read.is_ok() && begin == MAGIC
    }

    /// Returns true if `input` is a web address.
    fn is_url(input: &Path) -> bool {
        [HTTP, HTTPS].iter().any(|scheme| scheme.address(input).is_some())
    }

    /// The frames of the file at `path`, or at an `http://` address: its index is read, or its groups where it has
    /// none.
    ///
    /// # Errors
    /// [`SequenceError::Reel`].
    pub fn open(path: &Path, options: &OpenOptions) -> Result<Self, SequenceError> {
        let opened = match path.to_str().filter(|_| Self::is_url(path)) {
            Some(url) => Opened::on_web(path, url, options.max_bits_per_s),
            None => Opened::at(path),
        };
        let opened = opened.and_then(|opened| {
            let is_waited_for = options.waits_for_first && !Self::is_url(path);
            if opened.entries.is_empty() && !is_waited_for {
                return Err(ReelError::NoFrames {
                    path: path.to_owned(),
                    damage: opened.file.damage().first().cloned(),
                });
            }
            Ok(opened)
        });
        let opened = opened.map_err(|reason| SequenceError::Reel(Box::new(reason)))?;
        Ok(Self {
            notes: opened.file.damage().to_vec(),
            inputs: [path.to_owned()],
            looking: Mutex::default(),
            shared: Arc::new(Shared {
                opened: RwLock::new(opened),
                max_memory_bytes: options.read.max_memory_bytes,
            }),
            is_embedded: false,
        })
    }

    /// The frames of a file in the program, which has this name.
    pub(super) fn embedded(name: &str, bytes: &'static [u8]) -> Result<Self, ReelError> {
        let path = PathBuf::from(name);
        let opened = Opened::of(Arc::new(Arc::<[u8]>::from(bytes)), &path)?;
        Ok(Self {
            notes: Vec::new(),
            inputs: [path],
            looking: Mutex::default(),
            shared: Arc::new(Shared {
                opened: RwLock::new(opened),
                max_memory_bytes: ReadOptions::default().max_memory_bytes,
            }),
            is_embedded: true,
        })
    }

    fn file(&self) -> Arc<ReelFile> {
        self.shared.file()
    }
}

impl Shared {
    fn file(&self) -> Arc<ReelFile> {
        Arc::clone(&read(&self.opened).file)
    }
}

impl Opened {
    fn at(path: &Path) -> Result<Self, ReelError> {
        let file = regular_file::open(path).map_err(open_error(path))?;
        Self::of(Arc::new(file), path)
    }

    /// Without a group that is just being written.
    fn whole_at(path: &Path) -> Result<Self, ReelError> {
        let file = regular_file::open(path).map_err(open_error(path))?;
        Ok(Self::of_file(
            ReelFile::open(Arc::new(file), path)?.whole_groups(),
            path,
        ))
    }

    fn on_web(path: &Path, url: &str, max_bits_per_s: Option<f64>) -> Result<Self, ReelError> {
        let file = if url.starts_with("https:") {
            Err(std::io::Error::other("https:// is not read, only http:// is"))
        } else {
            HttpFile::open(url, max_bits_per_s, ClientDeadlines::default())
        };
        Self::of(Arc::new(file.map_err(open_error(path))?), path)
    }

    fn of(bytes: Arc<dyn ReadAt>, path: &Path) -> Result<Self, ReelError> {
        Ok(Self::of_file(ReelFile::open(bytes, path)?, path))
    }

    fn of_file(file: ReelFile, path: &Path) -> Self {
        let of_file = FrameEntry::file(path);
        let frames = (0..file.frame_count()).filter_map(|index| file.frame(index));
        let mut entries: Vec<FrameEntry> = frames
            .map(|frame| FrameEntry {
                name: printable::name(frame.name.to_owned()),
                time: frame.time,
                ..of_file.clone()
            })
            .collect();
        number(&mut entries);
        for entry in &mut entries {
            entry.name = format!("{}: {}", of_file.name, entry.name);
        }
        Self {
            file: Arc::new(file),
            entries: entries.into_iter().map(Arc::new).collect(),
        }
    }
}

fn open_error(path: &Path) -> impl Fn(std::io::Error) -> ReelError {
    move |source| ReelError::Io {
        path: path.to_owned(),
        byte: 0,
        source,
    }
}

impl Source for Reel {
    fn frames(&self) -> Range<usize> {
        0..read(&self.shared.opened).entries.len()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::clone(&read(&self.shared.opened).entries[index])
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(FileDecoder {
            decoder: ReelDecoder::new(self.file(), self.shared.max_memory_bytes),
            shared: Arc::clone(&self.shared),
        })
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: &self.inputs,
            fps: self.file().fps(),
            reel: Some(self.file()),
            notes: &self.notes,
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            groups: Some(self),
            samples: Some(self),
            growth: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Groups for Reel {
    fn group(&self, index: usize) -> Range<usize> {
        self.file().run_of(index)
    }
}

impl Samples for Reel {
    fn sample(&self, index: usize, max_points: usize, min_points: usize) -> Result<Option<FrameSample>, DecodeFailure> {
        let points = self.file().frame(index).map_or(0, |frame| frame.points);
        if points < min_points {
            return Ok(None);
        }
        let sample = self
            .decoder()
            .decode(index, &self.entry(index), max_points, &Progress::default())?;
        Ok(Some((sample, points)))
    }
}

impl Growth for Reel {
    /// A scanner may write while others read.
    fn may_grow(&self) -> bool {
        let [path] = &self.inputs;
        !self.is_embedded && !Self::is_url(path)
    }

    fn is_live(&self) -> bool {
        false
    }

    fn look_again(&self) -> Result<usize, SequenceError> {
        let _turn = lock(&self.looking);
        let before = self.file();
        let [path] = &self.inputs;
        if !self.may_grow() {
            return Ok(0);
        }
        let has_changed = || Some(std::fs::metadata(path).ok()?.len() != before.byte_size());
        if !has_changed().unwrap_or(false) {
            return Ok(0);
        }
        // A file that is just being rewritten is left for the next time.
        let Ok(now) = Opened::whole_at(path) else {
            return Ok(0);
        };
        let more = now.entries.len().saturating_sub(before.frame_count());
        let is_mended = before.is_cut() && now.entries.len() >= before.frame_count();
        if more > 0 || is_mended {
            *write(&self.shared.opened) = now;
        }
        Ok(more)
    }
}

/// Decodes frames of the file as it is now.
struct FileDecoder {
    decoder: ReelDecoder,
    shared: Arc<Shared>,
}

impl Decoder for FileDecoder {
    fn decode(
        &mut self,
        index: usize,
        _entry: &FrameEntry,
        max_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let file = self.shared.file();
        if index >= self.decoder.file().frame_count() {
            self.decoder = ReelDecoder::new(Arc::clone(&file), self.shared.max_memory_bytes);
        }
        let decoded = self.decoder.decode(index, max_points, progress)?;
        let points = decoded.cloud.positions.len();
        let levels = file.frame(index).map_or(&[][..], |frame| frame.level_points);
        let finer = levels.iter().copied().find(|&finer| finer > points);
        Ok(DecodedFrame {
            level: Some(DecodedLevel {
                points_in_frame: decoded.points_in_frame,
                points_of_finer: finer.filter(|_| !decoded.is_whole).unwrap_or(usize::MAX),
            }),
            cloud: decoded.cloud,
        })
    }
}
