//! Files, folders that may grow, patterns, and files that hold many frames.

mod color_depth;
mod companions;
mod decode;
mod discover;
mod folder;
mod kinds;
mod looks;
mod names;
mod numbers;
mod nuscenes;
mod oxts;
mod poses;
mod recording;
mod refusal;
mod registered;
mod series;
mod times;

pub(super) use numbers::number;
pub use recording::Recording;
pub(super) use recording::topics_of;

use super::{
    About, Capabilities, DecodeFailure, Decoder, FrameBytes, FrameEntry, FrameSample, Growth, Meshes, OpenOptions,
    Samples, SequenceError, Source,
};
use crate::assumption::Assumption;
use crate::io::{self, Format, Part, ReadOptions, SharedFile};
use crate::locks::{lock, read, write};
use crate::progress::Progress;
use color_depth::SharedDepth;
use companions::Known;
use decode::{decode, placed};
use discover::Discovered;
use looks::Looks;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, RwLock};
use std::thread;
use std::time::Duration;

/// Polling interval for an empty folder that is waited for.
const EMPTY_INTERVAL: Duration = Duration::from_millis(300);

/// Frames in files. Folders and patterns are looked at again.
#[derive(Debug)]
pub struct Files {
    entries: Arc<RwLock<Vec<Arc<FrameEntry>>>>,
    inputs: Vec<PathBuf>,
    options: OpenOptions,
    recordings: Vec<Recording>,
    notes: Vec<String>,
    damage: Vec<String>,
    assumptions: Vec<Assumption>,
    /// Cache of results for companion files next to the frames.
    known: Mutex<Known>,
    looks: Mutex<Looks>,
    /// Frames whose files changed after they were found, in the order of the changes.
    changes: Mutex<Vec<usize>>,
    shared: Arc<SharedFile>,
    color_depth: Arc<SharedDepth>,
}

impl Files {
    /// True if all frames are text, which may be lists of other things.
    pub(in crate::source) fn are_texts(&self) -> bool {
        let entries = read(&self.entries);
        let is_text = |entry: &Arc<FrameEntry>| Format::of_extension(&entry.path).is_some_and(Format::is_rarely_many);
        entries.iter().all(is_text)
    }

    /// Finds the frames of `inputs`: folders, glob patterns and files in any mix, in natural number order. `progress`
    /// counts the files that were looked at, and may be cancelled.
    ///
    /// Nothing is read but folders and the lists of contents of files that hold many frames. See [`SequenceError`] for
    /// the possible errors.
    pub fn open(inputs: &[PathBuf], options: &OpenOptions, progress: &Progress) -> Result<Self, SequenceError> {
        let mut known = Known::default();
        let mut found = discover::discover(inputs, options, &mut known, progress)?;
        while found.entries.is_empty() && options.waits_for_first {
            thread::sleep(EMPTY_INTERVAL);
            if progress.is_cancelled() {
                return Err(SequenceError::Cancelled);
            }
            found = discover::discover(inputs, options, &mut known, progress)?;
        }
        let Discovered {
            entries,
            recordings,
            notes,
            damage,
            assumptions,
        } = found;
        if options.topic.is_none() {
            recording::warn_of_unread(&recordings);
        }
        let is_fixed = inputs.iter().all(|input| input.is_file());
        let looks = if is_fixed {
            Looks::default()
        } else {
            Looks::of_opened(&entries)
        };
        let entries: Vec<Arc<FrameEntry>> = entries.into_iter().map(Arc::new).collect();
        let entries = Arc::new(RwLock::new(entries));
        Ok(Self {
            color_depth: Arc::new(SharedDepth::of(Arc::clone(&entries), options.color_depth)),
            entries,
            inputs: inputs.to_vec(),
            options: options.clone(),
            recordings,
            notes,
            damage,
            assumptions,
            known: Mutex::new(known),
            looks: Mutex::new(looks),
            changes: Mutex::default(),
            shared: Arc::default(),
        })
    }

