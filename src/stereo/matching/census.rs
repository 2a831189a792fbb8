//! Census transform of 9×7 pixels, and Hamming distances: matching costs that are invariant to brightness and contrast.
//!
//! Each pixel is described by 62 bits: each is set if the respective neighbour is darker than the pixel itself (Zabih
//! and Woodfill 1994, section 3.2). The cost of a match is the number of bits that differ. Any change of brightness
//! that keeps its order keeps the bits, so images of different exposure match. Beyond the border, border pixels are
//! repeated.
//!
//! The right line is stored reversed, so that the disparities of one pixel are contiguous in memory.

use super::constants::{CENSUS_HALF_HEIGHT as HALF_HEIGHT, CENSUS_HALF_WIDTH as HALF_WIDTH};
use super::costs::Costs;
use super::range::DisparityRange;
use super::refine::{Around, NEIGHBOR, NO_COST};
use crate::stereo::GrayImage;
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use std::ops::Range;

/// The bits of each pixel, line by line.
pub(in crate::stereo) fn census(image: &GrayImage) -> Vec<u64> {
    let width = image.width();
    let mut bits = vec![0; width * image.height()];
    let lines = bits.par_chunks_exact_mut(width).enumerate();
    lines.for_each(|(y, row)| census_of_row(image, y, row));
    bits
}

/// The bits of the pixels of line `y`. Precondition: `bits` are zeros, one per pixel.
pub(super) fn census_of_row(image: &GrayImage, y: usize, bits: &mut [u64]) {
    let mut padded = vec![0; image.width() + 2 * HALF_WIDTH];
    for dy in 0..=2 * HALF_HEIGHT {
        pad(
            image.row((y + dy).saturating_sub(HALF_HEIGHT).min(image.height() - 1)),
            &mut padded,
        );
        dispatch!(Level::new(), _simd => add_row(image.row(y), &padded, dy == HALF_HEIGHT, bits));
    }
}

fn pad(row: &[u8], padded: &mut [u8]) {
    let width = row.len();
    padded[..HALF_WIDTH].fill(row[0]);
    padded[HALF_WIDTH..HALF_WIDTH + width].copy_from_slice(row);
    padded[HALF_WIDTH + width..].fill(row[width - 1]);
}

/// Appends the bits of nine neighbours, or of eight in the pixel's own line.
#[inline(always)]
fn add_row(midpoint: &[u8], padded: &[u8], is_own: bool, bits: &mut [u64]) {
    for dx in 0..=2 * HALF_WIDTH {
        if is_own && dx == HALF_WIDTH {
            continue;
        }
        let neighbours = &padded[dx..dx + midpoint.len()];
        for ((bits, &center), &neighbour) in bits.iter_mut().zip(midpoint).zip(neighbours) {
            *bits = (*bits << 1) | u64::from(neighbour < center);
        }
    }
}

/// Costs of matching a pixel of the left image with pixels of the same line of the right one.
#[derive(Debug)]
pub(super) struct CensusPair {
    size: [usize; 2],
    range: DisparityRange,
    left: Vec<u64>,
    /// Each line from its end.
    right: Vec<u64>,
}

impl CensusPair {
    /// Precondition: images of one size.
    pub(in crate::stereo) fn new(left: &GrayImage, right: &GrayImage, range: DisparityRange) -> Self {
        let size = [left.width(), left.height()];
        let mut right = census(right);
        for row in right.chunks_exact_mut(size[0]) {
            row.reverse();
        }
        Self {
            size,
            range,
            left: census(left),
            right,
        }
    }

    /// The costs that [`super::refine`] requests. Precondition: pixel `at` of the image has a label `label`.
    pub(in crate::stereo) fn around(&self, at: usize, label: usize) -> Around {
        let width = self.size[0];
        let (line, x) = (at - at % width, at % width);
        // Label k is at `first + k` of the line, which is stored in reverse.
        let first = (width - 1 - x) as i64 + i64::from(self.range.min());
        let others = &self.right[line..line + width];
        let mut costs = [NO_COST; 2 * NEIGHBOR + 1];
        for (place, cost) in (first + label as i64 - NEIGHBOR as i64..).zip(&mut costs) {
            if let Some(other) = usize::try_from(place).ok().and_then(|place| others.get(place)) {
                *cost = (self.left[at] ^ other).count_ones() as u8;
            }
        }
        costs
    }

