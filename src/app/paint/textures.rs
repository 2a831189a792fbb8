//! egui's textures and the 3-D images: their texels, version, and sampling.
//!
//! **How it works.** A texture is stored as words of the target's order. Every change gives it a new version, and a
//! shape that was painted with another version is damage. The font atlas is the exception: glyphs are added where it
//! was transparent, which no shape shows yet, so only texels that were seen make a new version.
//!
//! A texture that egui frees is still needed to paint the current shapes, so it is dropped with the next changes.
//! Images are not stored at all, but handed over for each painting.
//!
//! Sampling is as in `egui.wgsl`: texel centres at halves, linear between four of them, coordinates wrapped as the
//! texture asks. As there, one filter is used for enlarging and reducing.

use super::blend::{OPAQUE, channels, packed};
use egui::epaint::{ImageData, ImageDelta};
use egui::{TextureFilter, TextureId, TextureOptions, TextureWrapMode, TexturesDelta};
use image::RgbaImage;
use std::collections::HashMap;

/// Version of a missing texture.
pub(super) const NOT_THERE: u64 = 0;

#[derive(Debug, Clone)]
struct Texture {
    size: [usize; 2],
    texels: Vec<u32>,
    options: TextureOptions,
    version: u64,
}

#[derive(Debug, Clone, Copy)]
struct UserPicture {
    /// Pixel version given by the owner.
    owners_version: u64,
    filter: TextureFilter,
    version: u64,
}

/// All that shapes can be painted with.
#[derive(Debug, Default)]
pub(super) struct Textures {
    held: HashMap<TextureId, Texture>,
    pictures: HashMap<TextureId, UserPicture>,
    freed: Vec<TextureId>,
    last_version: u64,
    /// Changes with each new font atlas, whose glyphs are elsewhere.
    pub(super) atlas: u64,
}

impl Textures {
    /// Takes in egui's changes; `changes` is empty afterwards.
    pub(super) fn update(&mut self, changes: &mut TexturesDelta) {
        for id in std::mem::take(&mut self.freed) {
            self.held.remove(&id);
        }
        for (id, deltas) in changes.set.drain() {
            for delta in deltas {
                self.set(id, &delta);
            }
        }
        self.freed.extend(changes.free.drain());
    }

    fn set(&mut self, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let size = image.size;
        if image.pixels.len() != size[0] * size[1] {
            return;
        }
        self.last_version += 1;
        let Some(corner) = delta.pos else {
            let texture = Texture {
                size,
                texels: image.pixels.iter().copied().map(packed).collect(),
                options: delta.options,
                version: self.last_version,
            };
            if id == TextureId::default() {
                self.atlas = self.last_version;
            }
            self.held.insert(id, texture);
            return;
        };
        let Some(texture) = self.held.get_mut(&id) else {
            return;
        };
        let fits = (0..2).all(|axis| {
            let end = corner[axis].checked_add(size[axis]);
            end.is_some_and(|end| end <= texture.size[axis])
        });
        if !fits || size[0] == 0 {
            return;
        }
        let mut is_seen = id != TextureId::default() || texture.options != delta.options;
        texture.options = delta.options;
        let rows = texture.texels[texture.size[0] * corner[1]..].chunks_mut(texture.size[0]);
        for (row, new) in rows.zip(image.pixels.chunks_exact(size[0])) {
            for (texel, &new) in row[corner[0]..].iter_mut().zip(new) {
                let new = packed(new);
                is_seen |= *texel != 0 && *texel != new;
                *texel = new;
            }
        }
        if is_seen {
            texture.version = self.last_version;
        }
    }

    /// Sets the version of an image to be shown, and its filter.
    pub(super) fn set_picture(&mut self, id: TextureId, version: u64, filter: TextureFilter) {
        let held = self.pictures.get(&id);
        if held.is_some_and(|held| held.owners_version == version && held.filter == filter) {
            return;
        }
        self.last_version += 1;
        let picture = UserPicture {
            owners_version: version,
            filter,
            version: self.last_version,
        };
        self.pictures.insert(id, picture);
    }

    /// Forgets an image.
    pub(super) fn remove_picture(&mut self, id: TextureId) {
        self.pictures.remove(&id);
    }

    /// Returns the texture version, which changes whenever something that is painted with the texture has to be
    /// repainted.
    pub(super) fn version(&self, id: TextureId) -> u64 {
        let picture = self.pictures.get(&id).map(|picture| picture.version);
        let texture = || self.held.get(&id).map(|texture| texture.version);
        picture.or_else(texture).unwrap_or(NOT_THERE)
    }

