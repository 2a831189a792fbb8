//! An error map as an image: black where nothing differs, through purple and orange to pale yellow.
//!
//! How it works: as in the figures of the FLIP paper, colours are those of the map *magma* (Smith and van der Walt
//! 2015, CC0), whose lightness rises evenly, so that a printed or colour-blind view orders errors the same.

use super::ErrorMap;
use crate::analysis::ColorMap;
use image::{Rgba, RgbaImage};

impl ErrorMap {
    /// The map as an opaque image of the same size, from black (0) to pale yellow (1).
    ///
    /// # Panics
    /// Precondition: one error per pixel.
    pub fn to_heatmap(&self) -> RgbaImage {
        let [width, height] = self.size_px;
        let pixels = u64::from(width) * u64::from(height);
        assert_eq!(self.errors.len() as u64, pixels, "one error for each pixel");
        RgbaImage::from_fn(width, height, |x, y| {
            let [red, green, blue] = color(self.errors[y as usize * width as usize + x as usize]);
            Rgba([red, green, blue, 255])
        })
    }
}

/// The colour of an error; outside 0 to 1 the colour of the nearer end.
fn color(error: f32) -> [u8; 3] {
    let [red, green, blue, _] = ColorMap::Magma.color(error);
    [red, green, blue]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_center_match_the_table() {
        assert_eq!(color(0.0), [0x00, 0x00, 0x04]);
        assert_eq!(color(-1.0), color(0.0));
        assert_eq!(color(1.0), [0xfc, 0xfd, 0xbf]);
        assert_eq!(color(2.0), color(1.0));
        // A colour of the table that lies between the steps of the map.
        let off = color(124.0 / 255.0).into_iter().zip([0xb0, 0x35, 0x7b]);
        assert!(off.map(|(a, b): (u8, u8)| a.abs_diff(b)).max() <= Some(2));
    }

    #[test]
    fn a_larger_error_is_never_darker() {
        let luma = |error: u32| {
            let [red, green, blue] = color(error as f32 / 1000.0).map(f64::from);
            0.2126 * red + 0.7152 * green + 0.0722 * blue
        };
        // A step of a thousandth is smaller than the rounding of its channels.
        assert!((0..1000).all(|error| luma(error + 1) > luma(error) - 1.0));
        assert!((0..100).all(|error| luma(10 * error + 10) > luma(10 * error)));
    }

    #[test]
    fn pixels_are_at_the_positions_of_their_errors() {
        let map = ErrorMap {
            size_px: [2, 3],
            errors: vec![0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        };
        let picture = map.to_heatmap();
        assert_eq!(picture.dimensions(), (2, 3));
        assert_eq!(picture.get_pixel(1, 0).0, [0xfc, 0xfd, 0xbf, 255]);
        assert_eq!(picture.get_pixel(0, 1).0, [0, 0, 4, 255]);
    }
}
