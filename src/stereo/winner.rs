//! The label of each pixel from its costs: the cheapest, between labels, unless another is as good.
//!
//! - *Left and right*: the costs of a pixel of the right image are those of its partners in the left one, so both
//!   winners come from one volume of costs (Hirschmüller 2008, section 2.4). A pixel keeps its disparity if that of its
//!   partner is at most 1 px away.
//! - *Unique*: any label but the winner and its neighbours has to cost some percent more. So nothing is said where
//!   nothing is seen: in an even wall all labels cost the same.
//! - *Between labels*: the lowest place of a curve through the winner and its neighbours, see [`Between`].

use fearless_simd::{Level, dispatch};

/// How the place between labels is found from three costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Between {
    /// The lowest place of a parabola.
    #[default]
    Parabola,
    /// Where two lines of the same slope meet, the steeper of both sides.
    Lines,
}

impl Between {
    /// The place from −½ to ½. Precondition: `at` is at most `below` and `above`.
    fn place(self, below: u16, at: u16, above: u16) -> f32 {
        let (below, above) = (f32::from(below - at), f32::from(above - at));
        let curve = match self {
            Self::Parabola => below + above,
            Self::Lines => 2.0 * below.max(above) / 2.0_f32.max(1.0),
        };
        if curve > 0.0 { (below - above) / (2.0 * curve) } else { 0.0 }
    }
}

/// How winners are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Choice {
    /// By how much all other labels have to cost more, in percent of the winner.
    pub(super) unique_percent: u16,
    pub(super) between: Between,
    /// Smallest disparity, where labels are disparities and left and right are to agree.
    pub(super) left_right: Option<i32>,
}

/// Memory for a line.
#[derive(Debug, Default)]
struct Right {
    /// From the last pixel of the right image backwards, as far as disparities reach beyond it.
    costs: Vec<u16>,
    labels: Vec<u16>,
}

impl Choice {
    /// Writes the labels of a line, NaN where there is none. `sums` are all its costs, which are changed.
    pub(super) fn winners(self, sums: &mut [u16], labels: &mut [f32]) {
        dispatch!(Level::new(), _simd => self.write(sums, labels));
    }

    #[inline(always)]
    fn write(self, sums: &mut [u16], labels: &mut [f32]) {
        let width = labels.len();
        let count = sums.len() / width;
        let mut right = Right::default();
        if self.left_right.is_some() {
            right.costs.resize(width + count, u16::MAX);
            right.labels.resize(width + count, 0);
            for (x, sums) in sums.chunks_exact(count).enumerate() {
                let first = width - 1 - x;
                let places = first..first + count;
                add_right(sums, &mut right.costs[places.clone()], &mut right.labels[places]);
            }
        }
        for (x, (label, sums)) in labels.iter_mut().zip(sums.chunks_exact_mut(count)).enumerate() {
            let at = cheapest(sums);
            *label = f32::NAN;
            if let Some(min) = self.left_right {
                let partner = x as i64 - i64::from(min) - at as i64;
                let is_inside = (0..width as i64).contains(&partner);
                if !is_inside || right.labels[width - 1 - x + at].abs_diff(at as u16) > 1 {
                    continue;
                }
            }
            let between = if at > 0 && at + 1 < count {
                self.between.place(sums[at - 1], sums[at], sums[at + 1])
            } else {
                0.0
            };
            if self.is_unique(sums, at) {
                *label = at as f32 + between;
            }
        }
    }

    /// Changes the winner's costs.
    #[inline(always)]
    fn is_unique(self, sums: &mut [u16], at: usize) -> bool {
        let cost = u32::from(sums[at]);
        let last = sums.len() - 1;
        sums[at.saturating_sub(1)..=(at + 1).min(last)].fill(u16::MAX);
        let other = u32::from(smallest(sums));
        other * 100 > cost * u32::from(100 + self.unique_percent)
    }
}

#[inline(always)]
fn add_right(sums: &[u16], costs: &mut [u16], labels: &mut [u16]) {
    for (label, ((&sum, cost), best)) in (0_u16..).zip(sums.iter().zip(costs).zip(labels)) {
        let is_better = sum < *cost;
        *cost = if is_better { sum } else { *cost };
        *best = if is_better { label } else { *best };
    }
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
