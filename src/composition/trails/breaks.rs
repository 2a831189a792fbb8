//! Trail breaks: the frames at which trails end, and the reasons.

/// A frame through which points cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrailBreak {
    /// The frame; of several in a row the first.
    pub frame: usize,
    /// Why not.
    pub reason: BreakReason,
}

/// Why points cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BreakReason {
    /// There are more points, or fewer.
    OtherCount {
        /// Point count of this frame.
        points: usize,
        /// A frame in which points are followed.
        other: usize,
        /// Point count of the other frame.
        other_points: usize,
    },
    /// The points seem to be in another order than in this frame before.
    OtherOrder {
        /// The last frame before.
        before: usize,
    },
    /// The frame cannot be read.
    Unreadable,
}

impl TrailBreak {
    /// Returns the message for the user; `named` returns the name of a frame, such as "frame 3".
    pub fn text(&self, named: impl Fn(usize) -> String) -> String {
        let frame = named(self.frame);
        match self.reason {
            BreakReason::OtherCount {
                points,
                other,
                other_points,
            } => format!(
                "{frame} has {points} points, {} has {other_points}: indices do not stay with the points",
                named(other)
            ),
            BreakReason::OtherOrder { before } => format!(
                "the points of {frame} seem to be in another order than those of {}: indices do not stay with the \
                 points",
                named(before)
            ),
            BreakReason::Unreadable => format!("{frame} cannot be read"),
        }
    }
}
