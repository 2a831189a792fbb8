//! Frames that take long to read: their bars, and the handling of a sequence whose first frame was cancelled.

use super::State;
use super::keeper::Keeper;
use crate::app::features::Features;
use crate::app::first_look::SequenceLook;
use crate::app::side::Side;
use crate::app::work::tasks::close;
use crate::app::work::works::WorkKind;
use crate::document::History;
use crate::playback::Player;
use crate::sequence::{Loader, Reading, ReadingStage, Sequence};
use std::time::Duration;

/// Polling interval for the progress of reading a frame.
const LOOK_INTERVAL: Duration = Duration::from_millis(100);

/// Completeness of a frame in the rendered image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::app) enum PictureStage {
    /// Some of its points.
    SomePoints,
    /// All of its points, without attributes that are still to be estimated.
    AllPoints,
    /// Surfels of the visible part, while those of all points are being estimated.
    SurfelsInView,
    /// Everything that was requested.
    Whole,
}

/// The frame that is not here, or not as it is to be.
fn expected(player: &Player) -> Option<usize> {
    let partial = player.is_partial().then(|| player.clock().frame());
    player.waiting_for().or(partial)
}

/// Returns the display name of the task that reads the frame of this name.
fn work_name(reading: &Reading, name: &str) -> String {
    match reading.stage {
        ReadingStage::Frame => format!("Reading {name}"),
        ReadingStage::AllPoints(count) => format!("All {} points of {name}", in_words(count)),
        ReadingStage::Normals => format!("Normals of {name}"),
        ReadingStage::Mesh => format!("Triangles of {name}"),
        ReadingStage::Octree => format!("Octree of {name}"),
    }
}

/// A number of points to three digits.
fn in_words(count: usize) -> String {
    let millions = count as f64 / 1e6;
    match count {
        10_000_000.. => format!("{millions:.1} M"),
        1_000_000.. => format!("{millions:.2} M"),
        _ => format!("{:.0} k", count as f64 / 1e3),
    }
}

impl State {
    /// Returns the completeness of the shown frame in the rendered image; `None` without one.
    pub(in crate::app) fn picture_stage(&self) -> Option<PictureStage> {
        let player = self.player.as_ref()?;
        let frame = player.shown().filter(|_| self.is_drawn())?;
        Some(match (player.is_partial(), frame.is_sample()) {
            (false, _) => PictureStage::Whole,
            (true, false) if self.main.drawing.has_surfels() => PictureStage::SurfelsInView,
            (true, false) => PictureStage::AllPoints,
            (true, true) => PictureStage::SomePoints,
        })
    }

    /// Tracks awaited frames that are being read, and cancelled ones. True if something is closed.
    pub(in crate::app) fn follow_readings(&mut self) -> bool {
        let is_given_up = |is_shown: bool, loader: &Loader| !is_shown && loader.was_cancelled();
        if let Some(player) = &self.player
            && is_given_up(player.shown().is_some(), player.loader())
        {
            let name = self.sequence_name().unwrap_or_default();
            self.close_sequence();
            self.notices.info(format!("Opening {name} was cancelled"));
            return true;
        }
        if let Some(split_view) = &self.features.split_view {
            let companion = &split_view.companion;
            if is_given_up(companion.shown().is_some(), companion.loader()) {
                let text = format!("Opening {} was cancelled", split_view.name);
                self.close_split_view();
                self.notices.info(text);
                return true;
            }
        }
        let (works, now) = (&mut self.shared.works, self.shared.now);
        let mut watch = |loader: &Loader, sequence: &Sequence, frame: usize, is_first: bool| {
            let readings = loader.readings();
            let mut readings = readings.iter();
            // Until the first frame is loaded, any frame is read to find the position of the sequence.
            if let Some(reading) = readings.find(|reading| is_first || reading.index == frame) {
                let name = || work_name(reading, &sequence.entry(frame).name);
                works.watch(WorkKind::Read, name, &reading.progress, now);
            }
        };
        if let Some(player) = &self.player
            && let Some(frame) = expected(player)
        {
            let is_first = player.shown().is_none();
            watch(player.loader(), player.sequence(), frame, is_first);
        }
        if let Some(split_view) = &self.features.split_view
            && let Some(frame) = split_view.companion.waiting_for()
        {
            let companion = &split_view.companion;
            let is_first = companion.shown().is_none();
            watch(companion.loader(), companion.sequence(), frame, is_first);
        }
        false
    }

    /// When to look again at how far the reading of a frame is that is waited for.
    pub(in crate::app) fn next_look_at_readings(&self) -> Option<Duration> {
        let waits = self.player.as_ref().is_some_and(|player| {
            let companion = self
                .features
                .split_view
                .as_ref()
                .map(|split_view| &split_view.companion);
            expected(player).is_some() || companion.is_some_and(|companion| companion.waiting_for().is_some())
        });
        let is_read = || self.shared.works.has(WorkKind::Read);
        (waits || is_read()).then(|| self.shared.now + LOOK_INTERVAL)
    }

    /// Nothing is open any more.
    pub(in crate::app) fn close_sequence(&mut self) {
        self.keep_document();
        if let Some(player) = self.player.take() {
            self.leave(player);
        }
    }

    /// Forgets the data of the sequence that was open before.
    pub(in crate::app) fn leave(&mut self, before: Player) {
        self.close_split_view();
        self.end_comparison(Side::A);
        self.style = self.new_style();
        self.shared.options.view = None;
        // Its threads end after the frame they are working on; nothing waits for that here.
        close(before);
        self.opening.looked = SequenceLook::default();
        self.motion.glide = None;
        self.main.drawing.forget_frame();
        for feature in Features::rows::<Self>() {
            feature.forget_sequence(self);
        }
        self.opening.keeper = Keeper::default();
        self.history = History::default();
        self.note_unnamed();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Progress;

    #[test]
    fn progress_bars_name_their_stage() {
        let name_of = |stage| {
            let progress = Progress::default();
            let reading = Reading {
                index: 0,
                stage,
                progress,
            };
            work_name(&reading, "hall.ply")
        };
        assert_eq!(name_of(ReadingStage::Frame), "Reading hall.ply");
        let all = |count| name_of(ReadingStage::AllPoints(count));
        assert_eq!(all(13_809_899), "All 13.8 M points of hall.ply");
        assert_eq!(all(1_000_000), "All 1.00 M points of hall.ply");
        assert_eq!(all(600_400), "All 600 k points of hall.ply");
        assert_eq!(name_of(ReadingStage::Normals), "Normals of hall.ply");
        assert_eq!(name_of(ReadingStage::Octree), "Octree of hall.ply");
    }
}
