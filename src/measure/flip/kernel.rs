//! Separable filters whose borders repeat the outermost pixels.
//!
//! How it works: a row (or column) is convolved by adding it up shifted, once for each tap, which is one multiplication
//! and addition on neighbouring numbers, eight at once. Rows are shared out among threads; each is written by one, so
//! that the answer does not depend on how many there are.

use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// Numbers that are added up at once.
const LANES: usize = 8;

/// Weights this much smaller than the largest change nothing that f32 keeps.
const NEGLIGIBLE: f64 = 1e-9;

/// Weights at −r … r pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kernel {
    weights: Vec<f32>,
}

impl Kernel {
    /// Weights of `weight` at pixels up to `radius_px`; the positive ones add up to 1 and any negative ones to −1.
    pub(super) fn normalized(radius_px: usize, weight: impl Fn(f64) -> f64) -> Self {
        let raw = |radius: usize| -> Vec<f64> {
            let radius = radius as i32;
            (-radius..=radius).map(|offset| weight(f64::from(offset))).collect()
        };
        let all = raw(radius_px);
        let largest = all.iter().copied().map(f64::abs).fold(0.0, f64::max);
        let matters = |radius: usize| {
            [0, 2 * radius]
                .into_iter()
                .any(|end| raw(radius)[end].abs() > NEGLIGIBLE * largest)
        };
        let radius = (1..=radius_px).rev().find(|&radius| matters(radius)).unwrap_or(0);
        let retained = raw(radius);
        let sum_of = |sign: f64| retained.iter().map(|weight| (weight * sign).max(0.0)).sum::<f64>();
        let [positive, negative] = [sum_of(1.0), sum_of(-1.0)];
        let weights = retained.into_iter().map(|weight| {
            let sum = if weight > 0.0 { positive } else { negative };
            if weight == 0.0 { 0.0 } else { (weight / sum) as f32 }
        });
        Self {
            weights: weights.collect(),
        }
    }

    fn radius(&self) -> usize {
        self.weights.len() / 2
    }
}

/// One number a pixel, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) values: Vec<f32>,
}

impl Plane {
    /// Filters rows by `along_x` and columns by `along_y`.
    pub(super) fn filtered(&self, along_x: &Kernel, along_y: &Kernel) -> Self {
        self.filtered_rows(along_x).filtered_columns(along_y)
    }

    fn filtered_rows(&self, kernel: &Kernel) -> Self {
        let radius = kernel.radius();
        let width = self.width;
        self.by_rows(|row, sums| {
            let pixels = &self.values[row * width..][..width];
            let mut padded = vec![pixels[0]; width + 2 * radius];
            padded[radius..radius + width].copy_from_slice(pixels);
            padded[radius + width..].fill(pixels[width - 1]);
            for (shift, &weight) in kernel.weights.iter().enumerate() {
                add_scaled(sums, &padded[shift..], weight);
            }
        })
    }

    fn filtered_columns(&self, kernel: &Kernel) -> Self {
        let radius = kernel.radius();
        let width = self.width;
        let last_row = (self.values.len() / width.max(1)).saturating_sub(1);
        self.by_rows(|row, sums| {
            for (shift, &weight) in kernel.weights.iter().enumerate() {
                let source = (row + shift).saturating_sub(radius).min(last_row);
                add_scaled(sums, &self.values[source * width..], weight);
            }
        })
    }

    /// A plane of the same size; `write` fills one zeroed row after the other.
    fn by_rows(&self, write: impl Fn(usize, &mut [f32]) + Sync) -> Self {
        let mut values = vec![0.0; self.values.len()];
        values
            .par_chunks_mut(self.width.max(1))
            .enumerate()
            .for_each(|(row, sums)| write(row, sums));
        Self {
            width: self.width,
            values,
        }
    }
}

/// `sums += weight · addends`, as far as there are sums.
fn add_scaled(sums: &mut [f32], addends: &[f32], weight: f32) {
    dispatch!(Level::new(), simd => add_scaled_in_lanes(simd, sums, addends, weight));
}

#[inline(always)]
fn add_scaled_in_lanes<S: Simd>(simd: S, sums: &mut [f32], addends: &[f32], weight: f32) {
    let (sums, rest) = sums.as_chunks_mut::<LANES>();
    for (sums, addends) in sums.iter_mut().zip(addends.as_chunks::<LANES>().0) {
        let sum = simd.load_array_f32x8(*sums) + simd.load_array_f32x8(*addends) * weight;
        simd.store_array_f32x8(sum, sums);
    }
    for (sum, addend) in rest.iter_mut().zip(&addends[sums.len() * LANES..]) {
        *sum += weight * addend;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn positive_and_negative_weights_are_normalised_separately() {
        let smooth = Kernel::normalized(1, |x| 3.0 - x.abs());
        assert_eq!(smooth.weights, [2.0 / 7.0, 3.0 / 7.0, 2.0 / 7.0]);
        let slope = Kernel::normalized(2, |x| -x);
        let expected = [2.0 / 3.0, 1.0 / 3.0, 0.0, -1.0 / 3.0, -2.0 / 3.0];
        assert_eq!(slope.weights, expected);
        // Negligible weights are dropped.
        let narrow = Kernel::normalized(9, |x| (-10.0 * x * x).exp());
        assert_eq!(narrow.weights.len(), 3);
    }

    proptest! {
        /// Against the double sum over clamped coordinates.
        #[test]
        fn separable_filters_match_double_sums(
            values in prop::collection::vec(-1.0f32..1.0, 7 * 5), a in 1u8..9, b in 1u8..9,
        ) {
            let plane = Plane { width: 7, values };
            let along_x = Kernel::normalized(3, |x| f64::from(a) - x);
            let along_y = Kernel::normalized(2, |y| f64::from(b) + y * y);
            let filtered = plane.filtered(&along_x, &along_y);
            for y in 0..5i32 {
                for x in 0..7i32 {
                    let mut sum = 0.0;
                    for (dy, wy) in (-2..).zip(&along_y.weights) {
                        for (dx, wx) in (-3..).zip(&along_x.weights) {
                            let [column, row] = [(x + dx).clamp(0, 6), (y + dy).clamp(0, 4)];
                            sum += wx * wy * plane.values[(row * 7 + column) as usize];
                        }
                    }
                    let found = filtered.values[(y * 7 + x) as usize];
                    prop_assert!((found - sum).abs() < 1e-5, "{found} for {sum} at {x}, {y}");
                }
            }
        }
    }
}
