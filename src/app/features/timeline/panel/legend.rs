//! Colour legend of the bar.

use crate::app::theme::{BAD, COARSE, ODD, PENDING, RESIDENT};
use crate::app::widgets::names::named;
use egui::{Color32, Sense, Ui, vec2};

/// A button that shows the legend.
pub(super) fn legend_ui(ui: &mut Ui) {
    let menu = ui.menu_button("?", |ui| {
        let absent = ui.visuals().extreme_bg_color;
        for (color, text) in [
            (RESIDENT, "In memory"),
            (COARSE, "In memory with fewer points"),
            (PENDING, "Being read or made ready"),
            (absent, "Not in memory: read before it is played"),
            (BAD, "Cannot be read"),
            (dim(RESIDENT), "Outside of in and out point: not played"),
            (ODD, "Numbers of files are missing here"),
        ] {
            ui.horizontal(|ui| {
                let (swatch, _) = ui.allocate_exact_size(vec2(18.0, 12.0), Sense::hover());
                ui.painter().rect_filled(swatch, 2.0, color);
                ui.label(text);
            });
        }
        ui.separator();
        ui.label("Wheel: fewer or more frames. Drag the lines of in and out point");
    });
    named(&menu.response, "Legend of the timeline");
    menu.response.on_hover_text("Legend of the bar");
}

/// The colour of frames outside of in and out point.
fn dim(color: Color32) -> Color32 {
    color.lerp_to_gamma(Color32::BLACK, 150.0 / 255.0)
}
