//! Maps of disparities.

/// Disparities of the pixels of the left image, line by line from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct DisparityMap {
    width: usize,
    height: usize,
    pixels: Vec<f32>,
}

impl DisparityMap {
    /// Precondition: as many as the image has pixels.
    pub(super) fn new([width, height]: [usize; 2], pixels: Vec<f32>) -> Self {
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

    /// Number of pixels that have one.
    pub fn found_count(&self) -> usize {
        self.pixels.iter().filter(|disparity| !disparity.is_nan()).count()
    }
}
