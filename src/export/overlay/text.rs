//! Lines of text in images, in the font of the window.

use super::canvas::OverlayCanvas;
use ab_glyph::{Font as _, FontRef, GlyphId, Point, PxScale, ScaleFont as _};
use epaint_default_fonts::UBUNTU_LIGHT;
use std::sync::OnceLock;

fn font() -> Option<&'static FontRef<'static>> {
    static FONT: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
    FONT.get_or_init(|| FontRef::try_from_slice(UBUNTU_LIGHT).ok()).as_ref()
}

/// A line of text, laid out.
#[derive(Debug, Clone)]
pub(super) struct Line {
    glyphs: Vec<(GlyphId, f32)>,
    scale: PxScale,
    /// Width of the line.
    pub(super) width_px: f32,
    /// From its upper edge to its base line.
    ascent_px: f32,
    /// From its upper edge to its lower one.
    pub(super) height_px: f32,
}

impl Line {
    /// `text` at `size_px`, the height of letters with descenders. Missing glyphs are boxes.
    pub(super) fn new(text: &str, size_px: f32) -> Self {
        let scale = PxScale::from(size_px);
        let mut line = Self {
            glyphs: Vec::new(),
            scale,
            width_px: 0.0,
            ascent_px: 0.0,
            height_px: size_px,
        };
        let Some(font) = font() else { return line };
        let scaled = font.as_scaled(scale);
        line.ascent_px = scaled.ascent();
        let mut before = None;
        for letter in text.chars() {
            let glyph = scaled.glyph_id(letter);
            let kerning = before.map_or(0.0, |before| scaled.kern(before, glyph));
            line.glyphs.push((glyph, line.width_px + kerning));
            line.width_px += kerning + scaled.h_advance(glyph);
            before = Some(glyph);
        }
        line
    }

    /// Draws it with its upper left corner at `at` pixels of the whole image.
    pub(super) fn draw(&self, canvas: &mut OverlayCanvas<'_>, at: [f32; 2], color: [u8; 3]) {
        self.draw_paler(canvas, at, color, 1.0);
    }

    /// [`Line::draw`] with an alpha of 0 to 1.
    pub(super) fn draw_paler(&self, canvas: &mut OverlayCanvas<'_>, at: [f32; 2], color: [u8; 3], alpha: f32) {
        let Some(font) = font() else { return };
        for &(glyph, x) in &self.glyphs {
            let place = Point {
                x: at[0] + x,
                y: at[1] + self.ascent_px,
            };
            let glyph = glyph.with_scale_and_position(self.scale, place);
            if let Some(outline) = font.outline_glyph(glyph) {
                let min = outline.px_bounds().min;
                outline.draw(|x, y, covered| {
                    let px = [min.x as i64 + i64::from(x), min.y as i64 + i64::from(y)];
                    canvas.blend(px, color, alpha * covered);
                });
            }
        }
    }
}
