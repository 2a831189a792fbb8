//! Label selection: the cheapest label of each pixel from its costs, with subpixel precision, unless another is as
//! good.
//!
//! - *Left and right*: a pixel of the right image has the costs of its partners in the left one, so both winners come
//!   from one volume of costs (Hirschmüller 2008, section 2.4). A pixel keeps its disparity if its partner's is at most
//!   1 px away.
//! - *Unique*: any label but the winner and its neighbours has to cost some percent more. So there is no result without
//!   texture: in an even wall all labels cost the same.
//! - *Between labels*, if by [`Between::Parabola`]: the minimum of a parabola through the winner and its neighbours.
//!   Sums
//!   of adjacent pixels in the line whose winners are the same or next to it are added, four to each side, against the
//!   noise of single pixels.

use super::constants::PARABOLA_REACH as REACH;
use fearless_simd::{Level, dispatch};

/// Subpixel interpolation method between labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Between {
    /// Intersection of two lines of one slope, the steeper side's, through the costs of pixels alone (Shimizu and
    /// Okutomi 2001). True to a hundredth of a pixel in the mean.
    // Median error against a sub-pixel ground truth (motorcycle, 741 × 500): 0.109 px, with the parabola 0.146.
    #[default]
    Lines,
    /// The lowest place of a parabola through the sums (Hirschmüller 2008, section 2.4). Less noisy, but drawn to whole
    /// labels: 0.25 becomes 0.05, so that surfaces become terraces.
    // It has a smaller error against a ground truth in whole pixels: 0.259 px instead of 0.36 (aloe).
    Parabola,
}

/// The lowest place of a parabola through three costs, from −1 to 1.
fn lowest([below, at, above]: [u32; 3]) -> f32 {
    let (below, above) = (below as f32 - at as f32, above as f32 - at as f32);
    if below + above > 0.0 {
        ((below - above) / (2.0 * (below + above))).clamp(-1.0, 1.0)
    } else {
        0.0
    }
}

/// Criteria for choosing winners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::stereo) struct Choice {
    /// Margin by which all other labels have to cost more, in percent of the winner.
    pub(in crate::stereo) unique_percent: u16,
    pub(in crate::stereo) between: Between,
    /// Smallest disparity, where labels are disparities and left and right are to agree.
    pub(in crate::stereo) left_right: Option<i32>,
}

impl Choice {
    /// Writes the labels of a line, NaN where there is none. `sums` are all its costs, which are changed.
    pub(in crate::stereo) fn winners(self, sums: &mut [u16], labels: &mut [f32]) {
        dispatch!(Level::new(), _simd => self.write(sums, labels));
    }

    #[inline(always)]
    fn write(self, sums: &mut [u16], labels: &mut [f32]) {
        let width = labels.len();
        let count = sums.len() / width;
        let best: Vec<usize> = sums.chunks_exact(count).map(cheapest).collect();
        for (x, label) in labels.iter_mut().enumerate() {
            *label = best[x] as f32 + self.between(sums, &best, x);
        }
        if let Some(min) = self.left_right {
            let right = right_winners(sums, width);
            for (x, label) in labels.iter_mut().enumerate() {
                let partner = x as i64 - i64::from(min) - best[x] as i64;
                let is_inside = (0..width as i64).contains(&partner);
                if !is_inside || usize::from(right[width - 1 - x + best[x]]).abs_diff(best[x]) > 1 {
                    *label = f32::NAN;
                }
            }
        }
        for ((label, sums), &best) in labels.iter_mut().zip(sums.chunks_exact_mut(count)).zip(&best) {
            if !label.is_nan() && !self.is_unique(sums, best) {
                *label = f32::NAN;
            }
        }
    }

