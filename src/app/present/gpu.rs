//! GPU presenter: the window's surface (`surface.rs`), egui's painter and the renderer of the 3-D image.
//!
//! **How it works.** The renderer of the GPU draws a packet into its own `Rgba8Unorm` texture, which egui's painter
//! shows as an image without filtering or conversion: both hold display-referred values, and so does the surface, for
//! which a format without sRGB conversion is chosen. The image is drawn only when there is a new packet; panels are
//! painted over it as often as they ask, and the previous ones, which are on the GPU already, where only the image is
//! new. Images of the CPU are copied to such a texture. Images and panels are one submission.

use super::gpu_picture::{DrawnBy, GpuPicture};
use super::presenter::{Painted, Panels, Presenter, PresenterInfo};
use super::surface::{WindowSurface, acquire};
use crate::app::meter::GpuWork;
use crate::app::side::Side;
use crate::render::gpu::{Context, ContextOptions};
use crate::render::{RenderError, RenderStats};
use crate::scene::ScenePacket;
use egui::epaint::Primitive;
use egui::{ClippedPrimitive, TextureId};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use image::RgbaImage;
use std::sync::Arc;
use std::time::Instant;
use winit::window::Window;

/// The GPU's side of the window.
pub(super) struct GpuPresenter {
    context: Arc<Context>,
    surface: WindowSurface,
    painter: egui_wgpu::Renderer,
    /// Primitives that egui painted last.
    primitives: Vec<ClippedPrimitive>,
    pixels_per_point: f32,
    /// The size of the window for which `primitives` are on the card.
    uploaded_for_px: Option<[u32; 2]>,
    /// GPU work since the window was painted.
    work: GpuWork,
    picture: GpuPicture,
    /// The image of the other side of a comparison, once there was one.
    other_picture: Option<GpuPicture>,
}

impl GpuPresenter {
    /// Opens the adapter that shows on `window`.
    pub(super) fn open(window: Arc<Window>) -> Result<Self, RenderError> {
        let surface = WindowSurface::open(window, |instance, surface| {
            Context::for_window(instance, surface, &ContextOptions::default())
        })?;
        let context = Arc::clone(surface.context());
        let options = RendererOptions {
            // Dithering would also be applied to the image, which must be shown unchanged.
            dithering: false,
            ..RendererOptions::default()
        };
        let mut painter = egui_wgpu::Renderer::new(&context.device, surface.format(), options);
        let picture = GpuPicture::new(&context, &mut painter)?;
        Ok(Self {
            context,
            surface,
            painter,
            primitives: Vec::new(),
            pixels_per_point: 1.0,
            uploaded_for_px: None,
            work: GpuWork::default(),
            picture,
            other_picture: None,
        })
    }

    fn picture(&self, side: Side) -> Option<&GpuPicture> {
        match side {
            Side::A => Some(&self.picture),
            Side::B => self.other_picture.as_ref(),
        }
    }

    fn paint_surface(&mut self) -> Result<Painted, RenderError> {
        let begin = Instant::now();
        let frame = acquire(&mut self.surface)?;
        let waited = begin.elapsed();
        let Some(frame) = frame else {
            return Ok(Painted {
                waited,
                ..Painted::default()
            });
        };
        let begin = Instant::now();
        let (device, queue) = (&self.context.device, &self.context.queue);
        let screen = ScreenDescriptor {
            size_in_pixels: self.surface.size_px(),
            pixels_per_point: self.pixels_per_point,
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("window") });
        let primitives = &self.primitives;
        let pictures = [Some(&mut self.picture), self.other_picture.as_mut()];
        let mut commands: Vec<_> = pictures
            .into_iter()
            .flatten()
            .filter_map(|picture| picture.commands.take())
            .collect();
        if self.uploaded_for_px.replace(screen.size_in_pixels) != Some(screen.size_in_pixels) {
            let others = self
                .painter
                .update_buffers(device, queue, &mut encoder, primitives, &screen);
            commands.extend(others);
            self.work.uploaded_bytes += bytes_of(primitives);
        }
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("window"),
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
        self.painter.render(&mut pass.forget_lifetime(), primitives, &screen);
        commands.push(encoder.finish());
        queue.submit(commands);
        self.work.submissions += 1;
        self.work.passes += 1;
        let painting = begin.elapsed();
        self.surface.window().pre_present_notify();
        let begin = Instant::now();
        queue.present(frame);
        let presenting = begin.elapsed();
        let [width, height] = self.surface.size_px().map(u64::from);
        Ok(Painted {
            presented: true,
            // A driver that lags behind blocks here, too.
            waited: waited + presenting,
            painting,
            presenting,
            repainted_px: width * height,
            gpu: std::mem::take(&mut self.work),
        })
    }
}

