//! Where trails end, and why.

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
        /// How many.
        points: usize,
        /// A frame in which points are followed.
        other: usize,
        /// How many that one has.
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
    /// What to tell a person; `named` says how a frame is called, such as "frame 3".
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
