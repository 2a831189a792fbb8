//! Capabilities of a source beyond its frames, and the facts about it.
//!
//! How it works: a source answers two questions, [`Source::about`] for what is known without reading a frame and
//! [`Source::capabilities`] for what else it can do, each a struct with a field per answer. Both methods have no
//! default. A source by itself names what it has and ends with `..Default::default()`. A source that wraps another one
//! names every field, or hands on the whole struct in one expression: a new field is then an error of the compiler in
//! every wrapper, and nothing is lost unnoticed. Whoever uses a source asks the methods of `dyn Source`.

use super::files::Recording;
use super::live::Live;
use super::traits::{DecodeFailure, Decoder, FrameSample, Source};
use super::{SequenceError, files};
use crate::assumption::Assumption;
use crate::io::Topic;
use crate::photos::ViewSet;
use crate::reel::ReelFile;
use crate::rgbd::{Filters, Sensor};
use crate::wire::RawImages;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Facts about a source, known without reading a frame.
#[derive(Debug, Clone, Default)]
pub struct About<'a> {
    /// What a person opened: nothing for what is no file.
    pub inputs: &'a [PathBuf],
    /// Frames per second, if the source says it and frames have no time stamps.
    pub fps: Option<f64>,
    /// The sequence file that was opened, as it is now.
    pub reel: Option<Arc<ReelFile>>,
    /// The recordings among what was opened.
    pub recordings: &'a [Recording],
    /// Assumptions about the inputs as a whole: which files are frames, in which order. Those about one frame are in
    /// [`RawCloud::assumptions`](crate::cloud::RawCloud::assumptions).
    pub assumptions: &'a [Assumption],
    /// What of the inputs is skipped, a sentence each.
    pub notes: &'a [String],
    /// Where the inputs are cut or damaged, and what is lost by that, a sentence each; all of them are among the notes.
    /// Sequence files tell it of themselves ([`About::reel`]).
    pub damage: &'a [String],
}

/// What a source can do beyond decoding its frames: a field per capability, `None` where it has it not.
#[derive(Clone, Copy, Default)]
pub struct Capabilities<'a> {
    /// Frames that are made from one another; without it each is by itself.
    pub groups: Option<&'a dyn Groups>,
    /// Faces of meshes; without it points that are sampled on them are all there is.
    pub meshes: Option<&'a dyn Meshes>,
    /// Some points of a frame without the others.
    pub samples: Option<&'a dyn Samples>,
    /// Frames that come while it is open.
    pub growth: Option<&'a dyn Growth>,
    /// State and recording of a live stream.
    pub live: Option<&'a dyn Live>,
    /// Frames that are depth images.
    pub depth_images: Option<&'a dyn DepthImages>,
    /// Calibrated photographs of its frames.
    pub photographs: Option<&'a dyn Photographed>,
    /// Files of images next to those of the entries; without it those of [`Capabilities::photographs`] are all.
    pub image_files: Option<&'a dyn ImageFiles>,
}

impl fmt::Debug for Capabilities<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            groups,
            meshes,
            samples,
            growth,
            live,
            depth_images,
            photographs,
            image_files,
        } = self;
        formatter
            .debug_struct("Capabilities")
            .field("groups", &groups.is_some())
            .field("meshes", &meshes.is_some())
            .field("samples", &samples.is_some())
            .field("growth", &growth.is_some())
            .field("live", &live.is_some())
            .field("depth_images", &depth_images.is_some())
            .field("photographs", &photographs.is_some())
            .field("image_files", &image_files.is_some())
            .finish()
    }
}

/// Frames that are made from one another.
pub trait Groups: Send + Sync {
    /// The frames that one decoder had best decode in their order: `index` among them. Other groups can be decoded
    /// meanwhile.
    fn group(&self, index: usize) -> Range<usize>;
}

/// Frames that may be meshes.
pub trait Meshes: Send + Sync {
    /// [`Source::decoder`] where the vertices of meshes are wanted with their faces, and not points that are sampled on
    /// them.
    fn mesh_decoder(&self) -> Box<dyn Decoder>;
}

/// Frames of which some points can be read without the others.
pub trait Samples: Send + Sync {
    /// At most `most_points` of a frame that has at least `fewest_points`, without reading the others, and how many it
    /// has; `None` where that cannot be done.
    fn sample(
        &self,
        index: usize,
        most_points: usize,
        fewest_points: usize,
    ) -> Result<Option<FrameSample>, DecodeFailure>;
}

/// Frames that come while the source is open.
pub trait Growth: Send + Sync {
    /// Whether frames may come.
    fn may_grow(&self) -> bool;

    /// Whether frames are gone for good some time after they came. Who opens it is shown the newest.
    fn is_live(&self) -> bool;

    /// Takes frames that came behind the last one; says how many.
    fn look_again(&self) -> Result<usize, SequenceError>;

