//! A point as it moves through the frames.

use crate::app::side::Side;
use crate::document::MeasuredPoint;
use crate::scene::{FollowedPoint, Pick};
use crate::sequence::PreparedFrame;
use glam::DVec3;

/// A point that was clicked on. In frames with the same number of points it is the one with the same index in the file;
/// in others, the position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// Side of the anchor, of two sequences.
    pub side: Side,
    /// Index in the file.
    pub index_in_file: u32,
    /// Index of the frame that it was last found in.
    pub frame: usize,
    /// Position in the coordinates of the file.
    pub place: DVec3,
    /// Index of the frame in which it was clicked on.
    pub(in crate::app) clicked_in: usize,
    pub(in crate::app) points_in_file: usize,
}

impl Anchor {
    pub(super) fn new(side: Side, pick: &Pick, frame: &PreparedFrame) -> Self {
        Self {
            side,
            index_in_file: pick.index_in_file,
            frame: pick.frame,
            place: pick.position,
            clicked_in: pick.frame,
            points_in_file: frame.frame.points_in_file(),
        }
    }

    /// The anchor of a point of the open sequence that a document has.
    pub(in crate::app) fn of(point: &MeasuredPoint) -> Self {
        Self {
            side: Side::A,
            index_in_file: point.point.index_in_file,
            frame: point.frame,
            place: point.place,
            clicked_in: point.frame,
            // No file has that many points: such a point stays where it is.
            points_in_file: point.point.points_in_file.unwrap_or(usize::MAX),
        }
    }

    /// The point as a document has it; `None` if it is not of the open sequence.
    pub(in crate::app) fn measured(&self) -> Option<MeasuredPoint> {
        (self.side == Side::A).then(|| MeasuredPoint {
            frame: self.frame,
            point: self.point(),
            place: self.place,
        })
    }

    /// The point that it follows.
    pub(in crate::app) fn point(&self) -> FollowedPoint {
        FollowedPoint {
            index_in_file: self.index_in_file,
            points_in_file: Some(self.points_in_file),
        }
    }

    /// Moves to where the point is in `frame`; its slot there, if there is one.
    pub(super) fn follow(&mut self, frame: &PreparedFrame, origin: DVec3) -> Option<usize> {
        let slot = self.point().slot_in(frame)?;
        self.place = origin + frame.frame.positions()[slot].as_dvec3();
        self.frame = frame.index;
        Some(slot)
    }
}