impl Presenter for GpuPresenter {
    fn info(&self) -> PresenterInfo {
        PresenterInfo {
            adapter: self.context.adapter_summary(),
            is_software: self.context.is_software(),
            paints_on_processor: false,
            max_edge_px: self.context.max_edge_px(),
            waits_for_screen: true,
        }
    }

    fn texture(&self, side: Side) -> Option<TextureId> {
        self.picture(side).map(|picture| picture.texture)
    }

    fn draw(&mut self, side: Side, packet: &ScenePacket) -> Result<(), RenderError> {
        let picture = match (side, &mut self.other_picture) {
            (Side::A, _) => &mut self.picture,
            (Side::B, Some(picture)) => picture,
            (Side::B, none) => none.insert(GpuPicture::new(&self.context, &mut self.painter)?),
        };
        picture.draw(&self.context, &mut self.painter, packet, &mut self.work)
    }

    fn read(&mut self, side: Side, shown_px: [u32; 2]) -> Result<Option<RgbaImage>, RenderError> {
        let picture = match side {
            Side::A => Some(&mut self.picture),
            Side::B => self.other_picture.as_mut(),
        };
        picture
            .map(|picture| picture.read(&self.context, shown_px, &mut self.work))
            .transpose()
    }

    fn was_drawn_by_gpu(&self) -> bool {
        self.picture.drawn_by == DrawnBy::Gpu
    }

    fn stats(&self) -> RenderStats {
        self.picture.stats()
    }

    fn set_resident_budget_bytes(&mut self, budget_bytes: u64) {
        let others = self.other_picture.iter_mut();
        // The budget is shared by both sides of a comparison.
        let count = 1 + others.len() as u64;
        for picture in others.chain([&mut self.picture]) {
            picture.renderer.set_resident_budget_bytes(budget_bytes / count);
        }
    }

    fn resize(&mut self) {
        self.surface.resize();
    }

    fn paint(&mut self, panels: Option<Panels<'_>>, _is_exposed: bool) -> Result<Painted, RenderError> {
        let begin = Instant::now();
        let mut unused = Vec::new();
        if let Some(Panels {
            egui,
            shapes,
            textures,
            pixels_per_point,
        }) = panels
        {
            let (device, queue) = (&self.context.device, &self.context.queue);
            for (id, deltas) in textures.set.drain() {
                for delta in deltas {
                    let [width, height] = delta.image.size();
                    self.work.uploaded_bytes += 4 * (width * height) as u64;
                    self.painter.update_texture(device, queue, id, &delta);
                }
            }
            self.primitives = egui.tessellate(shapes, pixels_per_point);
            self.pixels_per_point = pixels_per_point;
            self.uploaded_for_px = None;
            unused.extend(textures.free.drain());
        }
        let prepared = begin.elapsed();
        let painted = self.paint_surface();
        for id in unused {
            self.painter.free_texture(&id);
        }
        self.context.check_alive()?;
        painted.map(|painted| Painted {
            painting: painted.painting + prepared,
            ..painted
        })
    }

    fn simulate_loss(&self) {
        self.context.simulate_loss();
    }
}

/// Returns the GPU memory used by `primitives`.
fn bytes_of(primitives: &[ClippedPrimitive]) -> u64 {
    let meshes = primitives.iter().filter_map(|clipped| match &clipped.primitive {
        Primitive::Mesh(mesh) => Some(mesh),
        Primitive::Callback(_) => None,
    });
    let bytes = meshes.map(|mesh| size_of_val(&mesh.vertices[..]) + size_of_val(&mesh.indices[..]));
    bytes.sum::<usize>() as u64
}