    fn decoder_with(&self, options: ReadOptions) -> Box<dyn Decoder> {
        let (shared, color_depth) = (Arc::clone(&self.shared), Arc::clone(&self.color_depth));
        Box::new(move |entry: &FrameEntry, progress: &Progress| {
            let mut cloud = decode(entry, &options, &shared, progress)?;
            color_depth.apply(&mut cloud, &options, &shared);
            Ok(cloud)
        })
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

    fn about(&self) -> About<'_> {
        About {
            inputs: &self.inputs,
            recordings: &self.recordings,
            assumptions: &self.assumptions,
            notes: &self.notes,
            damage: &self.damage,
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            meshes: Some(self),
            samples: Some(self),
            growth: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Meshes for Files {
    fn mesh_decoder(&self) -> Box<dyn Decoder> {
        self.decoder_with(self.options.read.of_meshes())
    }
}

impl Samples for Files {
    fn sample(&self, index: usize, max_points: usize, min_points: usize) -> Result<Option<FrameSample>, DecodeFailure> {
        /// A disk that has to look for every point of a sample would take longer for them than for all: then there is
        /// none.
        const MAX_TIME: Duration = Duration::from_secs(1);
        let entry = self.entry(index);
        match (&entry.content, &entry.normals) {
            (FrameBytes::File(Part::Whole | Part::Sole), None) => {
                let sample = io::read_sample(&entry.path, max_points, min_points, MAX_TIME)?;
                Ok(sample.map(|(mut cloud, points)| {
                    self.color_depth.apply(&mut cloud, &self.options.read, &self.shared);
                    (placed(cloud, &entry).into(), points)
                }))
            }
            _ => Ok(None),
        }
    }
}

impl Growth for Files {
    /// Returns true if a folder or a pattern is open, not only files.
    fn may_grow(&self) -> bool {
        self.inputs.iter().any(|input| !input.is_file())
    }

    fn is_live(&self) -> bool {
        false
    }

    /// Looks at the inputs again. Files that came between others are skipped: frames keep their places. Files that are
    /// still being written are left for the next time. Normals that came next to a frame are read with it from then on,
    /// and a frame whose file changed is read again.
    fn look_again(&self) -> Result<usize, SequenceError> {
        let never = Progress::default();
        let mut known = lock(&self.known);
        let found = discover::discover(&self.inputs, &self.options, &mut known, &never)?.entries;
        drop(known);
        let mut looks = lock(&self.looks);
        let mut entries = write(&self.entries);
        let changed = looks.changed(&entries);
        lock(&self.changes).extend(changed);
        let places: HashSet<_> = entries
            .iter()
            .map(|entry| (entry.path.clone(), place_in_file(entry)))
            .collect();
        let is_known = |entry: &FrameEntry| places.contains(&(entry.path.clone(), place_in_file(entry)));
        let behind = found.iter().rposition(is_known).map_or(0, |last| last + 1);
        let mut found = found.into_iter();
        join_late_normals(&mut entries, found.by_ref().take(behind));
        let count_before = entries.len();
        let mut is_next = true;
        for entry in found {
            let expects_normals = entries.last().is_some_and(|before| before.normals.is_some());
            // All are checked, and those after an incomplete one wait for it.
            is_next &= looks.may_append(&entry, &entries, expects_normals);
            if !is_next {
                continue;
            }
            looks.note(&entry);
            // A temporary file that was renamed: it takes the place of its final name.
            match entries.last_mut().filter(|last| !last.path.exists()) {
                Some(last) => {
                    *last = Arc::new(entry);
                    lock(&self.changes).push(entries.len() - 1);
                }
                None => entries.push(Arc::new(entry)),
            }
        }
        Ok(entries.len() - count_before)
    }

    fn changed_since(&self, since: usize) -> Vec<usize> {
        lock(&self.changes).get(since..).unwrap_or_default().to_vec()
    }
}

/// Returns a string that distinguishes frames of one file from each other.
fn place_in_file(entry: &FrameEntry) -> String {
    match &entry.content {
        FrameBytes::File(Part::Whole | Part::Sole) => String::new(),
        content => format!("{content:?}"),
    }
}

/// Attaches to the frames in `entries` the companion normals that `found` now has for the same files.
fn join_late_normals(entries: &mut [Arc<FrameEntry>], found: impl Iterator<Item = FrameEntry>) {
    let with_normals = found.filter(|entry| entry.normals.is_some());
    let late: HashMap<PathBuf, FrameEntry> = with_normals.map(|entry| (entry.path.clone(), entry)).collect();
    for entry in entries.iter_mut().filter(|entry| entry.normals.is_none()) {
        if let Some(found) = late.get(&entry.path)
            && looks::is_quiet(found)
        {
            *entry = Arc::new(FrameEntry {
                normals: found.normals.clone(),
                ..FrameEntry::clone(entry)
            });
        }
    }
}
