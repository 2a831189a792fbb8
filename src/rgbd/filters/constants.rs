//! Constants shared by the CPU and GPU filters.

/// Half width of the median window: pixels to each side of its centre.
pub(crate) const MEDIAN_REACH: usize = 2;

/// Number of values kept by forgetful selection: of 25 values, this many have a smallest and a largest that are not the
/// median of all: half of them, and two more.
pub(crate) const MEDIAN_RETAINED: usize = 14;

/// Half width of the bilateral filter's window: pixels to each side of its centre.
pub(crate) const BILATERAL_REACH: usize = 4;

/// Noise model of a structured-light sensor: the distance at which it is best, metres; its noise there; and the
/// increase by the square of the metres beyond (Nguyen et al. 2012).
pub(crate) const SENSOR_BEST_M: f32 = 0.4;
pub(crate) const SENSOR_NOISE_M: f32 = 0.0012;
pub(crate) const SENSOR_NOISE_PER_M: f32 = 0.0019;

/// Minimum exponent of 2 of a weight: smaller ones are negligible, and this is not a number that adapters flush to
/// zero.
pub(crate) const MIN_EXPONENT: f32 = -126.0;
