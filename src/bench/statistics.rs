//! Order statistics of repeated measurements.
//!
//! Times on a busy machine have a long upper tail: the median and the quartiles give the time of an image, the mean is
//! included because the paper's tables are means.

/// Quantiles of samples, in the unit of the samples.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Quantiles {
    /// Number of samples.
    pub count: usize,
    /// Smallest.
    pub min: f64,
    /// First quartile.
    pub q1: f64,
    /// Median.
    pub median: f64,
    /// Third quartile.
    pub q3: f64,
    /// Largest.
    pub max: f64,
    /// Arithmetic mean.
    pub mean: f64,
}

impl Quantiles {
    /// Quantiles of `samples` in any order; `None` without samples. Between two samples they are interpolated linearly.
    ///
    /// Precondition: no NaN.
    pub fn of(samples: &[f64]) -> Option<Self> {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (&min, &max) = sorted.first().zip(sorted.last())?;
        Some(Self {
            count: sorted.len(),
            min,
            q1: quantile(&sorted, 0.25),
            median: quantile(&sorted, 0.5),
            q3: quantile(&sorted, 0.75),
            max,
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
        })
    }
}

/// The value below which a `fraction` of the samples lies. Preconditions: ascending, not empty, fraction in 0 to 1.
fn quantile(ascending: &[f64], fraction: f64) -> f64 {
    let place = fraction * (ascending.len() - 1) as f64;
    let below = ascending[place.floor() as usize];
    let above = ascending[place.ceil() as usize];
    below + (above - below) * place.fract()
}

/// Arithmetic mean; 0 without values.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn known_answers() {
        assert_eq!(Quantiles::of(&[]), None);
        let one = Quantiles::of(&[7.5]).unwrap();
        assert_eq!([one.min, one.q1, one.median, one.q3, one.max, one.mean], [7.5; 6]);
        let five = Quantiles::of(&[5.0, 1.0, 4.0, 2.0, 13.0]).unwrap();
        assert_eq!(
            [five.min, five.q1, five.median, five.q3, five.max, five.mean],
            [1.0, 2.0, 4.0, 5.0, 13.0, 5.0]
        );
        let four = Quantiles::of(&[4.0, 3.0, 2.0, 1.0]).unwrap();
        assert_eq!(
            [four.q1, four.median, four.q3],
            [1.75, 2.5, 3.25],
            "between the samples"
        );
    }

    proptest! {
        #[test]
        fn quantiles_are_sorted_and_ignore_input_order(mut samples in prop::collection::vec(0.0f64..1e6, 1..50)) {
            let q = Quantiles::of(&samples).unwrap();
            prop_assert!(q.min <= q.q1 && q.q1 <= q.median && q.median <= q.q3 && q.q3 <= q.max);
            prop_assert!(q.min <= q.mean + 1e-6 && q.mean <= q.max + 1e-6);
            let below = samples.iter().filter(|&&sample| sample <= q.median).count();
            prop_assert!(2 * below >= samples.len(), "half of the samples are not above the median");
            samples.reverse();
            prop_assert_eq!(Quantiles::of(&samples).unwrap().median, q.median);
        }
    }
}
