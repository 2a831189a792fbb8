//! Frame facts that stay known of prepared frames after they have been evicted from memory.

use crate::levels::octree::StopCriterion;
use crate::math::Aabb;
use crate::sequence::PreparedFrame;

/// Facts known of a frame that was prepared once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameFacts {
    /// Points in the file.
    pub points: usize,
    /// Bounding box of the points, relative to the sequence's origin; of some of them, if all were never prepared.
    pub bounds: Aabb,
    /// Share of the points that have no leaf of their own in the octree, if it was built for the present needs.
    pub loss: Option<f32>,
    /// RMS distance of points from the centres of their leaves, if the octree was built for the present needs; of 1,024
    /// of them.
    pub voxel_error: Option<f32>,
}

/// Points that suffice to estimate how far all are from their voxels, to a percent or two.
const ERROR_POINTS: usize = 1024;

/// A loss belongs to the purpose of the octree.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Known {
    facts: FrameFacts,
    stop: Option<StopCriterion>,
}

/// The facts of all frames, by index.
#[derive(Debug, Default)]
pub(super) struct Facts {
    frames: Vec<Option<Known>>,
    /// Changes whenever a fact does.
    revision: u64,
}

impl Facts {
    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    /// Records a prepared frame. Fewer points of it add no information.
    pub(super) fn note(&mut self, prepared: &PreparedFrame) {
        let index = prepared.index;
        if index >= self.frames.len() {
            self.frames.resize(index + 1, None);
        }
        let before = self.frames[index];
        if prepared.is_sample() && before.is_some() {
            return;
        }
        let octree = prepared.levels.octree().filter(|_| !prepared.is_sample());
        let (loss, voxel_error, stop) = match (octree, before) {
            (Some(octree), _) => (
                Some(octree.loss()),
                octree.position_error(prepared.frame.positions(), ERROR_POINTS),
                prepared.levels.stop(),
            ),
            (None, Some(before)) => (before.facts.loss, before.facts.voxel_error, before.stop),
            (None, None) => (None, None, None),
        };
        let facts = FrameFacts {
            points: prepared.frame.points_in_file(),
            bounds: prepared.frame.bounds(),
            loss,
            voxel_error,
        };
        let known = Some(Known { facts, stop });
        if before != known {
            self.frames[index] = known;
            self.revision += 1;
        }
    }

    /// The facts of the first `frame_count` frames; losses and errors only of octrees that end as `stop` says, if it is
    /// set.
    pub(super) fn of(&self, frame_count: usize, stop: Option<StopCriterion>) -> Vec<Option<FrameFacts>> {
        let facts = |index: usize| {
            let known = (*self.frames.get(index)?)?;
            let is_present = stop.is_none() || known.stop == stop;
            Some(FrameFacts {
                loss: known.facts.loss.filter(|_| is_present),
                voxel_error: known.facts.voxel_error.filter(|_| is_present),
                ..known.facts
            })
        };
        (0..frame_count).map(facts).collect()
    }

    /// Notes that the needs have changed, and with them which losses and errors are reported.
    pub(super) fn changed(&mut self) {
        self.revision += 1;
    }
}
