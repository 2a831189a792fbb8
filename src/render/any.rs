//! One renderer or the other, as a person chose.

use super::cpu::CpuRenderer;
use super::gpu::{Context, ContextOptions, GpuRenderer, may_have_gpu};
use super::{PassTimes, RenderError, RenderStats, Renderer};
use crate::rgbd::DepthFrame;
use crate::scene::{Choice, RendererChoice, ScenePacket};
use image::RgbaImage;
use std::sync::Arc;

/// A renderer that needs no window.
#[derive(Debug)]
pub enum AnyRenderer {
    /// Draws on an adapter of the graphics library.
    Gpu(Box<GpuRenderer>),
    /// Draws on the CPU.
    Cpu(Box<CpuRenderer>),
}

impl AnyRenderer {
    /// Opens the chosen renderer. Where it may choose, it takes the GPU if there is a real one: a software adapter is
    /// slower than [`CpuRenderer`], which also needs no adapter at all. No driver is opened where there cannot be a
    /// GPU.
    pub fn open(choice: impl Into<Choice<RendererChoice>>) -> Result<Self, RenderError> {
        Self::open_where(choice.into(), may_have_gpu())
    }

    fn open_where(choice: Choice<RendererChoice>, may_have_gpu: bool) -> Result<Self, RenderError> {
        if choice == RendererChoice::Cpu || choice.is_open() && !may_have_gpu {
            return Ok(Self::cpu());
        }
        match Context::headless(&ContextOptions::default()) {
            // A software driver has to support everything: llvmpipe took 27 to 44 times as long for 1,000,000 points,
            // and 6.5 to 7.4 times as long for 100,000 surfels in two passes (1920×1080, two cores).
            Ok(context) if choice.is_processor(context.is_software()) => {
                log::info!("{} is not a GPU", context.adapter_summary());
                Ok(Self::cpu())
            }
            Ok(context) => Self::gpu(context),
            Err(error) if choice.is_open() => {
                log::info!("{error}");
                Ok(Self::cpu())
            }
            Err(error) => Err(error),
        }
    }

    /// The CPU.
    pub fn cpu() -> Self {
        Self::Cpu(Box::default())
    }

    /// Draws on the adapter of `context`.
    pub fn gpu(context: Arc<Context>) -> Result<Self, RenderError> {
        Ok(Self::Gpu(Box::new(GpuRenderer::new(context)?)))
    }

    /// Sets if an adapter makes surfels of the screen and of byte codes: see [`GpuRenderer::set_makes_surfels`].
    pub fn set_makes_surfels(&mut self, makes_surfels: bool) {
        if let Self::Gpu(renderer) = self {
            renderer.set_makes_surfels(makes_surfels);
        }
    }

    /// Returns true if the CPU draws, without any driver.
    pub fn is_processor(&self) -> bool {
        matches!(self, Self::Cpu(_))
    }

    /// The renderer in one line, for reports.
    pub fn summary(&self) -> String {
        match self {
            Self::Gpu(renderer) => renderer.context().adapter_summary(),
            Self::Cpu(_) => format!(
                "software renderer of pointreel ({} threads)",
                rayon::current_num_threads()
            ),
        }
    }

    /// Longest edge of an image that is drawn at once.
    pub fn max_edge_px(&self) -> u32 {
        match self {
            Self::Gpu(renderer) => renderer.context().max_edge_px(),
            Self::Cpu(_) => CpuRenderer::MAX_EDGE_PX,
        }
    }

    /// Waits for requested uploads and images.
    pub fn wait(&self) -> Result<(), RenderError> {
        if let Self::Gpu(renderer) = self {
            renderer.context().wait_for_uploads()?;
        }
        Ok(())
    }

    /// Waits for the last image's time on the GPU's clock; `None` without one.
    pub fn wait_gpu_ms(&mut self) -> Option<f64> {
        match self {
            Self::Gpu(renderer) => renderer.wait_gpu_ms(),
            Self::Cpu(_) => None,
        }
    }

    /// Measures the GPU time taken to filter the images of a frame and to create points from them; `None` if the CPU
    /// does that, or the GPU has no timestamp queries.
    pub fn depth_image_times(&mut self, frame: &Arc<DepthFrame>) -> Result<Option<PassTimes>, RenderError> {
        match self {
            Self::Gpu(renderer) => renderer.depth_image_times(frame),
            Self::Cpu(_) => Ok(None),
        }
    }

    /// Discards the drawn image, so that the same packet is drawn again, for benchmarks.
    pub fn invalidate(&mut self) {
        match self {
            Self::Gpu(renderer) => renderer.invalidate(),
            Self::Cpu(renderer) => renderer.invalidate(),
        }
    }

    fn renderer(&self) -> &dyn Renderer {
        match self {
            Self::Gpu(renderer) => &**renderer,
            Self::Cpu(renderer) => &**renderer,
        }
    }

    fn renderer_mut(&mut self) -> &mut dyn Renderer {
        match self {
            Self::Gpu(renderer) => &mut **renderer,
            Self::Cpu(renderer) => &mut **renderer,
        }
    }
}

impl Renderer for AnyRenderer {
    fn prepare(&mut self, packet: &ScenePacket) -> Result<(), RenderError> {
        self.renderer_mut().prepare(packet)
    }

    fn render(&mut self) -> Result<(), RenderError> {
        self.renderer_mut().render()
    }

    fn read_image(&mut self) -> Result<RgbaImage, RenderError> {
        self.renderer_mut().read_image()
    }

    fn stats(&self) -> RenderStats {
        self.renderer().stats()
    }
}
