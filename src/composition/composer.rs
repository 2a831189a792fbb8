//! Runs stages: all at once, or by lane where the window schedules them.

use super::composed::{Composed, Problem};
use super::inputs::{Inputs, StandIns};
use super::stages::STAGES;
use super::step::{Lane, Step};
use crate::cloud::CloudError;
use crate::progress::Progress;
use crate::scene::Style;
use crate::sequence::PreparedFrame;
use std::sync::Arc;

/// All that `inputs` ask for of `pose`, which is theirs.
///
/// # Errors
/// If all together has more points than a frame can have.
pub fn compose(pose: &Arc<PreparedFrame>, inputs: &Inputs<'_>) -> Result<Composed, CloudError> {
    let mut composed = Composed::of(Arc::clone(pose));
    let progress = Progress::default();
    for stage in STAGES {
        if let Some(step) = (stage.step)(inputs, &mut composed.problems) {
            step.run(&mut composed, &progress)?;
        }
    }
    Ok(composed)
}

/// Runs the stages of [`Lane::View`]: stand-ins of the window for the composed frame.
#[must_use]
pub fn with_stand_ins(mut composed: Composed, style: &Style, stand_ins: StandIns) -> Composed {
    let pose = Arc::clone(&composed.pose);
    let inputs = Inputs::of_view(&pose, style, stand_ins);
    if let Some(request) = Request::gather(Lane::View, &pose, &inputs) {
        request.run_on(&mut composed, &Progress::default());
    }
    composed
}

/// The stages of one lane with all that they take, to be run on a task.
#[derive(Debug, Clone)]
pub struct Request {
    /// The pose that they are for.
    pub pose: Arc<PreparedFrame>,
    steps: Vec<Arc<dyn Step>>,
    problems: Vec<Problem>,
}

impl Request {
    /// The steps of a lane that apply to `pose`, the frame of `inputs`; `None` if none does.
    pub fn gather(lane: Lane, pose: &Arc<PreparedFrame>, inputs: &Inputs<'_>) -> Option<Self> {
        let mut problems = Vec::new();
        let stages = STAGES.iter().filter(|stage| stage.lane == lane);
        let steps = stages.filter_map(|stage| (stage.step)(inputs, &mut problems));
        let steps: Vec<_> = steps.collect();
        (!steps.is_empty()).then(|| Self {
            pose: Arc::clone(pose),
            steps,
            problems,
        })
    }

    /// Runs them; `None` once `progress` is cancelled. A step that fails leaves the frame as it was, and why.
    pub fn run(&self, progress: &Progress) -> Option<(Composed, Option<CloudError>)> {
        let mut composed = Composed::of(Arc::clone(&self.pose));
        composed.problems.clone_from(&self.problems);
        let failure = self.run_on(&mut composed, progress);
        (!progress.is_cancelled()).then_some((composed, failure))
    }

    fn run_on(&self, composed: &mut Composed, progress: &Progress) -> Option<CloudError> {
        let mut failure = None;
        for step in &self.steps {
            if progress.is_cancelled() {
                break;
            }
            failure = step.run(composed, progress).err().or(failure);
        }
        failure
    }
}

/// Equal if they make the same: poses are compared by identity.
impl PartialEq for Request {
    fn eq(&self, other: &Self) -> bool {
        let steps = self.steps.iter().zip(&other.steps);
        Arc::ptr_eq(&self.pose, &other.pose)
            && self.steps.len() == other.steps.len()
            && steps.into_iter().all(|(a, b)| a.is_same(&**b))
    }
}
