//! A frame between the stages.

use crate::measure::Change;
use crate::messages::frame_with_index;
use crate::scene::{PhotoDepths, Style};
use crate::sequence::{FrameError, PreparedFrame};
use std::sync::Arc;

/// A pose with all that stages have made of it so far.
#[derive(Debug, Clone)]
pub struct Composed {
    /// The frame that is drawn.
    pub frame: Arc<PreparedFrame>,
    /// The frame in it: the same, or the one it was derived from.
    pub pose: Arc<PreparedFrame>,
    /// Distances of its points to another frame, if its colours show them.
    pub change: Option<Measured>,
    /// Depth maps of its points from the viewpoints of the images, if they were drawn ahead.
    pub depths: Option<Arc<PhotoDepths>>,
    /// Coarse version of the frame with fewer records, while the camera moves.
    pub coarse: Option<Coarse>,
    /// Inputs that are missing or do not fit, in the order of the stages.
    pub problems: Vec<Problem>,
}

impl Composed {
    /// The pose as it is.
    pub fn of(pose: Arc<PreparedFrame>) -> Self {
        Self {
            frame: Arc::clone(&pose),
            pose,
            change: None,
            depths: None,
            coarse: None,
            problems: Vec::new(),
        }
    }

    /// The slot in the pose of a point of the frame; `None` for points of ghosts.
    pub fn slot_in_pose(&self, slot: usize) -> Option<usize> {
        if Arc::ptr_eq(&self.frame.frame, &self.pose.frame) {
            return Some(slot);
        }
        let index = *self.frame.frame.file_index().get(slot)? as usize;
        (index < self.pose.points.len()).then_some(index)
    }
}

/// A frame with levels of detail, and settings that draw it by these.
#[derive(Debug, Clone)]
pub struct Coarse {
    /// Coarse frame with the same points as the frame that it replaces.
    pub frame: Arc<PreparedFrame>,
    /// See [`in_cells`](super::in_cells).
    pub style: Style,
}

/// Distances to another frame, as they are drawn.
#[derive(Debug, Clone)]
pub struct Measured {
    /// The distances.
    pub change: Arc<Change>,
    /// The other frame.
    pub to: usize,
    /// The distance in the last colour, scene units.
    pub range: f64,
}

/// Something that could not be read or added.
#[derive(Debug, Clone)]
pub enum Problem {
    /// Sentence about the file of a frame or about an image.
    Note(String),
    /// No other frame to colour `frame` by.
    NoOtherFrame {
        /// The frame.
        frame: usize,
        /// Offset of the other frame, in frames later.
        step: i64,
    },
    /// The other frame cannot be read.
    OtherUnread {
        /// The frame.
        frame: usize,
        /// Why.
        reason: FrameError,
    },
    /// The other frame has no points.
    OtherEmpty {
        /// The frame.
        frame: usize,
        /// The other one.
        other: usize,
    },
    /// A neighbouring frame cannot be read.
    NoGhost {
        /// The neighbouring frame.
        frame: usize,
        /// Why.
        reason: FrameError,
    },
}

impl Problem {
    /// A sentence that names frames of a sequence of `count`.
    pub fn text(&self, count: usize) -> String {
        let named = |frame: usize| frame_with_index(frame, count);
        let keeps = |frame: usize, why: &str| format!("{} keeps its colours: {why}", named(frame));
        match self {
            Self::Note(text) => text.clone(),
            Self::NoOtherFrame { frame, step } => keeps(*frame, &format!("the sequence has no frame {step} later")),
            Self::OtherUnread { frame, reason } => keeps(*frame, &reason.to_string()),
            Self::OtherEmpty { frame, other } => keeps(*frame, &format!("{} has no points", named(*other))),
            Self::NoGhost { frame, reason } => format!("{} is not shown as a ghost: {reason}", named(*frame)),
        }
    }
}
