//! The question before a session opens anything outside of its folder.

use crate::app::State;
use crate::printable;
use egui::{Align2, Ui, Window};

/// Max names in a question.
const MAX_NAMED: usize = 10;

/// Asks before a session connects, or reads files outside of its folder.
pub(super) fn session_question_ui(ui: &mut Ui, state: &mut State) {
    let Some(question) = &state.opening.session_question else {
        return;
    };
    let name = question.name();
    let [addresses, outside] = [
        question.beyond.addresses.clone(),
        question
            .beyond
            .outside
            .iter()
            .map(|path| path.display().to_string())
            .collect(),
    ];
    Window::new("Open this session?")
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .show(ui, |ui| {
            ui.label(format!(
                "The session {name} is not made of the files in its folder alone."
            ));
            for (text, names) in [
                ("It connects to these addresses, or opens these ports:", addresses),
                ("It reads outside of its folder:", outside),
            ] {
                if !names.is_empty() {
                    ui.label(text);
                    ui.indent(text, |ui| {
                        for name in names.iter().take(MAX_NAMED) {
                            ui.monospace(printable::name(name.clone()));
                        }
                        if names.len() > MAX_NAMED {
                            ui.label(format!("and {} more", names.len() - MAX_NAMED));
                        }
                    });
                }
            }
            ui.horizontal(|ui| {
                if ui.button("Open").on_hover_text("You know where it is from").clicked() {
                    state.trust_session();
                }
                if ui.button("Cancel").on_hover_text("Nothing is opened").clicked() {
                    state.opening.session_question = None;
                }
            });
        });
}
