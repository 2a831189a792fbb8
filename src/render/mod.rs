//! From a [`ScenePacket`] to pixels. Consumers (window, headless, benchmarks) see only the [`Renderer`] trait.

mod any;
mod constants;
pub mod cpu;
mod effects;
mod gathered;
#[cfg_attr(not(feature = "gpu"), path = "no_gpu.rs")]
pub mod gpu;
mod known_depths;
mod matcher;
mod pass_times;
pub mod truth;

pub use any::AnyRenderer;
pub use known_depths::depths_of_photos;
pub use matcher::matcher_of_machine;
pub use pass_times::{PassTime, PassTimes};

use crate::scene::{ScenePacket, ScreenStats};

/// Draws packets. Preparing and drawing are apart so that each can be measured.
pub trait Renderer {
    /// Uploads the data that the packet needs and that is not resident yet.
    fn prepare(&mut self, packet: &ScenePacket) -> Result<(), RenderError>;

    /// Draws the prepared packet. Nothing is done when it equals the one drawn last.
    fn render(&mut self) -> Result<(), RenderError>;

    /// Waits for the image and reads it back: display-referred 8-bit RGBA, opaque.
    fn read_image(&mut self) -> Result<image::RgbaImage, RenderError>;

    /// Returns the statistics of the work done so far.
    fn stats(&self) -> RenderStats;
}

/// Counters and times of a renderer. Tests read them to prove that work was skipped.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct RenderStats {
    /// Images drawn since creation.
    pub frames: u64,
    /// Passes (render and compute) since creation.
    pub passes: u64,
    /// Uploads of record streams since creation.
    pub uploads: u64,
    /// Bytes of those uploads.
    pub uploaded_bytes: u64,
    /// Bytes of record streams that are on the GPU now.
    pub resident_bytes: u64,
    /// Draw calls of the last image.
    pub draw_calls: u32,
    /// Records handed to draw calls of the last image, each pass counted; by the software renderer to tiles, each tile
    /// counted.
    pub drawn_instances: u64,
    /// Records of the last image, each counted once.
    pub records: u64,
    /// CPU time of the last [`Renderer::prepare`].
    pub prepare_ms: f64,
    /// CPU time of the last [`Renderer::render`]: encoding and, unless the window does it, submission.
    pub encode_ms: f64,
    /// GPU time of the last image that was measured; `None` where timestamps are not supported.
    pub gpu_ms: Option<f64>,
    /// GPU time of each pass of that image.
    pub gpu_passes: PassTimes,
    /// GPU times of the passes over depth-camera images, if a GPU has filtered some and made points of them: times of
    /// the frame before the one uploaded last, unless the caller has waited.
    #[serde(skip_serializing_if = "PassTimes::are_none")]
    pub image_passes: PassTimes,
    /// Visible points, if the last image has screen-space normals and a GPU computes them: the number of an image some
    /// frames before it, as it is read back without waiting.
    #[serde(skip)]
    pub screen: Option<ScreenStats>,
    /// Software renderer's share of that time for the steps over the whole image: eye-dome lighting and the grid.
    pub screen_ms: f64,
}

/// An image in the size in which it is shown, where a smaller one was drawn (see
/// [`Style::resolution`](crate::scene::Style::resolution)): interpolated linearly, as the window does.
pub(crate) fn scaled_to(image: image::RgbaImage, size_px: [u32; 2]) -> image::RgbaImage {
    let [width, height] = size_px.map(|edge| edge.max(1));
    if image.dimensions() == (width, height) {
        return image;
    }
    image::imageops::resize(&image, width, height, image::imageops::FilterType::Triangle)
}

/// Reasons why there is no image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The GPU renderer is not in this build.
    #[error("this build has no GPU renderer: build with `--features gpu`, or draw on the CPU (`--renderer cpu`)")]
    NotBuilt,
    /// No adapter at all.
    #[error(
        "no Vulkan, Metal or DirectX 12 adapter was found ({reason}); \
         without a GPU install the software one: `apt-get install mesa-vulkan-drivers libvulkan1`"
    )]
    NoAdapter {
        /// Error message of the graphics library.
        reason: String,
    },
    /// The adapter refused to open.
    #[error("the adapter {adapter} could not be opened: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// Error message of the adapter.
        reason: String,
    },
    /// The driver reset or the adapter was unplugged.
    #[error("the graphics device was lost: {reason}")]
    DeviceLost {
        /// Error message of the driver.
        reason: String,
    },
    /// The GPU is out of memory.
    #[error("the GPU is out of memory for {what}; a smaller picture, another primitive or fewer points may fit")]
    OutOfMemory {
        /// Object that was to be allocated.
        what: &'static str,
    },
    /// An image larger than the adapter can make.
    #[error("a picture of {width}x{height} pixels is larger than the {max} of this adapter")]
    TooLarge {
        /// Requested width.
        width: u32,
        /// Requested height.
        height: u32,
        /// Largest edge.
        max: u32,
    },
    /// The window system does not show the painted image.
    #[error("the window cannot be painted: {reason}")]
    Window {
        /// Error message of the window system.
        reason: String,
    },
    /// The order of calls was wrong.
    #[error("nothing was prepared to be drawn")]
    NothingPrepared,
    /// The GPU did not answer.
    #[error("the GPU did not finish: {reason}")]
    Poll {
        /// Error message of the graphics library.
        reason: String,
    },
}
