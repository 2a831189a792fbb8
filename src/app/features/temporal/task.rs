//! A frame is made of several poses.

use crate::analysis::ColorMap;
use crate::app::work::outcome::Message;
use crate::measure::Change;
use crate::progress::Progress;
use crate::sequence::{Ghost, Needs, Paint, PreparedFrame, Sequence, with_ghosts};
use std::sync::Arc;

/// All that a frame is made from.
#[derive(Debug, Clone)]
pub(super) struct PoseRequest {
    pub(super) pose: Arc<PreparedFrame>,
    pub(super) change: Option<ChangeRequest>,
    pub(super) ghosts: Vec<Ghost>,
    pub(super) needs: Needs,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ChangeRequest {
    pub(super) to: usize,
    pub(super) range: Option<f64>,
    pub(super) map: ColorMap,
}

impl PartialEq for PoseRequest {
    /// Poses are compared by identity.
    fn eq(&self, other: &Self) -> bool {
        let same_ghosts =
            |(a, b): (&Ghost, &Ghost)| Arc::ptr_eq(&a.frame, &b.frame) && a.share == b.share && a.tint == b.tint;
        Arc::ptr_eq(&self.pose, &other.pose)
            && self.change == other.change
            && self.needs == other.needs
            && self.ghosts.len() == other.ghosts.len()
            && self.ghosts.iter().zip(&other.ghosts).all(same_ghosts)
    }
}

impl Message for Option<Box<ComposedFrame>> {}

/// A frame that was made from a pose and others.
#[derive(Debug)]
pub struct ComposedFrame {
    pub(super) request: PoseRequest,
    pub(super) frame: Arc<PreparedFrame>,
    pub(super) change: Option<Arc<Change>>,
    /// Why there is no change.
    pub(super) problem: Option<String>,
}

impl ComposedFrame {
    /// What is drawn.
    pub(in crate::app) fn frame(&self) -> &Arc<PreparedFrame> {
        &self.frame
    }

    /// The pose that it was made from.
    pub(in crate::app) fn pose(&self) -> &Arc<PreparedFrame> {
        &self.request.pose
    }
}

/// Makes the frame; `None` once nobody waits for it.
pub(super) fn compose(
    request: PoseRequest,
    known: Option<Arc<Change>>,
    other: Option<&PreparedFrame>,
    sequence: &Sequence,
    progress: &Progress,
) -> Option<ComposedFrame> {
    let is_wanted = || !progress.is_cancelled();
    let (mut frame, mut change, mut problem) = (Arc::clone(&request.pose), known, None);
    if let Some(ChangeRequest { to, range, map }) = request.change {
        if change.is_none() {
            let positions = request.pose.frame.positions();
            let measured = match other {
                Some(other) => Ok(Change::between(positions, other.frame.positions(), is_wanted)),
                None => sequence
                    .frame(to)
                    .map(|other| Change::between(positions, other.positions(), is_wanted)),
            };
            match measured {
                Ok(measured) => change = measured.map(Arc::new),
                Err(error) => problem = Some(error.to_string()),
            }
        }
        if !is_wanted() {
            return None;
        }
        match &change {
            Some(change) => {
                let range = range.unwrap_or(change.usual_range());
                let paint = Paint::change(range, map);
                frame = Arc::new(frame.in_colors(&change.colors(range, map), paint));
            }
            None if problem.is_none() => {
                problem = Some(format!("Frame {} has no points", to + 1));
            }
            None => {}
        }
    }
    if !request.ghosts.is_empty() {
        match with_ghosts(&frame, &request.ghosts, &request.needs) {
            Ok(merged) => frame = Arc::new(merged),
            Err(error) => problem = Some(format!("There are too many ghosts: {error}")),
        }
    }
    is_wanted().then_some(ComposedFrame {
        request,
        frame,
        change,
        problem,
    })
}
