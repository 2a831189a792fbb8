//! 3-D image in the window of the GPU, whatever renders it.

use super::software::{SoftwarePicture, picture_texture};
use crate::app::meter::GpuWork;
use crate::render::gpu::{Context, GpuRenderer};
use crate::render::{RenderError, RenderStats, Renderer, scaled_to};
use crate::scene::ScenePacket;
use crate::scene::describe::Conditions as _;
use egui::TextureId;
use image::RgbaImage;
use std::sync::Arc;

/// A 3-D image: its renderer, and the texture that egui shows.
pub(super) struct GpuPicture {
    pub(super) renderer: GpuRenderer,
    software: SoftwarePicture,
    pub(super) drawn_by: DrawnBy,
    /// Command buffer that draws the image, to be submitted with the window that shows it.
    pub(super) commands: Option<wgpu::CommandBuffer>,
    pub(super) texture: TextureId,
    /// Renderer and version of the texture that `texture` shows, and its filter.
    shown: Option<(DrawnBy, u64, wgpu::FilterMode)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DrawnBy {
    Gpu,
    Processor,
}

impl GpuPicture {
    pub(super) fn new(context: &Arc<Context>, painter: &mut egui_wgpu::Renderer) -> Result<Self, RenderError> {
        let texture = painter.register_native_texture(
            &context.device,
            &empty_picture(&context.device),
            wgpu::FilterMode::Nearest,
        );
        Ok(Self {
            renderer: GpuRenderer::new(Arc::clone(context))?,
            software: SoftwarePicture::default(),
            drawn_by: DrawnBy::Gpu,
            commands: None,
            texture,
            shown: None,
        })
    }

    pub(super) fn stats(&self) -> RenderStats {
        match self.drawn_by {
            DrawnBy::Gpu => self.renderer.stats(),
            DrawnBy::Processor => self.software.renderer.stats(),
        }
    }

    pub(super) fn draw(
        &mut self,
        context: &Context,
        painter: &mut egui_wgpu::Renderer,
        packet: &ScenePacket,
        work: &mut GpuWork,
    ) -> Result<(), RenderError> {
        // Left over if the window could not be painted.
        self.submit(context, work);
        self.drawn_by = if packet.style.is_drawn_on_gpu() {
            DrawnBy::Gpu
        } else {
            DrawnBy::Processor
        };
        let (generation, view) = match self.drawn_by {
            DrawnBy::Gpu => {
                let before = self.renderer.stats();
                self.renderer.prepare(packet)?;
                self.commands = self.renderer.encode()?;
                let after = self.renderer.stats();
                work.passes += after.passes - before.passes;
                work.uploaded_bytes += after.uploaded_bytes - before.uploaded_bytes;
                let view = self.renderer.color_view().cloned();
                (self.renderer.color_generation(), view)
            }
            DrawnBy::Processor => {
                work.uploaded_bytes += self.software.draw(context, packet)?;
                (self.software.generation, self.software.view())
            }
        };
        // An image at full resolution is shown unfiltered.
        let filter = if packet.style.drawing.resolution < 1.0 {
            wgpu::FilterMode::Linear
        } else {
            wgpu::FilterMode::Nearest
        };
        let shown = Some((self.drawn_by, generation, filter));
        if self.shown != shown
            && let Some(view) = view
        {
            painter.update_egui_texture_from_wgpu_texture(&context.device, &view, filter, self.texture);
            self.shown = shown;
        }
        Ok(())
    }

    fn submit(&mut self, context: &Context, work: &mut GpuWork) {
        if let Some(commands) = self.commands.take() {
            context.queue.submit([commands]);
            work.submissions += 1;
        }
    }

    /// Reads it back, in the size in which it is shown.
    pub(super) fn read(
        &mut self,
        context: &Context,
        shown_px: [u32; 2],
        work: &mut GpuWork,
    ) -> Result<RgbaImage, RenderError> {
        self.submit(context, work);
        let image = match self.drawn_by {
            DrawnBy::Gpu => self.renderer.read_image(),
            DrawnBy::Processor => self.software.renderer.read_image(),
        };
        Ok(scaled_to(image?, shown_px))
    }
}

/// Shown until there is an image.
fn empty_picture(device: &wgpu::Device) -> wgpu::TextureView {
    picture_texture(device, wgpu::Extent3d::default()).create_view(&wgpu::TextureViewDescriptor::default())
}
