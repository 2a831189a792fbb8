//! Rows of tiles of what is made of a picture: each is the work of one task.

use super::photographs::PhotoAnswer;
use super::tile::HEIGHT;
use crate::scene::ScenePacket;

/// A row of tiles of what is made of their pixels.
pub(super) enum TileRow<'a> {
    /// Of a picture, four bytes a pixel.
    Bytes(&'a mut [u8]),
    /// Of a picture that [`Screen`](super::screen::Screen) finishes: the fourth byte of a pixel is its opacity. And
    /// reversed depths.
    Unfinished { bytes: &'a mut [u8], depths: &'a mut [f32] },
    /// Reversed depths alone.
    Depths(&'a mut [f32]),
    /// What photographs say of the surface, alone.
    Photographed(&'a mut [PhotoAnswer]),
}

/// What belongs to rows of tiles, of as many values for each pixel of a picture.
pub(super) fn bands_of<'a, T>(
    packet: &ScenePacket,
    values: &'a mut [T],
    per_pixel: usize,
) -> impl Iterator<Item = &'a mut [T]> {
    values.chunks_mut(per_pixel * packet.viewport_px[0] as usize * HEIGHT)
}
