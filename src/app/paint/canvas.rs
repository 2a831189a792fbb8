//! The pixels that are painted to.

use super::PixelRect;

/// Some whole rows of the window.
#[derive(Debug)]
pub(super) struct Canvas<'a> {
    pub(super) pixels: &'a mut [u32],
    pub(super) width_px: u32,
    pub(super) first_row: u32,
}

impl Canvas<'_> {
    /// The pixels of a row from one column to before another.
    #[inline(always)]
    pub(super) fn span(&mut self, y: u32, from: u32, to: u32) -> &mut [u32] {
        let begin = self.width_px as usize * (y - self.first_row) as usize;
        &mut self.pixels[begin + from as usize..begin + to as usize]
    }

    /// Returns the row spans of a rectangle.
    #[inline(always)]
    pub(super) fn spans(&mut self, area: &PixelRect) -> impl Iterator<Item = &mut [u32]> {
        let [width, height] = area.size_px().map(|edge| edge as usize);
        let width_px = self.width_px as usize;
        let begin = width_px * (area.min[1] - self.first_row) as usize + area.min[0] as usize;
        let rows = self.pixels[begin..].chunks_mut(width_px).take(height);
        rows.map(move |row| &mut row[..width])
    }
}
