//! Questions to a source, with the answer where it lacks the capability.

use super::SequenceError;
use super::files::{Recording, topics_of};
use super::live::Live;
use super::traits::{DecodeFailure, Decoder, FrameSample, Growth, Source};
use crate::assumption::Assumption;
use crate::io::Topic;
use crate::photos::ViewSet;
use crate::reel::ReelFile;
use crate::rgbd::{Filters, Sensor};
use crate::wire::RawImages;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

impl dyn Source + '_ {
    /// See [`super::Groups::group`]; else the frame by itself.
    pub fn group(&self, index: usize) -> Range<usize> {
        match self.capabilities().groups {
            Some(groups) => groups.group(index),
            None => index..index + 1,
        }
    }

    /// See [`super::Meshes::mesh_decoder`]; else [`Source::decoder`].
    pub fn mesh_decoder(&self) -> Box<dyn Decoder> {
        match self.capabilities().meshes {
            Some(meshes) => meshes.mesh_decoder(),
            None => self.decoder(),
        }
    }

    /// See [`super::Samples::sample`]; else `None`.
    pub fn sample(
        &self,
        index: usize,
        max_points: usize,
        min_points: usize,
    ) -> Result<Option<FrameSample>, DecodeFailure> {
        match self.capabilities().samples {
            Some(samples) => samples.sample(index, max_points, min_points),
            None => Ok(None),
        }
    }

    /// See [`Growth::may_grow`].
    pub fn may_grow(&self) -> bool {
        self.capabilities().growth.is_some_and(Growth::may_grow)
    }

    /// See [`Growth::is_live`].
    pub fn is_live(&self) -> bool {
        self.capabilities().growth.is_some_and(Growth::is_live)
    }

    /// See [`Growth::look_again`]; else 0.
    pub fn look_again(&self) -> Result<usize, SequenceError> {
        self.capabilities().growth.map_or(Ok(0), Growth::look_again)
    }

    /// See [`Growth::changed_since`].
    pub fn changed_since(&self, since: usize) -> Vec<usize> {
        let growth = self.capabilities().growth;
        growth.map_or_else(Vec::new, |growth| growth.changed_since(since))
    }

    /// See [`Growth::wait_for_more`]; else this time goes by.
    pub fn wait_for_more(&self, at_most: Duration) -> Result<usize, SequenceError> {
        if let Some(growth) = self.capabilities().growth {
            return growth.wait_for_more(at_most);
        }
        thread::sleep(at_most);
        Ok(0)
    }

    /// Returns the status and recording of a live stream; `None` for sources that are not live.
    pub fn live(&self) -> Option<&dyn Live> {
        self.capabilities().live
    }

    /// See [`super::DepthImages::sensor`].
    pub fn sensor(&self, index: usize) -> Option<Sensor> {
        self.capabilities().depth_images?.sensor(index)
    }

    /// See [`super::DepthImages::raw_images`].
    pub fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        self.capabilities().depth_images?.raw_images(index)
    }

    /// See [`super::DepthImages::filters`].
    pub fn filters(&self) -> Option<Filters> {
        self.capabilities().depth_images?.filters()
    }

    /// See [`super::DepthImages::filtered`].
    pub fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        self.capabilities().depth_images?.filtered(filters)
    }

    /// See [`super::HasPosedImages::posed_images`].
    pub fn posed_images(&self, index: usize) -> Option<Arc<ViewSet>> {
        self.capabilities().posed_images?.posed_images(index)
    }

    /// Returns the image files that are read in addition to those of the entries: colours of depth images, posed
    /// images.
    pub fn images(&self) -> Vec<PathBuf> {
        if let Some(images) = self.capabilities().image_files {
            return images.image_files();
        }
        let set = (!self.is_live() && !self.frames().is_empty()).then(|| self.posed_images(self.frames().start));
        let photos = set.flatten();
        let files = photos
            .iter()
            .flat_map(|set| &set.photos)
            .filter(|photo| photo.has_file());
        files
            .flat_map(|photo| std::iter::once(&photo.path).chain(&photo.mask))
            .cloned()
            .collect()
    }

    /// See [`super::About::fps`].
    pub fn fps(&self) -> Option<f64> {
        self.about().fps
    }

    /// See [`super::About::inputs`].
    pub fn inputs(&self) -> &[PathBuf] {
        self.about().inputs
    }

    /// See [`super::About::reel`].
    pub fn reel(&self) -> Option<Arc<ReelFile>> {
        self.about().reel
    }

    /// See [`super::About::recordings`].
    pub fn recordings(&self) -> &[Recording] {
        self.about().recordings
    }

    /// The topics with point clouds of all recordings together, in the order of their names.
    pub fn topics(&self) -> Vec<Topic> {
        topics_of(self.recordings())
    }

    /// See [`super::About::assumptions`].
    pub fn assumptions(&self) -> &[Assumption] {
        self.about().assumptions
    }

    /// See [`super::About::notes`].
    pub fn notes(&self) -> &[String] {
        self.about().notes
    }

    /// See [`super::About::damage`].
    pub fn damage(&self) -> &[String] {
        self.about().damage
    }
}
