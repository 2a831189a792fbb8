//! Filters of depth images, in the order in which they are applied.
//!
//! Noise and outliers are dealt with while neighbours are still next to each other in an image, which costs a fixed
//! number of steps per pixel (Hofer et al. 2018, §3.4). Each filter reads one image and writes another, line by line on
//! all threads, so the result does not depend on their number. Unmeasured pixels stay unmeasured.

mod bilateral;
pub(crate) mod constants;
mod dropped;
mod flying;
mod median;
mod padded;
mod parameters;
mod range;
mod temporal;
#[cfg(test)]
pub(crate) mod test_images;
mod text;

pub use bilateral::Bilateral;
pub use dropped::{DroppedPixels, FilterReport, NOTICEABLE_SHARE};
pub use flying::FlyingPixels;
pub use median::median;
pub use parameters::{FilterKind, FilterParameter};
pub use range::DepthRange;
pub use temporal::{Temporal, TemporalFilter};
pub use text::ParseFiltersError;

use super::images::DepthImage;

/// Depth filters to apply; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Filters {
    /// Range of distances retained.
    pub near: Option<DepthRange>,
    /// True if the median filter of 5 × 5 pixels is applied.
    pub median: bool,
    /// The mean of 9 × 9 pixels that are at a similar depth.
    pub bilateral: Option<Bilateral>,
    /// Pixels between a surface and its background are dropped.
    pub flying: Option<FlyingPixels>,
    /// The mean with the images before.
    pub temporal: Option<Temporal>,
}

impl Filters {
    /// None.
    pub const NONE: Self = Self {
        near: None,
        median: false,
        bilateral: None,
        flying: None,
        temporal: None,
    };

    /// The default filters: all that look at one image alone.
    pub const USUAL: Self = Self {
        near: Some(DepthRange::USUAL),
        median: true,
        bilateral: Some(Bilateral::USUAL),
        flying: Some(FlyingPixels::USUAL),
        temporal: None,
    };

    /// Number of filters.
    pub const COUNT: usize = 5;

    /// Returns true if the depth range is not empty.
    pub fn keep_any(&self) -> bool {
        self.near.is_none_or(|near| near.near_m < near.far_m)
    }

    /// `depth` after all filters but the temporal one, which needs the images before: see [`TemporalFilter`].
    #[must_use]
    pub fn apply(&self, mut depth: DepthImage) -> DepthImage {
        if let Some(range) = self.near {
            range.apply(&mut depth);
        }
        // The order is fixed: the median removes black dots and straightens the lines into which surfels of a raw frame
        // are separated, then the bilateral filter closes these. Neither drops a point.
        if self.median {
            depth = median(&depth);
        }
        if let Some(bilateral) = self.bilateral {
            depth = bilateral.apply(&depth);
        }
        if let Some(flying) = self.flying {
            depth = flying.apply(&depth);
        }
        depth
    }
}
