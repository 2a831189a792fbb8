//! The list of keys, from the table that dispatches them.

use crate::app::commands::commands;
use crate::app::commands::common::group;
use crate::app::theme::ACCENT;
use crate::app::widgets::rows::heading_of_list;
use crate::app::widgets::tool_window::{is_small, tool_window};
use crate::app::{GESTURES, PanelId, State};
use egui::{Grid, RichText, ScrollArea, Ui};

/// Width of the window, points.
const WIDTH: f32 = 640.0;

/// A window with every key and mouse gesture while it is open.
pub(super) fn help_ui(ui: &mut Ui, state: &mut State) {
    let mut open = state.panels.has(PanelId::HELP);
    let screen = ui.ctx().content_rect();
    tool_window(ui.ctx(), PanelId::HELP.name(), "Keys and mouse")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_size([WIDTH, screen.height()])
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(screen.center())
        .show(ui, |ui| {
            ui.spacing_mut().interact_size.y = 0.0;
            if is_small(ui.ctx()) {
                // Scrolled as a whole, one list below another.
                at_left(ui);
                at_right(ui);
                return;
            }
            let height = (screen.height() - 90.0).max(120.0);
            ScrollArea::vertical().max_height(height).show(ui, |ui| {
                ui.columns_const(|[left, right]| {
                    at_left(left);
                    at_right(right);
                });
            });
        });
    state.panels.set(PanelId::HELP, open);
}

fn at_left(ui: &mut Ui) {
    bindings(ui, group::PLAYING);
    bindings(ui, group::POINTS);
    bindings(ui, group::FILE);
}

fn at_right(ui: &mut Ui) {
    bindings(ui, group::VIEW);
    heading_of_list(ui, "Mouse and flying");
    table(ui, "gestures", GESTURES.iter().copied());
}

fn bindings(ui: &mut Ui, group: &str) {
    heading_of_list(ui, group);
    let rows = commands().filter_map(|row| Some((row.keys?, row.what)));
    let rows = rows.filter(|(keys, _)| keys.group == group);
    table(ui, group, rows.map(|(keys, what)| (keys.text, what)));
}

fn table<'a>(ui: &mut Ui, id: &str, rows: impl Iterator<Item = (&'a str, &'a str)>) {
    Grid::new(id)
        .num_columns(2)
        .min_col_width(84.0)
        .spacing([12.0, 5.0])
        .show(ui, |ui| {
            for (keys, text) in rows {
                ui.label(RichText::new(keys).color(ACCENT));
                ui.label(text);
                ui.end_row();
            }
        });
}
