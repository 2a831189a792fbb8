//! Trails as tubes of points in a frame.

use super::Trails;
use crate::cloud::CloudError;
use crate::composition::composed::{Composed, Problem};
use crate::composition::ghosts::{Ghost, with_ghosts};
use crate::composition::inputs::Inputs;
use crate::composition::options::TrailLook;
use crate::composition::step::{Lane, Stage, Step, same_stage};
use crate::levels::LevelsKey;
use crate::levels::octree::StopCriterion;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::sequence::Needs;
use std::sync::Arc;

/// The row of the list.
pub(in crate::composition) const STAGE: Stage = Stage {
    name: "trails",
    lane: Lane::Poses,
    step,
};

/// Radius of trails, as a share of the frame's radius.
const TRAIL_RADIUS: f32 = 0.003;

/// Trails for a pose.
#[derive(Debug)]
struct TrailsStep {
    trails: Arc<Trails>,
    looks: Vec<TrailLook>,
    needs: Needs,
}

fn step(inputs: &Inputs<'_>, _problems: &mut Vec<Problem>) -> Option<Arc<dyn Step>> {
    let (trails, looks) = inputs.options.trails.as_ref()?;
    if looks.is_empty() {
        return None;
    }
    Some(Arc::new(TrailsStep {
        trails: Arc::clone(trails),
        looks: looks.clone(),
        needs: Scene::needs(inputs.style),
    }))
}

impl TrailsStep {
    fn tube(&self, look: &TrailLook, frame: usize, radius: f32) -> Result<Ghost, CloudError> {
        let frames = self.trails.frames();
        let range = match look.length {
            Some(length) => frame.saturating_sub(length).max(frames.start)..(frame + 1).min(frames.end),
            None => frames,
        };
        let tube = self.trails.tube_through(look.trail, range, frame, radius)?;
        Ok(Ghost {
            frame: Arc::new(tube),
            share: 1.0,
            tint: look.tint,
        })
    }
}

impl Step for TrailsStep {
    fn is_same(&self, other: &dyn Step) -> bool {
        same_stage(other).is_some_and(|other: &Self| {
            self.needs == other.needs && self.looks == other.looks && Arc::ptr_eq(&self.trails, &other.trails)
        })
    }

    fn run(&self, composed: &mut Composed, _progress: &Progress) -> Result<(), CloudError> {
        let frame = &composed.frame;
        let radius = TRAIL_RADIUS * frame.frame.bounds().radius();
        let tubes = self
            .looks
            .iter()
            .map(|look| self.tube(look, composed.pose.index, radius));
        let tubes: Vec<Ghost> = tubes.collect::<Result<_, _>>()?;
        // Tubes have enough points to make a loss criterion divide the frame's cells as well.
        let octree = frame.levels.octree();
        let depth = octree.map(|octree| frame.frame.level_of_first(octree.depth()));
        let levels = self.needs.levels.zip(depth).map(|(levels, depth)| LevelsKey {
            stop: StopCriterion::Depth(depth),
            ..levels
        });
        let needs = Needs { levels, ..self.needs };
        composed.frame = Arc::new(with_ghosts(frame, &tubes, &needs)?);
        Ok(())
    }
}
