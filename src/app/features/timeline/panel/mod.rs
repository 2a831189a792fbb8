//! The timeline: thumbnails, markers, a bar to scrub on, with frames in memory and failed ones, a curve, and the
//! transport under them.

mod bar;
mod cells;
mod context;
mod curve;
mod gaps;
mod legend;
mod markers;
mod range;
mod strip;
mod transport;

pub(in crate::app) use context::{TimelineContext, TimelineRequest};

use egui::Ui;

/// Thumbnails, markers, bar, curve, transport, place and pace; of a single frame its name.
pub(in crate::app) fn timeline_ui(ui: &mut Ui, context: &mut TimelineContext<'_>) -> Vec<TimelineRequest> {
    if let Some(player) = &mut context.player {
        player.refresh_runs();
        if transport::is_still(player) {
            ui.horizontal(|ui| transport::still_ui(ui, player));
            // It is the thumbnail in the list of recent files.
            if context.thumbnails.is_on {
                context.thumbnails.want(vec![0]);
            }
            return Vec::new();
        }
    }
    let on_strip = strip::strip_ui(ui, context);
    let keeps = markers::markers_ui(ui, context).then_some(TimelineRequest::Keep);
    let on_bar = bar::scrub_bar(ui, context);
    gaps::gaps_ui(ui, context);
    let is_cut = range::range_ui(ui, context).then_some(TimelineRequest::Keep);
    context.thumbnails.hover(on_strip.or(on_bar));
    curve::curve_ui(ui, context);
    ui.add_space(4.0);
    let command = transport::row_ui(ui, context).map(TimelineRequest::Run);
    keeps.into_iter().chain(is_cut).chain(command).collect()
}
