//! Both painters on the same window.

use super::opaque_picture;
use crate::common;
use egui::{Context, FullOutput, TextureFilter, TextureId, TexturesDelta};
use egui_kittest::TestRenderer;
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use image::RgbaImage;
use pointreel::app::paint::SoftwarePainter;
use pointreel::render::gpu;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// Steps of 255 that a channel may differ by: a rounding up or down.
const TOLERANCE: u8 = 1;

/// Of a million pixels, this many may differ by more: less than a glyph. Those that do (one of some millions) are soft
/// edges under soft edges, where two roundings add up.
const ODD_PER_MILLION: usize = 20;

/// The images in the centre, and how they are scaled. Their ids count from 0.
pub(super) type Pictures = Rc<RefCell<Vec<(RgbaImage, TextureFilter)>>>;

/// Comparison of the images of both painters.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Comparison {
    pub(super) pixels: usize,
    /// A channel differs at all.
    pub(super) unequal: usize,
    /// A channel differs by more than the tolerance.
    pub(super) odd: usize,
    pub(super) largest: u8,
}

impl Comparison {
    pub(super) fn of(ours: &[u32], theirs: &[u8]) -> Self {
        let mut found = Self::default();
        for (ours, theirs) in ours.iter().zip(theirs.chunks_exact(4)) {
            let [_, ours @ ..] = ours.to_be_bytes();
            let apart = ours.iter().zip(theirs).map(|(a, b)| a.abs_diff(*b));
            let apart = apart.max().unwrap();
            found.pixels += 1;
            found.unequal += usize::from(apart > 0);
            found.odd += usize::from(apart > TOLERANCE);
            found.largest = found.largest.max(apart);
        }
        found
    }

    pub(super) fn is_close(&self) -> bool {
        self.odd * 1_000_000 <= self.pixels * ODD_PER_MILLION
    }
}

/// Hands everything to both painters, and fails if their images are not alike.
pub(super) struct Both {
    gpu: Arc<gpu::Context>,
    theirs: egui_wgpu::Renderer,
    ours: SoftwarePainter,
    pictures: Pictures,
    registered: Vec<TextureId>,
    pixels: Vec<u32>,
    version: u64,
    compared: Rc<RefCell<Vec<Comparison>>>,
}

impl Both {
    /// `compared` gets the outcome of each image.
    pub(super) fn new(pictures: Pictures, compared: Rc<RefCell<Vec<Comparison>>>) -> Self {
        let gpu = common::context();
        // As in the window.
        let options = RendererOptions {
            dithering: false,
            ..RendererOptions::default()
        };
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let theirs = egui_wgpu::Renderer::new(&gpu.device, format, options);
        Self {
            gpu,
            theirs,
            ours: SoftwarePainter::new(),
            pictures,
            registered: Vec::new(),
            pixels: Vec::new(),
            version: 0,
            compared,
        }
    }

