//! Notes in the window, and in the session.

use super::Notes;
use super::panel::{PANEL, notes_ui};
use crate::app::features::feature::Feature;
use crate::app::panel_row::PanelRow;
use crate::app::state::State;
use crate::document::Document;
use egui::Ui;

impl Feature<State> for Notes {
    fn forget_sequence(state: &mut State) {
        state.features.notes = Self::default();
    }

    fn save(state: &State, document: &mut Document) {
        document.notes.clone_from(&state.features.notes.text);
    }

    fn load(state: &mut State, document: &Document) {
        state.features.notes.text.clone_from(&document.notes);
    }

    fn panels() -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::in_menu(PANEL, "Notes…", notes)];
        PANELS
    }
}

fn notes(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(PANEL) {
        return;
    }
    let corner = state.viewport.rect.right_top();
    let mut is_open = true;
    notes_ui(ui, &mut is_open, &mut state.features.notes, corner);
    state.panels.set(PANEL, is_open);
}
