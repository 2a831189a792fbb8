//! The timeline: thumbnails, markers, a bar to scrub on, with what is in memory and what failed, a curve, and the
//! transport under them.

mod bar;
mod curve;
mod markers;
mod strip;
mod transport;

use crate::app::State;
use egui::Ui;

/// Thumbnails, markers, bar, curve, transport, place and pace.
pub(in crate::app) fn timeline_ui(ui: &mut Ui, state: &mut State) {
    if let Some(player) = &mut state.player {
        player.refresh_runs();
    }
    let on_strip = strip::strip_ui(ui, state);
    markers::markers_ui(ui, state);
    let on_bar = bar::scrub_bar(ui, state);
    state.thumbnails.hover(on_strip.or(on_bar));
    curve::curve_ui(ui, state);
    ui.add_space(4.0);
    transport::row_ui(ui, state);
}
