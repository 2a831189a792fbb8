//! Penalties for disparity changes on a path: smaller where brightness changes, as object borders are seen there.

use crate::stereo::StereoError;
use crate::stereo::matching::costs::MAX_COST;

/// Penalties of semi-global matching, in bits of the census (0 to 62 a pixel).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Penalties {
    /// For a step of one disparity from pixel to pixel.
    pub p1: u8,
    /// For a larger step between pixels of the same brightness.
    pub p2: u8,
    /// For a larger step where brightness changes most.
    pub p2_min: u8,
    /// The change of brightness from pixel to pixel at which P2 is halfway down.
    pub half_change: u8,
}

impl Default for Penalties {
    fn default() -> Self {
        Self {
            // The P1 with the fewest errors, for positions from lines: it biases a parabola through the sums, which
            // turned 0.25 px into 0.05, and into 0.08 with P1 = 10.
            p1: 24,
            p2: 120,
            p2_min: 44,
            half_change: 16,
        }
    }
}

/// A path's cost is at most a pixel's plus P2; with P1 added it has to stay a byte.
const MAX: u8 = u8::MAX - MAX_COST;

/// P2 of each change of brightness.
#[derive(Debug, Clone)]
pub(super) struct Table {
    pub(super) p1: u8,
    p2: [u8; 256],
}

impl Penalties {
    /// Returns true if bytes can hold path costs with these penalties.
    pub(crate) fn are_valid(self) -> bool {
        self.table().is_ok()
    }

    /// # Errors
    /// [`StereoError::NoPenalties`].
    pub(super) fn table(self) -> Result<Table, StereoError> {
        let Self {
            p1,
            p2,
            p2_min,
            half_change,
        } = self;
        if p1 >= p2_min || p2_min > p2 || p1.checked_add(p2).is_none_or(|sum| sum > MAX) {
            return Err(StereoError::NoPenalties {
                p1,
                p2_min,
                p2,
                most: MAX,
            });
        }
        let half = u16::from(half_change.max(1));
        Ok(Table {
            p1,
            p2: std::array::from_fn(|change| {
                let above = u16::from(p2 - p2_min) * half / (half + change as u16);
                p2_min + above as u8
            }),
        })
    }
}

impl Table {
    pub(super) fn p2(&self, from: u8, to: u8) -> u8 {
        self.p2[usize::from(from.abs_diff(to))]
    }
}
