//! Marks that features paint over the image.

use crate::app::State;
use crate::app::features::Features;
use crate::app::widgets::overlay::PictureOverlay;
use crate::playback::Player;
use egui::{Rect, Ui};

/// Paints the marks of all features, at their positions in the next image, or in both images.
pub(super) fn marks_ui(ui: &Ui, state: &mut State) {
    let is_playing = state.player.as_ref().is_some_and(Player::is_playing);
    if state.follow_labels() && !is_playing {
        // Occlusion is only known after the next draw. During playback this runs again soon anyway.
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
    let is_first = state.features.split_view.is_none() || rect == state.viewport.rect;
    for feature in Features::rows::<State>() {
        feature.paint(state, &canvas, is_first);
    }
}
