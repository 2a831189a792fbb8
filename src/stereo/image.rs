//! Grey images: the input of matching.

use crate::rgbd::ColorImage;

/// Brightnesses, line by line from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GrayImage {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl GrayImage {
    /// The image of these brightnesses; `None` unless there is one per pixel, and at least one.
    pub fn new([width, height]: [u32; 2], pixels: Vec<u8>) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        (count > 0 && count == pixels.len() as u64).then_some(Self {
            width: width as usize,
            height: height as usize,
            pixels,
        })
    }

    /// The brightness of each colour by the weights of ITU-R BT.601.
    pub fn of_colors(colors: &ColorImage) -> Self {
        let [width, height] = colors.size_px();
        let weigh = |&[red, green, blue]: &[u8; 3]| {
            let sum = 77 * u32::from(red) + 150 * u32::from(green) + 29 * u32::from(blue);
            ((sum + 128) >> 8) as u8
        };
        Self {
            width: width as usize,
            height: height as usize,
            pixels: colors.pixels().iter().map(weigh).collect(),
        }
    }

    /// Width and height.
    pub fn size_px(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// Pixels in a line.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Lines.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All brightnesses.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Line `y`. Precondition: there is one.
    pub fn row(&self, y: usize) -> &[u8] {
        &self.pixels[y * self.width..(y + 1) * self.width]
    }

    /// An image without light. Precondition: a size above 0.
    pub(in crate::stereo) fn black([width, height]: [usize; 2]) -> Self {
        Self {
            width,
            height,
            pixels: vec![0; width * height],
        }
    }

    pub(in crate::stereo) fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// The brightness between pixels, mixed from the four around. Beyond the border it is the border's.
    #[inline]
    pub(in crate::stereo) fn bilinear(&self, x: f32, y: f32) -> u8 {
        let place = |at: f32, count: usize| {
            let at = at.clamp(0.0, (count - 1) as f32);
            let first = at as usize;
            (first, (first + 1).min(count - 1), at - first as f32)
        };
        let (left, right, to_right) = place(x, self.width);
        let (top, bottom, to_bottom) = place(y, self.height);
        let (above, below) = (self.row(top), self.row(bottom));
        let along = |row: &[u8]| {
            let (a, b) = (f32::from(row[left]), f32::from(row[right]));
            a + to_right * (b - a)
        };
        let (above, below) = (along(above), along(below));
        (above + to_bottom * (below - above) + 0.5) as u8
    }

    /// Half the size (rounded up): the mean of each four pixels, of those that there are at odd borders.
    pub(in crate::stereo) fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            let above = self.row(2 * y);
            let below = self.row((2 * y + 1).min(self.height - 1));
            pixels.extend((0..width).map(|x| {
                let (left, right) = (2 * x, (2 * x + 1).min(self.width - 1));
                let sum = [above[left], above[right], below[left], below[right]];
                (sum.into_iter().map(u16::from).sum::<u16>().midpoint(2) / 2) as u8
            }));
        }
        Self { width, height, pixels }
    }
}
