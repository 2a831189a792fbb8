//! Images of any size, opaque or with alpha.
//!
//! **How it works.** The records of an image are chosen once, for all of it. An image larger than 4096² pixels (or the
//! largest texture) is drawn in tiles, each with an off-axis frustum of the same camera, and written strip by strip: a
//! strip of tiles takes a quarter of a GiB at most, however large the image is.
//!
//! Where eye-dome lighting and ambient occlusion look at neighbours, tiles have a margin of that radius: no seams are
//! visible.
//!
//! *Alpha* is found by drawing each tile on black and on white. A coverage of `alpha` by the colour `c` leaves `alpha ·
//! c` on black and `alpha · c + 1 - alpha` on white, in every mode and by every renderer.

use super::error::ExportError;
use super::limits::MAX_EDGE_PX;
use super::overlay::{OverlayCanvas, PaintedLabels, draw_legend};
use super::picture_format::{PictureFormat, encode_picture};
use super::scale_bar::PaintedBar;
use crate::headless::{Headless, HeadlessError};
use crate::persist::Partial;
use crate::progress::Progress;
use crate::render::{AnyRenderer, RenderError, scaled_to};
use crate::scene::{Background, Camera, Legend, ScenePacket, Style, halo_px};
use crate::sequence::PreparedFrame;
use image::{RgbaImage, imageops};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Longest edge of a part: its targets take a quarter of a GiB on the GPU.
// Images rendered in parts match the whole image to 60 dB, or 35 dB for byte codes as masks, which are made for sectors
// of the image.
const MAX_PART_EDGE_PX: u32 = 4096;

/// Bytes of a strip of parts.
const MAX_STRIP_BYTES: u32 = 1 << 28;

/// Image size, and the background behind the cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureSize {
    /// Width and height.
    pub size_px: [u32; 2],
    /// True for a transparent background: straight alpha instead of [`Style::backdrop`].
    pub is_transparent: bool,
    /// True if a legend of the colours is drawn over the image, where they are numbers or classes.
    pub has_legend: bool,
    /// A bar of a round length is at the lower left.
    pub has_scale_bar: bool,
    /// Max edge of a tile; `None` for the renderer's default.
    pub part_edge_px: Option<u32>,
}

impl PictureSize {
    /// An opaque image.
    pub fn opaque(size_px: [u32; 2]) -> Self {
        Self {
            size_px,
            is_transparent: false,
            has_legend: false,
            has_scale_bar: false,
            part_edge_px: None,
        }
    }

    /// Without the halo that is drawn around a part.
    fn largest_part_px(&self, renderer: &AnyRenderer, packet: &ScenePacket) -> [u32; 2] {
        let samples = packet.style.drawing.antialiasing.samples_per_edge();
        let edge = self.part_edge_px.unwrap_or(MAX_PART_EDGE_PX / samples);
        let max = (renderer.max_edge_px() / samples).saturating_sub(2 * halo_px(packet));
        let edge = edge.clamp(1, max.max(1));
        let rows = MAX_STRIP_BYTES / (4 * self.size_px[0]);
        [edge, edge.min(rows.max(1))]
    }
}

/// Contents of an image and its render settings.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// The frame, composed.
    pub frame: &'a PreparedFrame,
    /// From where it is seen.
    pub camera: &'a Camera,
    /// Render style.
    pub style: &'a Style,
    /// Image size and background.
    pub size: PictureSize,
}

/// Draws an image whole.
///
/// # Errors
/// Sizes beyond [`MAX_EDGE_PX`], and errors of the renderer.
pub fn draw_picture(headless: &mut Headless, picture: &Picture<'_>) -> Result<RgbaImage, ExportError> {
    draw_observed(headless, picture, &Progress::default())
}

fn draw_observed(
    headless: &mut Headless,
    picture: &Picture<'_>,
    progress: &Progress,
) -> Result<RgbaImage, ExportError> {
    let mut pixels = Vec::new();
    let take = &mut |strip: RgbaImage| {
        pixels.extend_from_slice(&strip);
        Ok(())
    };
    for_each_strip(headless, picture, take, progress)?;
    let [width, height] = picture.size.size_px;
    Ok(RgbaImage::from_raw(width, height, pixels).unwrap_or_default())
}

/// Draws an image to a file in the format of its name, replacing the file as a whole.
///
/// # Errors
/// As [`draw_picture`], names and images that [`PictureFormat`] refuses, and failures to write the file.
pub fn write_picture(headless: &mut Headless, picture: &Picture<'_>, output: &Path) -> Result<(), ExportError> {
    write_picture_observed(headless, picture, output, &Progress::default())
}

