//! Change map: the same points, octree included, in the colours of their distances to another frame.

use super::composed::{Composed, Measured, Problem};
use super::inputs::{Inputs, WholeFrame};
use super::step::{Lane, Stage, Step, same_stage};
use crate::analysis::ColorMap;
use crate::cloud::CloudError;
use crate::measure::Change;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::sequence::{FrameError, Paint, PreparedFrame};
use std::sync::Arc;

/// The row of the list.
pub(super) const STAGE: Stage = Stage {
    name: "change map",
    lane: Lane::Poses,
    step,
};

#[derive(Debug)]
struct ChangeStep {
    to: usize,
    range: Option<f64>,
    map: ColorMap,
    /// Distances that were measured before, else the frame to measure to: the result is the same.
    source: Source,
}

#[derive(Debug)]
enum Source {
    Known(Arc<Change>),
    Frame(WholeFrame),
}

fn step(inputs: &Inputs<'_>, problems: &mut Vec<Problem>) -> Option<Arc<dyn Step>> {
    let colors = inputs.options.change?;
    let (pose, frames) = (inputs.pose, inputs.frames);
    let frame = pose.index;
    let Some(to) = colors.other_frame(frame, frames.frame_count()) else {
        let step = colors.step;
        problems.push(Problem::NoOtherFrame { frame, step });
        return None;
    };
    let source = match frames.known_change(pose, to) {
        Some(known) => Source::Known(known),
        None => match frames.whole(to, &Scene::needs(inputs.style)) {
            Ok(other) => Source::Frame(other),
            Err(reason) => {
                problems.push(Problem::OtherUnread { frame, reason });
                return None;
            }
        },
    };
    Some(Arc::new(ChangeStep {
        to,
        range: colors.range,
        map: inputs.style.colors.map,
        source,
    }))
}

impl ChangeStep {
    /// The distances; `None` if the other frame has no points or the task was cancelled.
    fn measure(&self, pose: &PreparedFrame, progress: &Progress) -> Result<Option<Arc<Change>>, FrameError> {
        let is_wanted = || !progress.is_cancelled();
        let positions = pose.frame.positions();
        let change = match &self.source {
            Source::Known(known) => return Ok(Some(Arc::clone(known))),
            Source::Frame(WholeFrame::InMemory(other)) => {
                Change::between(positions, other.frame.positions(), is_wanted)
            }
            Source::Frame(WholeFrame::InFile(sequence)) => {
                let other = sequence.frame(self.to)?;
                Change::between(positions, other.positions(), is_wanted)
            }
        };
        Ok(change.map(Arc::new))
    }
}

impl Step for ChangeStep {
    fn is_same(&self, other: &dyn Step) -> bool {
        same_stage(other)
            .is_some_and(|other: &Self| self.to == other.to && self.range == other.range && self.map == other.map)
    }

    fn run(&self, composed: &mut Composed, progress: &Progress) -> Result<(), CloudError> {
        let frame = composed.pose.index;
        match self.measure(&composed.frame, progress) {
            Ok(Some(change)) => {
                let range = self.range.unwrap_or(change.usual_range());
                let colors = change.colors(range, self.map);
                let paint = Paint::change(range, self.map);
                composed.frame = Arc::new(composed.frame.in_colors(&colors, paint));
                composed.change = Some(Measured {
                    change,
                    to: self.to,
                    range,
                });
            }
            Ok(None) => composed.problems.push(Problem::OtherEmpty { frame, other: self.to }),
            Err(reason) => composed.problems.push(Problem::OtherUnread { frame, reason }),
        }
        Ok(())
    }
}
