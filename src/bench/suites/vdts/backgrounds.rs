//! Coverage test with both [`COVERAGE_BACKGROUNDS`](crate::bench::run::COVERAGE_BACKGROUNDS): a pixel that lets either
//! of them show through is not covered.

use image::Rgba;

/// So much of 255 of a background may show through: 3 %.
const MAX_SHOWN_THROUGH: u8 = 8;

/// Returns true if a pixel, given its colour on each of them, is covered.
pub(super) fn is_covered(dark: Rgba<u8>, bright: Rgba<u8>) -> bool {
    (0..3).all(|channel| dark[channel].abs_diff(bright[channel]) <= MAX_SHOWN_THROUGH)
}
