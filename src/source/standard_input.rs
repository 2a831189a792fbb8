//! Standard input (`-`): data that another program writes to a pipe, as in `zcat scan.ply.gz | pointreel -`.
//!
//! How it works: all of it is written to a temporary file, up to its end, which is then opened like any other: readers
//! seek back and forth in files, a pipe is gone once it is read, and inputs are opened again if other options are
//! chosen. The first bytes identify the format; text without them is rows of points.

use super::opener::{Asked, Name, One, Opened};
use super::{About, Capabilities, DecodeFailure, Decoder, DepthImages, FrameEntry, SequenceError, Source};
use crate::io::Format;
use crate::locks::lock;
use crate::progress::Progress;
use crate::rgbd::{Filters, Sensor};
use crate::temporary::Temporary;
use crate::waiting::Waiting;
use crate::wire::RawImages;
use std::fs::{DirBuilder, File};
use std::io::{self, IsTerminal as _, Read, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// The word for it.
const WORD: &str = "-";

/// Standard input.
pub(super) const STANDARD_INPUT: One = One {
    names: &[Name::Word(WORD)],
    open: |_, asked| StandardInput::open(asked),
    sidecar_others: Some(|_| failed("it is a sequence of its own: open it without other inputs".to_owned())),
};

/// Number of folder names tried before the system is taken to have no space for one.
const MAX_FOLDERS: u32 = 100;

/// Bytes that are read at a time.
const BLOCK: usize = 1 << 16;

/// Data received from standard input, stored as long as the program runs.
static RECEIVED: Mutex<Option<Received>> = Mutex::new(None);

#[derive(Debug)]
struct Received {
    file: PathBuf,
    _folder: Temporary,
}

/// Contents of standard input.
struct StandardInput {
    source: Arc<dyn Source>,
    inputs: [PathBuf; 1],
}

impl StandardInput {
    fn open(asked: Asked<'_>) -> Opened {
        let mut received = lock(&RECEIVED);
        let file = match &*received {
            Some(received) => received.file.clone(),
            None if io::stdin().is_terminal() => {
                let problem = "nothing is written to it: pipe a file into it, as in `zcat scan.ply.gz | pointreel -`";
                return Err(failed(problem.to_owned()));
            }
            None => {
                let _waiting = Waiting::for_("the end of standard input");
                let new = receive(io::stdin().lock(), asked.progress)?;
                received.insert(new).file.clone()
            }
        };
        drop(received);
        let inputs = [file];
        let as_file = Asked {
            inputs: &inputs,
            ..asked
        };
        Ok(Arc::new(Self::of(as_file.open()?)))
    }

    fn of(source: Arc<dyn Source>) -> Self {
        Self {
            source,
            inputs: [WORD.into()],
        }
    }
}

fn failed(problem: String) -> SequenceError {
    SequenceError::Stream {
        input: "standard input".to_owned(),
        problem,
    }
}

/// Writes all that `from` gives to a temporary file.
fn receive(mut from: impl Read, progress: &Progress) -> Result<Received, SequenceError> {
    let unread = |error: io::Error| failed(format!("it cannot be read ({error})"));
    let unwritten = |error: io::Error| failed(format!("it cannot be stored ({error}): free space for temporary files"));
    let mut head = Vec::new();
    from.by_ref()
        .take(Format::MAGIC_BYTES as u64)
        .read_to_end(&mut head)
        .map_err(unread)?;
    if head.is_empty() {
        let problem = "it is empty: look at the program that writes to it";
        return Err(failed(problem.to_owned()));
    }
    let folder = new_folder().map_err(unwritten)?;
    let path = folder.path().join(name_of(&head));
    let mut file = File::create_new(&path).map_err(unwritten)?;
    file.write_all(&head).map_err(unwritten)?;
    let mut block = vec![0; BLOCK];
    loop {
        if progress.is_cancelled() {
            return Err(SequenceError::Cancelled);
        }
        match from.read(&mut block) {
            Ok(0) => break,
            Ok(count) => file.write_all(&block[..count]).map_err(unwritten)?,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(unread(error)),
        }
    }
    Ok(Received {
        file: path,
        _folder: folder,
    })
}

/// A name with an extension only if bytes alone do not identify the format: rows of text.
fn name_of(head: &[u8]) -> &'static str {
    const NAME: &str = "standard-input";
    let is_binary = head.contains(&0) || Format::detect(Path::new(NAME), head).is_some();
    if is_binary { NAME } else { "standard-input.xyz" }
}

/// A new folder accessible to this user only.
fn new_folder() -> io::Result<Temporary> {
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    let mut number = 0;
    loop {
        let name = format!("pointreel-input-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        match builder.create(&path) {
            Ok(()) => return Ok(Temporary::folder_and_contents(&path)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && number < MAX_FOLDERS => number += 1,
            Err(error) => return Err(error),
        }
    }
}

impl Source for StandardInput {
    fn frames(&self) -> Range<usize> {
        self.source.frames()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        self.source.entry(index)
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        self.source.decoder()
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: &self.inputs,
            ..self.source.about()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        let all = self.source.capabilities();
        Capabilities {
            depth_images: all.depth_images.map(|_| self as &dyn DepthImages),
            ..all
        }
    }
}

/// Returns the capabilities of the file; other filters open standard input again.
impl DepthImages for StandardInput {
    fn sensor(&self, index: usize) -> Option<Sensor> {
        self.source.sensor(index)
    }

    fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        self.source.raw_images(index)
    }

    fn filters(&self) -> Option<Filters> {
        self.source.filters()
    }

    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        Some(Arc::new(Self::of(self.source.filtered(filters)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn received_data_is_a_file_until_dropped() {
        let received = receive(&b"ply\nformat ascii 1.0\n"[..], &Progress::default()).unwrap();
        let file = received.file.clone();
        assert_eq!(std::fs::read(&file).unwrap(), b"ply\nformat ascii 1.0\n");
        drop(received);
        assert!(!file.exists());
        let error = receive(&b""[..], &Progress::default()).unwrap_err().to_string();
        assert!(error.starts_with("standard input: it is empty"), "{error}");
    }

    #[test]
    fn rows_of_text_have_an_extension() {
        assert_eq!(name_of(b"1 2 3\n4 5 6\n"), "standard-input.xyz");
        for head in [&b"ply\n"[..], b"LASF", b"\x89live\r\n\x1a\0"] {
            assert_eq!(name_of(head), "standard-input");
        }
    }
}
