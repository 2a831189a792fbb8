//! Files, folders that may grow, patterns, and files that hold many frames.

mod companions;
mod discover;
mod recording;
mod refusal;
mod stamps;

pub(super) use discover::number;
pub use recording::Recording;
pub(super) use recording::topics_of;

use super::{DecodeFailure, Decoder, FrameBytes, FrameEntry, FrameSample, OpenOptions, SequenceError, Source};
use crate::cloud::RawCloud;
use crate::io::normals::read_with_normals;
use crate::io::{self, Part, ReadOptions, SharedFile};
use crate::locks::{lock, read, write};
use crate::progress::Progress;
use companions::Known;
use discover::Discovered;
use std::collections::HashMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, RwLock};
use std::time::Duration;

/// Frames in files. Folders and patterns are looked at again.
#[derive(Debug)]
pub struct Files {
    entries: RwLock<Vec<Arc<FrameEntry>>>,
    inputs: Vec<PathBuf>,
    options: OpenOptions,
    recordings: Vec<Recording>,
    notes: Vec<String>,
    /// What was found out about files beside the frames.
    known: Mutex<Known>,
    shared: Arc<SharedFile>,
}

impl Files {
    /// Finds the frames of `inputs`: folders, glob patterns and files in any mix, in natural number order. `progress`
    /// counts the files that were looked at, and may be cancelled.
    ///
    /// Nothing is read but folders and the lists of contents of files that hold many frames. See [`SequenceError`] for
    /// what can be wrong.
    pub fn open(inputs: &[PathBuf], options: &OpenOptions, progress: &Progress) -> Result<Self, SequenceError> {
        let mut known = Known::default();
        let found = discover::discover(inputs, options, &mut known, progress)?;
        let Discovered {
            entries,
            recordings,
            notes,
        } = found;
        if options.topic.is_none() {
            recording::warn_of_unread(&recordings);
        }
        Ok(Self {
            entries: RwLock::new(entries.into_iter().map(Arc::new).collect()),
            inputs: inputs.to_vec(),
            options: options.clone(),
            recordings,
            notes,
            known: Mutex::new(known),
            shared: Arc::default(),
        })
    }

    fn decoder_with(&self, options: ReadOptions) -> Box<dyn Decoder> {
        let shared = Arc::clone(&self.shared);
        Box::new(move |entry: &FrameEntry, progress: &Progress| decode(entry, &options, &shared, progress))
    }
}

impl Source for Files {
    fn frames(&self) -> Range<usize> {
        0..read(&self.entries).len()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::clone(&read(&self.entries)[index])
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        self.decoder_with(self.options.read)
    }

    fn mesh_decoder(&self) -> Box<dyn Decoder> {
        self.decoder_with(self.options.read.of_meshes())
    }

    fn sample(
        &self,
        index: usize,
        most_points: usize,
        fewest_points: usize,
    ) -> Result<Option<FrameSample>, DecodeFailure> {
        /// A disk that has to look for every point of a sample would take longer for them than for all: then there is
        /// none.
        const MOST_TIME: Duration = Duration::from_secs(1);
        let entry = self.entry(index);
        match (&entry.content, &entry.normals) {
            (FrameBytes::File(Part::Whole), None) => {
                let sample = io::read_sample(&entry.path, most_points, fewest_points, MOST_TIME)?;
                Ok(sample.map(|(cloud, points)| (cloud.into(), points)))
            }
            _ => Ok(None),
        }
    }

    /// Whether a folder or a pattern is open, not only files.
    fn may_grow(&self) -> bool {
        self.inputs.iter().any(|input| !input.is_file())
    }

    /// Looks at the inputs again. What came between others is left out: frames keep their places. Files that are still
    /// being written are left for the next time. Normals that came beside a frame are read with it from then on.
    fn look_again(&self) -> Result<usize, SequenceError> {
        let never = Progress::default();
        let mut known = lock(&self.known);
        let found = discover::discover(&self.inputs, &self.options, &mut known, &never)?.entries;
        drop(known);
        let mut entries = write(&self.entries);
        let is_last = |entry: &FrameEntry| {
            let last = entries.last();
            last.is_some_and(|last| last.path == entry.path && last.content == entry.content)
        };
        let Some(last) = found.iter().rposition(is_last) else {
            return Ok(0);
        };
        let mut found = found.into_iter();
        join_late_normals(&mut entries, found.by_ref().take(last + 1));
        let count_before = entries.len();
        for entry in found {
            let before = entries.last();
            let expects_normals = before.is_some_and(|before| before.normals.is_some());
            if !discover::is_written(&entry, expects_normals) {
                break;
            }
            entries.push(Arc::new(entry));
        }
        Ok(entries.len() - count_before)
    }

    fn inputs(&self) -> &[PathBuf] {
        &self.inputs
    }

    fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }
}

/// Reads a frame of a file, or bytes in the program.
pub(super) fn decode(
    entry: &FrameEntry,
    options: &ReadOptions,
    shared: &SharedFile,
    progress: &Progress,
) -> Result<RawCloud, DecodeFailure> {
    let path = &entry.path;
    Ok(match (&entry.content, &entry.normals) {
        (FrameBytes::File(Part::Whole), Some(normals)) => read_with_normals(path, normals, options, progress)?,
        (FrameBytes::File(part), _) => shared.read_part(path, part, options, progress)?,
        (FrameBytes::Embedded(bytes), _) => io::read_bytes(path, bytes)?,
    })
}

/// Gives the frames in `entries` the normals that `found` has beside the same files by now.
fn join_late_normals(entries: &mut [Arc<FrameEntry>], found: impl Iterator<Item = FrameEntry>) {
    let with_normals = found.filter(|entry| entry.normals.is_some());
    let late: HashMap<PathBuf, FrameEntry> = with_normals.map(|entry| (entry.path.clone(), entry)).collect();
    for entry in entries.iter_mut().filter(|entry| entry.normals.is_none()) {
        if let Some(found) = late.get(&entry.path)
            && discover::is_written(found, false)
        {
            *entry = Arc::new(FrameEntry {
                normals: found.normals.clone(),
                ..FrameEntry::clone(entry)
            });
        }
    }
}
