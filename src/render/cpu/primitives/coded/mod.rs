//! Surfels drawn straight from the byte code of an octree (Botsch et al. 2002).
//!
//! How it works: the tree is traversed once for blocks (`blocks.rs`); then each tile decodes the blocks that may touch
//! it, level by level, adding the image of a vector for each node (`transform.rs`), looks up the normal as it is seen,
//! its light and its class (`normals.rs`), drops points that face away before any division, moves it along its normal
//! by its offset, and lays the mask of its shape, size and place (`footprints.rs`, `masks.rs`) on the pixels
//! (`splat.rs`). ε-z accumulation and normalisation match the exact disks: depths pushed back by a radius, then
//! weighted sums of splats not behind them.
//!
//! Splats too large for masks are drawn as exact disks: there the lookup saves nothing, as the pixels dominate the
//! cost.
//!
//! When it wins: many splats of a few pixels. What it costs: quantised normals (13 bits and 9 for shapes), places
//! within a pixel, sizes and light for one direction; `benches/coded_render.rs` measures both.

mod blocks;
mod code;
mod decode;
mod footprints;
#[cfg(test)]
mod light_tests;
mod masks;
mod normals;
mod splat;
#[cfg(test)]
mod tests;
mod tiles;
mod transform;

pub(in crate::render::cpu) use code::Coded;

use crate::cloud::{largest_normal_error, quantised_normals};
use crate::levels::octree::coded::offset_of_code;
use crate::render::cpu::finish::Held;
use crate::render::cpu::painter::Painter;
use crate::render::cpu::rows::TileRow;
use crate::scene::{ScenePacket, Splatting};
use blocks::{Block, Traversal};
use footprints::Footprints;
use masks::MASKS;
use tiles::CodedTiles;
use transform::Transform;

/// Draws a byte code; how many nodes were drawn, in blocks that may be seen.
///
/// It begins on the caller's thread: the tables are made by all threads at their first use, and one of those that
/// waited for a table might take up work that waits for the same.
pub(super) fn draw(coded: &Coded<'_>, packet: &ScenePacket, bands: Vec<TileRow<'_>>) -> u64 {
    let held = match packet.style.surfels.splatting {
        _ if coded.are_pixels => Held::Keys,
        Splatting::Visibility => Held::depths(packet),
        _ => Held::sums(packet),
    };
    let painter = Painter::new(packet, held, None);
    let view = painter.view();
    let transform = Transform::new(view, &coded.cloud.cube());
    let normal_error = largest_normal_error(coded.normal_bits);
    let reaches = coded.cloud.reaches(coded.largest_scale());
    let traversal = Traversal::new(coded, view, &transform, &reaches, normal_error);
    let blocks = traversal.blocks();
    let lists = traversal.by_tile(&blocks, painter.tiles);
    let content = CodedTiles {
        is_depth_only: packet.style.surfels.splatting == Splatting::Visibility,
        lighting: packet.style.light.lighting,
        normals: normals::seen(packet, view, coded.normal_bits),
        directions: quantised_normals(coded.normal_bits),
        footprints: Footprints::new(view),
        masks: &MASKS,
        offsets: std::array::from_fn(|code| offset_of_code(code, coded.offset_bits)),
        blocks: &blocks,
        lists: &lists,
        transform: &transform,
        coded,
        view,
    };
    painter.paint(&content, bands);
    let nodes = |block: &Block| block.nodes(coded.cloud).len() as u64;
    blocks.iter().map(nodes).sum()
}
