//! Disparity range of a pair, estimated on downscaled copies of it.
//!
//! Both images are halved until the longer side is at most 256 pixels. There every disparity up to three quarters of
//! the width is tried in both directions, which takes a small part of the time of the whole image. Areas of the result
//! smaller than a 400th of the image are discarded as errors. Two pixels of the small image are added to both ends for
//! details it did not show, and an eighth of the range to the near one: near things are often thin.

use crate::stereo::DisparityRange;
use crate::stereo::GrayImage;
use crate::stereo::Matching;
use crate::stereo::StereoError;

/// Longer side of the smallest copy.
// Finding the range of an image of 1.4 megapixels takes 40 ms on copies of this size.
const COARSE_PX: u32 = 256;

/// Minimum number of pixels in a thousand that have to be found.
const MIN_FOUND: usize = 20;

/// Areas of less than this part of the image are mistakes.
const MIN_AREA: usize = 400;

/// With that many disparities to choose from, chance alone finds one a few percent better.
const UNIQUE_PERCENT: u16 = 10;

/// Pixels of the copy that are added to both ends.
const MARGIN_PX: i32 = 2;

/// Part of the range that is added to the near end.
const NEAR_SHARE: f32 = 0.125;

impl Matching {
    /// The range of disparities of a rectified pair.
    ///
    /// # Errors
    /// [`StereoError::NothingAlike`] if no part of the images is alike, and the errors of [`Matching::disparities`].
    pub fn range(&self, left: &GrayImage, right: &GrayImage) -> Result<DisparityRange, StereoError> {
        let (mut left, mut right) = (left.clone(), right.clone());
        let mut scale = 1;
        while left.size_px().into_iter().max() > Some(COARSE_PX) {
            (left, right) = (left.halved(), right.halved());
            scale *= 2;
        }
        let reach = (left.width() * 3 / 4) as i32;
        let matching = Self {
            min_area_px: left.pixels().len() / MIN_AREA,
            unique_percent: self.unique_percent.max(UNIQUE_PERCENT),
            ..self.clone()
        };
        let map = matching.disparities(&left, &right, DisparityRange::new(-reach, reach)?)?;
        if map.found_count() * 1000 < (MIN_FOUND * map.pixels().len()).max(1) {
            return Err(StereoError::NothingAlike);
        }
        // NaN is neither.
        let min = map.pixels().iter().copied().fold(f32::INFINITY, f32::min);
        let max = map.pixels().iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let near = max + (max - min) * NEAR_SHARE;
        let end = |at: f32, margin: i32| (at as i32 + margin) * scale;
        DisparityRange::new(end(min.floor(), -MARGIN_PX), end(near.ceil(), MARGIN_PX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stereo::matching::costs::test_costs::Random;

    /// Knots 8 pixels apart.
    fn texture(x: f32, y: f32) -> f32 {
        let knot = |x: f32, y: f32| {
            let seed = (x as i64 as u64).wrapping_mul(7919) ^ ((y as i64 as u64) << 32);
            (Random(seed).next() % 256) as f32
        };
        let (x, y) = (x / 8.0, y / 8.0);
        let (s, t) = (x - x.floor(), y - y.floor());
        let line = |y: f32| knot(x.floor(), y) * (1.0 - s) + knot(x.floor() + 1.0, y) * s;
        line(y.floor()) * (1.0 - t) + line(y.floor() + 1.0) * t
    }

    /// Two walls side by side.
    fn pair(width: usize, height: usize, disparities: [f32; 2]) -> [GrayImage; 2] {
        let image = |shift: &dyn Fn(usize) -> f32| {
            let pixels = (0..width * height)
                .map(|at| texture((at % width) as f32 + shift(at / width), (at / width) as f32) as u8)
                .collect();
            GrayImage::new([width as u32, height as u32], pixels).unwrap()
        };
        let of_line = |y: usize| disparities[usize::from(y > height / 2)];
        [image(&|_| 0.0), image(&of_line)]
    }

    #[test]
    fn the_range_contains_the_disparities_and_little_more() {
        for disparities in [[40.0, 130.0], [-60.0, 20.0], [0.0, 0.0], [200.0, 210.0]] {
            let [left, right] = pair(900, 400, disparities);
            let range = Matching::default().range(&left, &right).unwrap();
            let (min, max) = (range.min() as f32, range.max() as f32);
            assert!(
                min <= disparities[0] && disparities[1] <= max,
                "{range:?} of {disparities:?}"
            );
            assert!(
                min >= disparities[0] - 20.0 && max <= disparities[1] + 20.0 + 32.0,
                "{range:?}"
            );
        }
    }

    #[test]
    fn images_of_nothing_have_no_range() {
        let even = GrayImage::new([300, 200], vec![7; 60_000]).unwrap();
        assert_eq!(Matching::default().range(&even, &even), Err(StereoError::NothingAlike));
        let mut random = Random(1);
        let mut noise = || GrayImage::new([300, 200], (0..60_000).map(|_| random.next() as u8).collect()).unwrap();
        assert_eq!(
            Matching::default().range(&noise(), &noise()),
            Err(StereoError::NothingAlike)
        );
    }
}
