//! Labels over the image.

use super::Labels;
use crate::app::widgets::overlay::PictureOverlay;

/// Paints the labels of the shown frame; pale where they are occluded.
pub(in crate::app) fn paint_labels(canvas: &PictureOverlay<'_>, labels: &Labels) {
    for (place, text, is_hidden) in labels.in_picture() {
        canvas.note(place, text, if is_hidden { 0.35 } else { 1.0 });
    }
}
