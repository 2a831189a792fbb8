//! The legend at the upper right of an image, as in the window.

use super::canvas::OverlayCanvas;
use super::text::Line;
use crate::scene::{Legend, LegendBody};

/// Height of an image with the lengths below.
const USUAL_HEIGHT_PX: f32 = 720.0;

const WHITE: [u8; 3] = [255; 3];

/// Lengths in an image of that height, pixels.
const TEXT: f32 = 15.0;
const ROW: f32 = 20.0;
const MARGIN: f32 = 14.0;
const PADDING: f32 = 10.0;
const RAMP_WIDTH: f32 = 18.0;
const RAMP_HEIGHT: f32 = 220.0;
const GAP: f32 = 10.0;

/// Draws the part of a legend that is in these rows.
pub(in crate::export) fn draw_legend(canvas: &mut OverlayCanvas<'_>, legend: &Legend) {
    let [width, height] = canvas.whole_px.map(|edge| edge as f32);
    // Readable in small images too, where there is space for it.
    let unit = (height.min(width) / USUAL_HEIGHT_PX).max(0.6);
    let title = Line::new(&legend.title, 1.1 * TEXT * unit);
    let line = |text: &String| Line::new(text, TEXT * unit);
    let rows: Vec<Line> = match &legend.body {
        LegendBody::Ramp { ticks, .. } => ticks.iter().map(|(_, text)| line(text)).collect(),
        LegendBody::Classes(classes) => classes.iter().map(|(_, text)| line(text)).collect(),
    };
    let widest = rows.iter().map(|row| row.width_px).fold(0.0, f32::max);
    let head = title.height_px + 0.6 * GAP * unit;
    let space = (height - 2.0 * (MARGIN + PADDING) * unit - head).max(1.0);
    let body = match &legend.body {
        LegendBody::Ramp { .. } => RAMP_HEIGHT * unit,
        LegendBody::Classes(classes) => ROW * unit * classes.len() as f32,
    };
    let body = body.min(space);
    let inner = title.width_px.max((RAMP_WIDTH + GAP) * unit + widest);
    let right = width - MARGIN * unit;
    let left = right - inner - 2.0 * PADDING * unit;
    let top = MARGIN * unit;
    let bottom = top + head + body + 2.0 * PADDING * unit;
    canvas.fill([left, top], [right, bottom], [0; 3], 0.62);
    let (left, top) = (left + PADDING * unit, top + PADDING * unit);
    title.draw(canvas, [left, top], WHITE);
    // Snapped to whole pixels, so that each row has a single colour.
    let (bar_left, bar_top) = (left.round(), (top + head).round());
    let body = body.round().max(1.0);
    let bar_right = bar_left + (RAMP_WIDTH * unit).round();
    let bar = [bar_left, bar_top, bar_right, bar_top + body];
    match &legend.body {
        LegendBody::Ramp { map, ticks } => {
            let first = bar[1].floor() as i64;
            for row in first..bar[3].ceil() as i64 {
                let share = 1.0 - (row as f32 + 0.5 - bar[1]) / body;
                let [red, green, blue, _] = map.color(share);
                let [begin, end] = [(row as f32).max(bar[1]), (row as f32 + 1.0).min(bar[3])];
                canvas.fill([bar[0], begin], [bar[2], end], [red, green, blue], 1.0);
            }
            for ((share, _), row) in ticks.iter().zip(&rows) {
                let y = bar[3] - body * share;
                let half = 0.5 * unit;
                canvas.fill([bar[2], y - half], [bar[2] + 4.0 * unit, y + half], WHITE, 1.0);
                row.draw(canvas, [bar[2] + GAP * unit, y - 0.5 * row.height_px], WHITE);
            }
        }
        LegendBody::Classes(classes) => {
            let step = body / classes.len().max(1) as f32;
            for (place, ((color, _), row)) in classes.iter().zip(&rows).enumerate() {
                let midpoint = bar[1] + step * (place as f32 + 0.5);
                let half = 0.5 * (step - 4.0 * unit).clamp(1.0, RAMP_WIDTH * unit);
                let [red, green, blue, alpha] = *color;
                let center = 0.5 * (bar[0] + bar[2]);
                canvas.fill(
                    [center - half, midpoint - half],
                    [center + half, midpoint + half],
                    [red, green, blue],
                    f32::from(alpha) / 255.0,
                );
                row.draw(canvas, [bar[2] + GAP * unit, midpoint - 0.5 * row.height_px], WHITE);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::ColorMap;
    use image::{Rgba, RgbaImage};

    fn ramp() -> Legend {
        Legend {
            title: "Height".to_owned(),
            body: LegendBody::Ramp {
                map: ColorMap::Turbo,
                ticks: vec![(0.0, "0".to_owned()), (1.0, "120".to_owned())],
            },
        }
    }

    fn drawn(legend: &Legend, size: [u32; 2], strip_rows: u32) -> RgbaImage {
        let mut whole = RgbaImage::from_pixel(size[0], size[1], Rgba([40, 50, 60, 255]));
        for top_px in (0..size[1]).step_by(strip_rows as usize) {
            let height = strip_rows.min(size[1] - top_px);
            let strip = image::imageops::crop_imm(&whole, 0, top_px, size[0], height);
            let mut rows = strip.to_image();
            let mut canvas = OverlayCanvas {
                rows: &mut rows,
                top_px,
                whole_px: size,
            };
            draw_legend(&mut canvas, legend);
            image::imageops::replace(&mut whole, &rows, 0, i64::from(top_px));
        }
        whole
    }

    #[test]
    fn strips_match_the_full_image() {
        let whole = drawn(&ramp(), [640, 480], 480);
        assert_eq!(drawn(&ramp(), [640, 480], 7), whole);
        assert_ne!(whole.get_pixel(600, 40), &Rgba([40, 50, 60, 255]));
        assert_eq!(
            whole.get_pixel(20, 240),
            &Rgba([40, 50, 60, 255]),
            "the rest is left alone"
        );
    }

    #[test]
    fn a_ramp_shows_its_whole_map_upright_with_white_numbers() {
        let picture = drawn(&ramp(), [1280, 720], 720);
        // A column through the bar: the left edge of the box is where pixels first change.
        let is_map = |share: f32| {
            let [red, green, blue, _] = ColorMap::Turbo.color(share);
            picture
                .enumerate_pixels()
                .find(|(_, _, pixel)| pixel.0 == [red, green, blue, 255])
        };
        let (_, low, _) = is_map(0.5 / 220.0).unwrap();
        let (_, high, _) = is_map(1.0 - 0.5 / 220.0).unwrap();
        assert_eq!(low - high, 219, "last colour on top");
        // Letters are thin: their pixels are partly covered.
        let is_bright = |pixel: &Rgba<u8>| pixel.0[..3].iter().all(|&channel| channel > 180);
        let right_of_bar = picture.enumerate_pixels().filter(|(x, ..)| *x > 1240);
        assert!(right_of_bar.filter(|(_, _, pixel)| is_bright(pixel)).count() > 20);
    }

    #[test]
    fn classes_have_their_colors_and_tiny_images_do_not_fail() {
        let entry = |class: u8| ([class, 0, 200, 255], format!("{class}  Something"));
        let legend = Legend {
            title: "Classification".to_owned(),
            body: LegendBody::Classes((0..20).map(entry).collect()),
        };
        let picture = drawn(&legend, [1280, 720], 720);
        for class in 0..20 {
            let (color, _) = entry(class);
            assert!(picture.pixels().any(|pixel| pixel.0 == color), "{class}");
        }
        for size in [[1, 1], [30, 2000], [2000, 3]] {
            drawn(&legend, size, size[1]);
            drawn(&ramp(), size, size[1]);
        }
    }
}
