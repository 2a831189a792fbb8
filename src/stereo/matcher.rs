//! From a rectified pair to disparities.

use super::census::CensusPair;
use super::semi_global::{Penalties, semi_global};
use super::filters::{median, remove_specks};
use super::winner::{Between, Choice};
use super::{DisparityMap, DisparityRange, GrayImage, StereoError};

/// By how much the disparities of neighbours on one surface differ at most.
const SPECK_STEP_PX: f32 = 1.0;

/// How a pair is matched.
#[derive(Debug, Clone, PartialEq)]
pub struct Matching {
    /// Penalties.
    pub penalties: Penalties,
    /// By how much all other disparities have to cost more than the one that is taken, in percent.
    pub unique_percent: u16,
    /// How disparities between pixels are found.
    pub between: Between,
    /// Connected areas of fewer pixels are taken out.
    pub least_area_px: usize,
}

impl Default for Matching {
    fn default() -> Self {
        Self {
            penalties: Penalties::default(),
            unique_percent: 3,
            between: Between::default(),
            least_area_px: 100,
        }
    }
}

impl Matching {
    /// Disparities of the pixels of `left`.
    ///
    /// # Errors
    /// [`StereoError`].
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
        semi_global(&costs, left, self.penalties, &mut labels, |sums, labels| {
            choice.winners(sums, labels);
        })?;
        for label in &mut labels {
            *label += range.min() as f32;
        }
        let mut labels = median(&labels, size[0]);
        remove_specks(&mut labels, size[0], self.least_area_px, |a, b| (a - b).abs() <= SPECK_STEP_PX);
        Ok(DisparityMap::new(size, labels))
    }
}
