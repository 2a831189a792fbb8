//! Levels of detail instead of all points, while the camera moves.

use super::composed::{Coarse, Composed, Problem};
use super::inputs::Inputs;
use super::step::{Lane, Stage, Step, same_stage};
use crate::cloud::CloudError;
use crate::levels::Lod;
use crate::progress::Progress;
use crate::scene::Style;
use std::sync::Arc;

/// The row of the list.
pub(super) const STAGE: Stage = Stage {
    name: "levels",
    lane: Lane::View,
    step,
};

/// Returns the settings changed to draw the number of octree cells that fit in `frame_ms`.
#[must_use]
pub fn in_cells(style: &Style, frame_ms: f32) -> Style {
    style.with(|style| {
        style.levels.surfel_lod = true;
        style.levels.lod = Lod::FrameTimeMs(frame_ms);
    })
}

/// Returns true if images may be of fewer cells while the camera moves: points have none, and levels have normals of
/// their own.
pub fn has_moving_levels(style: &Style) -> bool {
    !style.draws_points() && !style.has_screen_normals()
}

#[derive(Debug)]
struct LevelsStep(Coarse);

fn step(inputs: &Inputs<'_>, _problems: &mut Vec<Problem>) -> Option<Arc<dyn Step>> {
    let coarse = inputs.stand_ins.coarse.clone()?;
    Some(Arc::new(LevelsStep(coarse)))
}

impl Step for LevelsStep {
    fn is_same(&self, other: &dyn Step) -> bool {
        same_stage(other)
            .is_some_and(|Self(other)| Arc::ptr_eq(&self.0.frame, &other.frame) && self.0.style == other.style)
    }

    fn run(&self, composed: &mut Composed, _progress: &Progress) -> Result<(), CloudError> {
        composed.coarse = Some(self.0.clone());
        Ok(())
    }
}
