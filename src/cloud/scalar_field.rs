//! Numbers of points that have a name and no other meaning here.

use crate::printable;
use rayon::prelude::*;

/// One number a point, under the name that the file has for it: intensity, classification, time.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarField {
    /// The file's name for it, control characters escaped.
    pub name: String,
    /// One entry a point.
    pub values: Vec<f32>,
    /// Offset to be added to a value to get the number in the file: not zero where single precision would lose it, as
    /// in GPS times.
    pub offset: f64,
}

impl ScalarField {
    /// Values as the file has them.
    pub fn new(name: impl Into<String>, values: Vec<f32>) -> Self {
        Self {
            name: printable::name(name.into()),
            values,
            offset: 0.0,
        }
    }

    /// Other values under the same name, to which the same is to be added.
    pub(crate) fn with_values(&self, values: Vec<f32>) -> Self {
        Self {
            name: self.name.clone(),
            values,
            offset: self.offset,
        }
    }

    /// A field of double-precision numbers; the smallest finite one becomes the offset if single precision loses
    /// digits.
    pub fn from_f64(name: impl Into<String>, values: &[f64]) -> Self {
        /// Values that are worth handing to another thread.
        const VALUES_PER_TASK: usize = 1 << 15;
        let all = || values.par_iter().with_min_len(VALUES_PER_TASK);
        let is_exact = |value: &f64| !value.is_finite() || f64::from(*value as f32) == *value;
        // Single precision would lose digits of GPS times.
        let offset = if all().all(is_exact) {
            0.0
        } else {
            let finite = all().copied().filter(|value| value.is_finite());
            let smallest = finite.reduce(|| f64::INFINITY, f64::min);
            if smallest.is_finite() { smallest.floor() } else { 0.0 }
        };
        Self {
            name: printable::name(name.into()),
            values: all().map(|value| (value - offset) as f32).collect(),
            offset,
        }
    }
}
