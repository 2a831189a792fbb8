//! Frame sink that receives the frames of a video, whatever its format.

use super::error::ExportError;
use image::RgbaImage;

/// Takes the images of a video one after the other. A sink dropped before it is finished leaves nothing.
pub trait FrameSink: Send {
    /// Appends an image of the size that the sink was opened for.
    fn push(&mut self, picture: &RgbaImage) -> Result<(), ExportError>;

    /// Finishes the video after all frames were added: it gets its name, replacing any file of that name.
    fn finish(self: Box<Self>) -> Result<(), ExportError>;
}

/// The images of a video.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VideoStream {
    /// Width and height of all of them.
    pub size_px: [u32; 2],
    /// Frame rate in frames per second.
    pub per_second: f64,
    /// Total number of frames.
    pub count: usize,
    /// True if the alpha channel counts; otherwise the frames are opaque.
    pub is_transparent: bool,
}

impl VideoStream {
    /// Returns the display duration of frame `index`, in ticks of `1 / ticks_per_second`: whole numbers whose sums are
    /// never off by more than half a tick.
    pub(super) fn ticks(&self, index: usize, ticks_per_second: f64) -> u64 {
        let start = |index: usize| (index as f64 * ticks_per_second / self.per_second).round();
        (start(index + 1) - start(index)) as u64
    }
}
