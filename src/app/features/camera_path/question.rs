//! The question before something is lost.

use super::Question;
use crate::app::command::Command;
use crate::app::state::State;
use egui::{Align2, Button, Ui, Window};

/// Asks before something is lost.
pub(super) fn question_ui(ui: &mut Ui, state: &mut State) {
    let Some(question) = state.features.path.question else {
        return;
    };
    let (losses, go_on) = match question {
        Question::Open | Question::New => (vec!["The camera path is not saved."], "Discard it"),
        Question::Quit => (state.losses(), "Quit anyway"),
    };
    let can_save = state.features.path.is_unsaved() && state.features.path.draft.path().is_some();
    Window::new("Before this is lost")
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .show(ui, |ui| {
            for loss in losses {
                ui.label(loss);
            }
            ui.horizontal(|ui| {
                let save = ui.add_enabled(can_save, Button::new("Save it…"));
                if save.on_hover_text("Saves the path; nothing else is done").clicked() {
                    state.features.path.question = None;
                    state.run(Command::SAVE_PATH);
                }
                if ui.button(go_on).on_hover_text("It is lost").clicked() {
                    state.go_on_with(question);
                }
                if ui.button("Back").on_hover_text("Nothing is done (Esc)").clicked() {
                    state.features.path.question = None;
                }
            });
        });
}
