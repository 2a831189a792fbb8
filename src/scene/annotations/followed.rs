//! A point of a file that is the same one in other frames.
//!
//! **How it works.** Frames with the same number of points, written by one program, list them in one order: equal
//! indices are the same point. If another frame has another number of points, its index is unknown. So marks follow
//! points ([`FollowedPoint::slot_in`]) where indices are stable, and stay at their original position elsewhere.

use crate::sequence::PreparedFrame;

/// A point by its index in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FollowedPoint {
    /// Its index in the file, points without finite coordinates counted.
    pub index_in_file: u32,
    /// Number of points in the files in which the index is this point; `None` where any file with such a point will do.
    pub points_in_file: Option<usize>,
}

impl FollowedPoint {
    /// Its slot in `frame`; `None` where the frame has another number of points, or none with finite coordinates at
    /// this index. Costs a look at the indices of the frame.
    pub fn slot_in(self, frame: &PreparedFrame) -> Option<usize> {
        let cloud = &frame.frame;
        // Depends on the frame alone, not on the frames shown before: the window, `render` and a video agree.
        if self
            .points_in_file
            .is_some_and(|points| points != cloud.points_in_file())
        {
            return None;
        }
        let mut indices = cloud.file_index().iter();
        indices.position(|&index| index == self.index_in_file)
    }
}
