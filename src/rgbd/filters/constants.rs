//! Numbers that filters of the processor and those of a graphics card share.

/// Pixels of the window of the median to each side of its middle.
pub(crate) const MEDIAN_REACH: usize = 2;

/// Of 25 values so many have a smallest and a largest that are not the median of all: half of them, and two more.
pub(crate) const MEDIAN_KEPT: usize = 14;

/// Pixels of the window of the bilateral filter to each side of its middle.
pub(crate) const BILATERAL_REACH: usize = 4;

/// Where a sensor of structured light is at its best, metres; its noise there; and what comes to that by the square of
/// the metres beyond (Nguyen et al. 2012).
pub(crate) const SENSOR_BEST_M: f32 = 0.4;
pub(crate) const SENSOR_NOISE_M: f32 = 0.0012;
pub(crate) const SENSOR_NOISE_PER_M: f32 = 0.0019;

/// Least exponent of 2 of a weight: what is less is nothing, and no number that adapters take for zero.
pub(crate) const LEAST_EXPONENT: f32 = -126.0;
