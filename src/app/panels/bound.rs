//! Panels of features in the window: what each is given of the state, and what becomes of what it asks for.

use crate::app::State;
use crate::app::features::export::panel::{self as export, ExportRequest};
use egui::Ui;

pub(super) fn export_ui(ui: &mut Ui, state: &mut State) {
    let of = state.exportable();
    let top = state.viewport.rect.center_top();
    let is_open = &mut state.panels.export;
    match export::export_ui(ui, is_open, &mut state.export, &of, top) {
        Some(ExportRequest::ChoosePlace) => state.ask_for_place(),
        Some(ExportRequest::Start) => state.start_export(),
        None => {}
    }
}
