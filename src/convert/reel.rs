//! Conversion of all frames into one sequence file.
//!
//! **How it works.** Frames are read, edited and encoded group by group, with as many groups in parallel as there are
//! cores, and written in order under a hidden name. A companion file records the options and the progress ([`Ledger`]),
//! so that an interrupted conversion resumes after its last complete group. Frames that cannot be read are skipped and
//! reported. Shards take consecutive runs of groups, so that their files are joined by concatenation
//! ([`super::join()`]); each records its frames ([`FilePart`]).

use super::conversion::{Conversion, Converted, Shard, is_finished};
use super::error::ConvertError;
use super::lock::{self, Lock};
use super::record::Record;
use crate::cloud::RawCloud;
use crate::io::{Loss, Losses};
use crate::progress::Progress;
use crate::reel::{EncodedGroup, FilePart, NewFrame, ReelFile, ReelOptions, ReelWriter, encode_group};
use crate::regular_file;
use crate::sequence::{FrameEntry, Sequence};
use crate::temporary::Temporary;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::BufWriter;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The clouds of a group take no more memory than this, unless one alone does.
const GROUP_BYTES: usize = 256 << 20;

pub(super) type Writer = ReelWriter<BufWriter<File>>;

/// Ledger of an unfinished file: the state needed to resume it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Ledger {
    record: Record,
    /// The part of how many.
    #[serde(default)]
    part: [u64; 2],
    /// Frames of a group.
    group: usize,
    /// Frames of the sequence that are not in the file, as they cannot be read; known before the group is written
    /// after them.
    #[serde(rename = "left_out")]
    skipped: Vec<usize>,
}

/// An unfinished file and its ledger, under hidden names.
pub(super) struct Unfinished {
    pub(super) file: PathBuf,
    ledger: PathBuf,
    lock: PathBuf,
}

impl Unfinished {
    pub(super) fn of(output: &Path) -> Self {
        let name = output.file_name().unwrap_or_default().to_string_lossy();
        Self {
            file: output.with_file_name(format!(".{name}.unfinished")),
            ledger: output.with_file_name(format!(".{name}.unfinished.json")),
            lock: output.with_file_name(format!(".{name}.lock")),
        }
    }

    /// Keeps other processes from writing the same file until the answer is dropped.
    pub(super) fn lock(&self, output: &Path) -> Result<Lock, ConvertError> {
        lock::lock(&self.lock, output)
    }

    fn keep(&self, ledger: &Ledger) -> Result<(), ConvertError> {
        let text = serde_json::to_vec_pretty(ledger).unwrap_or_default();
        crate::persist::write_whole(&self.ledger, &text).map_err(write_error(&self.ledger))
    }

    /// Removes it: it will not be resumed. To be called while it is locked.
    fn remove(&self) {
        for path in [&self.file, &self.ledger] {
            // The next conversion overwrites a file that cannot be removed.
            let _ = fs::remove_file(path);
        }
    }

    /// Reopens the existing file to resume; `None` where that is impossible, with a message.
    fn reopened(&self, options: &ReelOptions) -> Option<Writer> {
        let reopened = Writer::append_to(&self.file, options.clone());
        let told = reopened.inspect_err(|error| log::warn!("the conversion starts over: {error}"));
        told.ok()
    }

    /// Returns the ledger of the unfinished file, if it was made with `record`.
    fn ledger_of(&self, record: &Record) -> Option<Ledger> {
        let ledger: Ledger = serde_json::from_slice(&crate::regular_file::read(&self.ledger).ok()?).ok()?;
        let is_file = self.file.symlink_metadata().is_ok_and(|there| there.is_file());
        (ledger.record == *record && is_file).then_some(ledger)
    }

