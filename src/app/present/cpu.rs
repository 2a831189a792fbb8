//! CPU presenter: images of the software renderer and egui's panels, painted into memory that the window system shows.
//!
//! **How it works.** The painter (`app/paint`) knows which rectangles of the window have changed (*damage*); only they
//! are painted, and only they are presented. They are painted straight into the buffer that the window system shows.
//! Where it alternates two buffers (Wayland), the current one lacks the damage of the image between, which is painted
//! too: a buffer's *age* distinguishes the cases. The pixels of an image are copied once, from the renderer's image to
//! that buffer. No driver is needed: it is opened only when a user chooses the GPU to draw.

use super::presenter::{Painted, Panels, Presenter, PresenterInfo};
use crate::app::meter::GpuWork;
use crate::app::paint::{PixelRect, SoftwarePainter};
use crate::app::side::Side;
use crate::render::cpu::CpuRenderer;
use crate::render::gpu::{Context, ContextOptions, GpuRenderer};
use crate::render::{AnyRenderer, RenderError, RenderStats, Renderer, scaled_to};
use crate::scene::{RendererChoice, ScenePacket};
use egui::{TextureFilter, TextureId};
use image::RgbaImage;
use softbuffer::{Rect, SoftBufferError, Surface};
use std::num::NonZeroU32;
use std::sync::Arc;
use std::time::Instant;
use winit::window::Window;

/// Max edge of the window and of the images in it: coordinates of X11 are signed 16-bit numbers.
const MAX_EDGE_PX: u32 = 16_384;

/// The CPU presenter of the window.
pub(super) struct CpuPresenter {
    window: Arc<Window>,
    surface: Surface<Arc<Window>, Arc<Window>>,
    painter: SoftwarePainter,
    picture: CpuPicture,
    /// The image of the other side of a comparison, once there was one.
    other_picture: Option<CpuPicture>,
    /// Opened when the GPU is chosen to draw.
    context: Option<Arc<Context>>,
    /// Damage of the window when it was presented last, which a buffer of age 2 lacks.
    last_damage: Vec<PixelRect>,
}

/// A 3-D image and its renderer.
struct CpuPicture {
    texture: TextureId,
    software: CpuRenderer,
    /// GPU renderer and the image into which its output is read back.
    hardware: Option<(GpuRenderer, RgbaImage)>,
    is_hardware: bool,
    version: u64,
}

impl CpuPicture {
    fn new(side: Side) -> Self {
        Self {
            texture: TextureId::User(side as u64),
            software: CpuRenderer::new(),
            hardware: None,
            is_hardware: false,
            version: 0,
        }
    }

    fn image(&self) -> &RgbaImage {
        match &self.hardware {
            Some((_, image)) if self.is_hardware => image,
            _ => self.software.image(),
        }
    }

    fn renderer(&self) -> &dyn Renderer {
        match &self.hardware {
            Some((renderer, _)) if self.is_hardware => renderer,
            _ => &self.software,
        }
    }

    /// Draws a packet; `context` opens the adapter.
    fn draw(
        &mut self,
        packet: &ScenePacket,
        context: impl FnOnce() -> Result<Arc<Context>, RenderError>,
    ) -> Result<(), RenderError> {
        self.is_hardware = packet.style.drawing.renderer == RendererChoice::Gpu;
        if self.is_hardware {
            let (renderer, image) = match &mut self.hardware {
                Some(hardware) => hardware,
                none => none.insert((GpuRenderer::new(context()?)?, RgbaImage::default())),
            };
            renderer.prepare(packet)?;
            renderer.render()?;
            *image = renderer.read_image()?;
        } else {
            self.software.prepare(packet)?;
            self.software.render()?;
        }
        self.version += 1;
        Ok(())
    }
}

impl CpuPresenter {
    /// A surface in memory for `window`.
    pub(super) fn open(window: Arc<Window>) -> Result<Self, RenderError> {
        let context = softbuffer::Context::new(Arc::clone(&window)).map_err(no_surface)?;
        let surface = Surface::new(&context, Arc::clone(&window)).map_err(no_surface)?;
        Ok(Self {
            window,
            surface,
            painter: SoftwarePainter::new(),
            picture: CpuPicture::new(Side::A),
            other_picture: None,
            context: None,
            last_damage: Vec::new(),
        })
    }

