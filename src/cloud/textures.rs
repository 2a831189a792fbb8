//! Textures of a mesh.

use image::{RgbaImage, imageops};

/// Textures, one after the other, as renderers read them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Textures {
    texels: Vec<[u8; 4]>,
    places: Vec<TexturePlace>,
}

/// Location of a texture image among the texels, row by row.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TexturePlace {
    /// Index of its upper left texel.
    pub first: u32,
    /// Texels in a row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Rounds it up to 16 bytes.
    pub unused: u32,
}

impl Textures {
    /// Max texels of all textures together: half of what every adapter can bind.
    pub const MAX_TEXELS: usize = 1 << 24;

    /// These images as textures. While they are too large together, the largest is halved. An empty image is one white
    /// texel.
    pub fn of(mut pictures: Vec<RgbaImage>) -> Self {
        let texels = |picture: &RgbaImage| picture.width() as usize * picture.height() as usize;
        while pictures.iter().map(texels).sum::<usize>() > Self::MAX_TEXELS {
            let Some(largest) = pictures.iter_mut().max_by_key(|picture| texels(picture)) else {
                break;
            };
            let [width, height] = [largest.width(), largest.height()].map(|edge| edge.div_ceil(2));
            *largest = imageops::thumbnail(largest, width, height);
        }
        let mut textures = Self::default();
        for picture in pictures {
            textures.push(&picture);
        }
        textures
    }

    fn push(&mut self, picture: &RgbaImage) {
        let first = self.texels.len() as u32;
        let (texels, _) = picture.as_raw().as_chunks();
        self.texels.extend_from_slice(texels);
        let is_empty = texels.is_empty();
        if is_empty {
            self.texels.push([255; 4]);
        }
        self.places.push(TexturePlace {
            first,
            width: if is_empty { 1 } else { picture.width() },
            height: if is_empty { 1 } else { picture.height() },
            unused: 0,
        });
    }

    /// 8-bit red, green, blue and alpha of all texels.
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }

    /// Returns the location of each texture image.
    pub fn places(&self) -> &[TexturePlace] {
        &self.places
    }

    /// Display-referred red, green and blue at a place of a texture, 0 to 1: bilinear. A coordinate of 1 is the width
    /// or the height, beyond which the texture repeats.
    ///
    /// # Panics
    /// Precondition: the texture exists.
    pub fn color(&self, texture: usize, place: [f32; 2]) -> [f32; 3] {
        let picture = &self.places[texture];
        let [left, right, x] = between(place[0], picture.width);
        let [upper, lower, y] = between(place[1], picture.height);
        let texel = |column: f32, row: f32| {
            let index = picture.first + row as u32 * picture.width + column as u32;
            self.texels[index as usize]
        };
        let texels = [
            [texel(left, upper), texel(right, upper)],
            [texel(left, lower), texel(right, lower)],
        ];
        [0, 1, 2].map(|channel| {
            let along = |[left, right]: [[u8; 4]; 2]| mix(f32::from(left[channel]), f32::from(right[channel]), x);
            mix(along(texels[0]), along(texels[1]), y) * (1.0 / 255.0)
        })
    }

    /// Bytes of all arrays.
    pub fn byte_size(&self) -> usize {
        size_of_val(self.texels.as_slice()) + size_of_val(self.places.as_slice())
    }
}

/// The texels along an axis before and behind a coordinate, and how far it is from the first to the second.
fn between(coordinate: f32, size: u32) -> [f32; 3] {
    let last = size as f32 - 1.0;
    let fraction = coordinate - coordinate.floor();
    let at = fraction * size as f32 - 0.5;
    let before = at.floor();
    // NaN becomes the first texel, as with conversions.
    let first = if before < 0.0 { last } else { before.min(last) };
    let second = if first < last { first + 1.0 } else { 0.0 };
    [first, second, at - before]
}

fn mix(from: f32, to: f32, share: f32) -> f32 {
    from + (to - from) * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    fn two_by_two() -> Textures {
        let mut picture = RgbaImage::new(2, 2);
        picture.put_pixel(0, 0, Rgba([255, 0, 0, 255]));
        picture.put_pixel(1, 0, Rgba([0, 255, 0, 255]));
        picture.put_pixel(0, 1, Rgba([0, 0, 255, 255]));
        picture.put_pixel(1, 1, Rgba([255, 255, 255, 0]));
        Textures::of(vec![RgbaImage::new(0, 0), picture])
    }

    #[test]
    fn texels_have_exact_colors_at_their_centers_and_textures_repeat() {
        let textures = two_by_two();
        assert_eq!(textures.color(0, [0.3, 0.7]), [1.0; 3]);
        for whole in [0.0, 1.0, -3.0] {
            let at = |u: f32, v: f32| textures.color(1, [u + whole, v - whole]);
            assert_eq!(at(0.25, 0.25), [1.0, 0.0, 0.0]);
            assert_eq!(at(0.75, 0.25), [0.0, 1.0, 0.0]);
            assert_eq!(at(0.25, 0.75), [0.0, 0.0, 1.0]);
            assert_eq!(at(0.75, 0.75), [1.0, 1.0, 1.0]);
            assert_eq!(at(0.5, 0.25), [0.5, 0.5, 0.0]);
            // Across the border, the first column follows the last one.
            assert_eq!(at(1.0, 0.25), [0.5, 0.5, 0.0]);
            assert_eq!(at(0.5, 0.5), [0.5, 0.5, 0.5]);
        }
    }

    #[test]
    fn nan_coordinates_have_a_color_and_large_textures_are_halved() {
        let textures = two_by_two();
        for odd in [f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX, 1e-45] {
            // It may be NaN or infinite, but a colour is returned.
            let _ = textures.color(1, [odd, 0.25]);
        }
        let large = RgbaImage::from_pixel(8192, 4096, Rgba([9, 8, 7, 255]));
        let textures = Textures::of(vec![large, RgbaImage::new(1, 1)]);
        assert_eq!([textures.places()[0].width, textures.places()[0].height], [4096, 2048]);
        assert!(textures.texels().len() <= Textures::MAX_TEXELS);
        assert_eq!(textures.places()[1].first, 4096 * 2048);
        assert_eq!(textures.texels()[5], [9, 8, 7, 255]);
    }
}
