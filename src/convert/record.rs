//! Record of the options and inputs of a folder of converted frames, so that two conversions are never mixed in one
//! folder, and no foreign file is taken for a finished frame.
//!
//! **How it works.** The options of the conversion and its inputs are one hidden file ([`Record`]). Another one has one
//! line per written frame ([`Ledger`]): name, size, and the source file it was made from, with its state. A frame
//! counts as finished if a file of that name and size exists and its source is unchanged. The line is written before
//! the file gets its name: so even after an interrupt, a file without a line is not of this conversion. Each shard
//! appends to its own ledger; all of them are read.

use super::conversion::{Conversion, Output, Shard};
use super::error::ConvertError;
use crate::io::Part;
use crate::locks::lock;
use crate::sequence::{FrameEntry, Sequence};
use crate::source::FrameBytes;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf, absolute};
use std::sync::{Arc, Mutex};
use std::time::UNIX_EPOCH;

/// Name of the file in the folder.
const FILE_NAME: &str = ".pointreel-convert.json";

/// Prefix and suffix of the file names of ledgers.
const LEDGER_NAME: [&str; 2] = [".pointreel-convert.", ".jsonl"];

/// The lock file of the writer of the frames of `shard` to `folder`.
pub(super) fn lock_of(folder: &Path, shard: Shard) -> PathBuf {
    folder.join(format!(
        ".pointreel-convert.{}-of-{}.lock",
        shard.index + 1,
        shard.count
    ))
}

/// Inputs that are named one by one; of more, the number counts.
const MAX_INPUTS: usize = 16;

/// The options and inputs that a converted frame depends on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    format: String,
    edit: String,
    /// Description of how the inputs were read.
    #[serde(default)]
    reading: String,
    /// Topics of recordings that are read.
    #[serde(default)]
    topics: Vec<String>,
    /// Files with many frames, and the folders of others.
    #[serde(default)]
    inputs: Vec<String>,
}

impl Record {
    pub(super) fn of(conversion: &Conversion, sequence: &Sequence) -> Self {
        let mut topics = sequence.source().topics();
        topics.retain(|topic| topic.is_read);
        Self {
            topics: topics.into_iter().map(|topic| topic.name).collect(),
            format: match &conversion.output {
                Output::Reel(_, options) => format!("{options:?}"),
                Output::File(_) | Output::Folder(_) => conversion.format.to_string(),
            },
            edit: conversion.edit.to_string(),
            reading: conversion.reading.clone(),
            inputs: inputs_of(sequence),
        }
    }

    /// Returns the record as text, with a hash of the names and times of the frames that are read.
    pub(super) fn made_of(&self, frames: &[Arc<FrameEntry>]) -> String {
        let mut names = crc32fast::Hasher::new();
        for entry in frames {
            names.update(entry.name.as_bytes());
            names.update(&entry.time.map_or(0, |time| time.as_nanos()).to_le_bytes());
        }
        let options = serde_json::to_string(self).unwrap_or_default();
        format!("{} frames {:08x} {options}", frames.len(), names.finalize())
    }

    /// Reads the record that a conversion has left in `folder`.
    pub(super) fn read(folder: &Path) -> Option<Self> {
        let bytes = crate::regular_file::read(&folder.join(FILE_NAME)).ok()?;
        serde_json::from_slice(&bytes).ok()
    }

    /// Fails if another one is in `folder`.
    pub(super) fn check(&self, folder: &Path) -> Result<(), ConvertError> {
        match Self::read(folder) {
            Some(known) if known != *self => Err(ConvertError::OtherConversion {
                path: folder.to_owned(),
                difference: self.difference(&known),
            }),
            _ => Ok(()),
        }
    }

    /// Writes the record to `folder`, replacing any other. Several shards may do so at once: they write the same.
    pub(super) fn keep_in(&self, folder: &Path) -> Result<(), ConvertError> {
        if Self::read(folder).is_some_and(|known| known == *self) {
            return Ok(());
        }
        let path = folder.join(FILE_NAME);
        let text = serde_json::to_vec_pretty(self).unwrap_or_default();
        crate::persist::write_whole(&path, &text).map_err(|reason| ConvertError::Write { path, reason })
    }

