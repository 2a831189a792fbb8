//! Colour scales: the linear or logarithmic position of a number between two ends; and quantile ranges, the two ends
//! that cover most of many numbers.

use std::ops::Range;

/// The ends of a logarithmic scale whose lower one is not above zero are this factor apart.
const SIX_DECADES: f64 = 1e6;

/// From numbers to shares of 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorScale {
    low: f64,
    high: f64,
    is_logarithmic: bool,
}

impl ColorScale {
    /// From `low` to `high`, finite and in this order. Logarithmic, if requested and `high` is above zero by more than
    /// rounding; a `low` that is not becomes a millionth of `high`.
    pub fn new(low: f64, high: f64, is_logarithmic: bool) -> Self {
        let min = high / SIX_DECADES;
        let is_logarithmic = is_logarithmic && min > 0.0;
        let low = if is_logarithmic && low <= 0.0 { min } else { low };
        Self {
            low,
            high,
            is_logarithmic,
        }
    }

    /// The two ends.
    pub fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Returns true if the scale is logarithmic.
    pub fn is_logarithmic(&self) -> bool {
        self.is_logarithmic
    }

    /// Returns the normalised position of `value` on the scale: 0 at the lower end and below, 1 at the upper end and
    /// above, NaN for NaN. If both ends are equal, that number is at 0.5.
    pub fn share(&self, value: f64) -> f32 {
        self.mapper(0.0).share(value)
    }

    /// The number at fraction `share` of the range.
    pub fn value_at(&self, share: f64) -> f64 {
        if self.is_logarithmic {
            let [low, high] = [self.low.ln(), self.high.ln()];
            (low + (high - low) * share).exp()
        } else {
            // Two products: the difference may overflow f64.
            self.low * (1.0 - share) + self.high * share
        }
    }

    /// Returns the mapper of this scale for numbers from which `offset` was subtracted.
    pub(crate) fn mapper(&self, offset: f64) -> Mapper {
        let [low, high] = if self.is_logarithmic {
            [self.low.ln(), self.high.ln()]
        } else {
            [self.low - offset, self.high - offset]
        };
        let extent = high - low;
        let factor = if extent > 0.0 { 1.0 / extent } else { 0.0 };
        Mapper {
            low,
            high,
            factor,
            offset,
            is_logarithmic: self.is_logarithmic,
        }
    }
}

/// A [`ColorScale`] made ready for many numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mapper {
    low: f64,
    high: f64,
    factor: f64,
    offset: f64,
    is_logarithmic: bool,
}

impl Mapper {
    /// Returns true if both ends are equal.
    fn is_one_number(&self) -> bool {
        self.factor == 0.0 || !self.factor.is_finite()
    }

    /// [`ColorScale::share`] of `value` and the offset.
    pub(crate) fn share(&self, value: f64) -> f32 {
        if self.is_logarithmic {
            self.logarithmic_share(value)
        } else if self.is_one_number() {
            self.share_of_one(value)
        } else {
            self.linear_share(value)
        }
    }

    /// Precondition: the ends differ.
    fn linear_share(&self, value: f64) -> f32 {
        ((value - self.low) * self.factor).clamp(0.0, 1.0) as f32
    }

    /// Precondition: logarithmic.
    fn logarithmic_share(&self, value: f64) -> f32 {
        let value = value + self.offset;
        if value.is_nan() {
            return f32::NAN;
        }
        // Values without a logarithm are below all that have one.
        let logarithm = if value > 0.0 { value.ln() } else { f64::NEG_INFINITY };
        if self.is_one_number() {
            self.share_of_one(logarithm)
        } else {
            self.linear_share(logarithm)
        }
    }

    fn share_of_one(&self, value: f64) -> f32 {
        if value.is_nan() {
            f32::NAN
        } else if value < self.low {
            0.0
        } else if value > self.high {
            1.0
        } else {
            0.5
        }
    }
}

/// The numbers that `shares` of `sorted` (ascending, finite) do not exceed, by the nearest rank, and `offset` added;
/// `None` without numbers. Where they are one number although there are others, the smallest and the largest.
pub fn quantile_range(sorted: &[f32], offset: f64, shares: Range<f64>) -> Option<[f64; 2]> {
    let last = sorted.len().checked_sub(1)?;
    let at = |share: f64| sorted[(share.clamp(0.0, 1.0) * last as f64).round() as usize];
    let mut range = [at(shares.start), at(shares.end)];
    if range[0] == range[1] {
        range = [sorted[0], sorted[last]];
    }
    Some(range.map(|value| f64::from(value) + offset))
}

