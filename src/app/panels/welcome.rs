//! What is in place of the picture while nothing is open: what could not be opened and why, and what to do.

use crate::app::command::{Command, keys_of};
use crate::app::{FailedOpening, State};
use egui::{Button, Frame, Rect, RichText, ScrollArea, Stroke, Ui, UiBuilder, vec2};

/// Width of what is in the middle, points.
const WIDTH: f32 = 460.0;

/// Longer reasons scroll, points.
const MAX_REASON_HEIGHT: f32 = 110.0;

/// The view over all of `rect`.
pub(super) fn welcome_ui(ui: &mut Ui, rect: Rect, state: &mut State) {
    // Text of a light theme is dark.
    ui.painter_at(rect).rect_filled(rect, 0.0, ui.visuals().panel_fill);
    let width = WIDTH.min(rect.width() - 24.0).max(0.0);
    let middle = Rect::from_center_size(rect.center(), vec2(width, (rect.height() - 24.0).max(0.0)));
    ui.scope_builder(UiBuilder::new().max_rect(middle), |ui| {
        ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
            ui.add_space((0.18 * rect.height()).min(120.0));
            match &state.failed {
                Some(failed) => failed_ui(ui, failed),
                None => _ = ui.vertical_centered(|ui| ui.heading("No sequence is open")),
            }
            ui.add_space(8.0);
            ui.vertical_centered(|ui| {
                ui.label("Drop files or a folder of point clouds here, or");
                for (text, command) in [
                    ("Open files", Command::OpenFiles),
                    ("Open folder", Command::OpenFolder),
                    ("Play the demo", Command::OpenDemo),
                ] {
                    let button = Button::new(text).min_size(vec2(160.0, 28.0));
                    if ui.add(button.shortcut_text(keys_of(command))).clicked() {
                        state.run(command);
                    }
                }
            });
        });
    });
}

/// What could not be shown, with the reason in full.
fn failed_ui(ui: &mut Ui, failed: &FailedOpening) {
    let color = ui.visuals().error_fg_color;
    let frame = Frame::window(ui.style()).stroke(Stroke::new(1.0, color.gamma_multiply(0.7)));
    frame.show(ui, |ui| {
        ui.horizontal(|ui| {
            let title = format!("{} cannot be shown", failed.name);
            ui.label(RichText::new(title).strong().color(color));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.small_button("Copy").on_hover_text("Copy the full text").clicked() {
                    ui.copy_text(failed.reason.clone());
                }
            });
        });
        ScrollArea::vertical()
            .id_salt("reason")
            .max_height(MAX_REASON_HEIGHT)
            .show(ui, |ui| ui.label(&failed.reason));
    });
}
