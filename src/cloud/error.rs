//! Errors of decoded clouds, and the limits that they state.

use std::ops::RangeInclusive;

/// Most points a frame can hold.
pub(super) const MAX_POINTS: usize = 1 << 31;

/// Extents of the clouds that images are drawn of, scene units: a cube of such a length is a normal number.
pub(super) const DRAWABLE_EXTENTS: RangeInclusive<f32> = 1e-12..=1e12;

/// Why a decoded cloud cannot become a frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// An attribute array does not have one entry a point.
    #[error("{attribute} has {found} entries for {expected} points")]
    LengthMismatch {
        /// Name of the attribute.
        attribute: String,
        /// Number of points.
        expected: usize,
        /// Number of entries.
        found: usize,
    },
    /// More points than indices of 31 bits tell apart.
    #[error("{found} points are more than a frame can hold ({})", MAX_POINTS)]
    TooManyPoints {
        /// Number of points.
        found: usize,
    },
    /// Coordinates that squares cannot be taken of.
    #[error(
        "the points reach over {length:.0e} units, and images are drawn of {:e} to {:e}: write the coordinates in \
         another unit, 1e{exponent} times as large",
        DRAWABLE_EXTENTS.start(), DRAWABLE_EXTENTS.end()
    )]
    Undrawable {
        /// Extent of the points, or their distance from the origin of the sequence, scene units.
        length: f64,
        /// Power of ten by which coordinates of about 1 result.
        exponent: i32,
    },
}
