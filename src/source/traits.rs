//! What every source of frames can do.

use super::entry::FrameEntry;
use super::error::SequenceError;
use super::files::{Recording, topics_of};
use super::live::Live;
use crate::assumption::Assumption;
use crate::cloud::RawCloud;
use crate::io::Topic;
use crate::photos::ViewSet;
use crate::progress::Progress;
use crate::reel::ReelFile;
use crate::rgbd::{Filters, Sensor};
use crate::wire::RawImages;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Why a decoder failed; its message names the file, the place in it and what was expected.
pub type DecodeFailure = Box<dyn std::error::Error + Send + Sync>;

/// Some points of a frame, and how many it has.
pub type FrameSample = (DecodedFrame, usize);

/// A frame as its decoder gives it. What the cloud has already (order, normals, radii, ellipses) is not worked out
/// again.
#[derive(Debug, Clone)]
pub struct DecodedFrame {
    /// Its points, in file coordinates.
    pub cloud: RawCloud,
    /// What level of the frame they are, if the decoder decodes levels.
    pub level: Option<DecodedLevel>,
}

/// How much of a frame that is stored by levels was decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DecodedLevel {
    /// Points of the whole frame.
    pub points_in_frame: usize,
    /// Points of the next finer level; `usize::MAX` where there is none.
    pub points_of_finer: usize,
}

impl From<RawCloud> for DecodedFrame {
    fn from(cloud: RawCloud) -> Self {
        Self { cloud, level: None }
    }
}

/// Where the frames of a sequence come from. Shared between threads.
pub trait Source: Send + Sync {
    /// The frames that can be decoded now: up to the newest, from the oldest that is not gone for good. Frames keep
    /// their numbers.
    fn frames(&self) -> Range<usize>;

    /// What is known of a frame before it is decoded, be it gone or not. Precondition: it is before the end of
    /// [`Source::frames`].
    fn entry(&self, index: usize) -> Arc<FrameEntry>;

    /// The frames that one decoder had best decode in their order, as they are made from one another: `index` among
    /// them. Other groups can be decoded meanwhile.
    fn group(&self, index: usize) -> Range<usize> {
        index..index + 1
    }

    /// Something that decodes frames of this source, for one thread at a time.
    fn decoder(&self) -> Box<dyn Decoder>;

    /// The same where the vertices of meshes are wanted with their faces, and not points that are sampled on them.
    fn mesh_decoder(&self) -> Box<dyn Decoder> {
        self.decoder()
    }

    /// At most `most_points` of a frame that has at least `fewest_points`, without reading the others, and how many it
    /// has; `None` where that cannot be done.
    fn sample(
        &self,
        _index: usize,
        _most_points: usize,
        _fewest_points: usize,
    ) -> Result<Option<FrameSample>, DecodeFailure> {
        Ok(None)
    }

    /// Frames a second, if the source says it and frames have no time stamps.
    fn fps(&self) -> Option<f64> {
        None
    }

    /// Whether its frames come while it is open and are gone for good some time later. Who opens it is shown the
    /// newest.
    fn is_live(&self) -> bool {
        false
    }

    /// Whether frames may come while it is open.
    fn may_grow(&self) -> bool {
        false
    }

    /// Takes frames that came behind the last one; says how many.
    fn look_again(&self) -> Result<usize, SequenceError> {
        Ok(0)
    }

    /// Frames whose files changed since they were found, after the first `since` of these changes: what was read of
    /// them is outdated.
    fn changed_since(&self, _since: usize) -> Vec<usize> {
        Vec::new()
    }

    /// [`Source::look_again`] once there is something, or after this time: a stream wakes up when a frame comes, a
    /// folder is looked at from time to time.
    fn wait_for_more(&self, at_most: Duration) -> Result<usize, SequenceError> {
        thread::sleep(at_most);
        self.look_again()
    }

    /// What a person opened: nothing for what is no file.
    fn inputs(&self) -> &[PathBuf] {
        &[]
    }

    /// The sequence file that was opened, as it is now.
    fn reel(&self) -> Option<Arc<ReelFile>> {
        None
    }

    /// The cameras that took frame `index`, and where they were; `None` of frames that no camera took, as far as
    /// anybody knows.
    fn sensor(&self, _index: usize) -> Option<Sensor> {
        None
    }

    /// What the cameras recorded of frame `index`, before any filter; `None` of frames that are no images.
    fn raw_images(&self, _index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        None
    }

    /// The filters of its depth images; `None` where frames are none.
    fn filters(&self) -> Option<Filters> {
        None
    }

    /// The same frames with other filters of depth images; `None` where frames are none. A live stream goes on: both
    /// have the same connection, which ends with the last of them.
    fn filtered(&self, _filters: Filters) -> Option<Arc<dyn Source>> {
        None
    }

    /// How a live stream is doing, and what records it; `None` of sources that are none.
    fn live(&self) -> Option<&dyn Live> {
        None
    }

    /// Calibrated photographs of what frame `index` shows, in its coordinates; `None` where there are none.
    fn photographs(&self, _index: usize) -> Option<Arc<ViewSet>> {
        None
    }

    /// Files of images that are read beside those of the entries: colours of depth images, photographs.
    fn images(&self) -> Vec<PathBuf> {
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

    /// The recordings among what was opened.
    fn recordings(&self) -> &[Recording] {
        &[]
    }

    /// The topics with point clouds of all recordings together, in the order of their names.
    fn topics(&self) -> Vec<Topic> {
        topics_of(self.recordings())
    }

    /// Assumptions about the inputs as a whole: which files are frames, in which order. Those about one frame are in
    /// [`RawCloud::assumptions`].
    fn assumptions(&self) -> &[Assumption] {
        &[]
    }

    /// What of the inputs is left out, a sentence each.
    fn notes(&self) -> &[String] {
        &[]
    }

    /// Where the inputs are cut or damaged, and what is lost by that, a sentence each; all of them are among the notes.
    /// Sequence files tell it of themselves ([`Source::reel`]).
    fn damage(&self) -> &[String] {
        &[]
    }
}

/// Decodes frames of one source. It may keep what several frames share, such as an open file or the frame before, but
/// gives the same answer whatever it decoded before.
pub trait Decoder: Send {
    /// Frame `index`, which `entry` tells of, in file coordinates. `most_points` are wanted: a decoder of levels gives
    /// the finest that has no more, any other decoder all points, and the caller thins them out. Says how far it is;
    /// what it returns after it was cancelled is not looked at.
    fn decode(
        &mut self,
        index: usize,
        entry: &FrameEntry,
        most_points: usize,
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
        _most_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        self(entry, progress).map(DecodedFrame::from)
    }
}