    /// Returns the ledger of the unfinished file, if it was made with `record` and none of its `sources` has changed
    /// since.
    fn ledger(&self, record: &Record, sources: &[Arc<FrameEntry>]) -> Option<Ledger> {
        let is_current = |_: &Ledger| sources.iter().all(|entry| is_finished(&self.file, entry));
        self.ledger_of(record).filter(is_current)
    }
}

/// Returns true if an interrupted conversion with this record into `output` would be resumed.
pub(super) fn is_interrupted(output: &Path, record: &Record) -> bool {
    Unfinished::of(output).ledger_of(record).is_some()
}

fn write_error(path: &Path) -> impl Fn(std::io::Error) -> ConvertError + Copy {
    move |reason| ConvertError::Write {
        path: path.to_owned(),
        reason,
    }
}

/// Work of a conversion into a sequence file: its frames, options and output.
struct Work<'a> {
    sequence: &'a Sequence,
    conversion: &'a Conversion,
    output: &'a Path,
    options: &'a ReelOptions,
    /// Frame indices of this part.
    frames: &'a [usize],
    progress: &'a Progress,
}

/// A sequence file that is written.
struct Open<'a> {
    unfinished: &'a Unfinished,
    writer: Writer,
    ledger: Ledger,
    /// Removed unless a group is written.
    until_a_group: Vec<Temporary>,
}

/// Converts frames of `sequence` into the sequence file `output`.
pub(super) fn convert(
    sequence: &Sequence,
    conversion: &Conversion,
    output: &Path,
    options: &ReelOptions,
    all_frames: &[usize],
    progress: &Progress,
) -> Result<Converted, ConvertError> {
    let mut converted = Converted::default();
    let record = Record::of(conversion, sequence);
    let part = part_of(sequence, &record, all_frames, conversion.shard);
    let frames = share(all_frames, conversion.shard);
    let entries: Vec<Arc<FrameEntry>> = frames.iter().map(|&frame| sequence.entry(frame)).collect();
    let was_there = output.symlink_metadata().is_ok();
    if !conversion.overwrites && was_there {
        let left = frames_of_finished(output, &part).map_err(|error| match error {
            ConvertError::Reel(_) => ConvertError::Exists {
                path: output.to_owned(),
                more: 0,
            },
            error => error,
        })?;
        // If its source has changed since, it is converted again.
        if entries.iter().all(|entry| is_finished(output, entry)) {
            converted.left = left;
            return Ok(converted);
        }
    }
    regular_file::check_replaceable(output).map_err(write_error(output))?;
    let unfinished = Unfinished::of(output);
    let _lock = unfinished.lock(output)?;
    // Another process may have finished it before this one got the lock.
    if !conversion.overwrites && !was_there && output.symlink_metadata().is_ok() {
        return Err(ConvertError::Exists {
            path: output.to_owned(),
            more: 0,
        });
    }
    let known = unfinished.ledger(&record, &entries);
    let known = known.filter(|ledger| !conversion.overwrites && ledger.part == [part.index, part.count]);
    // A file without a group cannot be continued.
    let mut until_a_group = Vec::new();
    let reopened = known.and_then(|ledger| Some((unfinished.reopened(options)?, ledger)));
    let (writer, ledger) = if let Some(both) = reopened {
        both
    } else {
        let ledger = Ledger {
            record,
            part: [part.index, part.count],
            group: group_length(sequence, frames, options),
            skipped: Vec::new(),
        };
        until_a_group.extend([&unfinished.file, &unfinished.ledger].map(|path| Temporary::file(path)));
        // Before the file, so that remains can be identified.
        unfinished.keep(&ledger)?;
        (Writer::create_part(&unfinished.file, options.clone(), part)?, ledger)
    };
    converted.left = writer.frame_count();
    let work = Work {
        sequence,
        conversion,
        output,
        options,
        frames,
        progress,
    };
    let open = Open {
        unfinished: &unfinished,
        writer,
        ledger,
        until_a_group,
    };
    write_frames(&work, open, &mut converted)?;
    Ok(converted)
}

