//! From a rectified pair to disparities: costs, their sums, winners, and their filters.

use super::census::CensusPair;
use super::contrast::remove_even;
use super::filters::{median, remove_specks};
use super::local::local;
use super::refine::refine;
use super::semi_global::{Penalties, semi_global};
use super::winner::{Between, Choice};
use crate::stereo::DisparityMap;
use crate::stereo::DisparityRange;
use crate::stereo::GrayImage;
use crate::stereo::StereoError;
use std::fmt::Debug;
use std::sync::{Arc, LazyLock};

/// Maximum difference of the disparities of neighbours on one surface.
const SPECK_STEP_PX: f32 = 1.0;

/// Cost aggregation method around a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Gathering {
    /// Along eight paths through the image.
    SemiGlobal(Penalties),
    /// In a square.
    Local {
        /// Pixels to each side, at most 15.
        radius_px: usize,
    },
}

/// Settings for matching a pair.
#[derive(Debug, Clone, PartialEq)]
pub struct Matching {
    /// Cost aggregation method.
    pub gathering: Gathering,
    /// Margin by which all other disparities have to cost more than the chosen one, in percent.
    pub unique_percent: u16,
    /// Subpixel disparity method.
    pub between: Between,
    /// Connected areas of fewer pixels are taken out.
    pub min_area_px: usize,
}

impl Default for Matching {
    fn default() -> Self {
        Self {
            gathering: Gathering::SemiGlobal(Penalties::default()),
            unique_percent: 3,
            between: Between::default(),
            min_area_px: 100,
        }
    }
}

impl Matching {
    /// The local winner: fast, for images of some hundred pixels a side.
    pub fn fast() -> Self {
        Self {
            gathering: Gathering::Local { radius_px: 3 },
            unique_percent: 5,
            min_area_px: 30,
            ..Self::default()
        }
    }

    /// Disparities of the pixels of `left`, whose partners are in the same line of `right`.
    ///
    /// # Errors
    /// [`StereoError`] of images that differ in size, of penalties, and of images too large for the range.
    pub fn disparities(
        &self,
        left: &GrayImage,
        right: &GrayImage,
        range: DisparityRange,
    ) -> Result<DisparityMap, StereoError> {
        if left.size_px() != right.size_px() {
            return Err(StereoError::SizesDiffer {
                left: left.size_px(),
                right: right.size_px(),
            });
        }
        let size = [left.width(), left.height()];
        let costs = CensusPair::new(left, right, range);
        let choice = Choice {
            unique_percent: self.unique_percent,
            between: self.between,
            left_right: Some(range.min()),
        };
        let mut labels = vec![f32::NAN; size[0] * size[1]];
        let winners = |sums: &mut [u16], labels: &mut [f32]| choice.winners(sums, labels);
        match self.gathering {
            Gathering::SemiGlobal(penalties) => semi_global(&costs, left, penalties, &mut labels, winners)?,
            Gathering::Local { radius_px } => local(&costs, radius_px, &mut labels, winners)?,
        }
        remove_even(left, &mut labels);
        if self.between == Between::Lines {
            labels = refine(&labels, size[0], |at, label| costs.around(at, label));
        }
        for label in &mut labels {
            *label += range.min() as f32;
        }
        Ok(self.without_specks(size, median(&labels, size[0])))
    }

    /// The map of filtered disparities, NaN where there is none, less its specks. Precondition: one per pixel.
    pub(crate) fn without_specks(&self, size: [usize; 2], mut disparities: Vec<f32>) -> DisparityMap {
        remove_specks(&mut disparities, size[0], self.min_area_px, |a, b| {
            (a - b).abs() <= SPECK_STEP_PX
        });
        DisparityMap::new(size, disparities)
    }
}

/// Matcher for rectified pairs: on this CPU, or on a GPU.
pub trait PairMatcher: Debug + Send + Sync {
    /// Disparities of the pixels of `left`, as [`Matching::disparities`] has them.
    ///
    /// # Errors
    /// The errors of [`Matching::disparities`].
    fn disparities(
        &self,
        matching: &Matching,
        left: &GrayImage,
        right: &GrayImage,
        range: DisparityRange,
    ) -> Result<DisparityMap, StereoError>;
}

/// The CPU.
#[derive(Debug, Clone, Copy)]
pub struct OnProcessor;

impl PairMatcher for OnProcessor {
    fn disparities(
        &self,
        matching: &Matching,
        left: &GrayImage,
        right: &GrayImage,
        range: DisparityRange,
    ) -> Result<DisparityMap, StereoError> {
        matching.disparities(left, right, range)
    }
}

/// A shared matcher: the CPU by default.
#[derive(Debug, Clone)]
pub struct SharedMatcher(pub Arc<dyn PairMatcher>);

impl Default for SharedMatcher {
    fn default() -> Self {
        static PROCESSOR: LazyLock<Arc<OnProcessor>> = LazyLock::new(|| Arc::new(OnProcessor));
        Self(Arc::<OnProcessor>::clone(&PROCESSOR))
    }
}

/// Equality by pointer: the same shared matcher.
impl PartialEq for SharedMatcher {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(test)]
mod tests;