    fn difference(&self, known: &Self) -> String {
        let listed = |what: &str, names: &[String]| match names {
            [] => format!("no {what}"),
            names => format!("{what} {}", names.join(", ")),
        };
        let (there, now) = if self.format != known.format {
            (known.format.clone(), self.format.clone())
        } else if self.edit != known.edit {
            (known.edit.clone(), self.edit.clone())
        } else if self.inputs != known.inputs {
            (listed("input", &known.inputs), listed("input", &self.inputs))
        } else if self.topics != known.topics {
            (listed("topic", &known.topics), listed("topic", &self.topics))
        } else {
            let reading = |text: &str| match text {
                "" => "read as by default".to_owned(),
                text => format!("read with {text}"),
            };
            (reading(&known.reading), reading(&self.reading))
        };
        format!("{there} there, {now} now")
    }

    /// The beginning of its SHA-256: every program computes the same.
    fn hash(&self) -> u64 {
        let text = serde_json::to_vec(self).unwrap_or_default();
        let digest = Sha256::digest(&text);
        digest
            .iter()
            .take(8)
            .fold(0, |hash, &byte| (hash << 8) | u64::from(byte))
    }
}

/// The files that hold several frames each and the folders of those that are a frame each, all once.
fn inputs_of(sequence: &Sequence) -> Vec<String> {
    let mut places: Vec<PathBuf> = Vec::new();
    for entry in sequence.entries() {
        let place = match (&entry.content, entry.path.parent()) {
            (FrameBytes::File(Part::Whole | Part::Sole), Some(folder)) if entry.path.is_file() => folder,
            _ => entry.path.as_path(),
        };
        // Files of one folder are consecutive.
        if places.last().is_none_or(|last| last != place) {
            places.push(place.to_owned());
        }
    }
    let mut places: Vec<String> = places.iter().map(|place| real(place).display().to_string()).collect();
    places.sort();
    places.dedup();
    if let Some(more) = places.len().checked_sub(MAX_INPUTS).filter(|&more| more > 0) {
        places.truncate(MAX_INPUTS);
        places.push(format!("{more} more"));
    }
    places
}

/// The one name of a file that has several, by links or relative to other folders.
pub(super) fn real(path: &Path) -> PathBuf {
    let path_or_here = if path.as_os_str().is_empty() {
        Path::new(".")
    } else {
        path
    };
    let found = path_or_here.canonicalize().or_else(|_| absolute(path_or_here));
    found.unwrap_or_else(|_| path.to_owned())
}

/// A frame that was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Line {
    file: String,
    bytes: u64,
    /// Hash of the record.
    record: u64,
    source: String,
    state: SourceState,
}

/// The state of a source file: another one, or none, means that it has changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct SourceState {
    bytes: u64,
    modified_ns: u64,
}

impl SourceState {
    /// Returns the state of all source files of a frame; zero where it has none.
    fn of(entry: &FrameEntry) -> Self {
        let files = std::iter::once(&entry.path).chain(&entry.normals);
        let mut state = Self {
            bytes: 0,
            modified_ns: 0,
        };
        for metadata in files.filter_map(|file| fs::metadata(file).ok()) {
            let modified = metadata.modified().ok();
            let since_1970 = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
            state.bytes = state.bytes.wrapping_add(metadata.len());
            let modified_ns = since_1970.map_or(0, |time| time.as_nanos() as u64);
            state.modified_ns = state.modified_ns.max(modified_ns);
        }
        state
    }
}

/// State of the output file of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FrameState {
    /// Nothing.
    Free,
    /// The frame, finished.
    Finished,
    /// The frame as it was before its source changed.
    Outdated,
    /// A file that this conversion has not written.
    Foreign,
}