/// Writes the frames that are not in the unfinished file yet, and gives it its name.
fn write_frames(work: &Work<'_>, open: Open<'_>, converted: &mut Converted) -> Result<(), ConvertError> {
    let Work { frames, progress, .. } = *work;
    let Open {
        unfinished,
        mut writer,
        mut ledger,
        mut until_a_group,
    } = open;
    let readable = |frame: &usize| !ledger.skipped.contains(frame);
    let rest: Vec<usize> = frames.iter().copied().filter(readable).skip(converted.left).collect();
    progress.set(frames.len() - rest.len(), frames.len());
    let groups: Vec<&[usize]> = rest.chunks(ledger.group).collect();
    for together in groups.chunks(rayon::current_num_threads()) {
        let encoded: Vec<Result<ConvertedGroup, ConvertError>> =
            together.par_iter().map(|group| encoded(work, group)).collect();
        for made in encoded {
            let made = made?;
            if made.is_cancelled {
                converted.is_cancelled = true;
                if work.conversion.overwrites || writer.frame_count() == 0 {
                    drop(writer);
                    unfinished.remove();
                }
                return Ok(());
            }
            ledger.skipped.extend(made.failed.iter().map(|(frame, _)| frame));
            converted.failed.extend(made.failed);
            converted.warnings.extend(made.warnings);
            converted.losses.merge(made.losses);
            unfinished.keep(&ledger)?;
            if let Some(group) = made.group {
                converted.written += group.frame_count();
                writer.write_encoded(&group)?;
                until_a_group.drain(..).for_each(Temporary::keep);
            }
        }
    }
    if writer.frame_count() == 0 && !frames.is_empty() {
        // An existing file is worth more than one without frames.
        drop(writer);
        unfinished.remove();
        return Ok(());
    }
    finish(writer, work.output, unfinished)
}

/// A group as it came out.
#[derive(Default)]
struct ConvertedGroup {
    /// `None` where none of its frames can be read.
    group: Option<EncodedGroup>,
    failed: Vec<(usize, ConvertError)>,
    warnings: Vec<(usize, String)>,
    losses: Losses,
    is_cancelled: bool,
}

/// Returns the losses: the data of `cloud` that a sequence file with `options` cannot hold, apart from the precision
/// that they specify.
pub(super) fn losses(cloud: &RawCloud, options: &ReelOptions) -> Losses {
    let keeps_points = options.keeps_points();
    let mut losses = Losses::default();
    losses.add_dropped(cloud);
    if !cloud.faces.is_empty() {
        losses.add(Loss::Faces, cloud.faces.len() as f64);
    }
    if cloud.texturing.is_some() {
        losses.add(Loss::Textures, 0.0);
    }
    if cloud.grid.is_some() && !options.keep_order {
        losses.add(Loss::Rows, 0.0);
    }
    if !keeps_points {
        if cloud.attributes.ellipses.is_some() {
            losses.add(Loss::Field("ellipses of merged points".to_owned()), 0.0);
        }
        let holes = cloud.positions.len() - cloud.positions.finite_bounds().0;
        if holes > 0 {
            losses.add(Loss::Holes, holes as f64);
        }
    }
    losses
}

fn encoded(work: &Work<'_>, frames: &[usize]) -> Result<ConvertedGroup, ConvertError> {
    let Work {
        sequence,
        conversion,
        options,
        progress,
        ..
    } = *work;
    let mut made = ConvertedGroup::default();
    let mut clouds: Vec<(RawCloud, Arc<FrameEntry>)> = Vec::new();
    for &frame in frames {
        if progress.is_cancelled() {
            made.is_cancelled = true;
            return Ok(made);
        }
        match conversion.edited(sequence, frame) {
            Ok(mut cloud) => {
                let warnings = std::mem::take(&mut cloud.warnings);
                made.losses.merge(losses(&cloud, options));
                made.warnings
                    .extend(warnings.into_iter().map(|warning| (frame, warning)));
                clouds.push((cloud, sequence.entry(frame)));
            }
            Err(error) => made.failed.push((frame, error)),
        }
        progress.advance(1);
    }
    let frames: Vec<NewFrame<'_>> = clouds
        .iter()
        .map(|(cloud, entry)| NewFrame {
            cloud,
            // The frame's own name, without the name of a multi-frame file.
            name: entry.name.rsplit(": ").next().unwrap_or_default(),
            time: entry.time,
        })
        .collect();
    if !frames.is_empty() {
        made.group = Some(encode_group(&frames, options)?);
    }
    Ok(made)
}

