//! Trails in the window.

use super::panel::{field_ui, paint_trails};
use super::{Traced, Trails};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::settings_row::{NamedRow, SettingsPart, SettingsRow};
use crate::app::state::State;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::work::outcome::Outcome;
use crate::document::Document;
use egui::{Key, Ui};

const COMMANDS: &[Row] = &[Row::new(
    Command::new("trails"),
    "Trails of the picked points",
    State::toggle_trails,
)
.keys(group::POINTS, "Shift+T", &[Chord::shift(Key::T)])
.on_if(|state| state.features.trails.is_on)];

impl Feature<State> for FeatureOf<Trails> {
    fn follow_frame(&self, state: &mut State) -> bool {
        let (Some(player), features) = (&state.player, &mut state.features) else {
            return false;
        };
        features
            .trails
            .follow(player, &features.inspection, &state.shared.tasks)
    }

    fn follow_panels(&self, state: &mut State) {
        self.follow_frame(state);
    }

    fn shows_frame(&self, state: &State) -> bool {
        state.features.trails.are_shown()
    }

    fn has_news(&self, state: &State) -> bool {
        state.features.trails.progress().is_some()
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|traced: Traced| state.features.trails.take_in(traced))
    }

    fn forget_sequence(&self, state: &mut State) {
        let trails = &mut state.features.trails;
        trails.forget_points();
        trails.is_on = false;
        trails.field.is_on = false;
    }

    fn save(&self, state: &State, document: &mut Document) {
        document.trails = state.features.trails.shown();
    }

    fn load(&self, state: &mut State, document: &Document) {
        state.features.trails.show(&document.trails);
    }

    fn paint(&self, state: &State, canvas: &PictureOverlay<'_>, _is_first: bool) {
        if let Some(player) = &state.player {
            paint_trails(canvas, &state.features.trails, player);
        }
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }

    fn settings(&self) -> &'static [SettingsRow<State>] {
        const SETTINGS: &[SettingsRow<State>] = &[SettingsRow {
            part: SettingsPart::Time,
            rank: 1,
            named: &[NamedRow {
                title: "Trails",
                text: "Trails…",
                hint: "Trajectories of points that are spread over the file, over the last frames",
                also: &[
                    "trajectories",
                    "motion",
                    "paths",
                    "flow",
                    "tracks",
                    "motion vectors",
                    "velocity",
                ],
            }],
            show: field,
        }];
        SETTINGS
    }
}

/// Trails of points that are spread over the frame.
fn field(ui: &mut Ui, state: &mut State) {
    field_ui(ui, &mut state.features.trails);
}

impl State {
    pub(in crate::app) fn toggle_trails(&mut self) {
        self.features.trails.is_on ^= true;
        if self.features.trails.is_on && self.features.inspection.picked().next().is_none() {
            self.notices.hint("Pick a point (I and a click): its trail is shown");
        }
    }
}
