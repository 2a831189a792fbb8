//! About panel: the program, where it runs, and where it stores its data: for help and for bug reports.

use crate::app::widgets::tool_window::tool_window;
use crate::app::work::files::picture_folder;
use crate::app::{PanelId, State};
use crate::persist;
use crate::source::Example;
use egui::{Align2, Grid, Label, RichText, Ui};
use std::fmt::Write as _;

/// The window while it is open.
pub(super) fn about_ui(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(PanelId::ABOUT) {
        return;
    }
    let mut is_open = true;
    let rows = rows(state);
    tool_window(ui.ctx(), PanelId::ABOUT.name(), "About pointreel")
        .open(&mut is_open)
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .show(ui, |ui| {
            ui.label("A viewer for time-varying point clouds. MIT OR Apache-2.0");
            ui.add_space(4.0);
            Grid::new("about").num_columns(2).show(ui, |ui| {
                for (name, text) in &rows {
                    ui.label(*name);
                    ui.add(Label::new(text).wrap());
                    ui.end_row();
                }
            });
            ui.add_space(4.0);
            ui.add(Label::new(RichText::new(credits()).weak()).wrap());
            ui.add_space(4.0);
            let copy = ui.button("Copy for a report");
            if copy.on_hover_text("All of these as lines of text").clicked() {
                ui.copy_text(lines(&rows));
            }
        });
    state.panels.set(PanelId::ABOUT, is_open);
}

/// Whose the demo and the examples are.
fn credits() -> String {
    let examples = Example::ALL.map(|example| format!("{}: {}", example.title(), example.credit()));
    format!("Demo: CesiumMan, CC BY 4.0, © Cesium\n{}", examples.join("\n"))
}

fn lines(rows: &[(&'static str, String)]) -> String {
    let mut text = String::new();
    for (name, value) in rows {
        _ = writeln!(text, "{name}: {value}");
    }
    text
}

fn rows(state: &State) -> Vec<(&'static str, String)> {
    let graphics = &state.graphics;
    let adapter = match (graphics.adapter.as_str(), graphics.is_software) {
        ("", _) => "none: the CPU draws".to_owned(),
        (name, true) => format!("{name}, software rendering on the CPU"),
        (name, false) => name.to_owned(),
    };
    let painter = if graphics.paints_on_processor {
        "the CPU"
    } else {
        "the GPU"
    };
    let processors = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let settings = persist::place_of("settings.json").map_or_else(
        || "nowhere: the system names no folder".to_owned(),
        |file| file.display().to_string(),
    );
    let mut rows = vec![
        ("Version", env!("CARGO_PKG_VERSION").to_owned()),
        (
            "System",
            format!(
                "{} on {}, {processors} threads",
                std::env::consts::OS,
                std::env::consts::ARCH
            ),
        ),
        ("Adapter", adapter),
        ("Painted by", painter.to_owned()),
        ("Settings", settings),
        ("Images", picture_folder().display().to_string()),
    ];
    if let (Some(name), Some(player)) = (state.sequence_name(), &state.player) {
        let points = player.shown().map_or(0, |frame| frame.frame.points_in_file());
        let frames = player.sequence().len();
        rows.push((
            "Open",
            format!("{name}, {frames} frames, {points} points in the shown one"),
        ));
    }
    rows
}