/// The frames that were written to a folder.
#[derive(Debug)]
pub(super) struct Ledger {
    folder: PathBuf,
    record: u64,
    lines: HashMap<String, Vec<Line>>,
    /// The ledger of this shard, once it is open.
    file: Option<Mutex<File>>,
}

impl Ledger {
    /// Reads the ledgers of frames written to `folder` with `record`, by any shard.
    pub(super) fn read(folder: &Path, record: &Record) -> Self {
        let record = record.hash();
        let mut lines: HashMap<String, Vec<Line>> = HashMap::new();
        let files = folder.read_dir().into_iter().flatten().flatten();
        let [start, end] = LEDGER_NAME;
        for file in files {
            let name = file.file_name();
            let name = name.to_string_lossy();
            if !name.starts_with(start) || !name.ends_with(end) {
                continue;
            }
            let text = fs::read(file.path()).unwrap_or_default();
            // An interrupted process may have left half a line.
            let read = text.split(|&byte| byte == b'\n');
            for line in read.filter_map(|line| serde_json::from_slice::<Line>(line).ok()) {
                if line.record == record {
                    lines.entry(line.file.clone()).or_default().push(line);
                }
            }
        }
        Self {
            folder: folder.to_owned(),
            record,
            lines,
            file: None,
        }
    }

    /// Opens the one of `shard` to append to it.
    pub(super) fn open(&mut self, shard: Shard) -> Result<(), ConvertError> {
        let [start, end] = LEDGER_NAME;
        let path = self
            .folder
            .join(format!("{start}{}-of-{}{end}", shard.index + 1, shard.count));
        let file = File::options().append(true).create(true).open(&path);
        let file = file.map_err(|reason| ConvertError::Write { path, reason })?;
        self.file = Some(Mutex::new(file));
        Ok(())
    }

    /// Returns the state of the output file `name` for the frame of `entry`.
    pub(super) fn state(&self, name: &str, entry: &FrameEntry) -> FrameState {
        let Ok(metadata) = fs::symlink_metadata(self.folder.join(name)) else {
            return FrameState::Free;
        };
        let source = source_of(entry);
        let of_frame = |line: &&Line| line.bytes == metadata.len() && line.source == source;
        let known = self.lines.get(name).map_or(&[][..], Vec::as_slice);
        let mut ours = known.iter().filter(of_frame).peekable();
        if !metadata.is_file() || ours.peek().is_none() {
            return FrameState::Foreign;
        }
        let state = SourceState::of(entry);
        if ours.any(|line| line.state == state) {
            FrameState::Finished
        } else {
            FrameState::Outdated
        }
    }

    /// Notes that the frame of `entry`, whose source was in `state` before it was read, is `bytes` long and is about to
    /// be named `name`.
    pub(super) fn note(&self, name: &str, bytes: u64, entry: &FrameEntry, state: StateBefore) -> std::io::Result<()> {
        let line = Line {
            file: name.to_owned(),
            bytes,
            record: self.record,
            source: source_of(entry),
            state: state.0,
        };
        let Some(file) = &self.file else { return Ok(()) };
        // The leading newline completes a partial line of a process that was killed.
        let mut text = b"\n".to_vec();
        serde_json::to_writer(&mut text, &line)?;
        text.push(b'\n');
        lock(file).write_all(&text)
    }
}

/// The state of the files of a frame before they are read.
#[derive(Debug, Clone, Copy)]
pub(super) struct StateBefore(SourceState);

impl StateBefore {
    pub(super) fn of(entry: &FrameEntry) -> Self {
        Self(SourceState::of(entry))
    }
}

/// The frame's file, and its name in there.
fn source_of(entry: &FrameEntry) -> String {
    let file = real(&entry.path).display().to_string();
    let time = entry.time.map(|time| format!(" at {time:?}")).unwrap_or_default();
    match &entry.content {
        FrameBytes::File(Part::Whole | Part::Sole) => file,
        FrameBytes::File(part) => format!("{file}, {part:?}{time}"),
        FrameBytes::Embedded(_) => format!("{file}, {}", entry.name),
    }
}
