//! Frames that take long to read: their bars, and what becomes of a sequence whose first frame nobody waits for any more.

use super::{Scrubbing, State};
use crate::app::progress::WorkKind;
use crate::app::tasks::close;
use crate::playback::Player;
use crate::sequence::{Loader, Sequence};
use std::time::Duration;

/// How often is looked at how far the reading of a frame is.
const LOOK_INTERVAL: Duration = Duration::from_millis(100);

impl State {
    /// Takes notice of frames that are waited for and being read, and of those that nobody waits for any more. True if something is
    /// closed.
    pub(super) fn follow_readings(&mut self) -> bool {
        let is_given_up = |is_shown: bool, loader: &Loader| !is_shown && loader.was_cancelled();
        if let Some(player) = &self.player
            && is_given_up(player.shown().is_some(), player.loader())
        {
            let name = self.sequence_name().unwrap_or_default();
            self.close_sequence();
            self.notices.info(format!("Opening {name} was cancelled"));
            return true;
        }
        if let Some(beside) = &self.beside {
            let companion = &beside.companion;
            if is_given_up(companion.shown().is_some(), companion.loader()) {
                let text = format!("Opening {} was cancelled", beside.name);
                self.close_beside();
                self.notices.info(text);
                return true;
            }
        }
        let (works, now) = (&mut self.works, self.now);
        let mut watch = |loader: &Loader, sequence: &Sequence, frame: usize, is_first: bool| {
            let readings = loader.readings();
            let mut readings = readings.iter();
            // Before the first frame is here, any is read to find where the sequence is.
            if let Some(reading) = readings.find(|reading| is_first || reading.index == frame) {
                let name = || format!("Reading {}", sequence.source(frame).name);
                works.watch(WorkKind::Read, name, &reading.progress, now);
            }
        };
        if let Some(player) = &self.player
            && let Some(frame) = player.waiting_for()
        {
            let is_first = player.shown().is_none();
            watch(player.loader(), player.sequence(), frame, is_first);
        }
        if let Some(beside) = &self.beside
            && let Some(frame) = beside.companion.waiting_for()
        {
            let companion = &beside.companion;
            let is_first = companion.shown().is_none();
            watch(companion.loader(), companion.sequence(), frame, is_first);
        }
        false
    }

    /// When to look again at how far the reading of a frame is that is waited for.
    pub(super) fn next_look_at_readings(&self) -> Option<Duration> {
        let waits = self.player.as_ref().is_some_and(|player| {
            let companion = self.beside.as_ref().map(|beside| &beside.companion);
            player.waiting_for().is_some()
                || companion.is_some_and(|companion| companion.waiting_for().is_some())
        });
        let is_read = || self.works.has(WorkKind::Read);
        (waits || is_read()).then(|| self.now + LOOK_INTERVAL)
    }

    /// Nothing is open any more.
    fn close_sequence(&mut self) {
        self.close_beside();
        if let Some(player) = self.player.take() {
            self.leave(player);
        }
    }

    /// Forgets what belongs to the sequence that was open before.
    pub(super) fn leave(&mut self, before: Player) {
        // Its numbers are those of the sequence before.
        self.settings.clip = None;
        // Its threads end what they are on; nobody waits for that here.
        close(before);
        self.framed = false;
        self.glide = None;
        self.drawing.forget_frame();
        self.temporal.forget_frames();
        self.thumbnails.forget_frames();
        self.trails.forget_points();
        self.inspection.forget_points();
        self.scrubbing = Scrubbing::default();
        self.quality = None;
        self.quality_key = None;
    }
}
