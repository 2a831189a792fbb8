//! The frames that a clip is put around.

use super::Clipping;
use super::handles::handles_ui;
use super::panel::{ClipContext, clip_ui};
use crate::app::features::clipping::{ClippedFrames, KnownBounds};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::settings_row::{NamedRow, SettingsPart, SettingsRow};
use crate::app::state::State;
use crate::app::widgets::overlay::PictureOverlay;
use crate::math::Aabb;
use egui::Ui;

impl State {
    /// The shown frame and all that is known of the others; `None` while nothing is shown.
    pub(in crate::app) fn clipped_frames(&mut self) -> Option<ClippedFrames> {
        let player = self.player.as_ref()?;
        let shown = player.shown()?.frame.bounds();
        let looked = self.opening.looked.look.as_ref().map_or(Aabb::EMPTY, |look| look.full);
        let loader = player.loader();
        let count = player.sequence().len();
        let all = self.features.clipping.bounds_of_all(loader.facts_revision(), || {
            let facts = loader.facts();
            let known = facts.iter().flatten();
            let bounds = known.clone().fold(looked, |bounds, fact| bounds.union(&fact.bounds));
            KnownBounds {
                bounds,
                known: known.count(),
                count,
            }
        });
        Some(ClippedFrames {
            shown,
            all,
            origin: player.sequence().origin(),
        })
    }

    /// Extends a box around all frames to those read since.
    pub(in crate::app) fn follow_clip(&mut self) {
        let clip = self.style.clip;
        if clip.is_some_and(|clip| clip.is_on && self.features.clipping.is_around_all(&clip))
            && let Some(frames) = self.clipped_frames()
        {
            self.features.clipping.grow(&mut self.style.clip, &frames);
        }
    }
}

impl Feature<State> for FeatureOf<Clipping> {
    fn follow(&self, state: &mut State) {
        state.follow_clip();
    }

    fn forget_sequence(&self, state: &mut State) {
        // Its coordinates belong to the previous sequence.
        state.style.clip = None;
        state.features.clipping.forget_frames();
    }

    fn handles(&self, ui: &Ui, state: &mut State) {
        clip_handles(ui, state);
    }

    fn settings(&self) -> &'static [SettingsRow<State>] {
        const SETTINGS: &[SettingsRow<State>] = &[SettingsRow {
            part: SettingsPart::Clip,
            rank: 0,
            named: &[NamedRow {
                title: "Clip",
                text: "Clip to a box or a plane…",
                hint: "Hides everything outside of a box, or on one side of a plane, in one frame or in all",
                also: &[
                    "crop",
                    "bounding box",
                    "show bounds",
                    "section",
                    "slice",
                    "cross section",
                    "cut",
                    "cutting plane",
                    "clipping plane",
                    "clip box",
                    "trim",
                    "region of interest",
                    "roi",
                    "isolate",
                    "cull",
                ],
            }],
            show: clip,
        }];
        SETTINGS
    }
}

fn clip(ui: &mut Ui, state: &mut State) {
    let mut context = ClipContext {
        frames: state.clipped_frames(),
        clip: &mut state.style.clip,
        clipping: &mut state.features.clipping,
        angle: state.features.inspection.last_angle(),
    };
    clip_ui(ui, &mut context);
}

/// The handles of the clip shape, over the image of the open sequence.
fn clip_handles(ui: &Ui, state: &mut State) {
    let is_shown = state.features.clipping.shows_outline;
    let Some(frames) = state.clipped_frames().filter(|_| is_shown) else {
        return;
    };
    let unit = state.length_unit();
    let rect = state.viewport.rect;
    let painter = ui.painter_at(rect);
    let canvas = PictureOverlay::new(&painter, rect, state.viewport.size_px, &state.camera);
    if let Some(clip) = state.style.clip.as_mut().filter(|clip| clip.is_on) {
        handles_ui(ui, &canvas, &mut state.features.clipping, clip, &frames, unit);
    }
}
