//! What the keys, the panels and the file of settings agree about.

/// Bounds of splat scale and of point size in pixels.
pub(in crate::app) const SPLAT_SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.1..=10.0;
pub(in crate::app) const POINT_SIZE_RANGE_PX: std::ops::RangeInclusive<f32> = 1.0..=32.0;
