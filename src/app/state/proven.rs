//! Opened inputs that show nothing: the window is as empty as before, and reports why. Only inputs that were shown are
//! listed as recently opened.

use super::State;
use super::failed_opening::FailedOpening;
use crate::app::side::Side;
use crate::playback::{Mark, Player};
use std::path::PathBuf;

/// Why nothing of the sequence can be shown, if nothing can.
fn reason_of_nothing(player: &Player) -> Option<String> {
    if player.shown().is_some() || player.sequence().source().is_live() || player.follows_newest() {
        return None;
    }
    let failure = player.failure()?;
    let is_all = player.sequence().len() == 1
        || (!player.runs_are_old() && player.runs().iter().all(|run| run.mark == Mark::Failed));
    is_all.then(|| failure.to_string())
}

impl State {
    /// Registers `inputs` to be listed as recently opened once they are shown.
    pub(in crate::app) fn prove(&mut self, inputs: Vec<PathBuf>, side: Side) {
        self.opening.unproven[side as usize] = inputs;
    }

    /// Lists inputs that are shown for the first time as recently opened.
    pub(in crate::app) fn note_proven(&mut self) {
        let is_a_shown = self.player.as_ref().is_some_and(|player| player.shown().is_some());
        let b = self
            .features
            .split_view
            .as_ref()
            .map(|split_view| &split_view.companion);
        let is_b_shown = b.is_some_and(|companion| companion.shown().is_some());
        for (is_shown, side) in [(is_a_shown, Side::A), (is_b_shown, Side::B)] {
            if is_shown && !self.opening.unproven[side as usize].is_empty() {
                let inputs = std::mem::take(&mut self.opening.unproven[side as usize]);
                if let Err(problem) = self.stored.recent.add(&inputs) {
                    self.notices.warn(problem);
                }
                if side == Side::A {
                    self.features
                        .thumbnails
                        .keep_next_at(self.stored.recent.picture_of(&inputs));
                }
            }
        }
    }

    /// Closes a sequence without any frame that can be shown. True if it was one.
    pub(in crate::app) fn close_if_broken(&mut self) -> bool {
        if let Some(player) = &mut self.player
            && player.failure().is_some()
        {
            player.refresh_runs();
        }
        // The first frame of a followed folder may still be being written.
        let player = self.player.as_ref().filter(|_| !self.shared.options.follow);
        let Some(reason) = player.and_then(reason_of_nothing) else {
            return false;
        };
        let name = self.sequence_name().unwrap_or_default();
        self.close_sequence();
        self.opening.failed = Some(FailedOpening {
            name,
            reason,
            choices: Vec::new(),
        });
        true
    }
}
