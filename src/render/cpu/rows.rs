//! Rows of tiles of the results for an image: each is the work of one task.

use super::photos::PhotoAnswer;
use super::tile::HEIGHT;
use crate::scene::ScenePacket;

/// A row of tiles of the results for their pixels.
pub(super) enum TileRow<'a> {
    /// Image pixels, four bytes per pixel.
    Bytes(&'a mut [u8]),
    /// Pixels of an image that [`Screen`](super::screen::Screen) finishes, the fourth byte being the opacity, with
    /// reversed depths.
    Unfinished { bytes: &'a mut [u8], depths: &'a mut [f32] },
    /// Reversed depths alone.
    Depths(&'a mut [f32]),
    /// View-dependent texturing results of the surface, alone.
    Textured(&'a mut [PhotoAnswer]),
}

/// Splits values into bands, one per row of tiles, with the same number of values for each pixel of an image.
pub(super) fn bands_of<'a, T>(
    packet: &ScenePacket,
    values: &'a mut [T],
    per_pixel: usize,
) -> impl Iterator<Item = &'a mut [T]> {
    values.chunks_mut(per_pixel * packet.viewport_px[0] as usize * HEIGHT)
}
