//! Timeline annotations: markers, a curve. The playhead and the range are the player's.

mod in_window;
pub(in crate::app) mod panel;

mod curve;
mod markers;
mod visible;

pub(in crate::app) use curve::Curve;
pub use curve::Quantity;
pub use markers::Markers;
pub(in crate::app) use visible::VisibleFrames;

use crate::document::Marker;
use crate::playback::Player;
use crate::sequence::{NumberGap, Sequence, number_gaps};
use std::time::Duration;

/// The marks of the open sequence.
#[derive(Debug)]
pub struct Timeline {
    /// Named frames.
    pub markers: Markers,
    /// Quantity of the curve under the bar.
    pub quantity: Option<Quantity>,
    /// The marker whose name is being written, and the name so far.
    pub(in crate::app) renaming: Option<(usize, String)>,
    pub(in crate::app) curve: Curve,
    /// The frames that are shown.
    pub(in crate::app) visible: VisibleFrames,
    /// Missing numbers between the frames, with the number of frames they were computed for.
    gaps: (usize, Vec<NumberGap>),
    /// Rectangle of the bar in the window, points.
    pub(in crate::app) bar_rect: egui::Rect,
    /// The playhead is being dragged, and playing continues when it is released.
    resumes: bool,
}

impl Default for Timeline {
    fn default() -> Self {
        Self {
            markers: Markers::default(),
            quantity: None,
            renaming: None,
            curve: Curve::default(),
            visible: VisibleFrames::default(),
            gaps: (0, Vec::new()),
            bar_rect: egui::Rect::ZERO,
            resumes: false,
        }
    }
}

impl Timeline {
    /// Another sequence was opened: nothing of the one before is left.
    pub(in crate::app) fn begin(&mut self) {
        self.markers = Markers::default();
        self.renaming = None;
        self.curve.forget();
        self.visible = VisibleFrames::default();
        self.gaps = (0, Vec::new());
    }

    /// Replaces the markers by those of a document. Returns a message about those that are skipped.
    pub(in crate::app) fn take_markers(&mut self, list: Vec<Marker>) -> Option<String> {
        let mut skipped = Vec::new();
        self.renaming = None;
        self.markers = Markers::of(list, &mut skipped);
        (!skipped.is_empty()).then(|| format!("Not all markers are there: {}", skipped.join(", ")))
    }

    /// The numbers that are missing between the names of the frames of `sequence`, which may have grown.
    pub(in crate::app) fn gaps(&mut self, sequence: &Sequence) -> &[NumberGap] {
        if self.gaps.0 != sequence.len() {
            self.gaps = (sequence.len(), number_gaps(&sequence.entries()));
        }
        &self.gaps.1
    }

    /// Puts a marker at a frame, or takes it away.
    pub(in crate::app) fn toggle_marker(&mut self, frame: usize) {
        self.markers.toggle(frame);
        self.renaming = None;
    }

    /// Begins to write the name of the marker at `frame`.
    pub(in crate::app) fn begin_renaming(&mut self, frame: usize) {
        let mut markers = self.markers.list().iter();
        let marker = markers.find(|marker| marker.frame == frame);
        self.renaming = marker.map(|marker| (frame, marker.name.clone()));
    }

    /// Gives the marker whose name was being written that name.
    pub(in crate::app) fn finish_renaming(&mut self) {
        if let Some((frame, name)) = self.renaming.take() {
            self.markers.rename(frame, &name);
        }
    }

    /// Takes the playhead in the hand: meanwhile playing rests.
    pub(in crate::app) fn take_playhead(&mut self, player: &mut Player, now: Duration) {
        self.resumes = player.is_playing();
        if self.resumes {
            player.toggle(now);
        }
    }

    /// Releases the playhead: playback continues if it was playing.
    pub(in crate::app) fn let_playhead_go(&mut self, player: &mut Player, now: Duration) {
        if std::mem::take(&mut self.resumes) && !player.is_playing() {
            player.toggle(now);
        }
    }

    /// Drops the grabbed playhead, as another sequence is opened.
    pub(in crate::app) fn forget_playhead(&mut self) {
        self.resumes = false;
    }
}
