//! Images of distances and of colours.

/// Returns true if a 16-bit number is a measurement: in every code of depth cameras 0 and 65535 are none.
pub fn is_measured(number: u16) -> bool {
    !matches!(number, 0 | u16::MAX)
}

/// Distances along the axis of a camera, line by line from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthImage {
    width: u32,
    height: u32,
    metres: Vec<f32>,
}

impl DepthImage {
    /// The image of `metres`; invalid distances (not finite, not above 0) become 0; `None` unless there is one per
    /// pixel.
    pub fn new([width, height]: [u32; 2], mut metres: Vec<f32>) -> Option<Self> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels != metres.len() as u64 {
            return None;
        }
        for depth in &mut metres {
            if !(depth.is_finite() && *depth > 0.0) {
                *depth = 0.0;
            }
        }
        Some(Self { width, height, metres })
    }

    /// Width and height.
    pub fn size_px(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Pixels in a line.
    pub fn width(&self) -> usize {
        self.width as usize
    }

    /// Lines.
    pub fn height(&self) -> usize {
        self.height as usize
    }

    /// Metres; 0 where nothing was measured.
    pub fn metres(&self) -> &[f32] {
        &self.metres
    }

    /// Number of pixels at which something was measured.
    pub fn valid_count(&self) -> usize {
        self.metres.iter().filter(|&&depth| depth > 0.0).count()
    }

    /// Returns the depth image with other distances. Precondition: there is the same number of them, and they are
    /// finite and above 0, or 0.
    pub(super) fn with_metres(&self, metres: Vec<f32>) -> Self {
        debug_assert_eq!(metres.len(), self.metres.len());
        Self { metres, ..*self }
    }

    pub(super) fn metres_mut(&mut self) -> &mut [f32] {
        &mut self.metres
    }
}

/// Colours, line by line from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColorImage {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl ColorImage {
    /// The image of these colours; `None` unless there is one per pixel.
    pub fn new([width, height]: [u32; 2], pixels: Vec<[u8; 3]>) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        (count > 0 && count == pixels.len() as u64).then_some(Self { width, height, pixels })
    }

    /// Width and height.
    pub fn size_px(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Red, green and blue.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// The colour at a place between pixels, interpolated from the four around it; beyond the border, the border's.
    pub fn bilinear(&self, [x, y]: [f32; 2]) -> [u8; 3] {
        let (columns, rows) = (self.width as usize, self.height as usize);
        let place = |at: f32, count: usize| {
            let at = at.clamp(0.0, (count - 1) as f32);
            let first = (at as usize).min(count.saturating_sub(2));
            (first, (first + 1).min(count - 1), at - first as f32)
        };
        let (left, right, to_right) = place(x, columns);
        let (top, bottom, to_bottom) = place(y, rows);
        let pixel = |column: usize, row: usize| self.pixels[row * columns + column].map(f32::from);
        let between = |a: f32, b: f32, share: f32| a + share * (b - a);
        let (a, b) = (pixel(left, top), pixel(right, top));
        let (c, d) = (pixel(left, bottom), pixel(right, bottom));
        std::array::from_fn(|channel| {
            let above = between(a[channel], b[channel], to_right);
            let below = between(c[channel], d[channel], to_right);
            (between(above, below, to_bottom) + 0.5) as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_distances_are_holes() {
        let raw = vec![1.0, 0.0, -1.0, f32::NAN, f32::INFINITY, 0.25];
        let image = DepthImage::new([3, 2], raw).unwrap();
        assert_eq!(image.metres(), [1.0, 0.0, 0.0, 0.0, 0.0, 0.25]);
        assert_eq!(image.valid_count(), 2);
        assert_eq!(DepthImage::new([3, 2], vec![1.0; 5]), None);
        assert_eq!(DepthImage::new([0, 2], Vec::new()), None);
    }

    #[test]
    fn colors_between_pixels_are_interpolated() {
        let image = ColorImage::new([2, 2], vec![[0; 3], [100, 0, 0], [0, 200, 0], [100, 200, 0]]).unwrap();
        for (at, expected) in [
            ([0.0, 0.0], [0, 0, 0]),
            ([1.0, 1.0], [100, 200, 0]),
            ([0.5, 0.5], [50, 100, 0]),
            ([0.25, 0.0], [25, 0, 0]),
            ([-3.0, 9.0], [0, 200, 0]),
        ] {
            assert_eq!(image.bilinear(at), expected, "{at:?}");
        }
        let one = ColorImage::new([1, 1], vec![[7, 8, 9]]).unwrap();
        assert_eq!(one.bilinear([0.5, -0.5]), [7, 8, 9]);
    }
}
