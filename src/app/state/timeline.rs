//! What a person puts on the timeline of the open sequence, and what is kept of it.

use super::State;
use crate::playback::Player;
use crate::timeline::PlayRange;
use std::path::PathBuf;

impl State {
    /// Takes what was kept of the sequence that was just opened.
    pub(super) fn read_timeline(&mut self, folder: Option<&PathBuf>) {
        let Some(player) = &mut self.player else {
            return;
        };
        let (range, chosen, problem) = self.timeline.read(folder, player.sequence());
        if let Some(problem) = problem {
            self.notices.warn(problem);
        }
        player.set_range(range, self.now);
        self.take_chosen(chosen);
    }

    pub(in crate::app) fn keep_timeline(&mut self) {
        if let Some(player) = &self.player
            && let Err(problem) = self.timeline.keep(player.clock().range())
        {
            self.notices.warn(problem);
        }
    }

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
            self.keep_timeline();
        }
    }

    /// Puts a marker at the playhead, or takes it away.
    pub(in crate::app) fn toggle_marker(&mut self) {
        if let Some(frame) = self.frame_at_playhead() {
            self.timeline.toggle_marker(frame);
            self.keep_timeline();
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
