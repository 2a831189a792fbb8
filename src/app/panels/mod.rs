//! The panels, one file each: `fn timeline_ui(ui, &mut State)`. They read and change [`State`] and know no GPU.

mod bound;
mod clip;
mod colors;
mod help;
mod legend;
mod marks;
mod menu;
mod notices;
mod pair;
mod presets;
mod quality;
mod question;
mod scale_bar;
mod settings;
mod statistics;
mod style;
mod viewport;

use super::State;
use super::features::benchmark::panel::benchmark_ui;
use super::features::beside::panel::beside_ui;
use super::features::camera_path::panel::camera_path_ui;
use super::features::comparison::panel::comparison_ui;
use super::features::inspection::measuring_panel::measuring_ui;
use super::features::inspection::point_panel::point_ui;
use super::features::palette::panel::palette_ui;
use super::features::temporal::panel::change_ui;
use super::features::timeline::panel::timeline_ui;
use bound::export_ui;
use egui::{CentralPanel, Context, Frame, Margin, Panel, ThemePreference, Ui};
use help::help_ui;
use menu::menu_ui;
use notices::notices_ui;
use presets::preset_name_ui;
use question::question_ui;
use settings::settings_ui;
use statistics::statistics_ui;
use viewport::viewport_ui;

/// Everything in the window, keys included.
pub fn window_ui(ui: &mut Ui, state: &mut State) {
    state.counters.ui_passes += 1;
    state.handle_keys(ui.ctx());
    let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
    Panel::top("menu")
        .frame(bar)
        .show(ui, |ui| menu_ui(ui, state));
    if state.pictures().is_some() {
        let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        Panel::top("comparison").frame(bar).show(ui, |ui| {
            comparison_ui(ui, state);
            beside_ui(ui, state);
        });
    }
    let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 8));
    Panel::bottom("timeline")
        .frame(bar)
        .show(ui, |ui| timeline_ui(ui, state));
    let side = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(12, 8));
    if state.panels.settings {
        Panel::right("settings")
            .frame(side)
            .default_size(312.0)
            .size_range(280.0..=460.0)
            .show(ui, |ui| settings_ui(ui, state));
    }
    if state.panels.statistics {
        Panel::left("statistics")
            .frame(side)
            .default_size(272.0)
            .size_range(240.0..=420.0)
            .show(ui, |ui| statistics_ui(ui, state));
    }
    CentralPanel::no_frame().show(ui, |ui| viewport_ui(ui, state));
    point_ui(ui, state);
    measuring_ui(ui, state);
    change_ui(ui, state);
    camera_path_ui(ui, state);
    export_ui(ui, state);
    notices_ui(ui, state);
    help_ui(ui, state);
    benchmark_ui(ui, state);
    preset_name_ui(ui, state);
    question_ui(ui, state);
    palette_ui(ui, state);
    follow_theme(ui.ctx(), state.theme);
    state.note_settings(ui.ctx());
    state.follow_poses();
    state.follow_thumbnails();
}

/// Has the panels run again where another theme was chosen.
fn follow_theme(ctx: &Context, theme: ThemePreference) {
    if ctx.options(|options| options.theme_preference) != theme {
        ctx.set_theme(theme);
        ctx.request_repaint();
    }
}
