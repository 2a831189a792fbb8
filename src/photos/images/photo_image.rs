//! Pixels of an input image, with alpha as the degree to which each of them belongs to the object.

use crate::photos::error::PhotosError;
use crate::photos::found::picture_file::{decode, size_px};
use crate::photos::sets::photo::Photo;
use glam::DVec2;
use image::DynamicImage;

/// Red, green, blue (display values) and alpha, line by line from the top. Colours are not multiplied by alpha: 255 is
/// a pixel of the object, 0 an unknown one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhotoImage {
    size_px: [u32; 2],
    pixels: Vec<[u8; 4]>,
}

impl PhotoImage {
    /// The image of these pixels; `None` if their number does not match its size.
    pub fn new(size_px: [u32; 2], pixels: Vec<[u8; 4]>) -> Option<Self> {
        let count = u64::from(size_px[0]) * u64::from(size_px[1]);
        (count > 0 && count == pixels.len() as u64).then_some(Self { size_px, pixels })
    }

    /// Reads the file of an input image. Alpha is the file's, times the brightness of the mask.
    ///
    /// # Errors
    /// If the image or its mask cannot be decoded, or if the image has another size than its camera.
    pub fn read(photo: &Photo) -> Result<Self, PhotosError> {
        let expected_px = photo.camera.size_px();
        // Reads the header first: a file that has become a huge one is not decoded.
        let found_px = size_px(&photo.path)?;
        if found_px != expected_px {
            return Err(PhotosError::WrongSize {
                path: photo.path.clone(),
                expected_px,
                found_px,
            });
        }
        let colors = decode(&photo.path)?.into_rgba8();
        let mut pixels: Vec<[u8; 4]> = colors.pixels().map(|pixel| pixel.0).collect();
        if let Some(mask) = &photo.mask {
            multiply_alpha(&mut pixels, expected_px, &decode(mask)?);
        }
        Self::new(expected_px, pixels).ok_or_else(|| PhotosError::invalid(&photo.path, "the picture", "no pixels"))
    }

    /// Width and height.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Pixels, line by line from the top.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// Columns, for indices.
    pub(in crate::photos) fn width(&self) -> usize {
        self.size_px[0] as usize
    }

    /// The pixel interpolated from the four around a place, those of zero alpha not counting for the colour; beyond the
    /// border, the border pixel. Centres of pixels are at integers. All values are 0 to 255.
    pub fn bilinear(&self, at: DVec2) -> [f32; 4] {
        let place = |at: f64, side: u32| {
            let last = (side - 1) as usize;
            let at = at.clamp(0.0, last as f64);
            let first = at as usize;
            (first, (first + 1).min(last), (at - first as f64) as f32)
        };
        let (left, right, to_right) = place(at.x, self.size_px[0]);
        let (top, bottom, to_bottom) = place(at.y, self.size_px[1]);
        let width = self.width();
        let pixel = |column: usize, row: usize| self.pixels[row * width + column];
        let corners = [
            pixel(left, top),
            pixel(right, top),
            pixel(left, bottom),
            pixel(right, bottom),
        ];
        let shares = [
            (1.0 - to_right) * (1.0 - to_bottom),
            to_right * (1.0 - to_bottom),
            (1.0 - to_right) * to_bottom,
            to_right * to_bottom,
        ];
        // True for nearly all pixels: no weighting, so no division.
        if corners.iter().all(|corner| corner[3] == u8::MAX) {
            let mix = |channel: usize| (0..4).map(|at| shares[at] * f32::from(corners[at][channel])).sum();
            return [mix(0), mix(1), mix(2), 255.0];
        }
        let mut sum = WeightedColor::default();
        for (corner, share) in corners.into_iter().zip(shares) {
            sum.add(corner, share);
        }
        sum.mean()
    }
}

/// A sum of colours, each by its alpha.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WeightedColor {
    color: [f32; 3],
    alpha: f32,
    weight: f32,
}

