//! Software painter: paints the output of egui on the CPU, for windows without a GPU.
//!
//! **How it works.** [`SoftwarePainter`] keeps the list of shapes that egui wants to be seen (`list`), each with its
//! mesh cut into fills, images and triangles (`pieces`). A new list is compared with the last one; only shapes that are
//! new are tessellated, and the bounds of added and removed shapes are the damage (`damage`). Any part of the window
//! can be painted at any time from the list: a buffer that is two frames old is brought up to date by painting the
//! damage of both. Parts are painted from the last shape that hides everything below it, as a 3-D image does, so
//! nothing is overdrawn in vain.
//!
//! **Why not a graphics library's software driver.** It paints the whole window for each change, and runs every pixel
//! through its general pipeline. Most pixels of a window are one colour, a copy, or a glyph's coverage.
//!
//! **Why our own.** `egui_software_backend` 0.0.3 and `dream-soft-render` 1.0.0 want egui 0.34. The first caches meshes
//! and tiles, but lays its whole canvas over the window each time, reports no damage and cannot show our textures; the
//! second paints all of it.
//!
//! **The same image.** Corners are rounded to 256ths of a pixel, edges belong to shapes by the top-left rule, colours
//! are blended in 8 bits, textures are sampled as in `egui.wgsl`: `tests/pictures/painters` compares it with
//! `egui-wgpu`.

mod band;
mod blend;
mod canvas;
mod damage;
mod image;
mod list;
mod pieces;
mod pixel_rect;
mod scaled;
mod textures;
mod triangle;

pub use self::pixel_rect::PixelRect;

use self::band::Layer;
use self::damage::Damage;
use self::list::{TessellatedShape, WindowScale};
use self::textures::Textures;
use ::image::RgbaImage;
use egui::epaint::{ClippedShape, TessellationOptions};
use egui::{Context, TextureFilter, TextureId, TexturesDelta};

/// Paints egui's shapes, including images, into the pixels of a window.
#[derive(Debug, Default)]
pub struct SoftwarePainter {
    textures: Textures,
    entries: Vec<TessellatedShape>,
    damage: Damage,
    shown: TessellatedFor,
}

/// Parameters that all entries were tessellated for.
#[derive(Debug, Default, PartialEq)]
struct TessellatedFor {
    screen: WindowScale,
    /// Version of the glyph atlas that texture coordinates refer to.
    atlas: u64,
    tessellation: Option<TessellationOptions>,
}

impl SoftwarePainter {
    /// One that shows nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in egui's changes of textures, each of which egui sends once; `changes` is empty afterwards.
    ///
    /// Freed textures stay until the next call: they are still shown.
    pub fn update_textures(&mut self, changes: &mut TexturesDelta) {
        self.textures.update(changes);
    }

    /// Reports that the image `id` has other pixels, another size or another filter: if `version` or `filter` differ
    /// from the last time. The pixels are handed over with [`Self::paint`].
    pub fn set_picture(&mut self, id: TextureId, version: u64, filter: TextureFilter) {
        self.textures.set_picture(id, version, filter);
    }

    /// Forgets an image: shapes that show it are skipped.
    pub fn remove_picture(&mut self, id: TextureId) {
        self.textures.remove_picture(id);
    }

    /// Takes in egui's current shapes, in a window of `size_px`.
    ///
    /// # Panics
    ///
    /// If `ctx` has not been run yet: it has no fonts then.
    pub fn show(&mut self, ctx: &Context, shapes: Vec<ClippedShape>, pixels_per_point: f32, size_px: [u32; 2]) {
        let shown = TessellatedFor {
            screen: WindowScale {
                size_px,
                pixels_per_point,
            },
            atlas: self.textures.atlas,
            tessellation: Some(ctx.tessellation_options(|options| *options)),
        };
        if self.shown != shown {
            self.entries.clear();
            self.damage = Damage::default();
            self.damage.add(PixelRect::of_size(size_px));
            self.shown = shown;
        }
        list::replace(
            &mut self.entries,
            shapes,
            ctx,
            self.shown.screen,
            &self.textures,
            |rect| self.damage.add(rect),
        );
    }

    /// Takes the damage since the last call, the region to be repainted: at most eight rectangles that share no pixel,
    /// none if nothing changed.
    pub fn take_damage(&mut self) -> Vec<PixelRect> {
        for entry in &mut self.entries {
            entry.follow_textures(&self.textures, |rect| self.damage.add(rect));
        }
        self.damage.take()
    }

    /// Repaints these parts. `target` is the window's pixels by rows, `0x00RRGGBB`; outside of `region` it stays as it
    /// is.
    ///
    /// `pictures` are those registered with [`Self::set_picture`]; they are taken to be opaque. Shapes without a
    /// texture are skipped, and the window is black elsewhere. Rectangles of `region` may share pixels.
    pub fn paint(&self, pictures: &[(TextureId, &RgbaImage)], region: &[PixelRect], target: &mut [u32]) {
        let size_px = self.shown.screen.size_px;
        let window = PixelRect::of_size(size_px);
        let region: Vec<PixelRect> = region
            .iter()
            .map(|rect| rect.intersection(&window))
            .filter(|rect| !rect.is_empty())
            .collect();
        let parts = self.entries.iter().flat_map(|entry| &entry.parts);
        let layers: Vec<Layer<'_>> = parts
            .filter(|part| region.iter().any(|rect| part.mesh.bounds.touches(rect)))
            .filter_map(|part| {
                let source = self.textures.source(part.mesh.texture, pictures)?;
                Some(Layer::new(&part.mesh, source))
            })
            .collect();
        band::paint(&layers, &region, size_px[0], target);
    }
}