    /// Frames whose files changed since they were found, after the first `since` of these changes: what was read of
    /// them is outdated.
    fn changed_since(&self, _since: usize) -> Vec<usize> {
        Vec::new()
    }

    /// [`Growth::look_again`] once there is something, or after this time: a stream wakes up when a frame comes, a
    /// folder is looked at from time to time.
    fn wait_for_more(&self, at_most: Duration) -> Result<usize, SequenceError> {
        thread::sleep(at_most);
        self.look_again()
    }
}

/// Frames that are depth images, or made of them.
pub trait DepthImages: Send + Sync {
    /// The cameras that took frame `index`, and where they were; `None` of frames that no camera took, as far as
    /// anybody knows.
    fn sensor(&self, index: usize) -> Option<Sensor>;

    /// What the cameras recorded of frame `index`, before any filter; `None` of frames that are no images.
    fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>>;

    /// The filters of its depth images; `None` where frames are none.
    fn filters(&self) -> Option<Filters>;

    /// The same frames with other filters of depth images; `None` where frames are none. A live stream goes on: both
    /// have the same connection, which ends with the last of them.
    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>>;
}

/// Frames that calibrated photographs show.
pub trait Photographed: Send + Sync {
    /// Photographs of what frame `index` shows, in its coordinates; `None` where there are none.
    fn photographs(&self, index: usize) -> Option<Arc<ViewSet>>;
}

/// Images in files next to those of the entries.
pub trait ImageFiles: Send + Sync {
    /// Their files: colours of depth images, photographs.
    fn image_files(&self) -> Vec<PathBuf>;
}

/// What is asked of a source, with the answer where it lacks the capability.
impl dyn Source + '_ {
    /// See [`Groups::group`]; else the frame by itself.
    pub fn group(&self, index: usize) -> Range<usize> {
        match self.capabilities().groups {
            Some(groups) => groups.group(index),
            None => index..index + 1,
        }
    }

    /// See [`Meshes::mesh_decoder`]; else [`Source::decoder`].
    pub fn mesh_decoder(&self) -> Box<dyn Decoder> {
        match self.capabilities().meshes {
            Some(meshes) => meshes.mesh_decoder(),
            None => self.decoder(),
        }
    }

    /// See [`Samples::sample`]; else `None`.
    pub fn sample(
        &self,
        index: usize,
        most_points: usize,
        fewest_points: usize,
    ) -> Result<Option<FrameSample>, DecodeFailure> {
        match self.capabilities().samples {
            Some(samples) => samples.sample(index, most_points, fewest_points),
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

    /// How a live stream is doing, and what records it; `None` of sources that are none.
    pub fn live(&self) -> Option<&dyn Live> {
        self.capabilities().live
    }

    /// See [`DepthImages::sensor`].
    pub fn sensor(&self, index: usize) -> Option<Sensor> {
        self.capabilities().depth_images?.sensor(index)
    }

    /// See [`DepthImages::raw_images`].
    pub fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        self.capabilities().depth_images?.raw_images(index)
    }

    /// See [`DepthImages::filters`].
    pub fn filters(&self) -> Option<Filters> {
        self.capabilities().depth_images?.filters()
    }

    /// See [`DepthImages::filtered`].
    pub fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        self.capabilities().depth_images?.filtered(filters)
    }

    /// See [`Photographed::photographs`].
    pub fn photographs(&self, index: usize) -> Option<Arc<ViewSet>> {
        self.capabilities().photographs?.photographs(index)
    }

    /// Files of images that are read next to those of the entries: colours of depth images, photographs.
    pub fn images(&self) -> Vec<PathBuf> {
        if let Some(images) = self.capabilities().image_files {
            return images.image_files();
        }
        let set = (!self.is_live() && !self.frames().is_empty()).then(|| self.photographs(self.frames().start));
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

    /// See [`About::fps`].
    pub fn fps(&self) -> Option<f64> {
        self.about().fps
    }

    /// See [`About::inputs`].
    pub fn inputs(&self) -> &[PathBuf] {
        self.about().inputs
    }

    /// See [`About::reel`].
    pub fn reel(&self) -> Option<Arc<ReelFile>> {
        self.about().reel
    }

    /// See [`About::recordings`].
    pub fn recordings(&self) -> &[Recording] {
        self.about().recordings
    }

    /// The topics with point clouds of all recordings together, in the order of their names.
    pub fn topics(&self) -> Vec<Topic> {
        files::topics_of(self.recordings())
    }

    /// See [`About::assumptions`].
    pub fn assumptions(&self) -> &[Assumption] {
        self.about().assumptions
    }

    /// See [`About::notes`].
    pub fn notes(&self) -> &[String] {
        self.about().notes
    }

    /// See [`About::damage`].
    pub fn damage(&self) -> &[String] {
        self.about().damage
    }
}