/// [`write_picture`], where `progress` counts the parts that are drawn, and may be cancelled.
///
/// # Errors
/// As [`write_picture`], and [`ExportError::Cancelled`]. Nothing is left of the file then.
pub fn write_picture_observed(
    headless: &mut Headless,
    picture: &Picture<'_>,
    output: &Path,
    progress: &Progress,
) -> Result<(), ExportError> {
    let size = picture.size;
    check_size(size.size_px)?;
    let failed = |reason: io::Error| ExportError::Write {
        path: output.to_owned(),
        reason,
    };
    let format = PictureFormat::of_name(output)?;
    format.check(size.size_px, size.is_transparent)?;
    let (partial, file) = Partial::create(output).map_err(failed)?;
    // Only PNG is written row by row: the other formats are encoded from the whole image, so their dimensions are
    // limited.
    if format == PictureFormat::Png {
        stream_png(headless, picture, file, output, progress)?;
    } else {
        let image = draw_observed(headless, picture, progress)?;
        let mut file = BufWriter::new(file);
        encode_picture(format, &image, &mut file)
            .and_then(|()| file.flush())
            .map_err(failed)?;
    }
    partial.finish().map_err(failed)
}

/// Draws an image as PNG to `out`, which is named `name` in errors.
///
/// # Errors
/// As [`draw_picture`], and if it cannot be written.
pub fn write_png(
    headless: &mut Headless,
    picture: &Picture<'_>,
    out: impl Write,
    name: &Path,
) -> Result<(), ExportError> {
    check_size(picture.size.size_px)?;
    stream_png(headless, picture, out, name, &Progress::default())
}

/// Writes strips as they are drawn.
fn stream_png(
    headless: &mut Headless,
    picture: &Picture<'_>,
    out: impl Write,
    name: &Path,
    progress: &Progress,
) -> Result<(), ExportError> {
    let failed = |reason: io::Error| ExportError::Write {
        path: name.to_owned(),
        reason,
    };
    let mut out = BufWriter::new(out);
    let mut encoder = start_png(&mut out, picture.size.size_px).map_err(failed)?;
    let mut png = encoder.stream_writer().map_err(io::Error::from).map_err(failed)?;
    let take = &mut |strip: RgbaImage| png.write_all(&strip).map_err(failed);
    for_each_strip(headless, picture, take, progress)?;
    png.finish().map_err(io::Error::from).map_err(failed)?;
    encoder.finish().map_err(io::Error::from).map_err(failed)?;
    // Dropping a writer would hide the error if its last bytes do not fit on the disk.
    out.flush().map_err(failed)
}

fn start_png<W: Write>(out: W, [width, height]: [u32; 2]) -> io::Result<png::Writer<W>> {
    // Strip by strip: the `image` crate needs the whole image.
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    Ok(encoder.write_header()?)
}

/// Refuses edges of zero, and beyond [`MAX_EDGE_PX`].
pub fn check_size([width, height]: [u32; 2]) -> Result<(), ExportError> {
    let is_fine = |edge| (1..=MAX_EDGE_PX).contains(&edge);
    let is_fine = is_fine(width) && is_fine(height);
    is_fine.then_some(()).ok_or(ExportError::PictureSize { width, height })
}

type TakeStrip<'a> = &'a mut dyn FnMut(RgbaImage) -> Result<(), ExportError>;

/// Draws strips of an image from its upper edge to its lower one.
fn for_each_strip(
    headless: &mut Headless,
    picture: &Picture<'_>,
    take: TakeStrip<'_>,
    progress: &Progress,
) -> Result<(), ExportError> {
    let Picture {
        frame,
        camera,
        style,
        size,
    } = *picture;
    let size_px @ [width, height] = size.size_px;
    check_size(size_px)?;
    let mut style = *style;
    if size.is_transparent {
        style.drawing.antialiasing = style.drawing.antialiasing.without_background();
    }
    let packet = headless.packet(frame, camera, &style, size_px);
    let halo_px = halo_px(&packet);
    let [part_width, part_height] = size.largest_part_px(headless.renderer(), &packet);
    let legend = match headless.screen_stats().and_then(|stats| stats.errors) {
        Some(errors) => Some(Legend::of_errors(&errors)),
        None => Legend::of(frame),
    };
    let legend = legend.filter(|_| size.has_legend);
    let unit = frame.frame.unit();
    let bar = size
        .has_scale_bar
        .then(|| PaintedBar::of(camera, size_px, unit))
        .flatten();
    let labels = headless.labels_on(frame.index, &style, camera, &packet, size_px);
    let labels = PaintedLabels::of(&labels, size_px);
    let mut take = |mut strip: RgbaImage, top: u32| {
        let mut canvas = OverlayCanvas {
            rows: &mut strip,
            top_px: top,
            whole_px: size_px,
        };
        labels.draw(&mut canvas);
        if let Some(bar) = &bar {
            bar.paint(&mut strip, top);
        }
        if let Some(legend) = &legend {
            let mut canvas = OverlayCanvas {
                rows: &mut strip,
                top_px: top,
                whole_px: size_px,
            };
            draw_legend(&mut canvas, legend);
        }
        take(strip)
    };
    let [drawn_width, drawn_height] = packet.viewport_px;
    if drawn_width <= part_width && drawn_height <= part_height {
        let image = draw_part(headless, &packet, size.is_transparent)?;
        take(scaled_to(image, size_px), 0)?;
        return note_part(progress, 1, 1);
    }
    if packet.viewport_px != size_px {
        return Err(ExportError::ScaledParts { width, height });
    }
    let total = width.div_ceil(part_width) as usize * height.div_ceil(part_height) as usize;
    let mut drawn = 0;
    for top in (0..height).step_by(part_height as usize) {
        let rows = part_height.min(height - top);
        let mut strip = RgbaImage::new(width, rows);
        for left in (0..width).step_by(part_width as usize) {
            let columns = part_width.min(width - left);
            let part = PictureTile::with_halo([left, top], [columns, rows], size_px, halo_px);
            // Only matrix, frustum, per-fragment light and gradient depend on the part: records are selected and
            // uploaded once.
            let packet = packet.part(part.start, part.size);
            let image = draw_part(headless, &packet, size.is_transparent)?;
            let [inset_x, inset_y] = part.inset;
            let image = imageops::crop_imm(&image, inset_x, inset_y, columns, rows);
            imageops::replace(&mut strip, &*image, i64::from(left), 0);
            drawn += 1;
            note_part(progress, drawn, total)?;
        }
        take(strip, top)?;
    }
    Ok(())
}

