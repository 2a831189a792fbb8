//! Pixel coverage of an object in an image, and the closer view within it that covers more.
//!
//! How it works: the same image is drawn on two backgrounds, and a pixel is free only where it shows both of them, so
//! that no colour of the object can pass for background. Covered pixels are stored as a summed-area table (Crow 1984):
//! the covered fraction of any rectangle is four look-ups. [`Cover::closer_view`] tries rectangles of the image's
//! aspect ratio, largest first, until one has the requested coverage: the view of a camera that aims at its centre and
//! comes closer by its scale.

use image::RgbaImage;

/// Steps in which rectangles are moved across the image, and in which they shrink: fine enough for aiming.
const STEPS: usize = 48;

/// Covered pixels of one image.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cover {
    size_px: [usize; 2],
    /// `(width + 1) × (height + 1)`: covered pixels above and to the left of each corner.
    sums: Vec<u32>,
}

/// A part of an image with its aspect ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CloserView {
    /// Offset from the centre of the image to the centre of the part, pixels to the right and down.
    pub(super) offset_px: [f64; 2],
    /// Its size as a fraction of the image's, up to 1.
    pub(super) scale: f64,
}

impl Cover {
    /// Compares the same image on two backgrounds.
    pub(super) fn of(on_first: &RgbaImage, on_second: &RgbaImage, backgrounds: [[u8; 3]; 2]) -> Self {
        let [width, height] = [on_first.width(), on_first.height()];
        Self::from_fn([width as usize, height as usize], |x, y| {
            let [first, second] = [on_first, on_second].map(|image| image.get_pixel(x as u32, y as u32).0);
            first[..3] != backgrounds[0] || second[..3] != backgrounds[1]
        })
    }

    pub(super) fn from_fn(size_px: [usize; 2], is_covered: impl Fn(usize, usize) -> bool) -> Self {
        let [width, height] = size_px;
        let stride = width + 1;
        let mut sums = vec![0; stride * (height + 1)];
        for y in 0..height {
            let mut in_row = 0;
            for x in 0..width {
                in_row += u32::from(is_covered(x, y));
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + in_row;
            }
        }
        Self { size_px, sums }
    }

    /// Covered part of the image, 0 to 1.
    pub(super) fn share(&self) -> f64 {
        self.share_within([0, 0], self.size_px)
    }

    /// Covered part of the rectangle from `min` to `max` (not included).
    fn share_within(&self, min: [usize; 2], max: [usize; 2]) -> f64 {
        let sum = |x: usize, y: usize| self.sums[y * (self.size_px[0] + 1) + x];
        let covered = sum(max[0], max[1]) + sum(min[0], min[1]) - sum(min[0], max[1]) - sum(max[0], min[1]);
        let pixels = (max[0] - min[0]) * (max[1] - min[1]);
        f64::from(covered) / pixels.max(1) as f64
    }

    /// Returns the largest part of the image whose coverage reaches `wanted_share`, or, if there is none down to
    /// `min_scale`, the most covered one of that scale. Ties go to the one nearest to the centre.
    pub(super) fn closer_view(&self, wanted_share: f64, min_scale: f64) -> CloserView {
        let mut scale = 1.0;
        loop {
            let (share, view) = self.max_covered(scale);
            if share >= wanted_share || scale <= min_scale {
                return view;
            }
            scale = (scale - 1.0 / STEPS as f64).max(min_scale);
        }
    }

