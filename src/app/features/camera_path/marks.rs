//! The camera path over the image.

use crate::app::theme::ACCENT;
use crate::app::widgets::overlay::PictureOverlay;
use crate::scene::CameraPath;
use egui::Stroke;
use glam::DVec3;

/// Number of pieces in which a path is painted.
const PIECES: usize = 256;

/// Paints the trajectory of the eye, with a ring at each keyframe.
pub(in crate::app) fn paint_path(canvas: &PictureOverlay<'_>, path: &CameraPath) {
    let eye = |piece: usize| {
        let share = piece as f64 / PIECES as f64;
        path.at(share * path.duration_s()).0.eye_in_world()
    };
    let eyes: Vec<DVec3> = (0..=PIECES).map(eye).collect();
    for ends in eyes.windows(2).filter(|ends| ends[0] != ends[1]) {
        canvas.line([ends[0], ends[1]], Stroke::new(1.5, ACCENT));
    }
    for key in path.keyframes().iter().take(PIECES) {
        canvas.ring(key.camera.eye_in_world(), ACCENT);
    }
}
