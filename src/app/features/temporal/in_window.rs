//! Changes between poses, and ghosts of other poses, in the window.

use super::panel::{change_ui, poses_ui};
use super::{ComposedFrame, Temporal};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::panel_row::PanelRow;
use crate::app::settings_row::{NamedRow, SettingsPart, SettingsRow};
use crate::app::state::State;
use crate::app::work::outcome::Outcome;
use egui::Ui;
use std::time::Duration;

impl Feature<State> for FeatureOf<Temporal> {
    fn follow_frame(&self, state: &mut State) -> bool {
        let style = state.drawn_style();
        let Some(player) = &state.player else { return false };
        let (tasks, now) = (&state.shared.tasks, state.shared.now);
        state.features.temporal.follow(player, &style, tasks, now)
    }

    fn follow_panels(&self, state: &mut State) {
        self.follow_frame(state);
    }

    fn next_deadline(&self, state: &State) -> Option<Duration> {
        state.features.temporal.next_deadline()
    }

    fn shows_frame(&self, state: &State) -> bool {
        let temporal = &state.features.temporal;
        temporal.change.is_on || temporal.onion.is_on
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|made: Option<Box<ComposedFrame>>| {
            if let Some(made) = made {
                state.features.temporal.take_in(*made);
            }
        })
    }

    fn forget_sequence(&self, state: &mut State) {
        state.features.temporal.forget_frames();
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::by_itself(change)];
        PANELS
    }

    fn settings(&self) -> &'static [SettingsRow<State>] {
        const SETTINGS: &[SettingsRow<State>] = &[SettingsRow {
            part: SettingsPart::Time,
            rank: 2,
            named: &[
                NamedRow {
                    title: "Change map",
                    text: "Change map…",
                    hint: "Colours each point by its distance to another frame",
                    also: &[
                        "change detection",
                        "cloud-to-cloud distance",
                        "c2c",
                        "difference",
                        "deviation",
                        "compare frames",
                        "distance between frames",
                        "hausdorff",
                    ],
                },
                NamedRow {
                    title: "Onion skin",
                    text: "Onion skin…",
                    hint: "Ghosts of the frames before and after, over the current one",
                    also: &[
                        "ghosts",
                        "accumulate",
                        "merge frames",
                        "overlay frames",
                        "trails of frames",
                        "persistence",
                        "previous frames",
                        "decay",
                    ],
                },
            ],
            show: poses,
        }];
        SETTINGS
    }
}

/// Ghosts of other poses, and where they differ.
fn poses(ui: &mut Ui, state: &mut State) {
    poses_ui(ui, &mut state.features.temporal);
}

fn change(ui: &mut Ui, state: &mut State) {
    let player = state.player.as_ref();
    let shown = player.and_then(|player| Some((player.shown()?, player.sequence().len())));
    let colors = state.style.colors.map;
    let corner = state.viewport.rect.right_top();
    change_ui(ui, &mut state.features.temporal, shown, colors, corner);
}
