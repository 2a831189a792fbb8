//! All that stages take.

use super::composed::Coarse;
use super::depths_ahead::DepthsAhead;
use super::options::ComposeOptions;
use crate::measure::Change;
use crate::photos::LoadedPhotos;
use crate::scene::Style;
use crate::sequence::{FrameError, Needs, PreparedFrame, Sequence};
use std::fmt;
use std::sync::Arc;

/// Source of other frames and images: without a window they are waited for, with one they are those in memory. By
/// default there are none.
pub trait Frames: fmt::Debug {
    /// Number of frames of the sequence.
    fn frame_count(&self) -> usize {
        0
    }

    /// Frame `index` with all its points, for measuring.
    ///
    /// # Errors
    /// If it cannot be read.
    fn whole(&self, index: usize, _needs: &Needs) -> Result<WholeFrame, FrameError> {
        let count = self.frame_count();
        Err(FrameError::NoSuchFrame { index, count })
    }

    /// Frame `index` for drawing; `None` if it is not resident and must not be waited for.
    ///
    /// # Errors
    /// If it cannot be read.
    fn drawable(&self, _index: usize, _needs: &Needs) -> Result<Option<Arc<PreparedFrame>>, FrameError> {
        Ok(None)
    }

    /// Returns the images of frame `index` except for these numbers, on their surface if they are of one scene, and
    /// notes on those that could not be loaded.
    fn posed_images(&self, _index: usize, _skipped: &[usize]) -> Option<LoadedPhotos> {
        None
    }

    /// Returns the parameters for drawing the depth maps of images ahead; otherwise the renderer does that
    /// first.
    fn depths_ahead(&self) -> Option<DepthsAhead> {
        None
    }

    /// The distances of `pose` to frame `to`, if they are cached.
    fn known_change(&self, _pose: &PreparedFrame, _to: usize) -> Option<Arc<Change>> {
        None
    }
}

/// A frame with all its points.
#[derive(Debug, Clone)]
pub enum WholeFrame {
    /// In memory.
    InMemory(Arc<PreparedFrame>),
    /// To be read when the step runs.
    InFile(Arc<Sequence>),
}

/// Stand-ins for the composed frame in the window.
#[derive(Debug, Clone, Default)]
pub struct StandIns {
    /// Surfels of the visible points, for a frame whose own are not there.
    pub in_view: Option<Arc<PreparedFrame>>,
    /// Levels of detail while the camera moves.
    pub coarse: Option<Coarse>,
}

/// All that the steps for one frame are made from.
#[derive(Debug)]
pub struct Inputs<'a> {
    /// The frame of the sequence.
    pub pose: &'a PreparedFrame,
    /// The choices of the user.
    pub options: &'a ComposeOptions,
    /// The settings, resolved.
    pub style: &'a Style,
    /// Other frames.
    pub frames: &'a dyn Frames,
    /// None without a window.
    pub stand_ins: StandIns,
}

static NO_OPTIONS: ComposeOptions = ComposeOptions::NONE;

/// No other frames.
#[derive(Debug)]
struct NoFrames;

impl Frames for NoFrames {}

impl<'a> Inputs<'a> {
    /// Creates the inputs of [`Lane::Photos`](super::Lane::Photos), for a frame whose images are there.
    pub fn of_photos(pose: &'a PreparedFrame, style: &'a Style, frames: &'a dyn Frames) -> Self {
        Self {
            pose,
            options: &NO_OPTIONS,
            style,
            frames,
            stand_ins: StandIns::default(),
        }
    }

    /// Creates the inputs of [`Lane::View`](super::Lane::View), for a frame that is composed except for that.
    pub fn of_view(pose: &'a PreparedFrame, style: &'a Style, stand_ins: StandIns) -> Self {
        Self {
            pose,
            options: &NO_OPTIONS,
            style,
            frames: &NoFrames,
            stand_ins,
        }
    }
}
