//! The row of the settings about thumbnails.

use super::Thumbnails;
use crate::app::widgets::rows::{row, rows};
use egui::{Checkbox, Ui};

/// Shows the toggle of the thumbnails.
pub(in crate::app) fn thumbnails_ui(ui: &mut Ui, thumbnails: &mut Thumbnails) {
    rows(ui, "thumbnails", |ui| {
        row(
            ui,
            "Thumbnails",
            "Small images of the frames over the timeline and in its tooltips, all from one view; rendered when \
                idle",
            Checkbox::new(&mut thumbnails.is_on, "Shown"),
        );
    });
}
