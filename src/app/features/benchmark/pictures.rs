//! The measured image, and its errors.

use egui::{ColorImage, RichText, TextureHandle, TextureOptions, Ui};
use image::RgbaImage;

/// Width above which images are next to the list, points.
const SIDE_BY_SIDE_WIDTH: f32 = 760.0;

/// Side by side where there is space, else one below the other.
pub(super) fn side_by_side_or_below(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    if ui.available_width() < SIDE_BY_SIDE_WIDTH {
        ui.vertical(add);
    } else {
        ui.horizontal_top(add);
    }
}

/// Shows both under `label`, which with `number` tells them from all others.
pub(super) fn pictures_ui(ui: &mut Ui, label: &str, number: u64, [picture, error_map]: [&RgbaImage; 2]) {
    ui.label(RichText::new(label).strong());
    ui.horizontal(|ui| {
        for (what, image, tooltip) in [
            ("image", picture, "The first view as rendered"),
            (
                "error map",
                error_map,
                "Its FLIP error: black where there is none, pale where it is largest",
            ),
        ] {
            let texture = texture(ui, label, number, what, image);
            let size = texture.size_vec2();
            ui.add(egui::Image::new((texture.id(), size)).alt_text(what))
                .on_hover_text(tooltip);
        }
    });
}

/// The texture of an image, created when it is first shown.
fn texture(ui: &Ui, label: &str, number: u64, what: &'static str, image: &RgbaImage) -> TextureHandle {
    let id = egui::Id::unique((label, number, what));
    if let Some(texture) = ui.data(|data| data.get_temp::<TextureHandle>(id)) {
        return texture;
    }
    let size = [image.width() as usize, image.height() as usize];
    let pixels = ColorImage::from_rgba_unmultiplied(size, image);
    let texture = ui.ctx().load_texture(what, pixels, TextureOptions::LINEAR);
    ui.data_mut(|data| data.insert_temp(id, texture.clone()));
    texture
}