    /// Returns the texel source to paint with.
    pub(super) fn source<'a>(
        &'a self,
        id: TextureId,
        pictures: &[(TextureId, &'a RgbaImage)],
    ) -> Option<SampledTexture<'a>> {
        if let Some(picture) = self.pictures.get(&id) {
            let (_, image) = pictures.iter().find(|(picture, _)| *picture == id)?;
            let (pixels, _) = image.as_raw().as_chunks::<4>();
            return SampledTexture::new(
                [image.width() as usize, image.height() as usize],
                Texels::Picture(pixels),
                picture.filter == TextureFilter::Linear,
                TextureWrapMode::ClampToEdge,
            );
        }
        let texture = self.held.get(&id)?;
        SampledTexture::new(
            texture.size,
            Texels::Words(&texture.texels),
            texture.options.magnification == TextureFilter::Linear,
            texture.options.wrap_mode,
        )
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Texels<'a> {
    /// `0xAARRGGBB`.
    Words(&'a [u32]),
    /// Bytes of the software renderer: red, green, blue and nothing. Opaque.
    Picture(&'a [[u8; 4]]),
}

/// A texture while it is painted with; it has at least one texel.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampledTexture<'a> {
    pub(super) size: [usize; 2],
    pub(super) texels: Texels<'a>,
    pub(super) is_linear: bool,
    wrap: TextureWrapMode,
}

/// Two texels along an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct BetweenTexels {
    pub(super) first: usize,
    pub(super) second: usize,
    /// Weight of the second.
    pub(super) share: f32,
}

/// An image's pixel in the target's format.
#[inline(always)]
pub(super) fn swizzled(pixel: [u8; 4]) -> u32 {
    let word = u32::from_le_bytes(pixel);
    (word & 0xff) << 16 | word & 0xff00 | word >> 16 & 0xff
}

impl<'a> SampledTexture<'a> {
    fn new(size: [usize; 2], texels: Texels<'a>, is_linear: bool, wrap: TextureWrapMode) -> Option<Self> {
        let count = match texels {
            Texels::Words(words) => words.len(),
            Texels::Picture(pixels) => pixels.len(),
        };
        // Texel coordinates are computed in f32 and i32.
        let is_sound = size.iter().all(|&edge| edge > 0 && edge < 1 << 20);
        let source = Self {
            size,
            texels,
            is_linear,
            wrap,
        };
        (is_sound && count >= size[0] * size[1]).then_some(source)
    }

    /// Returns true if the texture is opaque.
    pub(super) fn is_opaque(&self) -> bool {
        matches!(self.texels, Texels::Picture(_))
    }

    #[inline(always)]
    pub(super) fn texel(&self, x: usize, y: usize) -> u32 {
        let place = self.size[0] * y + x;
        match self.texels {
            Texels::Words(words) => words[place],
            Texels::Picture(pixels) => swizzled(pixels[place]) | OPAQUE,
        }
    }

    /// The texel that stands for any integer along an axis.
    #[inline(always)]
    pub(super) fn wrapped(&self, axis: usize, at: i32) -> usize {
        let edge = self.size[axis] as i32;
        let at = match self.wrap {
            TextureWrapMode::ClampToEdge => at.clamp(0, edge - 1),
            TextureWrapMode::Repeat => at.rem_euclid(edge),
            TextureWrapMode::MirroredRepeat => {
                let phase = at.rem_euclid(2 * edge);
                phase.min(2 * edge - 1 - phase)
            }
        };
        at as usize
    }

    /// The texel nearest to a coordinate along an axis, in texels.
    #[inline(always)]
    pub(super) fn nearest(&self, axis: usize, at: f32) -> usize {
        self.wrapped(axis, at.floor() as i32)
    }

    /// The two texels on either side of a coordinate.
    #[inline(always)]
    pub(super) fn between(&self, axis: usize, at: f32) -> BetweenTexels {
        let at = at - 0.5;
        let below = at.floor();
        let first = below as i32;
        let second = first.saturating_add(1);
        let share = at - below;
        BetweenTexels {
            first: self.wrapped(axis, first),
            second: self.wrapped(axis, second),
            // Non-finite values have weight 0.
            share: if share.is_finite() { share } else { 0.0 },
        }
    }

    /// The colour at a coordinate in texels, channels of 0 to 255.
    #[inline(always)]
    pub(super) fn at(&self, [x, y]: [f32; 2]) -> [f32; 4] {
        if !self.is_linear {
            return channels(self.texel(self.nearest(0, x), self.nearest(1, y)));
        }
        self.mixed(self.between(0, x), self.between(1, y))
    }

    /// The colour between four texels.
    #[inline(always)]
    pub(super) fn mixed(&self, x: BetweenTexels, y: BetweenTexels) -> [f32; 4] {
        let row = |y: usize| {
            mix(
                channels(self.texel(x.first, y)),
                channels(self.texel(x.second, y)),
                x.share,
            )
        };
        mix(row(y.first), row(y.second), y.share)
    }
}

/// From `a` to `b`.
#[inline(always)]
fn mix(a: [f32; 4], b: [f32; 4], share: f32) -> [f32; 4] {
    let mut mixed = a;
    for (mixed, b) in mixed.iter_mut().zip(b) {
        *mixed = *mixed * (1.0 - share) + b * share;
    }
    mixed
}
