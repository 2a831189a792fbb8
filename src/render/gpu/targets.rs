//! What is drawn into: colour (the picture), accumulation (weighted sums) and depth, all of the viewport's size.

use super::context::Context;

/// Display-referred 8-bit colour.
pub(super) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Sums of colour times weight, and of weights: half floats hold them to a part in 2048 and every adapter blends them.
pub(super) const ACCUMULATION_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Reverse-Z: floats are densest near 0, where the far half of the scene is.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The textures of one viewport size.
#[derive(Debug)]
pub(super) struct Targets {
    pub(super) size_px: [u32; 2],
    pub(super) color: wgpu::Texture,
    pub(super) color_view: wgpu::TextureView,
    pub(super) accumulation_view: wgpu::TextureView,
    pub(super) depth_view: wgpu::TextureView,
}

impl Targets {
    /// Precondition: both edges at least 1 and at most [`Context::max_edge_px`].
    pub(super) fn new(context: &Context, size_px: [u32; 2]) -> Self {
        let texture = |label, format, usage| {
            context.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: size_px[0],
                    height: size_px[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING | usage,
                view_formats: &[],
            })
        };
        let none = wgpu::TextureUsages::empty();
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let color = texture("color", COLOR_FORMAT, wgpu::TextureUsages::COPY_SRC);
        Self {
            size_px,
            color_view: view(&color),
            color,
            accumulation_view: view(&texture("accumulation", ACCUMULATION_FORMAT, none)),
            depth_view: view(&texture("depth", DEPTH_FORMAT, none)),
        }
    }
}
