//! Changes between poses, and ghosts of other poses, in the window.

use super::panel::change_ui;
use super::{ComposedFrame, Temporal};
use crate::app::features::feature::Feature;
use crate::app::panel_row::PanelRow;
use crate::app::state::State;
use crate::app::work::outcome::Outcome;
use egui::Ui;
use std::time::Duration;

impl Feature<State> for Temporal {
    fn follow_frame(state: &mut State) -> bool {
        let style = state.drawn_style();
        let Some(player) = &state.player else { return false };
        let (tasks, now) = (&state.shared.tasks, state.shared.now);
        state.features.temporal.follow(player, &style, tasks, now)
    }

    fn follow_panels(state: &mut State) {
        Self::follow_frame(state);
    }

    fn next_deadline(state: &State) -> Option<Duration> {
        state.features.temporal.next_deadline()
    }

    fn shows_frame(state: &State) -> bool {
        let temporal = &state.features.temporal;
        temporal.change.is_on || temporal.onion.is_on
    }

    fn take(state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|made: Option<Box<ComposedFrame>>| {
            if let Some(made) = made {
                state.features.temporal.take_in(*made);
            }
        })
    }

    fn forget_sequence(state: &mut State) {
        state.features.temporal.forget_frames();
    }

    fn panels() -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::by_itself(change)];
        PANELS
    }
}

fn change(ui: &mut Ui, state: &mut State) {
    let player = state.player.as_ref();
    let shown = player.and_then(|player| Some((player.shown()?, player.sequence().len())));
    let colors = state.style.colors.map;
    let corner = state.viewport.rect.right_top();
    change_ui(ui, &mut state.features.temporal, shown, colors, corner);
}