    /// The most covered part of a scale, with its share.
    fn max_covered(&self, scale: f64) -> (f64, CloserView) {
        let whole = self.size_px;
        let part = whole.map(|edge| ((edge as f64 * scale).round() as usize).clamp(1, edge.max(1)));
        let positions = |axis: usize| {
            let free = whole[axis].saturating_sub(part[axis]);
            (0..=STEPS).map(move |step| free * step / STEPS)
        };
        let mut best: Option<(f64, f64, CloserView)> = None;
        for y in positions(1) {
            for x in positions(0) {
                let max = [x + part[0], y + part[1]];
                if max[0] > whole[0] || max[1] > whole[1] {
                    continue;
                }
                let share = self.share_within([x, y], max);
                let offset_px = [0, 1].map(|axis| {
                    let center = [x, y][axis] as f64 + 0.5 * part[axis] as f64;
                    center - 0.5 * whole[axis] as f64
                });
                let off_center = offset_px[0].hypot(offset_px[1]);
                let is_better = best.is_none_or(|(best_share, best_off, _)| {
                    share > best_share || (share == best_share && off_center < best_off)
                });
                if is_better {
                    best = Some((share, off_center, CloserView { offset_px, scale }));
                }
            }
        }
        match best {
            Some((share, _, view)) => (share, view),
            // An empty image.
            None => (
                0.0,
                CloserView {
                    offset_px: [0.0; 2],
                    scale,
                },
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;
    use proptest::prelude::*;

    #[test]
    fn an_object_in_the_color_of_one_background_is_counted() {
        let [black, white] = [[0u8; 3], [255u8; 3]];
        let on_black = RgbaImage::from_pixel(4, 2, Rgba([0, 0, 0, 255]));
        let mut on_white = RgbaImage::from_pixel(4, 2, Rgba([255; 4]));
        let share = |on_white: &RgbaImage| Cover::of(&on_black, on_white, [black, white]).share();
        assert_eq!(share(&on_white), 0.0);
        // A black object of three pixels.
        for x in 0..3 {
            on_white.put_pixel(x, 1, Rgba([0, 0, 0, 255]));
        }
        assert_eq!(share(&on_white), 0.375);
    }

    proptest! {
        #[test]
        fn shares_of_rectangles_match_counting_pixels(
            pixels in prop::collection::vec(any::<bool>(), 7 * 5),
            x in (0usize..7, 1usize..8), y in (0usize..5, 1usize..6),
        ) {
            let covers = |x: usize, y: usize| pixels[y * 7 + x];
            let (min, max) = ([x.0, y.0], [(x.0 + x.1).min(7), (y.0 + y.1).min(5)]);
            let counted = (min[1]..max[1])
                .flat_map(|y| (min[0]..max[0]).map(move |x| (x, y)))
                .filter(|&(x, y)| covers(x, y))
                .count();
            let share = Cover::from_fn([7, 5], covers).share_within(min, max);
            prop_assert_eq!(share, counted as f64 / ((max[0] - min[0]) * (max[1] - min[1])) as f64);
        }
    }

    #[test]
    fn the_closer_view_is_the_largest_with_the_wanted_coverage() {
        // A block of 24×16 at the lower right of 96×64: a quarter of each edge.
        let cover = Cover::from_fn([96, 64], |x, y| (72..96).contains(&x) && y >= 48);
        let view = cover.closer_view(0.5, 0.1);
        // Half covered: its area is twice the block's.
        assert!(
            (view.scale - 0.25 * 2f64.sqrt()).abs() <= 1.0 / STEPS as f64,
            "{view:?}"
        );
        // Entirely within the image: in its corner.
        let expected = [48.0, 32.0].map(|half| half * (1.0 - view.scale));
        for (offset, expected) in view.offset_px.iter().zip(expected) {
            assert!((offset - expected).abs() <= 1.0, "{view:?}");
        }
        assert_eq!(cover.closer_view(0.01, 0.1).scale, 1.0);
        // Never closer than the limit, but then where the coverage is largest.
        let far = cover.closer_view(0.9, 0.5);
        assert_eq!((far.scale, far.offset_px), (0.5, [24.0, 16.0]));
    }

    #[test]
    fn an_empty_image_keeps_the_aim() {
        let view = Cover::from_fn([96, 64], |_, _| false).closer_view(0.5, 0.5);
        assert_eq!(view.offset_px, [0.0; 2]);
        let none = Cover::from_fn([0, 0], |_, _| false);
        assert_eq!(none.share(), 0.0);
        assert_eq!(none.closer_view(0.5, 0.5).scale, 0.5);
    }
}
