//! A scale bar in the pixels of an image: a bar with ends and a length, light with a dark outline, so that it is
//! legible on any background.
//!
//! It scales with the image, from its size at 720 rows. Coverage of strokes is by the distance of pixels from them; the
//! outline is the same with wider strokes.

use super::strokes::{Stroke, text_strokes};
use crate::cloud::LengthUnit;
use crate::scene::{Camera, ScaleBar};
use image::{Rgba, RgbaImage};

/// Number of rows of an image with the sizes below, in pixels.
const ROWS: f64 = 720.0;
const MARGIN: f32 = 16.0;
const DIGITS: f32 = 11.0;
const ABOVE_BAR: f32 = 8.0;
const END: f32 = 3.5;
const STROKE: f32 = 1.7;
const RIM: f32 = 1.4;

/// Colours of bar and outline, and opacity of the outline.
const LIGHT: f32 = 245.0;
const DARK: f32 = 20.0;
const RIM_OPACITY: f32 = 0.65;

/// Stroke coverage of a rectangle of pixels.
#[derive(Debug)]
pub(super) struct PaintedBar {
    /// The upper left pixel in the image.
    start_px: [u32; 2],
    size_px: [u32; 2],
    /// Coverage of each pixel by the bar and by its edge, 0 to 255.
    covered: Vec<[u8; 2]>,
}

impl PaintedBar {
    /// The bar for an image; `None` where there is no length, or not enough space.
    pub(super) fn of(camera: &Camera, [width, height]: [u32; 2], unit: Option<LengthUnit>) -> Option<Self> {
        let scale = (f64::from(height) / ROWS).max(0.5);
        let bar = ScaleBar::of(camera, f64::from(height), scale, unit)?;
        let scale = scale as f32;
        let length = bar.length_px as f32;
        let (mut strokes, text_width) = text_strokes(&bar.text(), DIGITS * scale);
        // At pixel centres, so that a thin bar is a single row of them.
        let margin = ((RIM + STROKE) * scale).ceil() + 1.5;
        let baseline = ((DIGITS + ABOVE_BAR) * scale).round();
        for stroke in &mut strokes {
            // Centred above the bar.
            for place in stroke {
                place[0] += 0.5 * (length - text_width);
            }
        }
        let end = END * scale;
        strokes.extend([
            [[0.0, baseline], [length, baseline]],
            [[0.0, baseline - end], [0.0, baseline + end]],
            [[length, baseline - end], [length, baseline + end]],
        ]);
        let leftmost = (0.5 * (length - text_width)).min(0.0);
        for place in strokes.iter_mut().flatten() {
            *place = [place[0] - leftmost + margin, place[1] + margin];
        }
        let widest = length.max(text_width);
        let size_px = [widest + 2.0 * margin, baseline + end + 2.0 * margin].map(|edge| edge.ceil() as u32);
        let left = (MARGIN * scale) as u32;
        let top = height.checked_sub(size_px[1] + left)?;
        (left + size_px[0] <= width).then(|| Self {
            start_px: [left, top],
            size_px,
            covered: covered(&strokes, size_px, scale),
        })
    }

    /// Paints over the rows of an image that begin at `top`.
    pub(super) fn paint(&self, rows: &mut RgbaImage, top: u32) {
        let [left, first] = self.start_px;
        let [width, height] = self.size_px;
        for y in first.max(top)..(first + height).min(top + rows.height()) {
            let covered = &self.covered[((y - first) * width) as usize..][..width as usize];
            for (x, &[bar, rim]) in (left..).zip(covered) {
                let pixel = rows.get_pixel_mut(x, y - top);
                lay_over(pixel, DARK, RIM_OPACITY * f32::from(rim) / 255.0);
                lay_over(pixel, LIGHT, f32::from(bar) / 255.0);
            }
        }
    }
}

/// Lays a gray over straight alpha.
fn lay_over(Rgba(pixel): &mut Rgba<u8>, gray: f32, opacity: f32) {
    let below = f32::from(pixel[3]) / 255.0 * (1.0 - opacity);
    let together = opacity + below;
    if opacity > 0.0 {
        for channel in &mut pixel[..3] {
            let color = gray * opacity + f32::from(*channel) * below;
            *channel = (color / together).round() as u8;
        }
        pixel[3] = (together * 255.0).round() as u8;
    }
}

