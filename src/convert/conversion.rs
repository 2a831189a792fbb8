//! What is to be converted, and how.

use super::edit::Edit;
use crate::io::WriteFormat;
use crate::reel::ReelOptions;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Which frames, what becomes of them, and where they go.
#[derive(Debug, Clone)]
pub struct Conversion {
    /// Frames, both ends included; all for `None`.
    pub frames: Option<RangeInclusive<usize>>,
    /// Every how many-th frame, and from which on: `(0, 1)` for all.
    pub shard: Shard,
    /// What becomes of each.
    pub edit: Edit,
    /// Format of the files, unless they are a sequence file.
    pub format: WriteFormat,
    /// Where they go.
    pub output: Output,
    /// Write frames that are there already, whatever options they were written with.
    pub overwrites: bool,
}

/// A share of the frames: those whose index leaves `index` when divided by `count`; of a sequence file, the `index`-th
/// of as many runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which share, from 0.
    pub index: usize,
    /// How many shares there are, at least 1.
    pub count: usize,
}

impl Shard {
    /// Everything.
    pub const WHOLE: Self = Self { index: 0, count: 1 };
}

/// Where frames go.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// One frame to this file.
    File(PathBuf),
    /// Frames to files in this folder, named by their number and, if they have one, their time.
    Folder(PathBuf),
    /// Frames to this sequence file, kept so.
    Reel(PathBuf, ReelOptions),
}
