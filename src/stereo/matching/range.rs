//! Range of disparities to try.

use super::costs::LANES;
use crate::stereo::StereoError;

/// Maximum number of disparities tried.
const MAX: usize = 8192;

/// Disparities in pixels, column in the left image less column in the right one: above 0 for finite depths in views
/// whose principal points agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DisparityRange {
    min: i32,
    count: usize,
}

impl DisparityRange {
    /// Disparities from `min` to `max`, and some beyond `max`: they are rounded up to a multiple of 32, which costs
    /// nothing.
    ///
    /// # Errors
    /// [`StereoError::NoRange`] where `max` is below `min`, or too far above.
    pub fn new(min: i32, max: i32) -> Result<Self, StereoError> {
        let error = StereoError::NoRange { min, max, most: MAX };
        let count = usize::try_from(i64::from(max) - i64::from(min) + 1).map_err(|_| error.clone())?;
        if count == 0 || count > MAX || min.unsigned_abs() as usize > 1 << 24 {
            return Err(error);
        }
        Ok(Self {
            min,
            count: count.next_multiple_of(LANES),
        })
    }

    /// The smallest.
    pub fn min(self) -> i32 {
        self.min
    }

    /// The largest that is tried.
    pub fn max(self) -> i32 {
        self.min + self.count as i32 - 1
    }

    /// Returns the number of disparities in the range.
    pub fn count(self) -> usize {
        self.count
    }
}
