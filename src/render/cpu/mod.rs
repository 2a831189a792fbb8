//! The software renderer: the passes of `render/gpu` on the CPU, for machines without a GPU.
//!
//! How it works: the image is divided into tiles whose pixels stay in the second cache while everything that may touch
//! them is drawn (`blocks.rs`), pass after pass, and are then written to the image once. Bands of tiles are tasks that
//! share nothing, so there are no locks and no atomic operations, and images do not depend on the number of threads.
//! Patches are affine functions of pixels (`facet.rs`), evaluated eight at a time (`raster.rs`). Steps that look beyond
//! a tile, such as eye-dome lighting, follow when all of them are drawn (`screen.rs`); depths that light depends on are
//! drawn before (`effects/ambient_occlusion`, `effects/shadow`).
//!
//! Modes, lights and background match the shaders'; `tests/pictures/cpu_renderer.rs` compares the two.

mod blocks;
mod deferred;
pub(in crate::render) mod depths;
pub(in crate::render) mod eight;
mod ewa;
mod facet;
mod finish;
mod footprints;
mod illumination;
mod linear;
mod packed_ellipses;
mod packed_normals;
mod painter;
mod photos;
mod physical;
pub(in crate::render) mod pixels;
mod primitives;
mod raster;
mod records;
mod rims;
mod rows;
mod screen;
mod shading;
mod small_splats;
mod spans;
mod sprites;
#[cfg(test)]
mod tests;
pub(in crate::render) mod tile;
mod triangle;
pub(in crate::render) mod view;

use super::effects::ambient_occlusion::cpu::Occlusion;
use super::effects::shadow::cpu::ShadowMap;
use super::effects::{self, OnCpu, Stage};
use super::gathered::Gathered;
use super::known_depths::KnownDepths;
use super::{RenderError, RenderStats, Renderer};
use crate::measure::DepthImage;
use crate::scene::{AmbientOcclusion, Content, Lights, PhotoViews, PhysicalLight, ScenePacket, Shadow};
use crate::stopwatch::milliseconds_since;
use blocks::Blocks;
use depths::{draw_distances, draw_reversed_depths};
use illumination::Illumination;
use image::RgbaImage;
use photos::{PhotoAnswer, Projected, fill_holes};
use primitives::{Drawable, of_surfaces};
use rows::{TileRow, bands_of};
use screen::Screen;
use std::time::Instant;

/// Draws on the CPU.
#[derive(Debug, Default)]
pub struct CpuRenderer {
    prepared: Option<ScenePacket>,
    drawn: Option<ScenePacket>,
    gathered: Gathered,
    /// Boxes around the records of the prepared packet, made for these records.
    blocks: Option<(Content, Blocks)>,
    image: RgbaImage,
    /// The antialiased image made from it; empty without antialiasing.
    smooth: RgbaImage,
    /// Reversed depths of the image, if a later step needs them.
    depths: Vec<f32>,
    /// Reversed depths drawn before the image, if light depends on them.
    occluders: Vec<f32>,
    /// The depths that the key light sees, and their inputs.
    shadow_map: Option<(ScenePacket, Vec<f32>)>,
    /// Depth maps seen from the posed images.
    photo_depths: KnownDepths,
    /// Samples of the posed images at the pixels of the rendered image, if holes are filled from around.
    textured: Vec<PhotoAnswer>,
    stats: RenderStats,
}

impl CpuRenderer {
    /// Longest edge of an image: as for textures of most GPUs.
    pub const MAX_EDGE_PX: u32 = 32_768;

    /// A renderer that has drawn nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Discards the drawn image, so that the same packet is drawn again, for benchmarks.
    pub fn invalidate(&mut self) {
        self.drawn = None;
    }

    /// The depth of the surface in the prepared packet's image, drawn separately: for surfels blended in two passes,
    /// the depth of the nearest disk, without the slack that lets them blend.
    /// [`Splatting::NoDepth`](crate::scene::Splatting::NoDepth) shows no surface in particular: infinite everywhere.
    pub fn draw_depths(&mut self) -> Result<DepthImage, RenderError> {
        let (Some(packet), Some((_, blocks))) = (&self.prepared, &self.blocks) else {
            return Err(RenderError::NothingPrepared);
        };
        let packet = of_surfaces(packet);
        Ok(DepthImage {
            size_px: packet.viewport_px,
            depth: draw_distances(&Drawable::of_surface(&packet), &packet, blocks),
        })
    }

    /// The last image.
    pub fn image(&self) -> &RgbaImage {
        if self.smooth.is_empty() {
            &self.image
        } else {
            &self.smooth
        }
    }

