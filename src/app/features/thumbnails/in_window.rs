//! Thumbnails of the frames, in the window.

use super::panel::thumbnails_ui;
use super::{Delivery, Thumbnails};
use crate::app::command::Command;
use crate::app::commands::common::{Row, needs_sequence};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::settings_row::{NamedRow, SettingsPart, SettingsRow};
use crate::app::state::State;
use crate::app::work::outcome::Outcome;
use egui::Ui;

const COMMANDS: &[Row] = &[
    Row::new(Command::TOGGLE_THUMBNAILS, "Thumbnails", |state| {
        state.features.thumbnails.is_on ^= true;
    })
    .what("Thumbnails: show or hide over the timeline")
    .also(&["preview images", "filmstrip"])
    .on_if(|state| state.features.thumbnails.is_on),
    Row::new(Command::REDO_THUMBNAILS, "Regenerate thumbnails", |state| {
        state.features.thumbnails.redo();
    })
    .applies(needs_sequence),
];

impl Feature<State> for FeatureOf<Thumbnails> {
    fn follow(&self, state: &mut State) {
        state.follow_thumbnails();
    }

    fn follow_panels(&self, state: &mut State) {
        state.follow_thumbnails();
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|delivery: Box<Delivery>| state.features.thumbnails.take_in(*delivery))
    }

    fn forget_frame(&self, state: &mut State, index: usize) {
        state.features.thumbnails.forget_frame(index);
    }

    fn forget_sequence(&self, state: &mut State) {
        state.features.thumbnails.forget_frames();
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }

    fn settings(&self) -> &'static [SettingsRow<State>] {
        const SETTINGS: &[SettingsRow<State>] = &[SettingsRow {
            part: SettingsPart::Time,
            rank: 0,
            named: &[NamedRow {
                title: "Thumbnails",
                text: "Thumbnails: settings…",
                hint: "Small images of the frames over the timeline",
                also: &["preview images", "filmstrip"],
            }],
            show: thumbnails,
        }];
        SETTINGS
    }
}

fn thumbnails(ui: &mut Ui, state: &mut State) {
    thumbnails_ui(ui, &mut state.features.thumbnails);
}

impl State {
    /// Begins the next thumbnail if there is time for it.
    fn follow_thumbnails(&mut self) {
        // The first image of the window has priority.
        let look = self.opening.looked.look().filter(|_| self.has_looked());
        let Some((player, look)) = self.player.as_ref().zip(look) else {
            return;
        };
        let style = self.style.resolved(&look);
        let hints = style.of_sequence.color_hints;
        let key = (self.camera.up, style.colors, hints);
        let is_measured = self.features.benchmark.is_running();
        self.features
            .thumbnails
            .follow(player, &look, key, is_measured, &self.shared.tasks, self.shared.now);
    }
}
