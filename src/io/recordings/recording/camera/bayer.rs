//! Demosaicing of Bayer images, taken behind a mosaic of colour filters: a pixel has one colour, the others are the
//! means of its neighbours.
//!
//! *How it works.* Bilinear interpolation: a missing colour of a pixel is the mean of the pixels among the 3 × 3 around
//! it that have it. These are the four next to it or at its corners, or the two in its line or column; at the border
//! the existing ones. Points take colours from it: sharper methods pay off for images that are displayed.

/// Whose colour a pixel has, of the first two lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Mosaic {
    /// Red, green and blue are 0, 1 and 2.
    channels: [[usize; 2]; 2],
    /// 1, or 2 of samples of 16 bits.
    pub(super) sample_bytes: u64,
}

impl Mosaic {
    /// By its name, such as `bayer_rggb8`: the colours of the first line, then of the second.
    pub(super) fn of(encoding: &str) -> Option<Self> {
        let name = encoding.strip_prefix("bayer_")?;
        let (colors, bits) = name.split_at_checked(4)?;
        let sample_bytes = match bits {
            "8" => 1,
            "16" => 2,
            _ => return None,
        };
        let channels = match colors {
            "rggb" => [[0, 1], [1, 2]],
            "bggr" => [[2, 1], [1, 0]],
            "gbrg" => [[1, 2], [0, 1]],
            "grbg" => [[1, 0], [2, 1]],
            _ => return None,
        };
        Some(Self { channels, sample_bytes })
    }

    /// The colours of an image of these samples. Precondition: one sample per pixel.
    pub(super) fn colors(self, samples: &[u8], [width, height]: [u32; 2]) -> Vec<[u8; 3]> {
        let (width, height) = (width as usize, height as usize);
        let around = |at: usize, side: usize| at.saturating_sub(1)..(at + 2).min(side);
        let color = |x: usize, y: usize| {
            let own = samples[y * width + x];
            let (mut sums, mut counts) = ([0_u32; 3], [0_u32; 3]);
            for line in around(y, height) {
                for column in around(x, width) {
                    let channel = self.channels[line % 2][column % 2];
                    sums[channel] += u32::from(samples[line * width + column]);
                    counts[channel] += 1;
                }
            }
            let own_channel = self.channels[y % 2][x % 2];
            std::array::from_fn(|channel| match counts[channel] {
                // A single-line image lacks a colour.
                0 => own,
                _ if channel == own_channel => own,
                count => ((sums[channel] + count / 2) / count) as u8,
            })
        };
        (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| color(x, y))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_of_each_color_is_reconstructed() {
        // Red increases to the right, green downwards, blue in both directions: bilinear means are exact in the
        // interior.
        let [width, height] = [8_u32, 6];
        let truth = |x: u32, y: u32| [20 * x, 10 + 20 * y, 10 * (x + y)].map(|value| value as u8);
        for (name, channels) in [
            ("bayer_rggb8", [[0, 1], [1, 2]]),
            ("bayer_bggr8", [[2, 1], [1, 0]]),
            ("bayer_gbrg8", [[1, 2], [0, 1]]),
            ("bayer_grbg8", [[1, 0], [2, 1]]),
        ] {
            let samples: Vec<u8> = (0..width * height)
                .map(|at| {
                    let (x, y) = (at % width, at / width);
                    let channel: usize = channels[y as usize % 2][x as usize % 2];
                    truth(x, y)[channel]
                })
                .collect();
            let found = Mosaic::of(name).unwrap().colors(&samples, [width, height]);
            for (at, found) in found.iter().enumerate() {
                let (x, y) = (at as u32 % width, at as u32 / width);
                let is_within = (1..width - 1).contains(&x) && (1..height - 1).contains(&y);
                let max = if is_within { 0 } else { 20 };
                let is_near = found.iter().zip(truth(x, y)).all(|(a, b)| a.abs_diff(b) <= max);
                assert!(is_near, "{name} at {x}, {y}: {found:?}");
            }
        }
        assert_eq!(Mosaic::of("bayer_rgbg8"), None);
        assert_eq!(Mosaic::of("bayer_rggb12"), None);
        assert_eq!(Mosaic::of("bayer_ü8"), None);
    }

    #[test]
    fn the_smallest_images_are_gray() {
        let mosaic = Mosaic::of("bayer_rggb8").unwrap();
        assert_eq!(mosaic.colors(&[9], [1, 1]), [[9; 3]]);
        assert_eq!(mosaic.colors(&[9, 5], [2, 1]), [[9, 5, 9], [9, 5, 5]]);
    }
}
