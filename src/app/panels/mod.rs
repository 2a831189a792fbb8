//! The panels, one file each, and a row each of `table.rs`. They read and change [`State`] and know no GPU.

mod about;
mod colors;
mod depth_filters;
mod help;
mod items;
mod legend;
mod marks;
mod menu;
mod notices;
mod pair;
mod presets;
mod question;
mod scale_bar;
mod settings;
mod statistics;
mod style;
mod table;
mod viewport;
mod welcome;

use super::{PanelId, State};
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::widgets::tool_window::{note_free_rect, space, tool_window};
use egui::{CentralPanel, Context, Frame, Margin, Panel, ScrollArea, ThemePreference, Ui};
use menu::menu_ui;
pub(in crate::app) use settings::own_rows;
pub(in crate::app) use table::{menu_panels, panels};
use viewport::viewport_ui;

/// Minimum width of the image next to a panel, points.
const MIN_VIEW_WIDTH: f32 = 160.0;

/// Everything in the window, keys included.
pub fn window_ui(ui: &mut Ui, state: &mut State) {
    state.shared.counters.ui_passes += 1;
    state.handle_keys(ui.ctx());
    let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
    Panel::top("menu").frame(bar).show(ui, |ui| menu_ui(ui, state));
    for row in panels() {
        bar_ui(ui, state, row);
    }
    let is_settled = note_free_rect(ui.ctx(), ui.available_rect_before_wrap());
    for row in panels() {
        side_ui(ui, state, row);
    }
    CentralPanel::no_frame().show(ui, |ui| viewport_ui(ui, state));
    for row in panels().filter(|row| is_settled && matches!(row.place, Dock::Window)) {
        (row.show)(ui, state);
    }
    state.panels.note_order(ui.ctx());
    for row in panels().filter(|row| matches!(row.place, Dock::Over)) {
        (row.show)(ui, state);
    }
    follow_theme(ui.ctx(), state.appearance.theme);
    state.note_changes(ui.ctx());
    state.follow_panels();
}

/// A bar above or below the image.
fn bar_ui(ui: &mut Ui, state: &mut State, row: &PanelRow<State>) {
    let (bar, margin) = match row.place {
        Dock::Top(name, is_shown) if is_shown(state) => (Panel::top(name), Margin::symmetric(8, 4)),
        Dock::Bottom(name) => (Panel::bottom(name), Margin::symmetric(10, 8)),
        _ => return,
    };
    let frame = Frame::side_top_panel(ui.style()).inner_margin(margin);
    bar.frame(frame).show(ui, |ui| (row.show)(ui, state));
}

/// Shows a side panel next to the image, while it is open; over it, in a window that is too narrow for both.
fn side_ui(ui: &mut Ui, state: &mut State, row: &PanelRow<State>) {
    let Some(id) = row.id.filter(|&id| state.panels.has(id)) else {
        return;
    };
    let (panel, width, range) = match &row.place {
        Dock::Left(width, range) => (Panel::left(id.name()), *width, range.clone()),
        Dock::Right(width, range) => (Panel::right(id.name()), *width, range.clone()),
        Dock::Top(..) | Dock::Chip(_) | Dock::Bottom(_) | Dock::Window | Dock::Over => return,
    };
    let max_width = ui.available_width() - MIN_VIEW_WIDTH;
    if max_width < *range.start() {
        return floating_ui(ui, state, row, id);
    }
    let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(12, 8));
    panel
        .frame(frame)
        .default_size(width)
        .size_range(*range.start()..=range.end().min(max_width))
        .show(ui, |ui| (row.show)(ui, state));
}

/// The panel of a row in its own window, which can be closed to see the image.
fn floating_ui(ui: &mut Ui, state: &mut State, row: &PanelRow<State>, id: PanelId) {
    let space = space(ui.ctx());
    let mut is_open = true;
    tool_window(ui.ctx(), id.name(), row.menu.unwrap_or(id.name()))
        .open(&mut is_open)
        .scroll(false)
        .default_rect(space.shrink(8.0))
        .show(ui, |ui| {
            let height = ui.available_height();
            ScrollArea::both()
                .max_height(height)
                .show(ui, |ui| (row.show)(ui, state));
        });
    if !is_open {
        state.panels.set(id, false);
    }
}

/// Reruns the panels if another theme was chosen.
fn follow_theme(ctx: &Context, theme: ThemePreference) {
    if ctx.options(|options| options.theme_preference) != theme {
        ctx.set_theme(theme);
        ctx.request_repaint();
    }
}
