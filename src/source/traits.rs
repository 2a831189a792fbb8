//! What every source of frames can do.

use super::capabilities::{About, Capabilities};
use super::entry::FrameEntry;
use crate::cloud::RawCloud;
use crate::progress::Progress;
use std::ops::Range;
use std::sync::Arc;

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

/// Origin of the frames of a sequence. Shared between threads. No method has a default, so that a source that wraps
/// another one loses nothing unnoticed.
pub trait Source: Send + Sync {
    /// The frames that can be decoded now: up to the newest, from the oldest that is not gone for good. Frames keep
    /// their numbers.
    fn frames(&self) -> Range<usize>;

    /// What is known of a frame before it is decoded, be it gone or not. Precondition: it is before the end of
    /// [`Source::frames`].
    fn entry(&self, index: usize) -> Arc<FrameEntry>;

    /// Something that decodes frames of this source, for one thread at a time.
    fn decoder(&self) -> Box<dyn Decoder>;

    /// Facts that are known without reading a frame.
    fn about(&self) -> About<'_>;

    /// What it can do beyond decoding its frames.
    fn capabilities(&self) -> Capabilities<'_>;
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
