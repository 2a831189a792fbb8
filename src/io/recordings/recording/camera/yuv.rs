//! Images of a luma and two chromas a pixel, where neighbours share their chromas.
//!
//! Cameras of webcams, phones and depth sensors send them as the converters of ROS (OpenCV) and of the Azure Kinect
//! (libyuv) take them: ITU-R BT.601, luma from 16 to 235, chromas around 128.

/// YUV layout: the content of two adjacent pixels, or the order of the planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Yuv {
    /// Four bytes for two pixels: where among them Y, U, Y, V are.
    Packed([usize; 4]),
    /// All Y, then for each 2 × 2 pixels a pair of U and V: where in the pair they are.
    Planes([usize; 2]),
}

impl Yuv {
    /// By its name in lower case.
    pub(super) fn of(encoding: &str) -> Option<Self> {
        Some(match encoding {
            "yuv422" | "uyvy" => Self::Packed([1, 0, 3, 2]),
            "yuv422_yuy2" | "yuyv" | "yuy2" => Self::Packed([0, 1, 2, 3]),
            "nv12" => Self::Planes([0, 1]),
            "nv21" => Self::Planes([1, 0]),
            _ => return None,
        })
    }

    /// Bytes of a line for each of its pixels.
    pub(super) fn pixel_bytes(self) -> u64 {
        match self {
            Self::Packed(_) => 2,
            Self::Planes(_) => 1,
        }
    }

    /// Stored lines of an image of height `height`.
    pub(super) fn lines(self, height: u32) -> u64 {
        match self {
            Self::Packed(_) => height.into(),
            Self::Planes(_) => u64::from(height) + u64::from(height.div_ceil(2)),
        }
    }

    /// The colours of an image `width` pixels wide. Precondition: `width` is even, and `bytes` are its lines.
    pub(super) fn colors(self, bytes: &[u8], [width, height]: [u32; 2]) -> Vec<[u8; 3]> {
        match self {
            Self::Packed([y0, u, y1, v]) => {
                let pairs = bytes.as_chunks::<4>().0.iter();
                let of_pair = |pair: &[u8; 4]| [y0, y1].map(|y| color(pair[y], pair[u], pair[v]));
                pairs.flat_map(of_pair).collect()
            }
            Self::Planes([u, v]) => {
                let (width, height) = (width as usize, height as usize);
                let (luma, chroma) = bytes.split_at(width * height);
                let lines = luma.chunks_exact(width).enumerate();
                let of_line = |(line, luma): (usize, &[u8])| {
                    let chroma = &chroma[line / 2 * width..][..width];
                    let pairs = luma.as_chunks::<2>().0.iter().zip(chroma.as_chunks::<2>().0);
                    let colors = pairs.flat_map(|(luma, pair)| luma.map(|y| color(y, pair[u], pair[v])));
                    colors.collect::<Vec<_>>()
                };
                lines.flat_map(of_line).collect()
            }
        }
    }
}

/// ITU-R BT.601 from its range in video to all of 8 bits.
fn color(y: u8, u: u8, v: u8) -> [u8; 3] {
    let y = 255.0 / 219.0 * (f32::from(y) - 16.0);
    let [u, v] = [u, v].map(|chroma| 255.0 / 224.0 * (f32::from(chroma) - 128.0));
    let channels = [y + 1.402 * v, y - 0.344_136 * u - 0.714_136 * v, y + 1.772 * u];
    // Casts saturate at 0 and 255.
    channels.map(|channel| channel.round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bars of a test card in BT.601, as its tables have them.
    #[test]
    fn color_bars_have_their_colors() {
        for (yuv, expected) in [
            ([16, 128, 128], [0, 0, 0]),
            ([235, 128, 128], [255, 255, 255]),
            ([81, 90, 240], [254, 0, 0]),
            ([145, 54, 34], [0, 255, 1]),
            ([41, 240, 110], [0, 0, 255]),
            ([0, 128, 128], [0, 0, 0]),
            ([255, 128, 128], [255, 255, 255]),
        ] {
            let [y, u, v] = yuv;
            let found = color(y, u, v);
            let is_near = found
                .iter()
                .zip(expected)
                .all(|(found, expected)| found.abs_diff(expected) <= 1);
            assert!(is_near, "{yuv:?}: {found:?}, {expected:?}");
        }
    }

    #[test]
    fn every_byte_order_has_the_same_pixels() {
        // Four columns and two lines: the left half is red, the right one blue, with a different luma in each pixel.
        let luma = [[81, 82, 41, 42], [83, 84, 43, 44]];
        let chroma = [[90, 240], [240, 110]];
        let expected: Vec<[u8; 3]> = luma
            .iter()
            .flat_map(|line| line.iter().enumerate())
            .map(|(at, &y)| color(y, chroma[at / 2][0], chroma[at / 2][1]))
            .collect();
        let pairs = || luma.iter().flat_map(|line| line.chunks(2).zip(&chroma));
        let uyvy: Vec<u8> = pairs().flat_map(|(y, c)| [c[0], y[0], c[1], y[1]]).collect();
        let yuyv: Vec<u8> = pairs().flat_map(|(y, c)| [y[0], c[0], y[1], c[1]]).collect();
        let nv12 = [luma.concat(), chroma.concat()].concat();
        let nv21 = [luma.concat(), vec![240, 90, 110, 240]].concat();
        for (names, bytes) in [
            (vec!["yuv422", "uyvy"], uyvy),
            (vec!["yuv422_yuy2", "yuyv", "yuy2"], yuyv),
            (vec!["nv12"], nv12),
            (vec!["nv21"], nv21),
        ] {
            for name in names {
                assert_eq!(Yuv::of(name).unwrap().colors(&bytes, [4, 2]), expected, "{name}");
            }
        }
        assert_eq!(Yuv::of("yuv444"), None);
    }
}