    #[inline(always)]
    fn fill_row(&self, y: usize, costs: &mut [u8]) {
        let width = self.size[0];
        let count = self.range.count();
        let line = y * width..(y + 1) * width;
        let (left, right) = (&self.left[line.clone()], &self.right[line]);
        for (x, (costs, &bits)) in costs.chunks_exact_mut(count).zip(left).enumerate() {
            // Disparity `min + k` is at `first + k` of the line, which is stored in reverse.
            let first = (width - 1 - x) as i64 + i64::from(self.range.min());
            let from = (-first).clamp(0, count as i64) as usize;
            let to = (width as i64 - first).clamp(from as i64, count as i64) as usize;
            // Outside the other image its border is repeated: in uniform areas, no label costs more than others. A
            // constant made labels inside the image cheaper: uniform images got depths.
            costs[..from].fill((bits ^ right[0]).count_ones() as u8);
            costs[to..].fill((bits ^ right[width - 1]).count_ones() as u8);
            if from < to {
                let begin = (first + from as i64) as usize;
                let others = &right[begin..begin + to - from];
                for (cost, &other) in costs[from..to].iter_mut().zip(others) {
                    *cost = (bits ^ other).count_ones() as u8;
                }
            }
        }
    }
}

impl Costs for CensusPair {
    fn size(&self) -> [usize; 2] {
        self.size
    }

    fn count(&self) -> usize {
        self.range.count()
    }

    fn fill(&self, rows: Range<usize>, costs: &mut [u8]) {
        costs
            .par_chunks_mut(self.size[0] * self.range.count())
            .zip(rows)
            .for_each(|(costs, y)| dispatch!(Level::new(), _simd => self.fill_row(y, costs)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stereo::matching::costs::test_costs::Random;

    fn random(size: [u32; 2], seed: u64) -> GrayImage {
        let mut random = Random(seed);
        let pixels = (0..size[0] * size[1]).map(|_| (random.next() % 8) as u8).collect();
        GrayImage::new(size, pixels).unwrap()
    }

    #[test]
    fn costs_count_differing_neighbour_comparisons() {
        let [width, height] = [23, 11];
        let (left, right) = (random([23, 11], 1), random([23, 11], 2));
        let range = DisparityRange::new(-7, 24).unwrap();
        let pair = CensusPair::new(&left, &right, range);
        let mut costs = vec![0; (width * height * 32) as usize];
        pair.fill(0..height as usize, &mut costs);
        let at = |image: &GrayImage, x: i64, y: i64| {
            image.row(y.clamp(0, height - 1) as usize)[x.clamp(0, width - 1) as usize]
        };
        for (index, &cost) in costs.iter().enumerate() {
            let (place, label) = (index as i64 / 32, index as i64 % 32);
            let (x, y) = (place % width, place / width);
            let partner = (x - label + 7).clamp(0, width - 1);
            let mut expected = 0;
            for (dy, dx) in (-3..=3).flat_map(|dy| (-4..=4).map(move |dx| (dy, dx))) {
                let is_darker = |image, x| at(image, x + dx, y + dy) < at(image, x, y);
                expected += u8::from(is_darker(&left, x) != is_darker(&right, partner));
            }
            assert_eq!(cost, expected, "{x}, {y}, label {label}");
        }
    }

    #[test]
    fn subpixel_queries_match_the_matched_costs() {
        let (left, right) = (random([40, 9], 3), random([40, 9], 4));
        let range = DisparityRange::new(-3, 28).unwrap();
        let pair = CensusPair::new(&left, &right, range);
        let mut costs = vec![0; 40 * 9 * 32];
        pair.fill(0..9, &mut costs);
        for at in 0..40 * 9 {
            for label in 2..30 {
                for (neighbor, cost) in pair.around(at, label).into_iter().enumerate() {
                    let other = label + neighbor - NEIGHBOR;
                    let partner = (at % 40) as i64 + 3 - other as i64;
                    let expected = if (0..40).contains(&partner) {
                        costs[at * 32 + other]
                    } else {
                        NO_COST
                    };
                    assert_eq!(cost, expected, "pixel {at}, label {other}");
                }
            }
        }
    }
}
