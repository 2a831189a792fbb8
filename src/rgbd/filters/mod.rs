//! Filters of depth images, in the order in which they are applied.
//!
//! Noise and outliers are dealt with while neighbours are still next to each other in an image, which costs a fixed
//! number of steps a pixel (paper 003, §3.4). Each filter reads one image and writes another, line by line on all
//! threads, so the result does not depend on how many there are. What was not measured stays not measured.

mod bilateral;
mod flying;
mod median;
mod padded;
mod range;
mod temporal;
#[cfg(test)]
mod test_images;

pub use bilateral::Bilateral;
pub use flying::FlyingPixels;
pub use median::median;
pub use range::DepthRange;
pub use temporal::{Temporal, TemporalFilter};

use super::images::DepthImage;
use std::fmt;
use std::str::FromStr;

/// Which filters are applied; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Filters {
    /// Distances that are kept.
    pub near: Option<DepthRange>,
    /// Whether the median of 5 × 5 pixels is taken.
    pub median: bool,
    /// The mean of 9 × 9 pixels that are at a similar depth.
    pub bilateral: Option<Bilateral>,
    /// Pixels between a surface and what is behind it are dropped.
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

    /// Those that pictures are made with where nobody chose: all that look at one image alone.
    pub const USUAL: Self = Self {
        near: Some(DepthRange::USUAL),
        median: true,
        bilateral: Some(Bilateral::USUAL),
        flying: Some(FlyingPixels::USUAL),
        temporal: None,
    };

    /// Words for them, in their order.
    pub const NAMES: [&'static str; 5] = ["near", "median", "bilateral", "flying", "temporal"];

    /// `depth` after all filters but the temporal one, which needs the images before: see [`TemporalFilter`].
    #[must_use]
    pub fn apply(&self, mut depth: DepthImage) -> DepthImage {
        if let Some(range) = self.near {
            range.apply(&mut depth);
        }
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

impl fmt::Display for Filters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let chosen = [
            self.near.is_some(),
            self.median,
            self.bilateral.is_some(),
            self.flying.is_some(),
            self.temporal.is_some(),
        ];
        let names: Vec<&str> = Self::NAMES
            .into_iter()
            .zip(chosen)
            .filter_map(|(name, is_chosen)| is_chosen.then_some(name))
            .collect();
        f.write_str(if names.is_empty() { "none" } else { "" })?;
        f.write_str(&names.join(","))
    }
}

/// A word that is no filter.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no filter of depth: expected near, median, bilateral, flying and temporal with commas between, or none"
)]
pub struct ParseFiltersError(String);

impl FromStr for Filters {
    type Err = ParseFiltersError;

    /// The usual parameters of the filters that are named; their order is always the same.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut filters = Self::NONE;
        if text == "none" {
            return Ok(filters);
        }
        for name in text.split(',') {
            match name {
                "near" => filters.near = Some(DepthRange::USUAL),
                "median" => filters.median = true,
                "bilateral" => filters.bilateral = Some(Bilateral::USUAL),
                "flying" => filters.flying = Some(FlyingPixels::USUAL),
                "temporal" => filters.temporal = Some(Temporal::USUAL),
                _ => return Err(ParseFiltersError(name.to_owned())),
            }
        }
        Ok(filters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for text in [
            "none",
            "near",
            "median,bilateral",
            "near,median,bilateral,flying,temporal",
        ] {
            assert_eq!(text.parse::<Filters>().unwrap().to_string(), text);
        }
        assert_eq!("flying,near".parse::<Filters>().unwrap().to_string(), "near,flying");
        assert_eq!(Filters::USUAL.to_string(), "near,median,bilateral,flying");
        assert_eq!(Filters::default(), Filters::NONE);
        for wrong in ["", "median,", "none,median", "blur"] {
            let error = wrong.parse::<Filters>().unwrap_err().to_string();
            assert!(error.contains("expected near, median"), "{error}");
        }
    }
}
