//! The panels, one file each: `fn timeline_ui(ui, &mut State)`. They read and change [`State`] and know no GPU.

mod benchmark;
mod beside;
mod camera_path;
mod clip;
mod colors;
mod comparison;
mod export;
mod footprints;
mod help;
mod lab;
mod legend;
mod marks;
mod measuring;
mod menu;
mod notices;
mod pair;
mod palette;
mod point;
mod presets;
mod quality;
mod question;
mod ramp;
mod scale_bar;
mod settings;
mod shading;
mod statistics;
mod temporal;
mod timeline;
mod trails;
mod viewport;
mod voxels;
mod works;

pub use benchmark::benchmark_ui;
pub use camera_path::camera_path_ui;
pub use export::export_ui;
pub use help::help_ui;
pub use measuring::measuring_ui;
pub use menu::menu_ui;
pub use notices::notices_ui;
pub use point::point_ui;
pub use quality::QualityLimits;
pub use settings::settings_ui;
pub use statistics::statistics_ui;
pub use temporal::change_ui;
pub use timeline::timeline_ui;
pub use viewport::viewport_ui;

use super::State;
use beside::beside_ui;
use comparison::comparison_ui;
use egui::{
    CentralPanel, Context, Frame, Id, InnerResponse, Margin, Panel, ThemePreference, Ui, Vec2,
};
use palette::palette_ui;
use presets::preset_name_ui;
use question::question_ui;

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

/// Has the panels run again when the window `name` has another size than in the last pass: what is in it takes its new
/// places then.
fn settle<R>(ui: &Ui, name: &'static str, shown: Option<InnerResponse<R>>) {
    let size = shown.map(|shown| shown.response.rect.size());
    let id = Id::unique(name).with("size");
    let before = ui.data_mut(|data| {
        let before = data.get_temp::<Option<Vec2>>(id);
        data.insert_temp(id, size);
        before
    });
    if before.is_some_and(|before| before != size) {
        ui.ctx().request_repaint();
    }
}

/// `1234567` → `1,234,567`.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.char_indices() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Bytes with a binary unit.
fn bytes(count: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = count as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{count} B")
    } else {
        format!("{value:.1} {}", UNITS[unit])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_000), "1,000");
        assert_eq!(grouped(12_345_678), "12,345,678");
        assert_eq!(bytes(1023), "1023 B");
        assert_eq!(bytes(1024), "1.0 KiB");
        assert_eq!(bytes(3 << 29), "1.5 GiB");
    }
}
