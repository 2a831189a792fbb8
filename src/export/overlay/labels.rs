//! Labels in an image, as in the window: a dot at the point, and the text next to it.
//!
//! How it works: labels are laid out once for the whole image, then each strip draws its rows of them. Those whose
//! points are hidden come first, dimmed, so that they never lie over others.

use super::canvas::OverlayCanvas;
use super::text::Line;
use crate::scene::LabelOnPicture;
use image::RgbaImage;

/// Draws labels with their texts over a whole image, as exports have them.
pub fn draw_labels(picture: &mut RgbaImage, labels: &[(LabelOnPicture, String)]) {
    let whole_px = picture.dimensions().into();
    let mut canvas = OverlayCanvas {
        rows: picture,
        top_px: 0,
        whole_px,
    };
    PaintedLabels::of(labels, whole_px).draw(&mut canvas);
}

/// Height of an image with the lengths below.
const USUAL_HEIGHT_PX: f32 = 720.0;

/// Lengths in an image of that height, pixels.
const TEXT: f32 = 15.0;
const DOT_RADIUS: f32 = 3.5;
const RIM: f32 = 1.2;
/// From the point to the lower left corner of the text's ground.
const ASIDE: f32 = 7.0;
const PADDING: [f32; 2] = [5.0, 2.0];

const WHITE: [u8; 3] = [255; 3];
const BLACK: [u8; 3] = [0; 3];
/// Colour of the dot.
const TINT: [u8; 3] = [255, 190, 60];
/// Opacity of the text background.
const GROUND_ALPHA: f32 = 0.72;
/// Opacity factor of hidden labels.
const DIMMED: f32 = 0.35;

/// Labels that are laid out.
#[derive(Debug)]
pub(in crate::export) struct PaintedLabels {
    labels: Vec<Painted>,
    unit: f32,
}

#[derive(Debug)]
struct Painted {
    /// Position of its point.
    at: [f32; 2],
    line: Line,
    opacity: f32,
}

impl PaintedLabels {
    /// Lays out the labels of an image of `size_px`; labels that would be far outside of it are omitted.
    pub(in crate::export) fn of(labels: &[(LabelOnPicture, String)], size_px: [u32; 2]) -> Self {
        let [width, height] = size_px.map(|edge| edge as f32);
        // Readable in small images too.
        let unit = (height.min(width) / USUAL_HEIGHT_PX).max(0.6);
        let is_near = |label: &LabelOnPicture| {
            let [x, y] = [label.px.x as f32, label.px.y as f32];
            (-width..2.0 * width).contains(&x) && (-height..2.0 * height).contains(&y)
        };
        let near = labels.iter().filter(|(label, _)| is_near(label));
        let painted = near.map(|(label, text)| Painted {
            at: [label.px.x as f32, label.px.y as f32],
            line: Line::new(text, TEXT * unit),
            opacity: if label.is_hidden { DIMMED } else { 1.0 },
        });
        let mut labels: Vec<Painted> = painted.collect();
        labels.sort_by(|a, b| a.opacity.total_cmp(&b.opacity));
        Self { labels, unit }
    }

