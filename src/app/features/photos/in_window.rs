//! View-dependent texturing in the window: input images of the shown frame.

use super::frusta::frusta_ui;
use super::panel::{PANEL, PhotosRequest, photos_ui};
use super::{Photos, PhotosLoaded, TexturedFrame};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::panel_row::PanelRow;
use crate::app::state::State;
use crate::app::widgets::overlay::PictureOverlay;
use crate::app::work::outcome::Outcome;
use crate::playback::Player;
use egui::Ui;

impl Feature<State> for FeatureOf<Photos> {
    fn follow_frame(&self, state: &mut State) -> bool {
        let style = state.drawn_style();
        if let Some(player) = &state.player {
            state.features.photos.follow(player, &style, &state.shared.tasks);
        }
        false
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        let outcome = match outcome.give(|loaded: PhotosLoaded| {
            for note in state.features.photos.take_in(loaded) {
                state.notices.warn(note);
            }
        }) {
            Ok(()) => return Ok(()),
            Err(outcome) => outcome,
        };
        outcome.give(|made: TexturedFrame| state.features.photos.take_frame(made))
    }

    fn forget_sequence(&self, state: &mut State) {
        state.features.photos.forget();
    }

    fn handles(&self, ui: &Ui, state: &mut State) {
        photo_frusta(ui, state);
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::in_menu(PANEL, "Images and cameras…", photos).also(&[
            "photographs",
            "photos",
            "camera frusta",
            "camera poses",
            "colmap",
            "frustum",
            "input views",
        ])];
        PANELS
    }
}

/// Paints the camera frusta of the input images over the rendered view of the open sequence.
fn photo_frusta(ui: &Ui, state: &mut State) {
    let set = state.player.as_ref().and_then(Player::posed_images);
    let Some(set) = set.filter(|_| state.features.photos.shows_frusta) else {
        return;
    };
    let rect = state.viewport.rect;
    let painter = ui.painter_at(rect);
    let canvas = PictureOverlay::new(&painter, rect, state.viewport.size_px, &state.camera);
    if let Some(number) = frusta_ui(ui, &canvas, &set, &mut state.features.photos) {
        state.stand_at_photo(number);
    }
}

fn photos(ui: &mut Ui, state: &mut State) {
    let set = state.player.as_ref().and_then(Player::posed_images);
    let corner = state.viewport.rect.left_top();
    let mut is_open = state.panels.has(PANEL);
    let request = photos_ui(ui, &mut is_open, &mut state.features.photos, set.as_deref(), corner);
    state.panels.set(PANEL, is_open);
    if let Some(PhotosRequest::StandAt(number)) = request {
        state.stand_at_photo(number);
    }
}