    fn texture(&self, size_px: [u32; 2], usage: wgpu::TextureUsages) -> wgpu::Texture {
        self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent(size_px),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage,
            view_formats: &[],
        })
    }

    /// Both get the images, the graphics library as textures.
    fn set_pictures(&mut self) {
        self.version += 1;
        let pictures = Rc::clone(&self.pictures);
        for (index, (picture, filter)) in pictures.borrow().iter().enumerate() {
            let size_px = [picture.width(), picture.height()];
            let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
            let texture = self.texture(size_px, usage);
            self.gpu.queue.write_texture(
                texture.as_image_copy(),
                picture.as_raw(),
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(4 * size_px[0]),
                    rows_per_image: None,
                },
                extent(size_px),
            );
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            let gpu_filter = match filter {
                TextureFilter::Nearest => wgpu::FilterMode::Nearest,
                TextureFilter::Linear => wgpu::FilterMode::Linear,
            };
            let device = &self.gpu.device;
            let theirs = &mut self.theirs;
            let id = if let Some(&id) = self.registered.get(index) {
                theirs.update_egui_texture_from_wgpu_texture(device, &view, gpu_filter, id);
                id
            } else {
                let id = theirs.register_native_texture(device, &view, gpu_filter);
                self.registered.push(id);
                id
            };
            assert_eq!(id, TextureId::User(index as u64));
            self.ours.set_picture(id, self.version, *filter);
        }
    }

    /// The window's image with a GPU, RGBA.
    fn paint_theirs(&mut self, ctx: &Context, output: &FullOutput, size_px: [u32; 2]) -> Vec<u8> {
        let scale = output.pixels_per_point;
        let primitives = ctx.tessellate(output.shapes.clone(), scale);
        let screen = ScreenDescriptor {
            size_in_pixels: size_px,
            pixels_per_point: scale,
        };
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let target = self.texture(size_px, usage);
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: None });
        self.theirs
            .update_buffers(device, queue, &mut encoder, &primitives, &screen);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                resolve_target: None,
                depth_slice: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        self.theirs.render(&mut pass.forget_lifetime(), &primitives, &screen);
        let row_bytes = (4 * size_px[0]).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row_bytes * size_px[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            target.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row_bytes),
                    rows_per_image: None,
                },
            },
            extent(size_px),
        );
        queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let bytes = buffer.get_mapped_range(..).unwrap();
        let rows = bytes.chunks_exact(row_bytes as usize);
        rows.flat_map(|row| row[..4 * size_px[0] as usize].iter().copied())
            .collect()
    }

    /// The parts that changed since the last time, and the rest as it was.
    fn paint_ours(&mut self, ctx: &Context, output: &FullOutput, size_px: [u32; 2]) {
        self.pixels.resize((size_px[0] * size_px[1]) as usize, 0x00ff_00ff);
        self.ours
            .show(ctx, output.shapes.clone(), output.pixels_per_point, size_px);
        let damage = self.ours.take_damage();
        let pictures = self.pictures.borrow();
        let pictures: Vec<_> = (0..)
            .map(TextureId::User)
            .zip(pictures.iter().map(|(picture, _)| picture))
            .collect();
        self.ours.paint(&pictures, &damage, &mut self.pixels);
    }
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    }
}

impl TestRenderer for Both {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        for (id, images) in &delta.set {
            for image in images {
                let (device, queue) = (&self.gpu.device, &self.gpu.queue);
                self.theirs.update_texture(device, queue, *id, image);
            }
        }
        for id in &delta.free {
            self.theirs.free_texture(id);
        }
        self.ours.update_textures(delta);
    }

    fn render(&mut self, ctx: &Context, output: &FullOutput) -> Result<RgbaImage, String> {
        let size = ctx.content_rect().size() * output.pixels_per_point;
        let size_px = [size.x.round() as u32, size.y.round() as u32];
        self.set_pictures();
        let theirs = self.paint_theirs(ctx, output, size_px);
        self.paint_ours(ctx, output, size_px);
        let found = Comparison::of(&self.pixels, &theirs);
        self.compared.borrow_mut().push(found);
        let bytes = self.pixels.iter().flat_map(|pixel| {
            let [_, red, green, blue] = pixel.to_be_bytes();
            [red, green, blue, 255]
        });
        let [width, height] = size_px;
        let ours = RgbaImage::from_raw(width, height, bytes.collect());
        let ours = ours.ok_or("no pixels")?;
        if found.is_close() {
            return Ok(ours);
        }
        let folder = env!("CARGO_TARGET_TMPDIR");
        let theirs = RgbaImage::from_raw(width, height, theirs).ok_or("no pixels")?;
        for (name, image) in [("ours", ours), ("theirs", theirs)] {
            let path = format!("{folder}/painter_{name}.png");
            image.save(path).map_err(|error| error.to_string())?;
        }
        Err(format!("{found:?}: see painter_*.png in {folder}"))
    }
}

/// An image with edges and slopes, other ones for other seeds.
pub(super) fn picture(size_px: [u32; 2], seed: u64) -> RgbaImage {
    let noise = opaque_picture(size_px[0].max(1), size_px[1].max(1), seed);
    let mut picture = noise;
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        if (x / 16 + y / 16) % 2 == 0 {
            pixel.0 = [(x % 256) as u8, (y % 256) as u8, (seed * 40) as u8, 255];
        }
    }
    picture
}
