//! What the frames of one file share is read once, and fails once.

use super::contents::Part;
use super::error::IoError;
use super::gltf::{self, Scene};
use super::options::ReadOptions;
use super::read::{finished, read_part_observed};
use super::watched;
use crate::cloud::RawCloud;
use crate::locks::lock;
use crate::progress::Progress;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// The last file of which several frames were read from something that they share: the scene of an animation, once for
/// each way to read it. Other formats have their frames one by one.
#[derive(Default)]
pub struct SharedFile {
    last: Mutex<Vec<Opened>>,
}

struct Opened {
    path: PathBuf,
    options: ReadOptions,
    scene: Result<Arc<Scene<'static>>, Arc<IoError>>,
}

impl std::fmt::Debug for SharedFile {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("SharedFile").finish_non_exhaustive()
    }
}

impl SharedFile {
    /// [`read_part_observed`], which reads of a file that it has opened before no more than the frame takes. A file
    /// that changes meanwhile is read as it was.
    pub fn read_part(
        &self,
        path: &Path,
        part: &Part,
        options: &ReadOptions,
        progress: &Progress,
    ) -> Result<RawCloud, Arc<IoError>> {
        let Part::Moment(time) = part else {
            return read_part_observed(path, part, options, progress).map_err(Arc::new);
        };
        let scene = self.scene(path, options, progress)?;
        let format = gltf::FORMAT;
        let decoded = scene.frame(time.as_secs_f64());
        finished(decoded, path, format, &options.of_format(format)).map_err(Arc::new)
    }

    fn scene(
        &self,
        path: &Path,
        options: &ReadOptions,
        progress: &Progress,
    ) -> Result<Arc<Scene<'static>>, Arc<IoError>> {
        // Who needs the same file waits here for whoever opens it.
        let mut last = lock(&self.last);
        last.retain(|opened| opened.path == path);
        if let Some(opened) = last.iter().find(|opened| opened.options == *options) {
            return opened.scene.clone();
        }
        let scene = open(path, options, progress).map_err(Arc::new);
        if progress.is_cancelled() {
            let path = path.to_owned();
            return Err(Arc::new(IoError::Cancelled { path }));
        }
        last.push(Opened {
            path: path.to_owned(),
            options: *options,
            scene: scene.clone(),
        });
        scene
    }
}

fn open(path: &Path, options: &ReadOptions, progress: &Progress) -> Result<Arc<Scene<'static>>, IoError> {
    let bytes = watched::read_file(path, progress).map_err(|source| IoError::Io {
        path: path.to_owned(),
        source,
    })?;
    let format = gltf::FORMAT;
    let scene = Scene::open(path, &bytes, &options.of_format(format));
    let scene = scene.map_err(|fault| fault.of(path, format))?;
    Ok(Arc::new(scene.into_owned()))
}
