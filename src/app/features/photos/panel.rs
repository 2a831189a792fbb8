//! List of input images: description, reprojection error of the camera, and use of each.

use super::Photos;
use crate::app::open_panels::PanelId;
use crate::app::widgets::names::named;
use crate::app::widgets::numbers::significant;
use crate::app::widgets::tool_window::tool_window;
use crate::photos::ViewSet;
use egui::{Align2, Checkbox, Grid, Pos2, RichText, ScrollArea, Ui, vec2};

/// Request of the image list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum PhotosRequest {
    /// To look from where this one was taken.
    StandAt(usize),
}

/// The name of the window among panels.
pub(in crate::app) const PANEL: PanelId = PanelId::new("photographs");

/// Shows the window while it is open, at `corner`; `shown` is the input image whose camera is the current view.
pub(in crate::app) fn photos_ui(
    ui: &mut Ui,
    is_open: &mut bool,
    photos: &mut Photos,
    set: Option<&ViewSet>,
    corner: Pos2,
) -> Option<PhotosRequest> {
    let mut request = None;
    tool_window(ui.ctx(), PANEL.name(), "Images")
        .open(is_open)
        .default_size(vec2(360.0, 320.0))
        .pivot(Align2::LEFT_TOP)
        .default_pos(corner + vec2(12.0, 12.0))
        .show(ui, |ui| {
            let Some(set) = set else {
                ui.label("The open sequence has no images: open a COLMAP, Meshroom or Bundler project");
                return;
            };
            head_ui(ui, photos, set);
            ui.separator();
            ScrollArea::both()
                .id_salt("list of images")
                .auto_shrink(false)
                .show(ui, |ui| request = list_ui(ui, photos, set));
        });
    request
}

fn head_ui(ui: &mut Ui, photos: &mut Photos, set: &ViewSet) {
    let count = set.photos.len();
    let text = match photos.loading() {
        Some(text) => text,
        None if count == 1 => "1 image".to_owned(),
        None => format!("{count} images"),
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(text);
        ui.add(Checkbox::new(&mut photos.shows_frusta, "Show camera frusta"))
            .on_hover_text("Draws the frustum of each camera; a click on one jumps to that view");
        let has_off = !photos.skipped().is_empty();
        let all = ui.add_enabled(has_off, egui::Button::new("Use all"));
        if all.on_hover_text("Uses all images for texturing again").clicked() {
            (0..count).for_each(|number| photos.set_used(number, true));
        }
    });
}

fn list_ui(ui: &mut Ui, photos: &mut Photos, set: &ViewSet) -> Option<PhotosRequest> {
    let mut request = None;
    Grid::new("table of images")
        .num_columns(5)
        .striped(true)
        .show(ui, |ui| {
            for (title, tooltip) in [
                ("", "Used for texturing"),
                ("Image", "A click jumps to the view of its camera"),
                ("Pixels", "Width and height of the file"),
                (
                    "Error",
                    "Reprojection error of the points of this image: root mean square, pixels",
                ),
                ("Gain", "Exposure compensation: factors on red, green and blue"),
            ] {
                ui.label(RichText::new(title).strong()).on_hover_text(tooltip);
            }
            ui.end_row();
            for (number, photo) in set.photos.iter().enumerate() {
                let mut is_used = photos.is_used(number);
                let used = ui.add(Checkbox::without_text(&mut is_used));
                let used = used.on_hover_text("Used for texturing");
                named(&used, format!("Use {}", photo.name));
                if used.changed() {
                    photos.set_used(number, is_used);
                }
                let place = photo.path.display().to_string();
                if ui.link(&photo.name).on_hover_text(place).clicked() {
                    request = Some(PhotosRequest::StandAt(number));
                }
                let [width, height] = photo.camera.size_px();
                ui.label(format!("{width} × {height}"));
                let error = photos.reprojection_error(number);
                ui.label(error.map_or_else(String::new, |error| format!("{} px", significant(error.rms_px))));
                let gain = photos
                    .gain(number)
                    .map(|gain| gain.to_array().map(|gain| format!("{gain:.2}")).join(" "));
                ui.label(gain.unwrap_or_default());
                ui.end_row();
            }
        });
    request
}
