//! A picture with all its mip levels, and its colours between texels and levels.

use super::mips::mips;
use super::photo_image::PhotoImage;
use glam::Vec4;

/// A picture with all its mip levels, finest first, down to a single texel; or without any.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    levels: Vec<PhotoImage>,
}

impl Texture {
    /// The picture with its levels.
    pub fn new(picture: PhotoImage) -> Self {
        let mut levels = mips(&picture);
        levels.insert(0, picture);
        Self { levels }
    }

    /// The picture alone, however far away it is: to be compared with.
    pub fn without_levels(picture: PhotoImage) -> Self {
        Self { levels: vec![picture] }
    }

    /// All levels, finest first; at least one.
    pub fn levels(&self) -> &[PhotoImage] {
        &self.levels
    }

    /// Width and height of the picture itself.
    pub fn size_px(&self) -> [u32; 2] {
        self.levels[0].size_px()
    }

    /// The colour at a place, in texels of the finest level from its upper left corner, as level `lod` has it: between
    /// texels and levels. Red, green and blue times alpha, and alpha, 0 to 1. Beyond the border it is that of the
    /// border.
    #[inline(always)]
    pub fn between_texels(&self, place: [f32; 2], lod: f32) -> [f32; 4] {
        let coarsest = self.levels.len() - 1;
        let lod = if lod.is_finite() { lod.max(0.0) } else { coarsest as f32 };
        let finer = (lod as usize).min(coarsest);
        let share = (lod - finer as f32).min(1.0);
        let finest = self.size_px();
        let fine = between_texels(&self.levels[finer], finest, place);
        if share == 0.0 || finer == coarsest {
            return fine;
        }
        let coarse = between_texels(&self.levels[finer + 1], finest, place);
        std::array::from_fn(|channel| fine[channel] + share * (coarse[channel] - fine[channel]))
    }

    /// Bytes of its texels.
    pub fn byte_size(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.pixels())).sum()
    }
}

/// Between the four texels of a level around a place that is told in texels of `finest`.
#[inline(always)]
fn between_texels(level: &PhotoImage, finest: [u32; 2], place: [f32; 2]) -> [f32; 4] {
    let size_px = level.size_px();
    let [(left, right, across), (top, bottom, down)] = [0, 1].map(|axis| {
        let edge = size_px[axis];
        let at = place[axis] * (edge as f32 / finest[axis] as f32) - 0.5;
        // Not `clamp`: what is no number is at the border.
        let at = at.max(0.0).min(edge as f32 - 1.0);
        let before = at as usize;
        (before, (before + 1).min(edge as usize - 1), at - before as f32)
    });
    let texel = |column: usize, row: usize| level.pixels()[size_px[0] as usize * row + column];
    let corners = [
        (texel(left, top), (1.0 - across) * (1.0 - down)),
        (texel(right, top), across * (1.0 - down)),
        (texel(left, bottom), (1.0 - across) * down),
        (texel(right, bottom), across * down),
    ];
    let mut sum = Vec4::ZERO;
    for (texel, weight) in corners {
        // All channels at once.
        let texel = Vec4::from_array(texel.map(f32::from));
        let alpha = weight * (1.0 / 255.0) * texel.w;
        sum += (texel * (alpha * (1.0 / 255.0))).with_w(alpha);
    }
    sum.to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red grows by 10 a column, green by 20 a row.
    fn ramp() -> Texture {
        let texels = (0..64).map(|at| [10 * (at % 8) as u8, 20 * (at / 8) as u8, 0, 255]);
        Texture::new(PhotoImage::new([8, 8], texels.collect()).unwrap())
    }

    #[test]
    fn middles_of_texels_have_their_colours_and_places_between_them_what_is_between() {
        let near = |place: [f32; 2], lod: f32, expected: [f32; 4]| {
            let found = ramp().between_texels(place, lod).map(|value| 255.0 * value);
            let far = found
                .iter()
                .zip(expected)
                .any(|(found, expected)| (found - expected).abs() > 0.01);
            assert!(!far, "{place:?}, {lod}: {found:?} {expected:?}");
        };
        near([3.5, 2.5], 0.0, [30.0, 40.0, 0.0, 255.0]);
        near([4.0, 2.5], 0.0, [35.0, 40.0, 0.0, 255.0]);
        near([3.5, 3.25], 0.0, [30.0, 55.0, 0.0, 255.0]);
        // Beyond the middles of the border there is nothing more.
        near([0.1, 8.0], 0.0, [0.0, 140.0, 0.0, 255.0]);
        // A ramp is the same at any level, away from its ends.
        near([3.5, 2.5], 1.0, [30.0, 40.0, 0.0, 255.0]);
        near([4.0, 4.0], 0.5, [35.0, 70.0, 0.0, 255.0]);
        // The coarsest is one texel.
        near([1.0, 1.0], 9.0, [35.0, 70.0, 0.0, 255.0]);
    }

    #[test]
    fn without_levels_the_finest_is_all_there_is() {
        let ramp = ramp();
        let bare = Texture::without_levels(ramp.levels()[0].clone());
        for lod in [0.0, 0.5, 3.0, f32::INFINITY] {
            assert_eq!(
                bare.between_texels([3.25, 2.0], lod),
                ramp.between_texels([3.25, 2.0], 0.0)
            );
        }
    }

    #[test]
    fn numbers_that_are_none_give_colours() {
        for (place, lod) in [
            ([f32::NAN, 2.0], 0.0),
            ([2.0, f32::INFINITY], 1.0),
            ([2.0, 2.0], f32::NAN),
        ] {
            assert!(ramp().between_texels(place, lod).iter().all(|value| value.is_finite()));
        }
    }
}
