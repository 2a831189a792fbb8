//! The image of the software renderer as a texture.

use crate::render::RenderError;
use crate::render::Renderer;
use crate::render::cpu::CpuRenderer;
use crate::render::gpu::Context;
use crate::scene::ScenePacket;

/// Renders on the CPU, and uploads each new image to the GPU once.
#[derive(Default)]
pub(super) struct SoftwarePicture {
    pub(super) renderer: CpuRenderer,
    texture: Option<wgpu::Texture>,
    /// Changes whenever the texture is another one than before.
    pub(super) generation: u64,
    frames_uploaded: u64,
}

impl SoftwarePicture {
    /// Draws a packet; returns how many bytes were uploaded for it.
    pub(super) fn draw(&mut self, context: &Context, packet: &ScenePacket) -> Result<u64, RenderError> {
        self.renderer.prepare(packet)?;
        self.renderer.render()?;
        let frames = self.renderer.stats().frames;
        let [width, height] = packet.viewport_px;
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let fits = self.texture.as_ref().is_some_and(|texture| texture.size() == size);
        if !fits {
            self.texture = Some(picture_texture(&context.device, size));
            self.generation += 1;
        } else if self.frames_uploaded == frames {
            return Ok(0);
        }
        if let Some(texture) = &self.texture {
            context.queue.write_texture(
                texture.as_image_copy(),
                self.renderer.image(),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(4 * width),
                    rows_per_image: None,
                },
                size,
            );
        }
        self.frames_uploaded = frames;
        Ok(4 * u64::from(width) * u64::from(height))
    }

    /// The image; `None` before the first one.
    pub(super) fn view(&self) -> Option<wgpu::TextureView> {
        let texture = self.texture.as_ref()?;
        Some(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    }
}

/// A texture that egui can show and the CPU can write.
pub(super) fn picture_texture(device: &wgpu::Device, size: wgpu::Extent3d) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}