    #[inline(always)]
    fn between(self, sums: &[u16], best: &[usize], x: usize) -> f32 {
        let count = sums.len() / best.len();
        let label = best[x];
        if self.between == Between::Lines || label == 0 || label + 1 == count {
            return 0.0;
        }
        let mut three = [0; 3];
        let near = x.saturating_sub(REACH)..(x + REACH + 1).min(best.len());
        for (near, &other) in near.clone().zip(&best[near]) {
            if other.abs_diff(label) <= 1 {
                let first = near * count + label - 1;
                for (total, &sum) in three.iter_mut().zip(&sums[first..first + 3]) {
                    *total += u32::from(sum);
                }
            }
        }
        lowest(three)
    }

    /// Changes the winner's costs.
    #[inline(always)]
    fn is_unique(self, sums: &mut [u16], best: usize) -> bool {
        let cost = u32::from(sums[best]);
        let last = sums.len() - 1;
        sums[best.saturating_sub(1)..=(best + 1).min(last)].fill(u16::MAX);
        let other = u32::from(smallest(sums));
        other * 100 > cost * (100 + u32::from(self.unique_percent))
    }
}

/// Winners of the pixels of the right image, from the last one backwards: label k of left pixel x is at
/// `width − 1 − x + k`, so that labels of a pixel are next to each other. The first of the cheapest.
#[inline(always)]
fn right_winners(sums: &[u16], width: usize) -> Vec<u16> {
    let count = sums.len() / width;
    let mut costs = vec![u16::MAX; width + count];
    let mut labels = vec![0; width + count];
    // In ascending columns, the labels of one position ascend, too.
    for (x, sums) in sums.chunks_exact(count).enumerate() {
        let places = width - 1 - x..width - 1 - x + count;
        let places = costs[places.clone()].iter_mut().zip(&mut labels[places]);
        for (label, (&sum, (cost, best))) in (0_u16..).zip(sums.iter().zip(places)) {
            let is_better = sum < *cost;
            *cost = if is_better { sum } else { *cost };
            *best = if is_better { label } else { *best };
        }
    }
    labels
}

#[inline(always)]
fn smallest(sums: &[u16]) -> u16 {
    sums.iter().fold(u16::MAX, |least, &sum| least.min(sum))
}

/// The first of the cheapest.
#[inline(always)]
fn cheapest(sums: &[u16]) -> usize {
    let least = smallest(sums);
    sums.iter().position(|&sum| sum == least).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(left_right: Option<i32>) -> Choice {
        Choice {
            unique_percent: 5,
            between: Between::Parabola,
            left_right,
        }
    }

    #[test]
    fn the_subpixel_position_is_the_minimum_of_a_parabola() {
        // (x − 2.25)² at 1, 2, 3, times 16.
        assert_eq!(lowest([25, 1, 9]), 0.25);
        // |x − 2.25| at 1, 2, 3, times 4: biased towards the whole label.
        assert!((lowest([5, 1, 3]) - 1.0 / 6.0).abs() < 1e-6);
        assert_eq!(lowest([7, 7, 7]), 0.0);
    }

    #[test]
    fn an_equally_good_second_label_leaves_no_winner() {
        let mut sums = vec![90; 32];
        sums[9..12].copy_from_slice(&[50, 20, 50]);
        let mut labels = [0.0];
        choice(None).winners(&mut sums.clone(), &mut labels);
        assert_eq!(labels, [10.0]);
        sums[25] = 21;
        choice(None).winners(&mut sums, &mut labels);
        assert!(labels[0].is_nan());
        choice(None).winners(&mut [0; 32], &mut labels);
        assert!(labels[0].is_nan(), "labels of one cost");
    }

    #[test]
    fn a_failed_left_right_check_leaves_no_winner() {
        // Pixels 40 and 44 both want pixel 30 of the right image; 44 is cheaper.
        let (width, count) = (64, 32);
        let mut sums = vec![500; width * count];
        sums[40 * count + 10] = 100;
        sums[44 * count + 14] = 50;
        let mut labels = vec![0.0; width];
        choice(Some(0)).winners(&mut sums, &mut labels);
        let found: Vec<usize> = (0..width).filter(|&x| !labels[x].is_nan()).collect();
        assert_eq!(found, [44]);
    }
}
