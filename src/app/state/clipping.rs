//! The frames that a clip is put around.

use super::State;
use crate::app::features::clipping::{ClippedFrames, KnownBounds};
use crate::math::Aabb;

impl State {
    /// The shown frame and all that is known of the others; `None` while nothing is shown.
    pub(in crate::app) fn clipped_frames(&mut self) -> Option<ClippedFrames> {
        let player = self.player.as_ref()?;
        let shown = player.shown()?.frame.bounds();
        let looked = self.looked.look.as_ref().map_or(Aabb::EMPTY, |look| look.full);
        let loader = player.loader();
        let count = player.sequence().len();
        let all = self.clipping.bounds_of_all(loader.facts_revision(), || {
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

    /// Has a box around all frames take in those that were read since.
    pub(super) fn follow_clip(&mut self) {
        let clip = self.style.clip;
        if clip.is_some_and(|clip| clip.is_on && self.clipping.is_around_all(&clip))
            && let Some(frames) = self.clipped_frames()
        {
            self.clipping.grow(&mut self.style.clip, &frames);
        }
    }
}
