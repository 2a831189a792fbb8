//! Onion skin: neighbouring poses around one, as ghosts.

use super::composed::{Composed, Problem};
use super::ghosts::{Ghost, with_ghosts};
use super::inputs::Inputs;
use super::step::{Lane, Stage, Step, same_stage};
use crate::cloud::CloudError;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::sequence::Needs;
use std::sync::Arc;

/// The row of the list.
pub(super) const STAGE: Stage = Stage {
    name: "onion skin",
    lane: Lane::Poses,
    step,
};

/// Ghosts for a pose.
#[derive(Debug)]
struct OnionStep {
    ghosts: Vec<Ghost>,
    needs: Needs,
}

fn step(inputs: &Inputs<'_>, problems: &mut Vec<Problem>) -> Option<Arc<dyn Step>> {
    let onion = inputs.options.onion?;
    let needs = Scene::needs(inputs.style);
    let mut ghosts = Vec::new();
    for (index, share, tint) in onion.around(inputs.pose.index, inputs.frames.frame_count()) {
        match inputs.frames.drawable(index, &needs) {
            Ok(Some(frame)) => ghosts.push(Ghost { frame, share, tint }),
            Ok(None) => {}
            Err(reason) => problems.push(Problem::NoGhost { frame: index, reason }),
        }
    }
    if ghosts.is_empty() {
        return None;
    }
    Some(Arc::new(OnionStep { ghosts, needs }))
}

impl Step for OnionStep {
    fn is_same(&self, other: &dyn Step) -> bool {
        same_stage(other).is_some_and(|other: &Self| self.ghosts == other.ghosts && self.needs == other.needs)
    }

    fn run(&self, composed: &mut Composed, _progress: &Progress) -> Result<(), CloudError> {
        composed.frame = Arc::new(with_ghosts(&composed.frame, &self.ghosts, &self.needs)?);
        Ok(())
    }
}