/// Computes a histogram: the number of values of `sorted` (ascending, finite) with `offset` added that fall into each
/// of `bins` parts of `range`, evenly spaced on the colour scale; the first and the last bin also count values beyond
/// the range.
pub fn histogram(sorted: &[f32], offset: f64, scale: &ColorScale, bins: usize) -> Vec<u32> {
    let mut counts = vec![0; bins];
    let Some(last) = bins.checked_sub(1) else {
        return counts;
    };
    let mapper = scale.mapper(offset);
    for &value in sorted {
        let share = mapper.share(f64::from(value));
        counts[((share * bins as f32) as usize).min(last)] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ends_midpoint_and_out_of_range_values_have_known_shares() {
        let scale = ColorScale::new(10.0, 30.0, false);
        let share = |value| scale.share(value);
        assert_eq!([10.0, 20.0, 30.0].map(share), [0.0, 0.5, 1.0]);
        assert_eq!([-1e300, 1e300, f64::INFINITY].map(share), [0.0, 1.0, 1.0]);
        assert!(share(f64::NAN).is_nan());
        let decades = ColorScale::new(1.0, 1000.0, true);
        assert!((decades.share(10.0) - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!([0.0, -5.0, 1000.0].map(|value| decades.share(value)), [0.0, 0.0, 1.0]);
        assert!(decades.share(f64::NAN).is_nan());
    }

    #[test]
    fn a_single_number_is_in_the_center() {
        for is_logarithmic in [false, true] {
            let scale = ColorScale::new(3.0, 3.0, is_logarithmic);
            let shares = [2.0, 3.0, 4.0].map(|value| scale.share(value));
            assert_eq!(shares, [0.0, 0.5, 1.0]);
        }
    }

    #[test]
    fn logarithms_need_numbers_above_zero() {
        assert!(!ColorScale::new(-3.0, 0.0, true).is_logarithmic());
        assert_eq!(ColorScale::new(-3.0, 100.0, true).ends(), [1e-4, 100.0]);
    }

    #[test]
    fn all_of_f64_is_a_range() {
        let scale = ColorScale::new(-f64::MAX, f64::MAX, false);
        assert!(scale.share(0.0).is_finite());
        assert_eq!(scale.value_at(0.5), 0.0);
        let small = ColorScale::new(0.0, 5e-324, false);
        assert_eq!((small.share(-1.0), small.share(1.0)), (0.0, 1.0));
    }

    #[test]
    fn outliers_do_not_stretch_the_range_and_ties_do_not_cut_it() {
        let mut values: Vec<f32> = (0..=100).map(|value| value as f32).collect();
        values[100] = f32::MAX;
        assert_eq!(quantile_range(&values, 0.0, 0.01..0.99), Some([1.0, 99.0]));
        assert_eq!(quantile_range(&values, 5.0, 0.01..0.99), Some([6.0, 104.0]));
        assert_eq!(quantile_range(&[], 0.0, 0.01..0.99), None);
        assert_eq!(quantile_range(&[7.0], 0.0, 0.01..0.99), Some([7.0; 2]));
        assert_eq!(quantile_range(&[7.0; 9], 0.0, 0.01..0.99), Some([7.0; 2]));
        // Nearly all are 1: the full range is used.
        let mut ones = vec![1.0; 1000];
        ones.push(5.0);
        assert_eq!(quantile_range(&ones, 0.0, 0.01..0.99), Some([1.0, 5.0]));
    }

    #[test]
    fn every_number_is_in_one_bin() {
        let values: Vec<f32> = (0..100).map(|value| value as f32).collect();
        let scale = ColorScale::new(20.0, 40.0, false);
        assert_eq!(histogram(&values, 0.0, &scale, 4), [25, 5, 5, 65]);
        assert_eq!(histogram(&values, 20.0, &scale, 2), [10, 90]);
        assert!(histogram(&values, 0.0, &scale, 0).is_empty());
    }

    proptest! {
        #[test]
        fn shares_are_monotonic(
            ends in prop::array::uniform2(-1e6f64..1e6), mut values in prop::collection::vec(-2e6f64..2e6, 2..50),
            is_logarithmic: bool,
        ) {
            let scale = ColorScale::new(ends[0].min(ends[1]), ends[0].max(ends[1]), is_logarithmic);
            values.sort_by(f64::total_cmp);
            let shares: Vec<f32> = values.iter().map(|&value| scale.share(value)).collect();
            prop_assert!(shares.is_sorted());
            prop_assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
        }

        #[test]
        fn value_and_share_round_trip(low in -1e3f64..1e3, extent in 0.1f64..1e3, share in 0f64..=1.0) {
            let scale = ColorScale::new(low, low + extent, false);
            prop_assert!((f64::from(scale.share(scale.value_at(share))) - share).abs() < 1e-6);
            let scale = ColorScale::new(extent, 1e4, true);
            prop_assert!((f64::from(scale.share(scale.value_at(share))) - share).abs() < 1e-6);
        }

        #[test]
        fn an_offset_changes_nothing(value in -1e3f32..1e3, offset in -1e9f64..1e9) {
            let plain = ColorScale::new(-500.0, 500.0, false).share(f64::from(value));
            let moved = ColorScale::new(offset - 500.0, offset + 500.0, false).mapper(offset);
            prop_assert!((moved.share(f64::from(value)) - plain).abs() < 1e-5);
        }
    }
}
