//! The window of notes.

use crate::app::open_panels::PanelId;
use crate::app::widgets::tool_window::tool_window;
use egui::{Align2, Pos2, TextEdit, Ui, vec2};

/// The name of the window among panels.
pub(super) const PANEL: PanelId = PanelId::new("notes");

/// Lines of the field while there is less.
const ROWS: usize = 8;

/// The window while it is open, at `corner`.
pub(super) fn notes_ui(ui: &mut Ui, is_open: &mut bool, notes: &mut String, corner: Pos2) {
    tool_window(ui.ctx(), PANEL.name(), "Notes")
        .open(is_open)
        .pivot(Align2::RIGHT_TOP)
        .default_pos(corner + vec2(-12.0, 12.0))
        .show(ui, |ui| {
            let field = TextEdit::multiline(notes)
                .hint_text("Anything to remember of this sequence; kept with its session")
                .desired_rows(ROWS);
            let field = ui.add(field);
            ui.ctx()
                .accesskit_node_builder(field.id, |node| node.set_label("Text of the notes"));
        });
}