impl WeightedColor {
    pub(in crate::photos) fn add(&mut self, [r, g, b, a]: [u8; 4], weight: f32) {
        let by_alpha = weight * f32::from(a);
        for (sum, channel) in self.color.iter_mut().zip([r, g, b]) {
            *sum += by_alpha * f32::from(channel);
        }
        self.alpha += by_alpha;
        self.weight += weight;
    }

    /// Returns the mean colour, in the range 0 to 255; all zero if nothing has an alpha.
    pub(in crate::photos) fn mean(&self) -> [f32; 4] {
        if self.alpha <= 0.0 {
            return [0.0; 4];
        }
        let [r, g, b] = self.color.map(|sum| sum / self.alpha);
        [r, g, b, self.alpha / self.weight]
    }

    pub(in crate::photos) fn rounded(&self) -> [u8; 4] {
        self.mean().map(|value| (value + 0.5) as u8)
    }
}

/// Multiplies alpha by the brightness of a mask, which is stretched over the image.
fn multiply_alpha(pixels: &mut [[u8; 4]], [width, height]: [u32; 2], mask: &DynamicImage) {
    let mask = mask.to_luma8();
    let (mask_width, mask_height) = mask.dimensions();
    if mask_width == 0 || mask_height == 0 {
        return;
    }
    let place = |at: u32, side: u32, mask_side: u32| (u64::from(at) * u64::from(mask_side) / u64::from(side)) as u32;
    for (row, line) in pixels.chunks_exact_mut(width as usize).enumerate() {
        let mask_row = place(row as u32, height, mask_height);
        for (column, pixel) in line.iter_mut().enumerate() {
            let brightness = mask.get_pixel(place(column as u32, width, mask_width), mask_row).0[0];
            pixel[3] = ((u32::from(pixel[3]) * u32::from(brightness) + 127) / 255) as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::{Camera, Distortion};
    use glam::DAffine3;
    use image::{GrayImage, RgbaImage};

    #[test]
    fn transparent_colors_have_no_weight() {
        let image = PhotoImage::new([2, 1], vec![[100, 50, 0, 255], [0, 250, 250, 0]]).unwrap();
        assert_eq!(image.bilinear(DVec2::new(0.5, 0.0)), [100.0, 50.0, 0.0, 127.5]);
        assert_eq!(image.bilinear(DVec2::new(1.0, 7.0)), [0.0; 4]);
        assert_eq!(image.bilinear(DVec2::new(-3.0, -3.0)), [100.0, 50.0, 0.0, 255.0]);
        assert_eq!(PhotoImage::new([2, 2], vec![[0; 4]]), None);
    }

    #[test]
    fn masks_are_multiplied_and_sizes_are_checked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        RgbaImage::from_pixel(4, 2, image::Rgba([10, 20, 30, 128]))
            .save(&path)
            .unwrap();
        let mask = folder.path().join("mask.png");
        GrayImage::from_raw(2, 1, vec![255, 0]).unwrap().save(&mask).unwrap();
        let camera = |size_px| Camera::new(size_px, DVec2::ONE, DVec2::ZERO, Distortion::None).unwrap();
        let photo = Photo {
            name: "a".into(),
            path,
            camera: camera([4, 2]),
            camera_from_world: DAffine3::IDENTITY,
            mask: Some(mask),
            depth: None,
            depth_range: None,
        };
        let image = PhotoImage::read(&photo).unwrap();
        let alphas: Vec<u8> = image.pixels().iter().map(|pixel| pixel[3]).collect();
        assert_eq!(alphas, [128, 128, 0, 0, 128, 128, 0, 0]);
        let other = Photo {
            camera: camera([8, 4]),
            ..photo
        };
        let error = PhotoImage::read(&other).unwrap_err().to_string();
        assert!(error.contains("has 4 × 2 pixels, but its camera 8 × 4"), "{error}");
    }
}
