//! What takes the pictures of a video, whatever its format.

use super::error::ExportError;
use image::RgbaImage;

/// Takes the pictures of a video one after the other. What is dropped before it is finished leaves nothing.
pub trait FrameSink: Send {
    /// Appends a picture of the size that the sink was opened for.
    fn push(&mut self, picture: &RgbaImage) -> Result<(), ExportError>;

    /// All pictures are there: the video gets its name, in place of a file that has it.
    fn finish(self: Box<Self>) -> Result<(), ExportError>;
}

/// The pictures of a video.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VideoStream {
    /// Width and height of all of them.
    pub size_px: [u32; 2],
    /// How many are shown a second.
    pub per_second: f64,
    /// How many there will be.
    pub count: usize,
    /// Whether their alpha counts; else they are opaque.
    pub is_transparent: bool,
}

impl VideoStream {
    /// How long picture `index` is shown, in ticks of `1 / ticks_per_second`: whole numbers whose sums are never off by
    /// more than half a tick.
    pub(super) fn ticks(&self, index: usize, ticks_per_second: f64) -> u64 {
        let start = |index: usize| (index as f64 * ticks_per_second / self.per_second).round();
        (start(index + 1) - start(index)) as u64
    }
}
