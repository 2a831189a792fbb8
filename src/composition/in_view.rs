//! Surfels of the visible points, for a large frame whose own surfels are not there.

use super::composed::{Composed, Problem};
use super::drawable::can_draw;
use super::inputs::Inputs;
use super::packet::PictureView;
use super::points_in_view::points_in_view;
use super::step::{Lane, Stage, Step, same_stage};
use crate::cloud::CloudError;
use crate::progress::Progress;
use crate::scene::{Clip, Scene, Style, ViewTransform};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, prepare_part};
use std::sync::Arc;

/// The row of the list.
pub(super) const STAGE: Stage = Stage {
    name: "in view",
    lane: Lane::View,
    step,
};

/// All that surfels in view depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewOfFrame {
    /// [`PreparedFrame::id`].
    frame: u64,
    needs: Needs,
    view: ViewTransform,
    viewport_px: [u32; 2],
    /// Relative to the origin of the sequence.
    clip: Option<Clip>,
}

impl ViewOfFrame {
    /// The view of `frame`, if surfels are asked for and it has none.
    pub fn without_surfels(frame: &PreparedFrame, view: &PictureView<'_>, style: &Style) -> Option<Self> {
        if !style.draws_surfels() || can_draw(frame, style) || frame.is_sample() {
            return None;
        }
        let viewport_px = style.drawn_px(view.size_px);
        let clip = style.of_sequence.clip.filter(|clip| clip.is_on);
        Some(Self {
            frame: frame.id,
            needs: Scene::needs(style),
            view: view
                .camera
                .transform(view.origin, viewport_px)
                .near_for(&frame.frame.bounds()),
            viewport_px,
            clip: clip.map(|clip| clip.relative_to(view.origin)),
        })
    }

    /// The visible points of `frame`, which this is a view of, with their surfels; `None` where nothing is seen.
    pub fn surfels(&self, frame: &PreparedFrame) -> Option<Arc<PreparedFrame>> {
        let positions = frame.frame.positions();
        let slots = points_in_view(positions, &self.view, self.viewport_px, self.clip.as_ref());
        let counters = PrepareCounters::default();
        let part = prepare_part(frame, &slots, &self.needs, &counters);
        part.map(Arc::new).ok().filter(|_| !slots.is_empty())
    }
}

/// Visible part that is drawn instead of a frame.
#[derive(Debug)]
struct InViewStep(Arc<PreparedFrame>);

fn step(inputs: &Inputs<'_>, _problems: &mut Vec<Problem>) -> Option<Arc<dyn Step>> {
    let part = inputs.stand_ins.in_view.as_ref()?;
    Some(Arc::new(InViewStep(Arc::clone(part))))
}

impl Step for InViewStep {
    fn is_same(&self, other: &dyn Step) -> bool {
        same_stage(other).is_some_and(|Self(other)| Arc::ptr_eq(&self.0, other))
    }

    fn run(&self, composed: &mut Composed, _progress: &Progress) -> Result<(), CloudError> {
        composed.frame = Arc::clone(&self.0);
        composed.pose = Arc::clone(&self.0);
        composed.depths = None;
        Ok(())
    }
}
