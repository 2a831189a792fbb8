//! Numbers of points that frames are made with.

/// Frames of fewer points save nothing worth it.
pub(super) const MIN_POINTS: u32 = 1 << 13;

/// The power of two at or below `points`, within bounds.
pub(super) fn power_of_two(points: f64) -> u32 {
    let points = points.min(f64::from(1_u32 << 31)) as u32;
    (1 << points.max(1).ilog2()).max(MIN_POINTS)
}