    /// Paints the damage and presents it, all of the window if that `is_exposed`.
    fn present(&mut self, is_exposed: bool) -> Result<Painted, RenderError> {
        let size_px = window_size_px(&self.window);
        let [Some(width), Some(height)] = size_px.map(NonZeroU32::new) else {
            return Ok(Painted::default());
        };
        let whole = vec![PixelRect::of_size(size_px)];
        let mut damage = self.painter.take_damage();
        if is_exposed {
            damage.clone_from(&whole);
        }
        if damage.is_empty() {
            return Ok(Painted {
                presented: true,
                ..Painted::default()
            });
        }
        self.surface.resize(width, height).map_err(no_surface)?;
        let begin = Instant::now();
        // Waits until the window system has read, or released, the previously presented buffer.
        let mut buffer = self.surface.buffer_mut().map_err(no_surface)?;
        let waited = begin.elapsed();
        let begin = Instant::now();
        let region = match buffer.age() {
            1 => damage.clone(),
            2 => [damage.as_slice(), &self.last_damage].concat(),
            _ => whole,
        };
        let pictures = [Some(&self.picture), self.other_picture.as_ref()];
        let pictures: Vec<_> = pictures
            .into_iter()
            .flatten()
            .map(|picture| (picture.texture, picture.image()))
            .collect();
        self.painter.paint(&pictures, &region, &mut buffer);
        let painting = begin.elapsed();
        self.window.pre_present_notify();
        let begin = Instant::now();
        let rects: Vec<Rect> = damage.iter().filter_map(rect).collect();
        buffer.present_with_damage(&rects).map_err(no_surface)?;
        self.last_damage = damage;
        Ok(Painted {
            presented: true,
            waited,
            painting,
            presenting: begin.elapsed(),
            repainted_px: region.iter().map(PixelRect::area_px).sum(),
            gpu: GpuWork::default(),
        })
    }
}

impl Presenter for CpuPresenter {
    fn info(&self) -> PresenterInfo {
        PresenterInfo {
            adapter: AnyRenderer::cpu().summary(),
            is_software: true,
            paints_on_processor: true,
            max_edge_px: MAX_EDGE_PX,
            waits_for_screen: false,
        }
    }

    fn texture(&self, side: Side) -> Option<TextureId> {
        match side {
            Side::A => Some(self.picture.texture),
            Side::B => self.other_picture.as_ref().map(|picture| picture.texture),
        }
    }

    fn draw(&mut self, side: Side, packet: &ScenePacket) -> Result<(), RenderError> {
        let picture = match side {
            Side::A => &mut self.picture,
            Side::B => self.other_picture.get_or_insert_with(|| CpuPicture::new(Side::B)),
        };
        let known = &mut self.context;
        picture.draw(packet, || {
            if let Some(context) = known {
                return Ok(Arc::clone(context));
            }
            let context = Context::headless(&ContextOptions::default())?;
            Ok(Arc::clone(known.insert(context)))
        })?;
        // An image at full resolution is shown unfiltered.
        let filter = if packet.style.drawing.resolution < 1.0 {
            TextureFilter::Linear
        } else {
            TextureFilter::Nearest
        };
        self.painter.set_picture(picture.texture, picture.version, filter);
        Ok(())
    }

    fn read(&mut self, side: Side, shown_px: [u32; 2]) -> Result<Option<RgbaImage>, RenderError> {
        let picture = match side {
            Side::A => Some(&self.picture),
            Side::B => self.other_picture.as_ref(),
        };
        Ok(picture.map(|picture| scaled_to(picture.image().clone(), shown_px)))
    }

    fn was_drawn_by_gpu(&self) -> bool {
        self.picture.is_hardware
    }

    fn stats(&self) -> RenderStats {
        self.picture.renderer().stats()
    }

    fn set_resident_budget_bytes(&mut self, budget_bytes: u64) {
        let others = self.other_picture.iter_mut();
        // The budget is shared by both sides of a comparison.
        let count = 1 + others.len() as u64;
        for picture in others.chain([&mut self.picture]) {
            if let Some((renderer, _)) = &mut picture.hardware {
                renderer.set_resident_budget_bytes(budget_bytes / count);
            }
        }
    }

    /// The surface is resized when it is painted next.
    fn resize(&mut self) {}

    fn paint(&mut self, panels: Option<Panels<'_>>, is_exposed: bool) -> Result<Painted, RenderError> {
        let begin = Instant::now();
        if let Some(Panels {
            egui,
            shapes,
            textures,
            pixels_per_point,
        }) = panels
        {
            self.painter.update_textures(textures);
            let size_px = window_size_px(&self.window);
            self.painter.show(egui, shapes, pixels_per_point, size_px);
        }
        let noticed = begin.elapsed();
        let painted = self.present(is_exposed)?;
        if let Some(context) = &self.context {
            context.check_alive()?;
        }
        Ok(Painted {
            painting: painted.painting + noticed,
            ..painted
        })
    }

    fn simulate_loss(&self) {
        if let Some(context) = &self.context {
            context.simulate_loss();
        }
    }
}

/// Width and height of the visible area; 0 while the window is minimised.
fn window_size_px(window: &Window) -> [u32; 2] {
    let size: [u32; 2] = window.inner_size().into();
    size.map(|edge| edge.min(MAX_EDGE_PX))
}

fn rect(rect: &PixelRect) -> Option<Rect> {
    let [width, height] = rect.size_px();
    Some(Rect {
        x: rect.min[0],
        y: rect.min[1],
        width: NonZeroU32::new(width)?,
        height: NonZeroU32::new(height)?,
    })
}

#[expect(clippy::needless_pass_by_value, reason = "it is what `map_err` hands over")]
fn no_surface(error: SoftBufferError) -> RenderError {
    RenderError::Window {
        reason: error.to_string(),
    }
}
