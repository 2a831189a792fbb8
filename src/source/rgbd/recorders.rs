//! Files that are recordings of depth images as a whole: a row for each program or device that writes them.
//!
//! To add one: a file with its [`Recorder`], and a row of the table.

use super::error::RgbdError;
use super::recorder::{Found, Recorder};
use super::{kinect, record3d, topics};
use crate::source::OpenOptions;
use std::path::Path;

/// The first that can read a file does.
const RECORDERS: &[Recorder] = &[kinect::RECORDER, record3d::RECORDER, topics::RECORDER];

/// The recording in the file at `path`; `None` if there is none.
pub(super) fn find(path: &Path, options: &OpenOptions) -> Result<Option<Found>, RgbdError> {
    let recorder = RECORDERS.iter().find(|recorder| (recorder.can_read)(path));
    recorder.map_or(Ok(None), |recorder| (recorder.find)(path, options))
}

/// Extensions of files that hold nothing but such a recording.
pub(in crate::source) fn extensions() -> impl Iterator<Item = &'static str> {
    RECORDERS.iter().flat_map(|recorder| recorder.extensions).copied()
}
