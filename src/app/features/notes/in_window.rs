//! Notes in the window, and in the session.

use super::Notes;
use super::panel::{PANEL, notes_ui};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::panel_row::PanelRow;
use crate::app::state::State;
use egui::Ui;

impl Feature<State> for FeatureOf<Notes> {
    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] =
            &[PanelRow::in_menu(PANEL, "Notes…", notes).also(&["comment", "description", "metadata"])];
        PANELS
    }
}

fn notes(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(PANEL) {
        return;
    }
    let corner = state.viewport.rect.right_top();
    let mut is_open = true;
    notes_ui(ui, &mut is_open, &mut state.document.notes, corner);
    state.panels.set(PANEL, is_open);
}
