//! Description of a conversion: its input and its options.

use super::edit::Edit;
use super::error::ConvertError;
use super::rate_goal::RateGoal;
use crate::cloud::RawCloud;
use crate::io::{Losses, WriteFormat};
use crate::reel::ReelOptions;
use crate::sequence::{FrameEntry, Sequence};
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Conversion job: the frames, the edits applied to them, and the output.
#[derive(Debug, Clone)]
pub struct Conversion {
    /// Frames, both ends included; all for `None`.
    pub frames: Option<RangeInclusive<usize>>,
    /// Every how many-th frame, and from which on: `(0, 1)` for all.
    pub shard: Shard,
    /// Edits applied to each frame.
    pub edit: Edit,
    /// Format of the files, unless they are a sequence file.
    pub format: WriteFormat,
    /// Output target.
    pub output: Output,
    /// Size or error of a sequence file that its precision is chosen for.
    pub goal: Option<RateGoal>,
    /// Overwrite existing frames, even of other programs or options.
    pub overwrites: bool,
    /// Human-readable description of how the inputs are read, where that changes frames.
    pub reading: String,
}

impl Conversion {
    /// Display name of the output format.
    pub fn target_name(&self) -> String {
        match self.output {
            Output::Reel(..) => "reel".to_owned(),
            Output::File(_) | Output::Folder(_) => self.format.to_string(),
        }
    }

    /// A frame as it is to be written.
    pub(super) fn edited(&self, sequence: &Sequence, index: usize) -> Result<RawCloud, ConvertError> {
        edited(sequence, index, &self.edit)
    }
}

/// Decodes a frame and edits it.
pub(super) fn edited(sequence: &Sequence, index: usize, edit: &Edit) -> Result<RawCloud, ConvertError> {
    let mut cloud = sequence.decode(index)?;
    edit.apply(&mut cloud).map_err(|reason| ConvertError::Edit {
        path: sequence.entry(index).path.clone(),
        reason,
    })?;
    Ok(cloud)
}

/// A share of the frames: those whose index modulo `count` is `index`; of a sequence file, the `index`-th of `count`
/// runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Index of the shard, from 0.
    pub index: usize,
    /// Number of shards, at least 1.
    pub count: usize,
}

impl Shard {
    /// Everything.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// The file that this share of the sequence file `output` is written to: `walk.part-1-of-3.reel`; `output` itself
    /// for everything.
    pub fn part_of(self, output: &Path) -> PathBuf {
        if self == Self::WHOLE {
            return output.to_owned();
        }
        let stem = output.file_stem().unwrap_or_default().to_string_lossy();
        output.with_file_name(format!("{stem}{}", self.suffix()))
    }

    /// Returns the suffix of the file names of parts.
    fn suffix(self) -> String {
        format!(".part-{}-of-{}.reel", self.index + 1, self.count)
    }

    /// The share that a file of this name is of `output`.
    pub(super) fn of_part_name(name: &str, output: &Path) -> Option<Self> {
        let stem = output.file_stem()?.to_str()?;
        let numbers = name.strip_prefix(stem)?.strip_prefix(".part-")?.strip_suffix(".reel")?;
        let (index, count) = numbers.split_once("-of-")?;
        let shard = Self {
            index: index.parse::<usize>().ok()?.checked_sub(1)?,
            count: count.parse().ok()?,
        };
        (shard.index < shard.count).then_some(shard)
    }
}

/// Output target of the frames.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// One frame to this file.
    File(PathBuf),
    /// Frames to files in this folder, named as those that they were read from, or by their number and, if they have
    /// one, their time.
    Folder(PathBuf),
    /// All frames to this sequence file, encoded with these options.
    Reel(PathBuf, ReelOptions),
}

/// Result of a conversion.
#[derive(Debug, Default)]
pub struct Converted {
    /// Frames that were written.
    pub written: usize,
    /// Frames that were finished before.
    pub left: usize,
    /// Frames that could not be converted, and why.
    pub failed: Vec<(usize, ConvertError)>,
    /// Frames that were written without a part of their files, and why.
    pub warnings: Vec<(usize, String)>,
    /// Losses: the data of the frames that the target format cannot hold.
    pub losses: Losses,
    /// Notes that concern all frames.
    pub notes: Vec<String>,
    /// True if it was cancelled before the end.
    pub is_cancelled: bool,
}

/// Returns true if `output` exists and is not older than the source it was made from.
pub(super) fn is_finished(output: &Path, entry: &FrameEntry) -> bool {
    let modified = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified());
    let Ok(output) = modified(output) else {
        return false;
    };
    let mut files = std::iter::once(&entry.path).chain(&entry.normals);
    // Generated frames have no file.
    files.all(|file| modified(file).map_or(true, |input| output >= input))
}
