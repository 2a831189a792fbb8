//! One renderer or the other, as a person chose.

use super::cpu::CpuRenderer;
use super::gpu::{Context, ContextOptions, GpuRenderer};
use super::{RenderError, RenderStats, Renderer};
use crate::scene::{RendererChoice, ScenePacket};
use image::RgbaImage;

/// A renderer that needs no window.
#[derive(Debug)]
pub enum AnyRenderer {
    /// Draws on an adapter of the graphics library.
    Gpu(Box<GpuRenderer>),
    /// Draws on the processor.
    Cpu(Box<CpuRenderer>),
}

impl AnyRenderer {
    /// Opens what was chosen. Where it may choose, it takes the GPU if there is a real one: a software adapter is slower than
    /// [`CpuRenderer`], and where there is none at all that needs none.
    pub fn open(choice: RendererChoice) -> Result<Self, RenderError> {
        let gpu = |context| Ok(Self::Gpu(Box::new(GpuRenderer::new(context)?)));
        if choice == RendererChoice::Cpu {
            return Ok(Self::cpu());
        }
        match Context::headless(&ContextOptions::default()) {
            Ok(context) if choice.is_processor(context.is_software()) => {
                log::info!("{} is no GPU", context.adapter_summary());
                Ok(Self::cpu())
            }
            Ok(context) => gpu(context),
            Err(error) if choice == RendererChoice::Auto => {
                log::info!("{error}");
                Ok(Self::cpu())
            }
            Err(error) => Err(error),
        }
    }

    fn cpu() -> Self {
        Self::Cpu(Box::default())
    }

    /// One line for reports: what draws.
    pub fn summary(&self) -> String {
        match self {
            Self::Gpu(renderer) => renderer.context().adapter_summary(),
            Self::Cpu(_) => format!(
                "software renderer of pointreel ({} threads)",
                rayon::current_num_threads()
            ),
        }
    }

    /// Waits for the last picture, and for its time on the GPU's clock.
    pub fn wait(&mut self) {
        if let Self::Gpu(renderer) = self {
            renderer.wait_gpu_ms();
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
