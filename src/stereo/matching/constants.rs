//! Matching constants shared between the CPU and the GPU.

/// Pixels to each side that the bits of the census know of.
pub(crate) const CENSUS_HALF_WIDTH: usize = 4;
/// Lines above and below.
pub(crate) const CENSUS_HALF_HEIGHT: usize = 3;

/// Maximum variation of an even window: that of an even area after JPEG.
pub(crate) const EVEN_WINDOW: u8 = 2;

/// Pixels to each side whose costs are added for the place between labels by a parabola.
pub(crate) const PARABOLA_REACH: usize = 4;

/// Pixels to each side of the square whose costs are added for the place where lines meet, and whose places a plane is
/// laid through.
pub(crate) const REFINE_REACH: usize = 3;

/// Largest square whose sums fit 16 bits.
pub(crate) const MAX_RADIUS: usize = 15;
