//! A texture with all its mip levels, and interpolation of its colours between texels and levels.
//!
//! *Between texels* of the finest level colours are on cubics through the texels (Catmull and Rom 1974), clamped to the
//! four around: an image drawn at about its own size loses little, where straight lines would blur it by as much as
//! half a texel, and no edge has a brighter or darker fringe. Smaller levels, which are not seen close up, are
//! interpolated from four.

use super::mips::mips;
use super::photo_image::PhotoImage;
use glam::Vec4;

/// An image with all its mip levels, finest first, down to a single texel; or without any.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    levels: Vec<PhotoImage>,
}

impl Texture {
    /// The image with its levels.
    pub fn new(picture: PhotoImage) -> Self {
        let mut levels = mips(&picture);
        levels.insert(0, picture);
        Self { levels }
    }

    /// The image alone, at any distance: for comparison.
    pub fn without_levels(picture: PhotoImage) -> Self {
        Self { levels: vec![picture] }
    }

    /// All levels, finest first; at least one.
    pub fn levels(&self) -> &[PhotoImage] {
        &self.levels
    }

    /// Width and height of the image itself.
    pub fn size_px(&self) -> [u32; 2] {
        self.levels[0].size_px()
    }

    /// The colour at a place, in texels of the finest level from its upper left corner, as level `lod` has it: between
    /// texels and levels. Red, green and blue times alpha, and alpha, 0 to 1. Beyond the border it is the border's.
    #[inline(always)]
    pub fn between_texels(&self, place: [f32; 2], lod: f32) -> [f32; 4] {
        let coarsest = self.levels.len() - 1;
        let lod = if lod.is_finite() { lod.max(0.0) } else { coarsest as f32 };
        let finer = (lod as usize).min(coarsest);
        let share = (lod - finer as f32).min(1.0);
        let finest = self.size_px();
        let fine = if finer == 0 {
            // Bilinear interpolation blurs where an image is drawn at about its own size: 36.66 → 36.94 dB with cubics
            // (Redwood's frames, plain depth buffer). The nearest image alone loses 0.1 dB: its noise is no longer
            // blurred.
            on_cubics(&self.levels[0], place)
        } else {
            between_texels(&self.levels[finer], finest, place)
        };
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

/// On cubics through the 16 texels of an image around a place, between the least and the largest of the four that are
/// next to it.
#[inline(always)]
fn on_cubics(picture: &PhotoImage, place: [f32; 2]) -> [f32; 4] {
    let [width, height] = picture.size_px().map(|edge| edge as usize);
    let (columns, across) = cubic_places(place[0], width - 1);
    let (rows, down) = cubic_places(place[1], height - 1);
    let line = |row: usize| Line::of(&picture.pixels()[width * row..][..width], columns);
    let lines = [line(rows[0]), line(rows[1]), line(rows[2]), line(rows[3])];
    let sum = lines[0].at(across) * down[0]
        + lines[1].at(across) * down[1]
        + lines[2].at(across) * down[2]
        + lines[3].at(across) * down[3];
    let min = lines[1].left.min(lines[1].right).min(lines[2].left.min(lines[2].right));
    let max = lines[1].left.max(lines[1].right).max(lines[2].left.max(lines[2].right));
    // Without this, 36.94 dB as well, but halos at edges. Using eight lanes it took 21.8 instead of 29.5 ns, a tenth of
    // the cost of one image at a point: not adopted.
    sum.max(min).min(max).to_array()
}

/// Four adjacent texels.
struct Line {
    first: Vec4,
    left: Vec4,
    right: Vec4,
    last: Vec4,
}

impl Line {
    // Not by `map`, whose closure calls are not inlined in a loop compiled for several instruction sets. Those calls,
    // eight per texel, took a third of the time.
    #[inline(always)]
    fn of(texels: &[[u8; 4]], columns: [usize; 4]) -> Self {
        Self {
            first: times_alpha(texels[columns[0]]),
            left: times_alpha(texels[columns[1]]),
            right: times_alpha(texels[columns[2]]),
            last: times_alpha(texels[columns[3]]),
        }
    }

    #[inline(always)]
    fn at(&self, shares: [f32; 4]) -> Vec4 {
        self.first * shares[0] + self.left * shares[1] + self.right * shares[2] + self.last * shares[3]
    }
}

/// The four texels of an edge up to `last` around a place on it, and their shares there.
#[inline(always)]
fn cubic_places(place: f32, last: usize) -> ([usize; 4], [f32; 4]) {
    // Not `clamp`: NaN has to end up at the border.
    let at = (place - 0.5).max(0.0).min(last as f32);
    let before = at as usize;
    let texels = [
        before.saturating_sub(1),
        before,
        (before + 1).min(last),
        (before + 2).min(last),
    ];
    (texels, cubic_weights(at - before as f32))
}

/// Red, green and blue times alpha, and alpha, 0 to 1: all at once.
#[inline(always)]
fn times_alpha([red, green, blue, alpha]: [u8; 4]) -> Vec4 {
    let texel = Vec4::new(f32::from(red), f32::from(green), f32::from(blue), f32::from(alpha)) * (1.0 / 255.0);
    (texel * texel.w).with_w(texel.w)
}

/// Shares of four texels at a place a fraction `t` from the second to the third.
#[inline(always)]
fn cubic_weights(t: f32) -> [f32; 4] {
    // a = −0.5, 36.94 dB (Redwood). The sharper cubics with a = −0.75 and −1 have 36.93 and 36.87.
    let (t2, t3) = (t * t, t * t * t);
    [
        -0.5 * t3 + t2 - 0.5 * t,
        1.5 * t3 - 2.5 * t2 + 1.0,
        -1.5 * t3 + 2.0 * t2 + 0.5 * t,
        0.5 * (t3 - t2),
    ]
}

/// Interpolates between the four texels of a level around a position given in texels of `finest`.
#[inline(always)]
fn between_texels(level: &PhotoImage, finest: [u32; 2], place: [f32; 2]) -> [f32; 4] {
    let size_px = level.size_px();
    let (left, right, across) = linear_places(place[0] / finest[0] as f32, size_px[0]);
    let (top, bottom, down) = linear_places(place[1] / finest[1] as f32, size_px[1]);
    let texel = |column: usize, row: usize| times_alpha(level.pixels()[size_px[0] as usize * row + column]);
    let above = texel(left, top) * (1.0 - across) + texel(right, top) * across;
    let below = texel(left, bottom) * (1.0 - across) + texel(right, bottom) * across;
    (above * (1.0 - down) + below * down).to_array()
}

/// The two texels of an edge that are next to a place at `share` of it, and how far it is from the first to the second.
#[inline(always)]
fn linear_places(share: f32, edge: u32) -> (usize, usize, f32) {
    // Not `clamp`: NaN has to end up at the border.
    let at = (share * edge as f32 - 0.5).max(0.0).min(edge as f32 - 1.0);
    let before = at as usize;
    (before, (before + 1).min(edge as usize - 1), at - before as f32)
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
    fn texel_centers_have_exact_colors_and_others_are_interpolated() {
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
        // Beyond the centres of the border texels the value stays constant.
        near([0.1, 8.0], 0.0, [0.0, 140.0, 0.0, 255.0]);
        // A ramp is the same at every level, away from its ends.
        near([3.5, 2.5], 1.0, [30.0, 40.0, 0.0, 255.0]);
        near([4.0, 4.0], 0.5, [35.0, 70.0, 0.0, 255.0]);
        // The coarsest level is one texel.
        near([1.0, 1.0], 9.0, [35.0, 70.0, 0.0, 255.0]);
    }

    /// A wave of eight texels, away from its crests: straight lines are off by up to 5 of 255, cubics by half of that.
    #[test]
    fn waves_are_hardly_flattened_between_texels() {
        let wave = |x: f32| 127.5 + 100.0 * (x * std::f32::consts::TAU / 8.0).sin();
        let texels = (0..32 * 4).map(|at| [wave((at % 32) as f32 + 0.5).round() as u8, 0, 0, 255]);
        let texture = Texture::new(PhotoImage::new([32, 4], texels.collect()).unwrap());
        for step in 0..200 {
            let x = 4.0 + 0.1 * step as f32;
            let [red, ..] = texture.between_texels([x, 2.0], 0.0);
            let is_crest = (wave(x) - 127.5).abs() > 75.0;
            let off = (255.0 * red - wave(x)).abs();
            assert!(is_crest || off < 2.5, "{x}: {} {}", 255.0 * red, wave(x));
        }
    }

    #[test]
    fn edges_have_no_halos_and_transparent_texels_no_color() {
        // Grey next to white, and transparent on both sides.
        let texels = (0..8 * 8).map(|at| match at % 8 {
            0..3 => [100, 100, 100, 255],
            3..6 => [255, 255, 255, 255],
            _ => [0, 255, 0, 0],
        });
        let texture = Texture::new(PhotoImage::new([8, 8], texels.collect()).unwrap());
        for step in 0..=80 {
            let [red, green, blue, alpha] = texture.between_texels([0.1 * step as f32, 3.3], 0.0);
            let is_grey = (red - green).abs() < 1e-6 && (red - blue).abs() < 1e-6;
            assert!(is_grey && (0.0..=1.0).contains(&alpha) && red <= alpha + 1e-6, "{step}");
            assert!(alpha < 1.0 - 1e-6 || (0.392..=1.0).contains(&red), "{step}: {red}");
        }
    }

    #[test]
    fn without_mipmaps_every_lod_samples_the_finest_level() {
        let texture = ramp();
        let [picture, ..] = texture.levels() else { panic!() };
        let bare = Texture::without_levels(picture.clone());
        for lod in [0.0, 0.5, 3.0, f32::INFINITY] {
            assert_eq!(
                bare.between_texels([3.25, 2.0], lod),
                ramp().between_texels([3.25, 2.0], 0.0)
            );
        }
    }

    #[test]
    fn nan_and_infinite_coordinates_give_colors() {
        for (place, lod) in [
            ([f32::NAN, 2.0], 0.0),
            ([2.0, f32::INFINITY], 1.0),
            ([2.0, 2.0], f32::NAN),
        ] {
            assert!(ramp().between_texels(place, lod).iter().all(|value| value.is_finite()));
        }
    }
}
