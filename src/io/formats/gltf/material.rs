//! Colours of surfaces: the base colour of the material, its texture, and the colours of vertices, multiplied in linear
//! light.
//!
//! Factors and vertex colours are linear light, textures and the colours of points are sRGB. A texture alone is passed
//! on unchanged. Without a readable texture the other two remain: the shape does not depend on it.

use super::accessor::AccessorSource;
use super::buffers::resource;
use super::document::{Material, Pbr, at};
use super::geometry::Geometry;
use crate::cloud::{self, Texturing};
use crate::io::error::Fault;
use crate::io::meshes::picture;
use image::RgbaImage;
use std::path::Path;
use std::sync::Arc;

/// Surface appearance: the materials of a file.
pub(super) struct Surfaces<'a> {
    pub(super) materials: &'a [Material],
    pub(super) textures: &'a Textures,
}

/// Texture of each material.
pub(super) struct Textures(Vec<Option<RgbaImage>>);

impl Textures {
    /// Loads the textures of the file `path` that `geometry` needs.
    pub(super) fn load(source: &AccessorSource<'_>, geometry: &Geometry, path: &Path) -> Result<Self, Fault> {
        let materials = &source.document.materials;
        let mut is_used = vec![false; materials.len()];
        for material in geometry.materials.iter().flatten() {
            at(materials, *material, "material")?;
            is_used[*material] = true;
        }
        let mut textures = Vec::with_capacity(materials.len());
        for (material, is_used) in materials.iter().zip(is_used) {
            let texture = match &material.pbr_metallic_roughness.base_color_texture {
                Some(texture) if is_used => picture_of(source, texture.index, path)?,
                _ => None,
            };
            textures.push(texture);
        }
        Ok(Self(textures))
    }
}

impl Textures {
    /// All of them, one behind the other.
    pub(super) fn pictures(&self) -> cloud::Textures {
        cloud::Textures::of(self.0.iter().flatten().cloned().collect())
    }

    /// The number of each material's among them.
    fn numbers(&self) -> Vec<Option<u32>> {
        let mut next = 0..;
        let number = |picture: &Option<RgbaImage>| picture.as_ref().and_then(|_| next.next());
        self.0.iter().map(number).collect()
    }
}

impl Surfaces<'_> {
    /// True where a vertex may be another colour than white.
    pub(super) fn has_colors(&self, geometry: &Geometry) -> bool {
        let is_colored = |material: &Material| {
            let pbr = &material.pbr_metallic_roughness;
            pbr.base_color_factor.is_some_and(|factor| factor != [1.0; 4])
        };
        geometry.has_colors || self.materials.iter().any(is_colored) || self.textures.0.iter().any(Option::is_some)
    }

    /// The colour of a place but for the texture.
    pub(super) fn color_without_texture(&self, material: Option<usize>, light: [f32; 4]) -> [u8; 4] {
        encoded(self.linear_color(material, light))
    }

    fn linear_color(&self, material: Option<usize>, light: [f32; 4]) -> [f32; 4] {
        let material = material.map(|index| &self.materials[index].pbr_metallic_roughness);
        let factor = material.and_then(|pbr| pbr.base_color_factor).unwrap_or([1.0; 4]);
        std::array::from_fn(|channel| light[channel] * factor[channel])
    }

    /// The textures `pictures` on the vertices of `geometry`.
    pub(super) fn texturing(&self, geometry: &Geometry, pictures: &Arc<cloud::Textures>) -> Texturing {
        let numbers: Vec<Option<u32>> = self.textures.numbers();
        let place = |(material, &place): (&Option<usize>, &[f32; 2])| match material {
            Some(index) => in_picture(&self.materials[*index].pbr_metallic_roughness, place),
            None => place,
        };
        let placed = geometry.materials.iter().zip(&geometry.texture_places);
        Texturing {
            textures: Arc::clone(pictures),
            texture_of_vertex: geometry
                .materials
                .iter()
                .map(|material| numbers[(*material)?])
                .collect(),
            places: placed.map(place).collect(),
        }
    }

    /// The colour of a place.
    pub(super) fn color(&self, material: Option<usize>, light: [f32; 4], texture_place: [f32; 2]) -> [u8; 4] {
        let light = self.linear_color(material, light);
        let Some(index) = material else {
            return encoded(light);
        };
        let pbr = &self.materials[index].pbr_metallic_roughness;
        let Some(picture) = &self.textures.0[index] else {
            return encoded(light);
        };
        let texel = texel(picture, in_picture(pbr, texture_place));
        if light == [1.0; 4] {
            return texel;
        }
        let linear = texel.map(|channel| f32::from(channel) / 255.0);
        encoded([
            decoded(linear[0]) * light[0],
            decoded(linear[1]) * light[1],
            decoded(linear[2]) * light[2],
            linear[3] * light[3],
        ])
    }
}

/// Returns the texture coordinates of a vertex in the image of its material.
fn in_picture(pbr: &Pbr, place: [f32; 2]) -> [f32; 2] {
    let texture = pbr.base_color_texture.as_ref();
    let Some(transform) = texture.and_then(|texture| texture.extensions.transform.as_ref()) else {
        return place;
    };
    let [width, height] = transform.scale.unwrap_or([1.0; 2]);
    let (sine, cosine) = transform.rotation.sin_cos();
    let [u, v] = [place[0] * width, place[1] * height];
    [
        cosine * u + sine * v + transform.offset[0],
        cosine * v - sine * u + transform.offset[1],
    ]
}

fn picture_of(source: &AccessorSource<'_>, texture: usize, path: &Path) -> Result<Option<RgbaImage>, Fault> {
    let texture = at(&source.document.textures, texture, "texture")?;
    // Extensions have images in formats that are not supported.
    let Some(image) = texture.source else {
        return Ok(None);
    };
    let image = at(&source.document.images, image, "image")?;
    let max_bytes = source.options.left_bytes().saturating_sub(source.spent_bytes.get());
    let owned;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => match resource(uri, path, max_bytes, source.options) {
            Ok(bytes) => {
                owned = bytes;
                &owned[..]
            }
            Err(_) => return Ok(None),
        },
        (None, Some(view)) => source.buffers.view(source.document, view)?,
        (None, None) => return Ok(None),
    };
    let Ok(picture) = picture::decode(bytes, max_bytes) else {
        return Ok(None);
    };
    source.spend(picture.as_raw().len() as u64)?;
    Ok(Some(picture))
}

/// The nearest texel of an image that repeats in all directions.
fn texel(picture: &RgbaImage, place: [f32; 2]) -> [u8; 4] {
    let index = |place: f32, size: u32| {
        let fraction = place - place.floor();
        // NaN becomes the first texel.
        ((fraction * size as f32) as u32).min(size - 1)
    };
    picture
        .get_pixel(index(place[0], picture.width()), index(place[1], picture.height()))
        .0
}

fn decoded(channel: f32) -> f32 {
    if channel <= 0.04045 {
        channel / 12.92
    } else {
        ((channel + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear light as sRGB; alpha is as it is.
fn encoded([red, green, blue, alpha]: [f32; 4]) -> [u8; 4] {
    let channel = |light: f32| {
        let light = light.clamp(0.0, 1.0);
        if light <= 0.003_130_8 {
            light * 12.92
        } else {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        }
    };
    [channel(red), channel(green), channel(blue), alpha.clamp(0.0, 1.0)].map(|value| (value * 255.0).round() as u8)
}
