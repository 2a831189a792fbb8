//! Messages over the image, at its lower left, and bars of long work below them.

use crate::app::theme::GOOD;
use crate::app::work::panel::work_ui;
use crate::app::{Notice, PanelId, Severity, State, Work};
use egui::{Align2, Area, Frame, Id, RichText, ScrollArea, Stroke, Ui, vec2};

/// Width of a message.
const WIDTH: f32 = 420.0;

/// Longer texts scroll.
const MAX_TEXT_HEIGHT: f32 = 120.0;

/// Number of others of a kind that the tooltip lists.
const LISTED_OTHERS: usize = 12;

/// Every message with its full text, a button to copy it and one to dismiss it; long work with a bar and a button to
/// cancel it.
pub(super) fn notices_ui(ui: &mut Ui, state: &mut State) {
    let works = shown_works(state);
    if state.notices.list().is_empty() && works.is_empty() {
        return;
    }
    let mut dismissed = None;
    // The part of the window that panels leave free is the image.
    let corner = state.viewport.rect.left_bottom() + vec2(12.0, -12.0);
    Area::new(Id::unique("notices"))
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(corner)
        .show(ui.ctx(), |ui| {
            for notice in state.notices.list() {
                if notice_ui(ui, notice) {
                    dismissed = Some(notice.id);
                }
            }
            for work in works {
                work_ui(ui, work, state.now(), WIDTH);
            }
        });
    if let Some(id) = dismissed {
        state.notices.dismiss(id);
    }
}

/// Returns long-running work without its own open window.
fn shown_works(state: &State) -> Vec<&Work> {
    // Its window has the same bar.
    let measuring = state.features.benchmark.work();
    let measuring = measuring.filter(|_| !state.panels.has(PanelId::BENCHMARK));
    let works = state.shared.works.list().iter().chain(measuring);
    works.filter(|work| work.is_long(state.now())).collect()
}

/// True if it is to be dismissed.
fn notice_ui(ui: &mut Ui, notice: &Notice) -> bool {
    let (color, word) = match notice.severity {
        Severity::Info => (GOOD, "Done"),
        Severity::Hint => (ui.visuals().hyperlink_color, "Hint"),
        Severity::Warning => (ui.visuals().warn_fg_color, "Note"),
        Severity::Error => (ui.visuals().error_fg_color, "Error"),
    };
    let frame = Frame::window(ui.style()).stroke(Stroke::new(1.0, color.gamma_multiply(0.7)));
    frame
        .show(ui, |ui| {
            ui.set_width(WIDTH);
            let dismissed = ui
                .horizontal(|ui| {
                    ui.label(RichText::new(word).strong().color(color));
                    if notice.count > 1 {
                        ui.weak(format!("{} times", notice.count));
                    }
                    if !notice.others.is_empty() {
                        let more = format!("and {} more like it", notice.others.len());
                        ui.weak(more).on_hover_text(listed(&notice.others));
                    }
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        let dismissed = ui.small_button("Dismiss").clicked();
                        if ui.small_button("Copy").on_hover_text("Copy the full text").clicked() {
                            let others = notice.others.iter().map(String::as_str);
                            let all = std::iter::once(notice.text.as_str()).chain(others);
                            let all: Vec<&str> = all.collect();
                            ui.ctx().copy_text(all.join("\n"));
                        }
                        dismissed
                    })
                    .inner
                })
                .inner;
            ScrollArea::vertical()
                .id_salt(notice.id)
                .max_height(MAX_TEXT_HEIGHT)
                .show(ui, |ui| ui.label(&notice.text));
            dismissed
        })
        .inner
}

/// The first of them, a line each.
fn listed(others: &[String]) -> String {
    let mut lines: Vec<&str> = others.iter().take(LISTED_OTHERS).map(String::as_str).collect();
    if others.len() > LISTED_OTHERS {
        lines.push("… (Copy copies all)");
    }
    lines.join("\n")
}
