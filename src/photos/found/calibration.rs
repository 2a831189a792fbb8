//! What a reconstruction lists, before any photograph is looked for.
//!
//! One file may list photographs that are there ([`Calibration::photographs`]), or cameras that filmed, of which each
//! moment has photographs of its own ([`Rig`]). Who knows the names in it, and the folders around it, can tell.

use super::rig::Rig;
use crate::photos::error::PhotosError;
use crate::photos::found::draft::Drafts;
use crate::photos::sets::view_set::ViewSet;
use std::path::{Path, PathBuf};

/// Cameras and poses by the names of photographs.
#[derive(Debug, Clone)]
pub struct Calibration {
    drafts: Drafts,
}

impl Calibration {
    pub(in crate::photos) fn new(drafts: Drafts) -> Self {
        Self { drafts }
    }

    /// The file; of COLMAP that of its images.
    pub fn path(&self) -> &Path {
        &self.drafts.path
    }

    /// Folders around which photographs are looked for, the nearest first.
    pub fn folders(&self) -> &[PathBuf] {
        &self.drafts.folders
    }

    /// The names of all photographs, as they are written.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.drafts.photos.iter().map(|draft| draft.name.as_str())
    }

    /// When each photograph was taken, in the unit of the file; `None` unless all of them say that.
    pub fn times(&self) -> Option<Vec<f64>> {
        self.drafts.photos.iter().map(|draft| draft.time).collect()
    }

    /// A file of points that is named in place of points.
    pub fn points_file(&self) -> Option<&Path> {
        self.drafts.points_file.as_deref()
    }

    /// Some of the photographs alone, by their indices, in this order; without points, whose tracks name them all.
    #[must_use]
    pub fn some(&self, chosen: &[usize]) -> Self {
        let photos = chosen.iter().filter_map(|&index| self.drafts.photos.get(index));
        let mut drafts = Drafts::new(&self.drafts.path, self.drafts.folders.clone());
        drafts.photos = photos.cloned().collect();
        drafts.notes.clone_from(&self.drafts.notes);
        Self { drafts }
    }

    /// The photographs that can be shown.
    ///
    /// # Errors
    /// [`PhotosError::NoPhotos`] where none of them can.
    pub fn photographs(self) -> Result<ViewSet, PhotosError> {
        self.drafts.into_view_set()
    }

    /// The cameras, where the names are those of cameras and not of photographs.
    ///
    /// # Errors
    /// [`PhotosError::NoPhotos`] where no camera has a lens and a pose.
    pub fn rig(self) -> Result<Rig, PhotosError> {
        Rig::of(self.drafts)
    }
}
