//! Mean of the better half of the matching costs of each pixel of a line (Kang et al. 2001).
//!
//! How it works: costs are held sorted, the least first, for half of the number of views. The costs of another view
//! sink in from the largest on: two operations per position, for all pixels of a line at once, instead of sorting the
//! few costs of every pixel. A pixel that a view does not show has a cost above all others and is not counted.

use super::turned::UNSEEN_COST;
use fearless_simd::{Level, dispatch};

/// Costs of a line of pixels on one plane.
#[derive(Debug)]
pub(super) struct BetterHalf {
    width: usize,
    /// The smallest cost of each pixel, then the next ones.
    sorted: Vec<u8>,
    /// Number of views that show each pixel.
    counts: Vec<u8>,
    sums: Vec<u16>,
}

impl BetterHalf {
    /// For lines of `width` pixels and at most this many views.
    pub(super) fn new(width: usize, views: usize) -> Self {
        Self {
            width,
            sorted: vec![UNSEEN_COST; width * views.div_ceil(2)],
            counts: vec![0; width],
            sums: vec![0; width],
        }
    }

    /// Forgets all views.
    pub(super) fn clear(&mut self) {
        self.sorted.fill(UNSEEN_COST);
        self.counts.fill(0);
    }

    /// Takes the costs of a view, which are others afterwards.
    pub(super) fn take(&mut self, costs: &mut [u8]) {
        dispatch!(Level::new(), _simd => self.sink(costs));
    }

    #[inline(always)]
    fn sink(&mut self, costs: &mut [u8]) {
        for (count, &cost) in self.counts.iter_mut().zip(&*costs) {
            *count += u8::from(cost != UNSEEN_COST);
        }
        for sorted in self.sorted.chunks_exact_mut(self.width) {
            for (sorted, cost) in sorted.iter_mut().zip(&mut *costs) {
                let (less, more) = ((*sorted).min(*cost), (*sorted).max(*cost));
                *sorted = less;
                *cost = more;
            }
        }
    }

    /// Returns true if some of the pixels are shown by no view.
    pub(super) fn lacks_views(&self) -> bool {
        self.counts.contains(&0)
    }

    /// Writes the means, rounded, and the value in `beyond` where no view shows the pixel.
    pub(super) fn means(&mut self, beyond: &[u8], means: &mut [u8]) {
        dispatch!(Level::new(), _simd => self.mean(beyond, means));
    }

    #[inline(always)]
    fn mean(&mut self, beyond: &[u8], means: &mut [u8]) {
        self.sums.fill(0);
        for (rank, sorted) in (0_u8..).zip(self.sorted.chunks_exact(self.width)) {
            for ((sum, &sorted), &count) in self.sums.iter_mut().zip(sorted).zip(&self.counts) {
                // Half means `count / 2`, rounded up.
                let counts = 2 * u16::from(rank) < u16::from(count);
                *sum += if counts { u16::from(sorted) } else { 0 };
            }
        }
        let of_pixels = self.sums.iter().zip(&self.counts).zip(beyond);
        for (mean, ((&sum, &count), &beyond)) in means.iter_mut().zip(of_pixels) {
            let half = f32::from(count.div_ceil(2).max(1));
            let of_seen = (f32::from(sum) / half + 0.5) as u8;
            *mean = if count == 0 { beyond } else { of_seen };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The expected means, by sorting.
    fn expected(costs: &[u8], beyond: u8) -> u8 {
        let mut seen: Vec<u32> = costs
            .iter()
            .filter(|&&cost| cost != UNSEEN_COST)
            .map(|&cost| cost.into())
            .collect();
        seen.sort_unstable();
        let half = seen.len().div_ceil(2);
        let sum: u32 = seen[..half].iter().sum();
        (sum + half as u32 / 2)
            .checked_div(half as u32)
            .map_or(beyond, |mean| mean as u8)
    }

    #[test]
    fn the_lower_half_of_the_costs_is_averaged() {
        for (costs, mean) in [
            (vec![], 9),
            (vec![UNSEEN_COST], 9),
            (vec![40], 40),
            (vec![40, 7], 7),
            (vec![40, 8, UNSEEN_COST, 60, 6], 7),
            (vec![62, 5, 2], 4),
        ] {
            let mut half = BetterHalf::new(1, costs.len());
            for &cost in &costs {
                half.take(&mut [cost]);
            }
            let mut means = [0];
            half.means(&[9], &mut means);
            assert_eq!(means, [mean], "{costs:?}");
            assert_eq!(expected(&costs, 9), mean, "{costs:?}");
        }
    }

    proptest! {
        #[test]
        fn means_match_those_of_sorted_costs(
            lines in prop::collection::vec(prop::collection::vec(prop_oneof![0_u8..=62, Just(UNSEEN_COST)], 40), 1..64),
            beyond in prop::collection::vec(0_u8..=62, 40),
        ) {
            let mut half = BetterHalf::new(40, lines.len());
            for _ in 0..2 {
                half.clear();
                for line in &lines {
                    half.take(&mut line.clone());
                }
            }
            let mut means = vec![0; 40];
            half.means(&beyond, &mut means);
            for pixel in 0..40 {
                let costs: Vec<u8> = lines.iter().map(|line| line[pixel]).collect();
                prop_assert_eq!(means[pixel], expected(&costs, beyond[pixel]));
            }
        }
    }
}