/// A tile of an image as it is drawn, in pixels: with the margin that its pixels depend on.
struct PictureTile {
    /// Its upper left pixel.
    start: [u32; 2],
    size: [u32; 2],
    /// Offset of the requested area within the tile.
    inset: [u32; 2],
}

impl PictureTile {
    fn with_halo(start: [u32; 2], size: [u32; 2], whole: [u32; 2], halo: u32) -> Self {
        let inset = start.map(|start| start.min(halo));
        let end = |axis: usize| (start[axis] + size[axis] + halo).min(whole[axis]);
        let first = |axis: usize| start[axis] - inset[axis];
        Self {
            start: [first(0), first(1)],
            size: [end(0) - first(0), end(1) - first(1)],
            inset,
        }
    }
}

/// Reports the number of drawn tiles. Fails once the export is cancelled.
fn note_part(progress: &Progress, drawn: usize, total: usize) -> Result<(), ExportError> {
    progress.set(drawn, total);
    if progress.is_cancelled() {
        return Err(ExportError::Cancelled);
    }
    Ok(())
}

fn draw_part(headless: &mut Headless, packet: &ScenePacket, is_transparent: bool) -> Result<RgbaImage, ExportError> {
    let mut draw = |packet: &ScenePacket| {
        let drawn = headless.draw_packet(packet);
        drawn.map_err(|reason: RenderError| HeadlessError::from(reason))
    };
    if !is_transparent {
        return Ok(draw(packet)?);
    }
    let mut on = |gray: u8| {
        let mut packet = packet.clone();
        packet.style.backdrop.background = Background::solid([gray; 3]);
        draw(&packet)
    };
    // Drawing twice needs no support for alpha in any pass, and is correct in all of them.
    let (mut on_black, on_white) = (on(0)?, on(255)?);
    for (pixel, white) in on_black.pixels_mut().zip(on_white.pixels()) {
        pixel.0 = with_alpha(pixel.0, white.0);
    }
    Ok(on_black)
}

/// The colour and alpha of a pixel, from its colours on black and on white.
fn with_alpha(black: [u8; 4], white: [u8; 4]) -> [u8; 4] {
    let shines_through: u32 = (0..3)
        .map(|channel| u32::from(white[channel].saturating_sub(black[channel])))
        .sum();
    // Rounded to the nearest third.
    let alpha = 255 - (shines_through + 1) / 3;
    if alpha == 0 {
        return [0; 4];
    }
    let color = |channel: usize| ((u32::from(black[channel]) * 255 + alpha / 2) / alpha).min(255);
    [color(0), color(1), color(2), alpha].map(|channel| channel as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_is_computed_from_black_and_white_backgrounds() {
        assert_eq!(with_alpha([0, 0, 0, 255], [255, 255, 255, 255]), [0; 4]);
        assert_eq!(with_alpha([9, 80, 200, 255], [9, 80, 200, 255]), [9, 80, 200, 255]);
        // Half-transparent: 0.5 · c, and the same plus 0.5 · white.
        assert_eq!(with_alpha([50, 100, 0, 255], [178, 228, 128, 255]), [100, 201, 0, 127]);
    }

    #[test]
    fn compositing_over_any_color_reproduces_the_drawn_image() {
        for alpha in 0..=255u32 {
            for color in [0, 1, 77, 200, 255u32] {
                let over = |behind: u32| ((color * alpha + behind * (255 - alpha)) as f32 / 255.0).round();
                let pixel = |behind: u32| [over(behind) as u8, over(behind) as u8, over(behind) as u8, 255];
                let [seen, .., found] = with_alpha(pixel(0), pixel(255));
                let again = (u32::from(seen) * u32::from(found) + 119 * (255 - u32::from(found))) as f32 / 255.0;
                assert!((again - over(119)).abs() <= 1.51, "{color} at {alpha}");
            }
        }
    }
}
