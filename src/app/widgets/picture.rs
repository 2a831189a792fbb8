//! An image of the renderer.

use egui::{Color32, Pos2, Rect, TextureId, Ui, pos2};

/// The part of an image over `rect` that is in `part`.
pub(in crate::app) fn picture(ui: &Ui, rect: Rect, texture: Option<TextureId>, part: Rect) {
    if let Some(texture) = texture {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let painter = ui.painter_at(part);
        painter.image(texture, rect, whole, Color32::WHITE);
    }
}
