//! What a person puts on the timeline: in and out point, markers, a curve. The playhead and the range are the player's;
//! here is what is kept of them.

mod curve;
mod file;
mod markers;

pub(in crate::app) use curve::Curve;
pub use curve::Quantity;
pub use markers::{Marker, Markers};

use super::State;
use super::state::Chosen;
use crate::playback::Player;
use crate::timeline::PlayRange;
use std::path::PathBuf;

/// The marks of the open sequence.
#[derive(Debug)]
pub struct Timeline {
    /// Named frames.
    pub markers: Markers,
    /// What the curve under the bar shows.
    pub quantity: Option<Quantity>,
    /// The marker whose name is being written, and the name so far.
    pub(super) renaming: Option<(usize, String)>,
    pub(super) curve: Curve,
    /// Where the bar is in the window, points.
    pub(super) bar_rect: egui::Rect,
    /// What was chosen for the sequence in place of what is guessed.
    pub(super) chosen: Chosen,
    /// Where they are kept, if they may be.
    file: Option<PathBuf>,
}

impl Default for Timeline {
    fn default() -> Self {
        Self {
            markers: Markers::default(),
            quantity: None,
            renaming: None,
            curve: Curve::default(),
            bar_rect: egui::Rect::ZERO,
            chosen: Chosen::default(),
            file: None,
        }
    }
}

impl State {
    /// Takes what was kept of the sequence that was just opened.
    pub(super) fn read_timeline(&mut self, folder: Option<&PathBuf>) {
        let now = self.now();
        let Some(player) = &mut self.player else {
            return;
        };
        self.timeline.renaming = None;
        self.timeline.curve.forget();
        let file = folder.and_then(|folder| file::file_of(folder, player.sequence()));
        let kept = file.map(|file| file::read(&file));
        let (file, problem, (range, markers, chosen)) = kept
            .map_or_else(Default::default, |kept| {
                (kept.file, kept.problem, kept.value)
            });
        self.timeline.file = file;
        if let Some(problem) = problem {
            self.notices.warn(problem);
        }
        player.set_range(range, now);
        self.timeline.markers = markers;
        self.take_chosen(chosen);
    }

    pub(super) fn keep_timeline(&mut self) {
        if let (Some(file), Some(player)) = (&self.timeline.file, &self.player)
            && let Err(problem) = file::write(
                file,
                player.clock().range(),
                &self.timeline.markers,
                self.timeline.chosen,
            )
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
    pub(super) fn set_range(&mut self, change: impl FnOnce(PlayRange, usize) -> PlayRange) {
        if let Some(frame) = self.frame_at_playhead() {
            self.play_with(|player, now| {
                player.set_range(change(player.clock().range(), frame), now);
            });
            self.keep_timeline();
        }
    }

    /// Puts a marker at the playhead, or takes it away.
    pub(super) fn toggle_marker(&mut self) {
        if let Some(frame) = self.frame_at_playhead() {
            self.toggle_marker_at(frame);
        }
    }

    pub(super) fn toggle_marker_at(&mut self, frame: usize) {
        self.timeline.markers.toggle(frame);
        self.timeline.renaming = None;
        self.keep_timeline();
    }

    /// Goes to the next marker, or to the one before.
    pub(super) fn go_to_marker(&mut self, is_next: bool) {
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

    /// Gives the marker whose name was being written that name.
    pub(super) fn finish_renaming(&mut self) {
        if let Some((frame, name)) = self.timeline.renaming.take() {
            self.timeline.markers.rename(frame, &name);
            self.keep_timeline();
        }
    }
}