    /// Draws the part of them that is in these rows.
    pub(in crate::export) fn draw(&self, canvas: &mut OverlayCanvas<'_>) {
        let unit = self.unit;
        for Painted { at, line, opacity } in &self.labels {
            canvas.disk(*at, (DOT_RADIUS + RIM) * unit, BLACK, 0.8 * opacity);
            canvas.disk(*at, DOT_RADIUS * unit, TINT, *opacity);
            if line.width_px == 0.0 {
                continue;
            }
            let [left, bottom] = [at[0] + ASIDE * unit, at[1] - ASIDE * unit];
            let padding = PADDING.map(|length| length * unit);
            let text = [left + padding[0], bottom - padding[1] - line.height_px];
            let min = [left, text[1] - padding[1]];
            let max = [text[0] + line.width_px + padding[0], bottom];
            canvas.fill(min, max, BLACK, GROUND_ALPHA * opacity);
            line.draw_paler(canvas, text, WHITE, *opacity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use image::{Rgba, RgbaImage};

    const GRAY: Rgba<u8> = Rgba([90, 90, 90, 255]);

    fn label(px: [f64; 2], is_hidden: bool, text: &str) -> (LabelOnPicture, String) {
        let px = DVec2::from_array(px);
        let on_picture = LabelOnPicture {
            label: 0,
            px,
            is_hidden,
        };
        (on_picture, text.to_owned())
    }

    fn drawn(labels: &[(LabelOnPicture, String)], size: [u32; 2], strip_rows: u32) -> RgbaImage {
        let painted = PaintedLabels::of(labels, size);
        let mut whole = RgbaImage::from_pixel(size[0], size[1], GRAY);
        for top_px in (0..size[1]).step_by(strip_rows as usize) {
            let height = strip_rows.min(size[1] - top_px);
            let mut rows = image::imageops::crop_imm(&whole, 0, top_px, size[0], height).to_image();
            let mut canvas = OverlayCanvas {
                rows: &mut rows,
                top_px,
                whole_px: size,
            };
            painted.draw(&mut canvas);
            image::imageops::replace(&mut whole, &rows, 0, i64::from(top_px));
        }
        whole
    }

    #[test]
    fn strips_match_the_full_image_and_text_is_next_to_its_point() {
        let labels = [
            label([200.3, 150.7], false, "Knee"),
            label([40.0, 300.0], true, "hidden"),
        ];
        let whole = drawn(&labels, [640, 480], 480);
        assert_eq!(drawn(&labels, [640, 480], 7), whole);
        let changed = |left: u32, top: u32, right: u32, bottom: u32| {
            let pixels = whole.enumerate_pixels();
            let within = pixels.filter(|(x, y, _)| (left..right).contains(x) && (top..bottom).contains(y));
            within.filter(|(_, _, pixel)| **pixel != GRAY).count()
        };
        assert!(changed(206, 120, 260, 146) > 300, "the ground of the text");
        assert_eq!(changed(0, 0, 190, 270), 0);
        assert_eq!(whole.get_pixel(200, 150), &Rgba([255, 190, 60, 255]));
    }

    #[test]
    fn the_dot_is_where_its_point_is() {
        for px in [[100.5, 80.5], [100.9, 80.1], [99.0, 81.25]] {
            let picture = drawn(&[label(px, false, "")], [300, 200], 200);
            // The missing blue of the dot measures how much of a pixel it covers; its outline is symmetric too.
            let (mut sum, mut center) = (0.0, DVec2::ZERO);
            for (x, y, pixel) in picture.enumerate_pixels() {
                let weight = f64::from(GRAY.0[2].abs_diff(pixel.0[2]));
                sum += weight;
                center += weight * DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            }
            let center = center / sum;
            assert!((center - DVec2::from_array(px)).length() < 0.1, "{center} for {px:?}");
        }
    }

    #[test]
    fn hidden_labels_are_paler_and_labels_outside_do_not_fail() {
        let shown = drawn(&[label([50.5, 50.5], false, "a")], [200, 100], 100);
        let hidden = drawn(&[label([50.5, 50.5], true, "a")], [200, 100], 100);
        let red = |picture: &RgbaImage| picture.get_pixel(50, 50).0[0];
        assert!(
            red(&hidden) > GRAY.0[0] && red(&hidden) < red(&shown),
            "{}",
            red(&hidden)
        );
        let outside = [[-5.0, 50.0], [1e9, -1e12], [f64::NAN, 0.0], [203.0, 99.0]];
        let outside = outside.map(|px| label(px, false, &"long ".repeat(40)));
        drawn(&outside, [200, 100], 100);
        drawn(&outside, [1, 1], 1);
    }
}
