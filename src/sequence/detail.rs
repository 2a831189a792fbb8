//! Level of detail: the number of points of a frame that are wanted if there is no time for all.

use crate::cloud::Frame;
use std::num::NonZeroU32;

/// The points of a frame that is played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detail {
    /// All.
    #[default]
    Full,
    /// At most this many, taken evenly.
    AtMost(NonZeroU32),
}

impl Detail {
    /// At most `points`; at least one.
    pub fn at_most(points: u32) -> Self {
        Self::AtMost(NonZeroU32::new(points).unwrap_or(NonZeroU32::MIN))
    }

    /// The number of points.
    pub fn max_points(self) -> usize {
        match self {
            Self::Full => usize::MAX,
            Self::AtMost(points) => points.get() as usize,
        }
    }

    /// Returns true if `frame` has enough points. Three quarters of the wanted number will do: a frame is not rebuilt
    /// for so little. A level of detail will do if the next finer one has more.
    pub(super) fn is_met_by(self, frame: &Frame) -> bool {
        let points = frame.len() + frame.dropped_points();
        let is_finest = |finer: usize| finer > self.max_points();
        !frame.is_sample() || points >= self.max_points() / 4 * 3 || frame.points_of_finer().is_some_and(is_finest)
    }

    /// Returns true if `frame` has enough excess points to make creating one with fewer worthwhile.
    pub(super) fn is_exceeded_by(self, frame: &Frame) -> bool {
        frame.len() > self.max_points().saturating_mul(3) / 2
    }
}
