//! The timeline: markers, a bar to scrub on, with what is in memory and what failed, a curve, and the transport under them.

mod bar;
mod curve;
mod markers;
mod transport;

use crate::app::State;
use egui::Ui;

/// Markers, bar, curve, transport, place and pace.
pub fn timeline_ui(ui: &mut Ui, state: &mut State) {
    if let Some(player) = &mut state.player {
        player.refresh_runs();
    }
    markers::markers_ui(ui, state);
    bar::scrub_bar(ui, state);
    curve::curve_ui(ui, state);
    ui.add_space(4.0);
    transport::row_ui(ui, state);
}
