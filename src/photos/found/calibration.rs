//! Calibration listed by a reconstruction, before any input image is looked for.
//!
//! One file may list input images that exist ([`Calibration::posed_images`]), or cameras of a multi-view video, each
//! time step of which has its own images ([`Rig`]). The names in it, and the folders around it, determine which.

use super::rig::Rig;
use crate::photos::error::PhotosError;
use crate::photos::found::draft::Drafts;
use crate::photos::sets::view_set::ViewSet;
use std::path::{Path, PathBuf};

/// Camera intrinsics and poses, by the names of input images.
#[derive(Debug, Clone)]
pub struct Calibration {
    drafts: Drafts,
}

impl Calibration {
    pub(in crate::photos) fn new(drafts: Drafts) -> Self {
        Self { drafts }
    }

    /// The file; for COLMAP, the file of its images.
    pub fn path(&self) -> &Path {
        &self.drafts.path
    }

    /// Returns the folders around which input images are looked for, the nearest first.
    pub fn folders(&self) -> &[PathBuf] {
        &self.drafts.folders
    }

    /// Returns the names of all input images, as they are written.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.drafts.photos.iter().map(|draft| draft.name.as_str())
    }

    /// Returns the capture times of the input images, in the unit of the file; `None` unless all of them have one.
    pub fn times(&self) -> Option<Vec<f64>> {
        self.drafts.photos.iter().map(|draft| draft.time).collect()
    }

    /// Returns the path of a file of points that is named instead of listing the points.
    pub fn points_file(&self) -> Option<&Path> {
        self.drafts.points_file.as_deref()
    }

    /// Returns a subset of the input images, by their indices, in this order; without points, whose tracks name all
    /// images.
    #[must_use]
    pub fn some(&self, chosen: &[usize]) -> Self {
        let photos = chosen.iter().filter_map(|&index| self.drafts.photos.get(index));
        let mut drafts = Drafts::new(&self.drafts.path, self.drafts.folders.clone());
        drafts.photos = photos.cloned().collect();
        drafts.notes.clone_from(&self.drafts.notes);
        Self { drafts }
    }

    /// Returns the input images that can be shown.
    ///
    /// # Errors
    /// [`PhotosError::NoPhotos`] if none of them can.
    pub fn posed_images(self) -> Result<ViewSet, PhotosError> {
        self.drafts.into_view_set()
    }

    /// Returns the rig of cameras, if the names belong to cameras and not to images.
    ///
    /// # Errors
    /// [`PhotosError::NoPhotos`] if no camera has a lens and a pose.
    pub fn rig(self) -> Result<Rig, PhotosError> {
        Rig::of(self.drafts)
    }
}
