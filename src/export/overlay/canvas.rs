//! Rows of an image with an overlay.

use image::{Rgba, RgbaImage};

/// Some rows of an image.
#[derive(Debug)]
pub(in crate::export) struct OverlayCanvas<'a> {
    /// The rows.
    pub(in crate::export) rows: &'a mut RgbaImage,
    /// Row offset: the number of rows of the whole image above this strip.
    pub(in crate::export) top_px: u32,
    /// Width and height of the whole image.
    pub(in crate::export) whole_px: [u32; 2],
}

impl OverlayCanvas<'_> {
    /// Blends `color` over a pixel of the whole image, with an alpha of 0 to 1. Pixels outside of the rows are ignored.
    pub(super) fn blend(&mut self, [x, y]: [i64; 2], color: [u8; 3], alpha: f32) {
        let place = u32::try_from(x)
            .ok()
            .zip(u32::try_from(y - i64::from(self.top_px)).ok());
        let pixel = place.and_then(|(x, y)| self.rows.get_pixel_mut_checked(x, y));
        if let Some(Rgba(pixel)) = pixel {
            *pixel = over(*pixel, color, alpha.clamp(0.0, 1.0));
        }
    }

    /// Fills a disk; pixels at its edge are covered in part.
    pub(super) fn disk(&mut self, [x, y]: [f32; 2], radius: f32, color: [u8; 3], alpha: f32) {
        let reach = radius + 1.0;
        let rows = (y - reach).floor().max(self.top_px as f32) as i64
            ..(y + reach).ceil().min((self.top_px + self.rows.height()) as f32) as i64;
        for row in rows {
            for column in (x - reach).floor() as i64..(x + reach).ceil() as i64 {
                let away = (column as f32 + 0.5 - x).hypot(row as f32 + 0.5 - y);
                self.blend([column, row], color, alpha * (radius + 0.5 - away).clamp(0.0, 1.0));
            }
        }
    }

    /// Fills pixels from `min` to before `max`; edges within pixels cover them in part.
    pub(super) fn fill(&mut self, min: [f32; 2], max: [f32; 2], color: [u8; 3], alpha: f32) {
        let covered = |pixel: i64, axis: usize| {
            let [begin, end] = [pixel as f32, pixel as f32 + 1.0];
            (end.min(max[axis]) - begin.max(min[axis])).clamp(0.0, 1.0)
        };
        let first_row = min[1].floor().max(self.top_px as f32) as i64;
        let last_row = max[1].ceil().min((self.top_px + self.rows.height()) as f32) as i64;
        for y in first_row..last_row {
            for x in min[0].floor() as i64..max[0].ceil() as i64 {
                self.blend([x, y], color, alpha * covered(x, 0) * covered(y, 1));
            }
        }
    }
}

/// `color` with `alpha` over a pixel of straight alpha.
fn over(below: [u8; 4], color: [u8; 3], alpha: f32) -> [u8; 4] {
    let alpha_below = f32::from(below[3]) / 255.0 * (1.0 - alpha);
    let sum = alpha + alpha_below;
    if sum <= 0.0 {
        return below;
    }
    let channel = |channel: usize| {
        let mixed = f32::from(color[channel]) * alpha + f32::from(below[channel]) * alpha_below;
        (mixed / sum).round() as u8
    };
    [channel(0), channel(1), channel(2), (sum * 255.0).round() as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_blended_over_the_image() {
        assert_eq!(over([10, 20, 30, 255], [90, 100, 110], 1.0), [90, 100, 110, 255]);
        assert_eq!(over([10, 20, 30, 255], [90, 100, 110], 0.0), [10, 20, 30, 255]);
        assert_eq!(over([10, 20, 30, 255], [90, 100, 110], 0.5), [50, 60, 70, 255]);
        assert_eq!(over([0; 4], [90, 100, 110], 0.5), [90, 100, 110, 128]);
        assert_eq!(over([7; 4], [90, 100, 110], 0.0)[3], 7);
    }

    #[test]
    fn edges_within_pixels_cover_them_partially() {
        let mut image = RgbaImage::from_pixel(4, 3, Rgba([0, 0, 0, 255]));
        let mut canvas = OverlayCanvas {
            rows: &mut image,
            top_px: 10,
            whole_px: [4, 100],
        };
        canvas.fill([1.0, 0.0], [2.5, 11.25], [200; 3], 1.0);
        let red = |x, y| image.get_pixel(x, y).0[0];
        assert_eq!([red(0, 0), red(1, 0), red(2, 0), red(3, 0)], [0, 200, 100, 0]);
        assert_eq!([red(1, 1), red(2, 1), red(1, 2)], [50, 25, 0]);
    }
}