    /// Draws a packet as it is before antialiasing ([`ScenePacket::as_drawn`]).
    fn draw(&mut self, packet: &ScenePacket) -> Result<(), RenderError> {
        let Some((_, blocks)) = &self.blocks else {
            return Err(RenderError::NothingPrepared);
        };
        let [width, height] = packet.viewport_px;
        if self.image.dimensions() != (width, height) {
            self.image = RgbaImage::new(width, height);
        }
        let screen = Screen::of(packet);
        let pixels = self.image.len() / 4;
        self.depths.resize(if screen.is_some() { pixels } else { 0 }, 0.0);
        let bytes = bands_of(packet, &mut self.image, 4);
        let bands: Vec<TileRow<'_>> = if screen.is_some() {
            let both = bytes.zip(bands_of(packet, &mut self.depths, 1));
            both.map(|(bytes, depths)| TileRow::Unfinished { bytes, depths })
                .collect()
        } else {
            bytes.map(TileRow::Bytes).collect()
        };
        let occlusion = AmbientOcclusion::of(packet).map(|settings| {
            self.occluders.resize(pixels, 0.0);
            let packet = of_surfaces(packet);
            draw_reversed_depths(&Drawable::of(&packet), &packet, blocks, &mut self.occluders);
            Occlusion::new(settings, packet.viewport_px, &self.occluders)
        });
        let shadow = Shadow::of(packet);
        let shadow = shadow.as_ref().map(|shadow| ShadowMap {
            shadow,
            depths: depths_from_lamp(&mut self.shadow_map, shadow, blocks),
        });
        let physical = PhysicalLight::of(packet);
        let photo_views = PhotoViews::of(packet);
        let posed_images = photo_views.as_ref().zip(packet.posed_images.as_ref());
        let depths = self.photo_depths.of(packet);
        let projected = posed_images.map(|(views, shown)| {
            let projected = Projected::new(views, shown.posed_images.all(), &depths.maps);
            if projected.fills_holes() {
                self.textured.resize(pixels, PhotoAnswer::default());
                look(&projected, packet, blocks, &mut self.textured);
                fill_holes(&mut self.textured, packet.viewport_px);
                return projected.with_told(&self.textured);
            }
            projected
        });
        let illumination = Lights::of(packet).map(|lights| Illumination {
            lights,
            occlusion,
            shadow,
            physical: physical.as_ref(),
            posed_images: projected.as_ref(),
        });
        self.stats.drawn_instances = Drawable::of(packet).draw(packet, blocks, illumination, bands);
        self.stats.records = match &packet.content {
            // How much of a code is drawn is only known afterwards.
            Content::Coded(_) => self.stats.drawn_instances,
            content => content.record_count() as u64,
        };
        self.stats.screen_ms = 0.0;
        if let Some(screen) = screen {
            let start = Instant::now();
            rayon::scope(|_| screen.draw(&mut self.image, &self.depths, projected.as_ref()));
            self.stats.screen_ms = milliseconds_since(start);
        }
        Ok(())
    }

    /// Makes the image shown from the drawn one.
    fn antialias(&mut self, packet: &ScenePacket) {
        let mut steps = effects::of_stage(packet, Stage::Shown);
        let step = steps.find_map(|effect| match effect.on_cpu {
            OnCpu::Shown(step) => Some(step),
            OnCpu::InTiles | OnCpu::Rows(_) => None,
        });
        let [width, height] = step.map_or([0; 2], |_| packet.viewport_px);
        if self.smooth.dimensions() != (width, height) {
            self.smooth = RgbaImage::new(width, height);
        }
        if let Some(step) = step {
            step(&self.image, &mut self.smooth);
        }
    }
}

impl Renderer for CpuRenderer {
    fn prepare(&mut self, packet: &ScenePacket) -> Result<(), RenderError> {
        let start = Instant::now();
        let [width, height] = packet.as_drawn().viewport_px;
        if width.max(height) > Self::MAX_EDGE_PX {
            let max = Self::MAX_EDGE_PX;
            return Err(RenderError::TooLarge { width, height, max });
        }
        let packet = &self.gathered.packet(packet);
        let is_cached = self.blocks.as_ref().is_some_and(|(of, _)| *of == packet.content);
        if !is_cached {
            let blocks = Drawable::of(packet).blocks();
            self.blocks = Some((packet.content.clone(), blocks));
        }
        self.prepared = Some(packet.clone());
        self.stats.prepare_ms = milliseconds_since(start);
        Ok(())
    }

    fn render(&mut self) -> Result<(), RenderError> {
        let packet = self.prepared.clone().ok_or(RenderError::NothingPrepared)?;
        if self.drawn.as_ref() == Some(&packet) {
            return Ok(());
        }
        let start = Instant::now();
        self.draw(&packet.as_drawn())?;
        self.antialias(&packet);
        self.stats.frames += 1;
        self.stats.passes += 1;
        self.stats.draw_calls = 1;
        self.stats.encode_ms = milliseconds_since(start);
        self.drawn = Some(packet);
        Ok(())
    }

    fn read_image(&mut self) -> Result<RgbaImage, RenderError> {
        if self.drawn.is_none() {
            return Err(RenderError::NothingPrepared);
        }
        Ok(self.image().clone())
    }

    fn stats(&self) -> RenderStats {
        self.stats
    }
}

/// Samples the posed images at all pixels of a packet.
fn look(posed_images: &Projected<'_>, packet: &ScenePacket, blocks: &Blocks, told: &mut [PhotoAnswer]) {
    let illumination = Lights::of(packet).map(|lights| Illumination {
        lights,
        occlusion: None,
        shadow: None,
        physical: None,
        posed_images: Some(posed_images),
    });
    let bands = bands_of(packet, told, 1).map(TileRow::Textured);
    Drawable::of(packet).draw(packet, blocks, illumination, bands.collect());
}

/// The reversed depths that a lamp sees: those that are known, or drawn now.
fn depths_from_lamp<'a>(known: &'a mut Option<(ScenePacket, Vec<f32>)>, shadow: &Shadow, blocks: &Blocks) -> &'a [f32] {
    let packet = &shadow.lamp_packet;
    let (of, mut depths) = known.take().unwrap_or_else(|| (packet.clone(), Vec::new()));
    if depths.is_empty() || of != *packet {
        let [width, height] = packet.viewport_px.map(|edge| edge as usize);
        depths.resize(width * height, 0.0);
        draw_reversed_depths(&Drawable::of_shadow(shadow), packet, blocks, &mut depths);
    }
    &known.insert((packet.clone(), depths)).1
}
