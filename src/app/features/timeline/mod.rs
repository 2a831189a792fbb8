//! What a person puts on the timeline: in and out point, markers, a curve. The playhead and the range are the player's;
//! here is what is kept of them.

pub(in crate::app) mod panel;

mod curve;
mod file;
mod markers;
mod visible;

pub(in crate::app) use curve::Curve;
pub use curve::Quantity;
pub use markers::Markers;
pub(in crate::app) use visible::VisibleFrames;

use crate::app::first_look::Chosen;
use crate::document::Marker;
use crate::playback::Player;
use crate::sequence::{NumberGap, Sequence, number_gaps};
use crate::timeline::PlayRange;
use std::path::PathBuf;
use std::time::Duration;

/// The marks of the open sequence.
#[derive(Debug)]
pub struct Timeline {
    /// Named frames.
    pub markers: Markers,
    /// What the curve under the bar shows.
    pub quantity: Option<Quantity>,
    /// The marker whose name is being written, and the name so far.
    pub(in crate::app) renaming: Option<(usize, String)>,
    pub(in crate::app) curve: Curve,
    /// The frames that are shown.
    pub(in crate::app) visible: VisibleFrames,
    /// Numbers that are missing between the frames, of so many of which that was found.
    gaps: (usize, Vec<NumberGap>),
    /// Where the bar is in the window, points.
    pub(in crate::app) bar_rect: egui::Rect,
    /// What was chosen for the sequence in place of what is guessed.
    pub(in crate::app) chosen: Chosen,
    /// The playhead is in the hand, and playing goes on when it is let go.
    resumes: bool,
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
            visible: VisibleFrames::default(),
            gaps: (0, Vec::new()),
            bar_rect: egui::Rect::ZERO,
            chosen: Chosen::default(),
            resumes: false,
            file: None,
        }
    }
}

impl Timeline {
    /// Takes what was kept of `sequence`, which was just opened: its range and what was chosen for it. What could not
    /// be read is said.
    pub(in crate::app) fn read(
        &mut self,
        folder: Option<&PathBuf>,
        sequence: &Sequence,
    ) -> (PlayRange, Chosen, Option<String>) {
        self.renaming = None;
        self.curve.forget();
        self.visible = VisibleFrames::default();
        self.gaps = (0, Vec::new());
        let file = folder.and_then(|folder| file::file_of(folder, sequence));
        let kept = file.map(|file| file::read(&file));
        let (file, problem, (range, markers, chosen)) =
            kept.map_or_else(Default::default, |kept| (kept.file, kept.problem, kept.value));
        self.file = file;
        self.markers = markers;
        (range, chosen, problem)
    }

    /// Takes the markers of a session in place of those that were kept. What is left out of them is said.
    pub(in crate::app) fn take_markers(&mut self, list: Vec<Marker>) -> Option<String> {
        let mut left_out = Vec::new();
        self.renaming = None;
        self.markers = Markers::of(list, &mut left_out);
        (!left_out.is_empty()).then(|| format!("Not all markers of the session are there: {}", left_out.join(", ")))
    }

    /// The numbers that are missing between the names of the frames of `sequence`, which may have grown.
    pub(in crate::app) fn gaps(&mut self, sequence: &Sequence) -> &[NumberGap] {
        if self.gaps.0 != sequence.len() {
            self.gaps = (sequence.len(), number_gaps(&sequence.entries()));
        }
        &self.gaps.1
    }

    /// Keeps the marks and `range`, if they may be kept.
    pub(in crate::app) fn keep(&self, range: PlayRange) -> Result<(), String> {
        match &self.file {
            Some(file) => file::write(file, range, &self.markers, self.chosen),
            None => Ok(()),
        }
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

    /// Lets the playhead go: what played before plays on.
    pub(in crate::app) fn let_playhead_go(&mut self, player: &mut Player, now: Duration) {
        if std::mem::take(&mut self.resumes) && !player.is_playing() {
            player.toggle(now);
        }
    }

    /// Another sequence is opened: there is nothing in the hand.
    pub(in crate::app) fn forget_playhead(&mut self) {
        self.resumes = false;
    }
}
