//! Trails in the window.

use super::panel::paint_trails;
use super::{Traced, TrailField, Trails};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group};
use crate::app::features::feature::Feature;
use crate::app::features::inspection::Anchor;
use crate::app::state::State;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::work::outcome::Outcome;
use crate::document::{Document, ShownTrails, SpreadTrails};
use egui::Key;

const COMMANDS: &[Row] = &[Row::new(
    Command::new("trails"),
    "Trails of the picked points",
    State::toggle_trails,
)
.keys(group::POINTS, "Shift+T", &[Chord::shift(Key::T)])
.on_if(|state| state.features.trails.is_on)];

impl Feature<State> for Trails {
    fn follow_frame(state: &mut State) -> bool {
        let (Some(player), features) = (&state.player, &mut state.features) else {
            return false;
        };
        features
            .trails
            .follow(player, &features.inspection, &state.shared.tasks)
    }

    fn follow_panels(state: &mut State) {
        Self::follow_frame(state);
    }

    fn shows_frame(state: &State) -> bool {
        state.features.trails.are_shown()
    }

    fn has_news(state: &State) -> bool {
        state.features.trails.progress().is_some()
    }

    fn take(state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|traced: Traced| state.features.trails.take_in(traced))
    }

    fn forget_sequence(state: &mut State) {
        let trails = &mut state.features.trails;
        trails.forget_points();
        trails.is_on = false;
        trails.field.is_on = false;
    }

    fn save(state: &State, document: &mut Document) {
        let Self { is_on, kept, field, .. } = &state.features.trails;
        document.trails = ShownTrails {
            of_picked: *is_on,
            kept: kept.iter().filter_map(Anchor::measured).collect(),
            spread: field.is_on.then_some(SpreadTrails {
                points: field.points,
                frames: field.length,
            }),
        };
    }

    fn load(state: &mut State, document: &Document) {
        let (trails, shown) = (&mut state.features.trails, &document.trails);
        trails.is_on = shown.of_picked;
        trails.kept = shown.kept.iter().map(Anchor::of).collect();
        trails.field.is_on = shown.spread.is_some();
        if let Some(SpreadTrails { points, frames }) = shown.spread {
            trails.field.points = points.clamp(1, TrailField::MAX_POINTS);
            trails.field.length = frames.clamp(1, TrailField::MAX_LENGTH);
        }
    }

    fn paint(state: &State, canvas: &PictureOverlay<'_>, _is_first: bool) {
        if let Some(player) = &state.player {
            paint_trails(canvas, &state.features.trails, player);
        }
    }

    fn commands() -> &'static [Row] {
        COMMANDS
    }
}

impl State {
    pub(in crate::app) fn toggle_trails(&mut self) {
        self.features.trails.is_on ^= true;
        if self.features.trails.is_on && self.features.inspection.picked().next().is_none() {
            self.notices.hint("Pick a point (I and a click): its trail is shown");
        }
    }
}
