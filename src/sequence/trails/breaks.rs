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
    /// What to tell a person who calls the first frame `first`.
    pub fn text(&self, first: usize) -> String {
        let frame = self.frame + first;
        match self.reason {
            BreakReason::OtherCount {
                points,
                other,
                other_points,
            } => format!(
                "frame {frame} has {points} points, frame {} has {other_points}: indices do not stay with the points",
                other + first
            ),
            BreakReason::OtherOrder { before } => format!(
                "the points of frame {frame} seem to be in another order than those of frame {}: indices do not stay \
                 with the points",
                before + first
            ),
            BreakReason::Unreadable => format!("frame {frame} cannot be read"),
        }
    }
}
