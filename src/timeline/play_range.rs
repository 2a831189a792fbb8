//! In and out point: the frames between which a sequence plays.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// In and out point of a sequence. A missing point means the end, however long the sequence grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, Serialize, Deserialize)]
#[serde(default)]
pub struct PlayRange {
    first: Option<usize>,
    last: Option<usize>,
}

impl PlayRange {
    /// The in point: the first frame that plays, if it is not the sequence's.
    pub fn first(self) -> Option<usize> {
        self.first
    }

    /// The out point: the last frame that plays, if it is not the sequence's.
    pub fn last(self) -> Option<usize> {
        self.last
    }

    /// Begins at `frame`. An out point before it goes.
    #[must_use]
    pub fn beginning_at(self, frame: usize) -> Self {
        Self {
            first: Some(frame),
            last: self.last.filter(|&last| last >= frame),
        }
    }

    /// Ends with `frame`. An in point after it goes.
    #[must_use]
    pub fn ending_at(self, frame: usize) -> Self {
        Self {
            first: self.first.filter(|&first| first <= frame),
            last: Some(frame),
        }
    }

    /// Returns true if the in point is not after the out point.
    pub(crate) fn is_sound(self) -> bool {
        match (self.first, self.last) {
            (Some(first), Some(last)) => first <= last,
            _ => true,
        }
    }

    /// The frames that play, of `frame_count`; at least one where there is one, and of points beyond the end the last.
    pub fn of(self, frame_count: usize) -> Range<usize> {
        let end_frame = frame_count.saturating_sub(1);
        let first = self.first.unwrap_or(0).min(end_frame);
        let last = self.last.unwrap_or(end_frame).clamp(first, end_frame);
        first..frame_count.min(last + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn setting_one_point_beyond_the_other_removes_the_other() {
        let range = PlayRange::default().beginning_at(3).ending_at(7);
        assert_eq!((range.first(), range.last()), (Some(3), Some(7)));
        assert_eq!(range.of(100), 3..8);
        assert_eq!(range.beginning_at(8).of(100), 8..100);
        assert_eq!(range.ending_at(2).of(100), 0..3);
        assert_eq!(range.ending_at(3).of(100), 3..4);
        assert_eq!(PlayRange::default().of(5), 0..5);
        assert_eq!(range.of(0), 0..0);
    }

    proptest! {
        #[test]
        fn the_played_range_exists_and_is_not_empty(
            first in prop::option::of(0usize..20), last in prop::option::of(0usize..20), count in 1usize..12,
        ) {
            let range = PlayRange { first, last };
            let frames = range.of(count);
            prop_assert!(!frames.is_empty() && frames.end <= count, "{frames:?}");
            // In and out points that exist and are in order are applied to the frame.
            if range.is_sound() && first.max(last).is_none_or(|max| max < count) {
                prop_assert_eq!(frames, first.unwrap_or(0)..last.map_or(count, |last| last + 1));
            }
        }
    }
}
