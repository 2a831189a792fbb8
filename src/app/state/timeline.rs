//! What a user puts on the timeline of the open sequence.

use super::State;
use crate::playback::Player;
use crate::timeline::PlayRange;

impl State {
    /// The frame at the playhead, or waited for, of the open sequence.
    fn frame_at_playhead(&self) -> Option<usize> {
        let player = self.player.as_ref()?;
        let frame = player.waiting_for().unwrap_or(player.clock().frame());
        (!player.sequence().is_empty()).then_some(frame)
    }

    /// Changes in or out point, given the range and the frame at the playhead.
    pub(in crate::app) fn set_range(&mut self, change: impl FnOnce(PlayRange, usize) -> PlayRange) {
        if let Some(frame) = self.frame_at_playhead() {
            self.play_with(|player, now| {
                player.set_range(change(player.clock().range(), frame), now);
            });
            self.keep_document();
        }
    }

    /// Puts a marker at the playhead, or takes it away.
    pub(in crate::app) fn toggle_marker(&mut self) {
        if let Some(frame) = self.frame_at_playhead() {
            self.timeline.toggle_marker(frame);
            self.keep_document();
        }
    }

    /// Goes to the next marker, or to the one before.
    pub(in crate::app) fn go_to_marker(&mut self, is_next: bool) {
        let (Some(frame), Some(player)) = (self.frame_at_playhead(), &self.player) else {
            return;
        };
        let count = player.sequence().len();
        let markers = &self.timeline.markers;
        let found = if is_next {
            markers.next_after(frame, count)
        } else {
            markers.last_before(frame, count)
        };
        if let Some(frame) = found {
            self.play_with(|player: &mut Player, now| player.seek(frame, now));
        }
    }
}
