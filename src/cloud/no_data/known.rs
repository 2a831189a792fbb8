//! Known facts about a cloud in addition to its positions, and equality of two coordinates.

use glam::DVec3;

/// Relative rounding of single precision.
const ROUNDING: f64 = 1e-6;

/// Known facts about a cloud in addition to its positions.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Known {
    /// See `RawCloud::integer_limits`.
    pub(super) limits: Option<[[f64; 2]; 3]>,
    /// True if points are vertices of triangles.
    pub(super) has_faces: bool,
}

pub(super) fn is_at(position: DVec3, place: [f64; 3]) -> bool {
    (0..3).all(|axis| is_near(position[axis], place[axis]))
}

pub(super) fn is_near(coordinate: f64, value: f64) -> bool {
    (coordinate - value).abs() <= ROUNDING * value.abs()
}