/// Computes the pixel coverage of strokes and of their edges.
fn covered(strokes: &[Stroke], [width, height]: [u32; 2], scale: f32) -> Vec<[u8; 2]> {
    let mut covered = vec![[0; 2]; (width * height) as usize];
    let radius = (0.5 * STROKE * scale).max(0.5);
    let reaches = [radius, radius + RIM * scale];
    for &[from, to] in strokes {
        let range = |axis: usize, edge: u32| {
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            let low = (low - reaches[1] - 1.0).max(0.0) as u32;
            let high = (high + reaches[1] + 2.0).max(0.0) as u32;
            low..high.min(edge)
        };
        for y in range(1, height) {
            for x in range(0, width) {
                let away = distance([x as f32 + 0.5, y as f32 + 0.5], [from, to]);
                let there = &mut covered[(y * width + x) as usize];
                for (there, reach) in there.iter_mut().zip(reaches) {
                    let share = (reach + 0.5 - away).clamp(0.0, 1.0);
                    *there = (*there).max((255.0 * share) as u8);
                }
            }
        }
    }
    covered
}

/// From a place to a stroke.
fn distance(place: [f32; 2], [from, to]: Stroke) -> f32 {
    let vector = |a: [f32; 2], b: [f32; 2]| glam::Vec2::from_array(b) - glam::Vec2::from_array(a);
    let (along, offset) = (vector(from, to), vector(from, place));
    let share = offset.dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
    offset.distance(along * share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::UpAxis;
    use glam::{DVec3, Vec3};

    fn camera() -> Camera {
        let bounds = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        Camera::framing(&bounds, DVec3::ZERO, UpAxis::Z)
    }

    /// The longest row of the image that is as light as the bar.
    fn longest_light_row(picture: &RgbaImage) -> usize {
        let rows = picture.rows().map(|row| {
            let light: Vec<bool> = row.map(|pixel| pixel.0[0] > 200).collect();
            let runs = light.split(|is_light| !is_light).map(<[bool]>::len);
            runs.max().unwrap_or(0)
        });
        rows.max().unwrap_or(0)
    }

    #[test]
    fn the_bar_has_the_stated_length_at_any_image_size() {
        for size in [[640, 360], [1280, 720], [3000, 2160]] {
            let scale = f64::from(size[1]) / ROWS;
            let bar = ScaleBar::of(&camera(), f64::from(size[1]), scale, None).unwrap();
            let painted = PaintedBar::of(&camera(), size, None).unwrap();
            let mut picture = RgbaImage::from_pixel(size[0], size[1], Rgba([0, 0, 0, 255]));
            painted.paint(&mut picture, 0);
            let length = longest_light_row(&picture) as f64;
            // Round caps extend by half a stroke.
            let reach = f64::from(STROKE) * scale + 1.0;
            assert!(
                (length - bar.length_px - reach).abs() <= reach,
                "{size:?}: {length} {bar:?}"
            );
            assert!(picture.pixels().all(|pixel| pixel.0[3] == 255));
        }
    }

    #[test]
    fn the_bar_is_painted_in_strips_and_opaque_on_transparent_images() {
        let (size, painted) = ([640, 360], PaintedBar::of(&camera(), [640, 360], None).unwrap());
        let mut whole = RgbaImage::new(size[0], size[1]);
        painted.paint(&mut whole, 0);
        assert!(whole.pixels().any(|pixel| pixel.0 == [245, 245, 245, 255]));
        assert_eq!(whole.get_pixel(0, 0).0, [0; 4]);
        for top in (0..360).step_by(7) {
            let mut strip = RgbaImage::new(size[0], 7.min(360 - top));
            painted.paint(&mut strip, top);
            for (x, y, pixel) in strip.enumerate_pixels() {
                assert_eq!(pixel, whole.get_pixel(x, y + top));
            }
        }
    }

    #[test]
    fn small_images_have_no_scale_bar() {
        for size in [[1, 1], [90, 720], [1280, 20]] {
            assert!(PaintedBar::of(&camera(), size, None).is_none(), "{size:?}");
        }
    }
}
