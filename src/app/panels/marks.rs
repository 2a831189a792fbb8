//! What features paint over the picture: the camera path, trails, points that were clicked on, labels.

use crate::app::features::camera_path::marks::paint_path;
use crate::app::features::inspection::marks::paint_inspection;
use crate::app::features::labels::marks::paint_labels;
use crate::app::features::trails::panel::paint_trails;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::{PanelId, State};
use crate::playback::Player;
use egui::{Rect, Ui};

/// Paints the marks of all features, where they are in the picture that is drawn next, or in both.
pub(super) fn marks_ui(ui: &Ui, state: &mut State) {
    let is_playing = state.player.as_ref().is_some_and(Player::is_playing);
    if state.follow_labels() && !is_playing {
        // What is drawn after this pass tells what is hidden. Who plays is asked again soon.
        ui.ctx().request_repaint();
    }
    let state = &*state;
    let viewport = &state.viewport;
    marks(ui, state, viewport.rect, viewport.size_px);
    if viewport.other_rect != viewport.rect {
        marks(ui, state, viewport.other_rect, viewport.other_size_px);
    }
}

fn marks(ui: &Ui, state: &State, rect: Rect, size_px: [u32; 2]) {
    let painter = ui.painter_at(rect);
    let canvas = PictureOverlay::new(&painter, rect, size_px, &state.camera);
    if let Some(path) = state.path.draft.path()
        && state.panels.has(PanelId::CAMERA_PATH)
        && !state.path.is_playing()
    {
        paint_path(&canvas, path);
    }
    if let Some(player) = &state.player {
        paint_trails(&canvas, &state.trails, player);
    }
    paint_inspection(&canvas, &state.inspection, state.length_unit());
    // Of two sequences they are those of the first.
    if state.beside.is_none() || rect == state.viewport.rect {
        paint_labels(&canvas, &state.labels);
    }
}
