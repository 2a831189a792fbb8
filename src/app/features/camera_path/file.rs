//! A camera path is read and written on a thread.

use super::Draft;
use crate::app::work::outcome::Message;
use crate::app::work::tasks::TaskFailed;
use crate::scene::CameraPath;
use std::path::PathBuf;
use std::sync::Arc;

impl Message for PathFile {}

/// A camera path and its file.
#[derive(Debug)]
pub enum PathFile {
    /// It was read.
    Read {
        /// Its file.
        file: PathBuf,
        /// The path.
        draft: Arc<Draft>,
    },
    /// It was written.
    Saved {
        /// Its file.
        file: PathBuf,
        /// Contents of the file.
        draft: Arc<Draft>,
    },
}

/// Reads a path.
pub(in crate::app) fn read_path(file: PathBuf) -> Result<PathFile, TaskFailed> {
    match CameraPath::read(&file) {
        Ok(path) => Ok(PathFile::Read {
            file,
            draft: Arc::new(Draft::of(path)),
        }),
        Err(reason) => Err(TaskFailed(reason.to_string())),
    }
}

/// Writes a path, if there is one.
pub(in crate::app) fn save_path(file: PathBuf, draft: Arc<Draft>) -> Result<PathFile, TaskFailed> {
    match draft.path().map(|path| path.write(&file)) {
        Some(Err(reason)) => Err(TaskFailed(reason.to_string())),
        Some(Ok(())) | None => Ok(PathFile::Saved { file, draft }),
    }
}
