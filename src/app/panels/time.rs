//! The section of the settings about time: thumbnails, trails, and what other poses add to the shown one.

use crate::app::State;
use crate::app::features::temporal::panel::poses_ui;
use crate::app::features::thumbnails::panel::thumbnails_ui;
use crate::app::features::trails::panel::field_ui;
use crate::app::widgets::rows::heading;
use egui::Ui;

pub(super) fn time_ui(ui: &mut Ui, state: &mut State) {
    heading(ui, "Time");
    thumbnails_ui(ui, &mut state.thumbnails);
    field_ui(ui, &mut state.trails);
    poses_ui(ui, &mut state.temporal);
}
