//! Maps of disparities.

use glam::DVec2;

/// Disparities of the pixels of the left image, line by line from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct DisparityMap {
    width: usize,
    height: usize,
    pixels: Vec<f32>,
}

impl DisparityMap {
    /// Precondition: one per pixel of the image.
    pub(in crate::stereo) fn new([width, height]: [usize; 2], pixels: Vec<f32>) -> Self {
        debug_assert_eq!(width * height, pixels.len());
        Self { width, height, pixels }
    }

    /// Pixels in a line.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Lines.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Column in the left image less column in the right one, in pixels; NaN where none was found.
    pub fn pixels(&self) -> &[f32] {
        &self.pixels
    }

    pub(in crate::stereo) fn pixels_mut(&mut self) -> &mut [f32] {
        &mut self.pixels
    }

    /// The disparity at a place between pixels: interpolated from the four around if they are of one surface (within a
    /// pixel), else the nearest one's; `None` if that has none.
    pub(in crate::stereo) fn between(&self, at: DVec2) -> Option<f64> {
        let [width, height] = [self.width as f64 - 1.0, self.height as f64 - 1.0];
        let nearest = at.round();
        if !(nearest.x >= 0.0 && nearest.y >= 0.0 && nearest.x <= width && nearest.y <= height) {
            return None;
        }
        let pixel = |x: f64, y: f64| f64::from(self.pixels[y as usize * self.width + x as usize]);
        let first = at.floor().max(DVec2::ZERO);
        let last = (first + 1.0).min(DVec2::new(width, height));
        let four = [
            pixel(first.x, first.y),
            pixel(last.x, first.y),
            pixel(first.x, last.y),
            pixel(last.x, last.y),
        ];
        let min = four.into_iter().fold(f64::INFINITY, f64::min);
        let max = four.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if four.iter().any(|disparity| disparity.is_nan()) || max - min > 1.0 {
            let disparity = pixel(nearest.x, nearest.y);
            return (!disparity.is_nan()).then_some(disparity);
        }
        let share = (at - first).clamp(DVec2::ZERO, DVec2::ONE);
        let above = four[0] + share.x * (four[1] - four[0]);
        let below = four[2] + share.x * (four[3] - four[2]);
        Some(above + share.y * (below - above))
    }

    /// Number of pixels that have one.
    pub fn found_count(&self) -> usize {
        self.pixels.iter().filter(|disparity| !disparity.is_nan()).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disparities_are_interpolated_on_one_surface_and_nearest_across_a_step() {
        let map = DisparityMap::new([3, 2], vec![4.0, 5.0, 9.0, 4.0, 5.0, f32::NAN]);
        for (at, expected) in [
            ([0.25, 0.5], Some(4.25)),
            ([0.0, 0.0], Some(4.0)),
            ([-0.4, 1.4], Some(4.0)),
            ([1.4, 0.0], Some(5.0)),
            ([1.6, 0.2], Some(9.0)),
            ([1.9, 0.9], None),
            ([2.6, 0.0], None),
            ([0.0, -0.6], None),
            ([f64::NAN, 0.0], None),
        ] {
            assert_eq!(map.between(at.into()), expected, "{at:?}");
        }
        assert_eq!(map.found_count(), 5);
    }
}
