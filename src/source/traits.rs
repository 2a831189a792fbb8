//! Sources of frames: their frames, the facts about them, and their capabilities.
//!
//! How it works: a source answers two questions, [`Source::about`] for the facts known without reading a frame and
//! [`Source::capabilities`] for its further abilities, each a struct with a field per answer. Both methods have no
//! default. A source by itself names its own fields and ends with `..Default::default()`. A source that wraps another
//! one names every field, or hands on the whole struct in one expression: a new field is then an error of the compiler
//! in every wrapper, and nothing is lost unnoticed. Users of a source call the methods of `dyn Source`.

use super::SequenceError;
use super::entry::FrameEntry;
use super::files::Recording;
use super::live::Live;
use crate::assumption::Assumption;
use crate::cloud::RawCloud;
use crate::photos::ViewSet;
use crate::progress::Progress;
use crate::reel::ReelFile;
use crate::rgbd::{Filters, Sensor};
use crate::wire::RawImages;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Reason why a decoder failed; its message names the file, the position in it and the expected data.
pub type DecodeFailure = Box<dyn std::error::Error + Send + Sync>;

/// Some points of a frame, and how many it has.
pub type FrameSample = (DecodedFrame, usize);

/// A frame as its decoder gives it. Existing attributes of the cloud (order, normals, radii, ellipses) are not computed
/// again.
#[derive(Debug, Clone)]
pub struct DecodedFrame {
    /// Its points, in file coordinates.
    pub cloud: RawCloud,
    /// Level of detail of the points, if the decoder decodes levels.
    pub level: Option<DecodedLevel>,
}

/// Decoded level of detail: the part of a frame stored by levels that was decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DecodedLevel {
    /// Points of the whole frame.
    pub points_in_frame: usize,
    /// Points of the next finer level; `usize::MAX` if there is none.
    pub points_of_finer: usize,
}

impl From<RawCloud> for DecodedFrame {
    fn from(cloud: RawCloud) -> Self {
        Self { cloud, level: None }
    }
}

/// Origin of the frames of a sequence. Shared between threads. No method has a default, so that a source that wraps
/// another one loses nothing unnoticed.
pub trait Source: Send + Sync {
    /// The frames that can be decoded now: up to the newest, from the oldest that is not gone for good. Frames keep
    /// their numbers.
    fn frames(&self) -> Range<usize>;

    /// Returns the entry of a frame: everything known before it is decoded, even if the frame is already gone.
    /// Precondition: the index is before the end of [`Source::frames`].
    fn entry(&self, index: usize) -> Arc<FrameEntry>;

    /// Something that decodes frames of this source, for one thread at a time.
    fn decoder(&self) -> Box<dyn Decoder>;

    /// Facts that are known without reading a frame.
    fn about(&self) -> About<'_>;

    /// Returns the optional capabilities of the source beyond decoding its frames.
    fn capabilities(&self) -> Capabilities<'_>;
}

/// Decodes frames of one source. It may cache data shared by frames, such as an open file or the previous frame, but
/// its result does not depend on earlier decoding.
pub trait Decoder: Send {
    /// Frame `index`, described by `entry`, in file coordinates. `max_points` are wanted: a decoder of levels gives the
    /// finest that has no more, any other decoder all points, and the caller subsamples them. Reports progress; its
    /// result after cancellation is ignored.
    fn decode(
        &mut self,
        index: usize,
        entry: &FrameEntry,
        max_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure>;
}

/// A function that decodes every frame by itself.
impl<F> Decoder for F
where
    F: FnMut(&FrameEntry, &Progress) -> Result<RawCloud, DecodeFailure> + Send,
{
    fn decode(
        &mut self,
        _index: usize,
        entry: &FrameEntry,
        _max_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        self(entry, progress).map(DecodedFrame::from)
    }
}

/// Facts about a source, known without reading a frame.
#[derive(Debug, Clone, Default)]
pub struct About<'a> {
    /// Input paths that were opened; empty for inputs that are not files.
    pub inputs: &'a [PathBuf],
    /// Frames per second, if the source states it and frames have no time stamps.
    pub fps: Option<f64>,
    /// The sequence file that was opened, as it is now.
    pub reel: Option<Arc<ReelFile>>,
    /// The recordings among the inputs.
    pub recordings: &'a [Recording],
    /// Assumptions about the inputs as a whole: which files are frames, in which order. Those about one frame are in
    /// [`RawCloud::assumptions`](crate::cloud::RawCloud::assumptions).
    pub assumptions: &'a [Assumption],
    /// Notes on the skipped parts of the inputs, one sentence each.
    pub notes: &'a [String],
    /// Descriptions of truncated or damaged inputs and the resulting loss, one sentence each; all of them are among the
    /// notes. Sequence files report it themselves ([`About::reel`]).
    pub damage: &'a [String],
}

/// Optional capabilities of a source beyond decoding its frames: one field per capability, `None` if unsupported.
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
    /// Calibrated images of its frames.
    pub posed_images: Option<&'a dyn HasPosedImages>,
    /// Image files next to the entries' files; without it, [`Capabilities::posed_images`] lists them all.
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
            posed_images,
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
            .field("posed_images", &posed_images.is_some())
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

/// Frames with some points that can be read without the others.
pub trait Samples: Send + Sync {
    /// At most `max_points` of a frame that has at least `min_points`, without reading the others, and how many it
    /// has; `None` where that cannot be done.
    fn sample(&self, index: usize, max_points: usize, min_points: usize) -> Result<Option<FrameSample>, DecodeFailure>;
}

/// Frames that come while the source is open.
pub trait Growth: Send + Sync {
    /// Returns true if frames may still be added.
    fn may_grow(&self) -> bool;

    /// Returns true if the source is live: frames are gone for good some time after they came. The newest frame is
    /// shown on opening.
    fn is_live(&self) -> bool;

    /// Takes frames that came after the last one; returns their number.
    fn look_again(&self) -> Result<usize, SequenceError>;

    /// Frames whose files changed since they were found, after the first `since` of these changes: data read of them is
    /// outdated.
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
    /// The cameras that took frame `index`, and where they were; `None` of frames that no camera took, as far as is
    /// known.
    fn sensor(&self, index: usize) -> Option<Sensor>;

    /// Returns the raw images that the cameras recorded of frame `index`, before any filter; `None` for frames that are
    /// not images.
    fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>>;

    /// The filters of its depth images; `None` where frames are none.
    fn filters(&self) -> Option<Filters>;

    /// Returns a source of the same frames with other depth image filters; `None` if the frames are not depth images. A
    /// live stream continues: both share one connection, which ends with the last of them.
    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>>;
}

/// Frames that calibrated images show.
pub trait HasPosedImages: Send + Sync {
    /// Returns the posed images of frame `index`, in its coordinates; `None` if there are none.
    fn posed_images(&self, index: usize) -> Option<Arc<ViewSet>>;
}

/// Images in files next to the entries' files.
pub trait ImageFiles: Send + Sync {
    /// Returns the image files: colours of depth images, posed images.
    fn image_files(&self) -> Vec<PathBuf>;
}
