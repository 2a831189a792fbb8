//! One stage, and its step on one frame.

use super::composed::{Composed, Problem};
use super::inputs::Inputs;
use crate::cloud::CloudError;
use crate::progress::Progress;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// Stages that the window runs together: on which thread, and how often. Without a window all run at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lane {
    /// Depends on other frames: a task per pose.
    Poses,
    /// Depends on the input images: runs as a task in a pool of its own, also for the frames that follow.
    Photos,
    /// Depends on the camera: for each image, from the results of tasks ([`StandIns`](super::StandIns)).
    View,
}

/// The step of a stage, and problems with its inputs.
pub type MakeStep = fn(&Inputs<'_>, &mut Vec<Problem>) -> Option<Arc<dyn Step>>;

/// A row of [`STAGES`](super::STAGES).
pub struct Stage {
    /// Its name in the table of the module.
    pub name: &'static str,
    /// With which stages the window runs it.
    pub lane: Lane,
    /// Its step for a frame; `None` if it does not apply. It tells of inputs that are not there.
    pub step: MakeStep,
}

impl fmt::Debug for Stage {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

/// A stage with all that it takes for one frame.
pub trait Step: Any + fmt::Debug + Send + Sync {
    /// Returns true if both steps turn a frame into the same result; other frames are compared by identity.
    fn is_same(&self, other: &dyn Step) -> bool;

    /// Changes the frame composed so far. Its result is not drawn once `progress` is cancelled.
    ///
    /// # Errors
    /// If the frame would have more points than a frame can have; it is as before then.
    fn run(&self, composed: &mut Composed, progress: &Progress) -> Result<(), CloudError>;
}

/// `other` if it is a step of the same stage.
pub(super) fn same_stage<S: Step>(other: &dyn Step) -> Option<&S> {
    (other as &dyn Any).downcast_ref()
}
