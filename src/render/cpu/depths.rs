//! Depths alone of a packet's surface.

use super::blocks::Blocks;
use super::primitives::Drawable;
use super::rows::{TileRow, bands_of};
use crate::scene::ScenePacket;

/// Reversed depths of all pixels of a packet; 0 where nothing is.
pub(super) fn draw_reversed_depths(drawable: &Drawable<'_>, packet: &ScenePacket, blocks: &Blocks, depths: &mut [f32]) {
    let bands = bands_of(packet, depths, 1).map(TileRow::Depths);
    drawable.draw(packet, blocks, None, bands.collect());
}

/// Distances of all pixels of a packet along the view axis; infinite where nothing is.
pub(super) fn draw_distances(drawable: &Drawable<'_>, packet: &ScenePacket, blocks: &Blocks) -> Vec<f32> {
    let [width, height] = packet.viewport_px.map(|edge| edge as usize);
    let mut distances = vec![0.0; width * height];
    draw_reversed_depths(drawable, packet, blocks, &mut distances);
    for distance in &mut distances {
        *distance = packet.view.near / *distance;
    }
    distances
}

/// Distances of the surface that a packet shows. Blocks are those of its content, which packets in turn may share.
pub(in crate::render) fn distances_of_surface(packet: &ScenePacket, blocks: &mut Option<Blocks>) -> Vec<f32> {
    let drawable = Drawable::of_surface(packet);
    let blocks = blocks.get_or_insert_with(|| drawable.blocks());
    draw_distances(&drawable, packet, blocks)
}