/// Frames per group: the requested number, fewer where their clouds are large.
fn group_length(sequence: &Sequence, frames: &[usize], options: &ReelOptions) -> usize {
    let first = frames.iter().find_map(|&frame| sequence.decode(frame).ok());
    let fitting = first.map_or(usize::MAX, |cloud| GROUP_BYTES / cloud.byte_size().max(1));
    (options.keyframes as usize).min(fitting).max(1)
}

/// The share of `frames` that a shard takes: a run of them, as their files are joined one behind the other.
fn share(frames: &[usize], shard: Shard) -> &[usize] {
    // Runs, not every n-th frame as in folders: `convert --join` concatenates their groups without re-encoding.
    &frames[bounds(frames.len(), shard)]
}

fn bounds(count: usize, shard: Shard) -> Range<usize> {
    let bound = |index: usize| index * count / shard.count;
    bound(shard.index)..bound(shard.index + 1)
}

/// Returns the part description that a shard stores in its file.
fn part_of(sequence: &Sequence, record: &Record, frames: &[usize], shard: Shard) -> FilePart {
    let entries: Vec<Arc<FrameEntry>> = frames.iter().map(|&frame| sequence.entry(frame)).collect();
    let bounds = bounds(frames.len(), shard);
    FilePart {
        index: shard.index as u64,
        count: shard.count as u64,
        frames: bounds.start as u64..bounds.end as u64,
        of_frames: frames.len() as u64,
        made_of: record.made_of(&entries),
    }
}

/// Frames of a file that has the name of the output already.
///
/// # Errors
/// A file that is not whole, and one of other frames or options: it is not this conversion that is done.
fn frames_of_finished(output: &Path, part: &FilePart) -> Result<usize, ConvertError> {
    let file = ReelFile::open_path(output)?;
    let difference = match file.part() {
        _ if !file.damage().is_empty() => Some("it is damaged, or ends early".to_owned()),
        Some(there) if there.made_of != part.made_of => Some("it has other frames or options".to_owned()),
        Some(there) if there != part => Some(format!("it is {} there, {} now", there.name(), part.name())),
        None if part.count > 1 => Some(format!("it does not say that it is {}", part.name())),
        None => Some("it does not say what it was made of".to_owned()),
        Some(_) => None,
    };
    match difference {
        None => Ok(file.frame_count()),
        Some(difference) => Err(ConvertError::OtherPart {
            path: output.to_owned(),
            difference,
        }),
    }
}

/// Gives a file that is whole its name.
pub(super) fn finish(writer: Writer, output: &Path, unfinished: &Unfinished) -> Result<(), ConvertError> {
    let failed = write_error(output);
    let file = writer
        .finish()?
        .into_inner()
        .map_err(|error| failed(error.into_error()))?;
    // Flushed to disk before it gets its name.
    file.sync_data().map_err(failed)?;
    fs::rename(&unfinished.file, output).map_err(failed)?;
    crate::regular_file::sync_folder_of(output);
    match fs::remove_file(&unfinished.ledger) {
        Err(reason) if reason.kind() != std::io::ErrorKind::NotFound => Err(write_error(&unfinished.ledger)(reason)),
        _ => Ok(()),
    }
}
