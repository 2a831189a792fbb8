//! Goal of rate control.

/// Requested size or error of a sequence file, instead of a precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RateGoal {
    /// At most this many bytes for all frames, with the smallest error.
    Bytes(u64),
    /// At most this root mean square distance of a point from its original, in the unit of the file, with the smallest
    /// size.
    RmsError(f64),
}
