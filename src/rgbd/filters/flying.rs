//! Flying pixels: points that a sensor invents between a surface and its background.
//!
//! A pixel is retained if enough of its eight neighbours are at its depth. All pixels are tested on the unfiltered
//! image: dropping one does not affect the next.

use super::padded::{LANES, Padded, by_blocks, load};
use crate::rgbd::DepthImage;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x8};

/// A depth that no pixel is near.
const NOWHERE_M: f32 = 1e9;

/// Around a pixel, line by line: columns and rows from the one to the left and above.
const AROUND: [[usize; 2]; 8] = [[0, 0], [1, 0], [2, 0], [0, 1], [2, 1], [0, 2], [1, 2], [2, 2]];

/// Pixels of a row that are around eight neighbours.
const SPAN: usize = LANES + 2;

/// Parameters of the filter; see the module's text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlyingPixels {
    /// Difference in depth that neighbours may have, in metres.
    pub max_m: f32,
    /// Distance threshold as a fraction of the depth: the larger of both applies.
    pub max_share: f32,
    /// Neighbours that have to be as near.
    pub min_neighbours: u8,
    /// Number of further pixels removed along every edge.
    pub erosion_px: u8,
}

impl FlyingPixels {
    /// Half of the neighbours, no erosion.
    pub const USUAL: Self = Self {
        max_m: 0.01,
        max_share: 0.02,
        min_neighbours: 4,
        erosion_px: 0,
    };

    /// `depth` without flying pixels.
    #[must_use]
    pub fn apply(&self, depth: &DepthImage) -> DepthImage {
        let mut retained = self.keep(depth, self.min_neighbours);
        for _ in 0..self.erosion_px {
            retained = self.keep(&retained, AROUND.len() as u8);
        }
        retained
    }

    /// The pixels of `depth` with at least this many neighbours at their depth.
    fn keep(&self, depth: &DepthImage, min: u8) -> DepthImage {
        let padded = Padded::of(depth, 1, NOWHERE_M);
        let min = f32::from(min);
        dispatch!(Level::new(), simd => {
            by_blocks(simd, depth, #[inline(always)] |at| self.retained_at(simd, &padded, min, at))
        })
    }

    #[inline(always)]
    fn retained_at<S: Simd>(&self, simd: S, padded: &Padded, min: f32, at: [usize; 2]) -> f32x8<S> {
        let splat = |value: f32| f32x8::splat(simd, value);
        let (none, one) = (splat(0.0), splat(1.0));
        let rows = [0, 1, 2].map(|down| padded.around::<SPAN>(at, down));
        let center = load(simd, rows[1], 1);
        let max = (center * self.max_share).max(splat(self.max_m));
        let mut neighbours = none;
        for [right, down] in AROUND {
            let is_near = (load(simd, rows[down], right) - center).abs().simd_le(max);
            neighbours += simd.select_f32x8(is_near, one, none);
        }
        let retained = simd.select_f32x8(neighbours.simd_ge(splat(min)), center, none);
        simd.select_f32x8(center.simd_lt(splat(0.5 * NOWHERE_M)), retained, none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::filters::test_images::noise;

    fn by_definition(depth: &DepthImage, filter: &FlyingPixels) -> Vec<f32> {
        let (width, height) = (depth.width() as isize, depth.height() as isize);
        let pixel = |x: isize, y: isize| {
            let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
            if is_inside {
                depth.metres()[(y * width + x) as usize]
            } else {
                0.0
            }
        };
        let at = |x: isize, y: isize| {
            let center = pixel(x, y);
            let max = filter.max_m.max(filter.max_share * center);
            let is_near = |[right, down]: &[usize; 2]| {
                let z = pixel(x + *right as isize - 1, y + *down as isize - 1);
                z > 0.0 && (z - center).abs() <= max
            };
            let near = AROUND.iter().filter(|offset| is_near(offset)).count();
            if near >= usize::from(filter.min_neighbours) {
                center
            } else {
                0.0
            }
        };
        (0..height).flat_map(|y| (0..width).map(move |x| at(x, y))).collect()
    }

    #[test]
    fn the_flying_pixel_filter_matches_its_definition() {
        for hole_share in [0.0, 0.2, 0.6] {
            let image = noise([45, 27], hole_share);
            let filter = FlyingPixels::USUAL;
            assert_eq!(filter.apply(&image).metres(), by_definition(&image, &filter));
        }
    }

    /// Near on the left, far on the right, and between them the column that a sensor invents.
    #[test]
    fn pixels_flying_between_two_surfaces_are_dropped() {
        let depth = |at: u32| match at % 32 {
            0..16 => 1.0,
            16 => 1.4,
            _ => 2.0,
        };
        let image = DepthImage::new([32, 20], (0..32 * 20).map(depth).collect()).unwrap();
        let row = |filter: FlyingPixels| filter.apply(&image).metres()[32 * 10..32 * 11].to_vec();
        let retained = |filter| row(filter).iter().map(|&z| z > 0.0).collect::<Vec<bool>>();
        let columns = |dropped: std::ops::Range<usize>| (0..32).map(|x| !dropped.contains(&x)).collect::<Vec<bool>>();
        assert_eq!(retained(FlyingPixels::USUAL), columns(16..17));
        let eroded = FlyingPixels {
            erosion_px: 1,
            ..FlyingPixels::USUAL
        };
        let mut expected = columns(15..18);
        // The border of the image is an edge too.
        (expected[0], expected[31]) = (false, false);
        assert_eq!(retained(eroded), expected);
    }
}
