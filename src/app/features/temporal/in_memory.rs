//! Frames for the stages of composition, as far as they are in memory: the window waits for none.

use super::Known;
use crate::composition::{Frames, WholeFrame};
use crate::measure::Change;
use crate::playback::Player;
use crate::sequence::{FrameError, Needs, PreparedFrame, Slot};
use std::sync::Arc;

/// Frames of the open sequence in memory; input images are loaded by their feature (`features/photos`), which runs
/// their lane.
#[derive(Debug)]
pub(super) struct FramesInMemory<'a> {
    pub(super) player: &'a Player,
    pub(super) known: &'a Known,
}

impl Frames for FramesInMemory<'_> {
    fn frame_count(&self) -> usize {
        self.player.sequence().len()
    }

    /// The task reads a frame that is not in memory.
    fn whole(&self, index: usize, _needs: &Needs) -> Result<WholeFrame, FrameError> {
        Ok(match self.player.loader().get(index, &Needs::default()) {
            Slot::Ready(frame) | Slot::Partial(frame) | Slot::Stale(frame) if !frame.is_sample() => {
                WholeFrame::InMemory(frame)
            }
            _ => WholeFrame::InFile(Arc::clone(self.player.sequence())),
        })
    }

    fn drawable(&self, index: usize, needs: &Needs) -> Result<Option<Arc<PreparedFrame>>, FrameError> {
        Ok(match self.player.loader().get(index, needs) {
            Slot::Ready(frame) | Slot::Coarse(frame) | Slot::Partial(frame) | Slot::Stale(frame) => Some(frame),
            Slot::Pending | Slot::Failed(_) => None,
        })
    }

    fn known_change(&self, pose: &PreparedFrame, to: usize) -> Option<Arc<Change>> {
        self.known.find(&(pose.index, to, pose.frame.len()))
    }
}
