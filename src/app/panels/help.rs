//! The list of keys, from the table that dispatches them.

use crate::app::theme::ACCENT;
use crate::app::{BINDINGS, GESTURES, State};
use egui::{Grid, RichText, ScrollArea, Ui, Window};

/// Width of the window, points.
const WIDTH: f32 = 640.0;

/// A window with every key and mouse gesture while it is open.
pub fn help_ui(ui: &mut Ui, state: &mut State) {
    let mut open = state.panels.help;
    let screen = ui.ctx().content_rect();
    Window::new("Keys and mouse")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_size([WIDTH, screen.height()])
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(screen.center())
        .show(ui, |ui| {
            ScrollArea::vertical().show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    ui.vertical(|ui| {
                        group(ui, "Playing");
                        group(ui, "File and window");
                    });
                    ui.add_space(24.0);
                    ui.vertical(|ui| group(ui, "View"));
                });
                ui.add_space(8.0);
                ui.strong("Mouse and flying");
                Grid::new("gestures")
                    .num_columns(2)
                    .spacing([24.0, 4.0])
                    .show(ui, |ui| {
                        for (gesture, text) in GESTURES {
                            row(ui, gesture, text);
                        }
                    });
            });
        });
    state.panels.help = open;
}

fn group(ui: &mut Ui, group: &str) {
    ui.strong(group);
    Grid::new(group)
        .num_columns(2)
        .spacing([24.0, 4.0])
        .show(ui, |ui| {
            for binding in BINDINGS.iter().filter(|binding| binding.group == group) {
                row(ui, binding.keys, binding.text);
            }
        });
    ui.add_space(8.0);
}

fn row(ui: &mut Ui, keys: &str, text: &str) {
    ui.label(
        RichText::new(keys)
            .monospace()
            .color(crate::app::theme::ACCENT),
    );
    ui.label(text);
    ui.end_row();
}
