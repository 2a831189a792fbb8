//! Sampling of image colours between and across texels (Yang et al. 2006 §3.4): trilinear along the short axis of a
//! pixel's footprint, several times along its long one.

use crate::photos::Texture;
use crate::render::constants::PHOTO_MAX_TAPS;
use glam::Vec4;

/// Position in an image, and the footprint of one pixel of the rendered frame there; all in texels of the finest level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    pub(super) place: [f32; 2],
    /// Displacement of the position for a pixel to the right, and for one downwards.
    pub(super) per_px: [[f32; 2]; 2],
}

/// Red, green and blue times alpha, and alpha, 0 to 1.
#[inline(always)]
pub(super) fn sample(texture: &Texture, footprint: &Footprint) -> [f32; 4] {
    let [first, second] = footprint.per_px;
    let (first_len, second_len) = (length(first), length(second));
    let (long, long_len, short_len) = if first_len >= second_len {
        (first, first_len, second_len)
    } else {
        (second, second_len, first_len)
    };
    let taps = (long_len / short_len.max(1.0)).ceil().clamp(1.0, PHOTO_MAX_TAPS);
    let per_tap = long_len / taps;
    // The branch saves the logarithm, a function call, wherever a step is at most a texel.
    let lod = if per_tap > 1.0 { per_tap.log2() } else { 0.0 };
    let mut sum = Vec4::ZERO;
    for tap in 0..taps as usize {
        let along = (tap as f32 + 0.5) / taps - 0.5;
        let [x, y] = footprint.place;
        let place = [x + along * long[0], y + along * long[1]];
        sum += Vec4::from_array(texture.between_texels(place, lod));
    }
    (sum / taps).to_array()
}

/// Length of a vector; not by `hypot`, which is a call.
#[inline(always)]
fn length([x, y]: [f32; 2]) -> f32 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photos::PhotoImage;

    fn footprint(place: [f32; 2], right: [f32; 2], down: [f32; 2]) -> Footprint {
        Footprint {
            place,
            per_px: [right, down],
        }
    }

    fn textured(texels: Vec<[u8; 4]>) -> Texture {
        Texture::new(PhotoImage::new([8, 8], texels).unwrap())
    }

    /// A checker of single texels seen from afar is grey; seen from the side it is so as well, and stays sharp across.
    #[test]
    fn texels_covered_by_a_pixel_are_averaged() {
        let checker = (0..64).map(|at| [255 * ((at % 8 + at / 8) % 2) as u8; 3]);
        let checker = checker.map(|[red, green, blue]| [red, green, blue, 255]);
        let checker = textured(checker.collect());
        let [far, ..] = sample(&checker, &footprint([4.0, 4.0], [4.0, 0.0], [0.0, 4.0]));
        assert!((far - 0.5).abs() < 0.01, "{far}");
        let stripes = (0..64).map(|at| [255 * (at / 8 % 2) as u8, 0, 0, 255]);
        let stripes = textured(stripes.collect());
        let [along, ..] = sample(&stripes, &footprint([4.0, 3.5], [4.0, 0.0], [0.0, 1.0]));
        assert!((along - 1.0).abs() < 0.01, "{along}");
        let [across, ..] = sample(&stripes, &footprint([3.5, 4.0], [1.0, 0.0], [0.0, 4.0]));
        assert!((across - 0.5).abs() < 0.01, "{across}");
    }
}
