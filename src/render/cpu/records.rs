//! Primitives with a record for everything that is drawn: blocks of records are handed to the tiles that they touch.

use super::blocks::{Blocks, Extent, Placed, TileLists};
use super::finish::Held;
use super::illumination::Illumination;
use super::painter::{InTiles, Painter};
use super::raster;
use super::rows::TileRow;
use super::tile::Tile;
use super::view::{PixelRect, PixelView};
use crate::scene::{Lighting, ScenePacket};
use fearless_simd::Simd;
use std::ops::Range;

/// The records of a primitive, and how they are drawn.
pub(super) trait DrawnRecords: Placed {
    /// Scratch data that a thread keeps from tile to tile.
    type Scratch: Default;

    /// Returns the contents of the pixels when everything is drawn.
    fn held(&self, packet: &ScenePacket) -> Held;

    /// Returns the extent to which a record is drawn around its position.
    fn extent(&self) -> Extent;

    /// Draws the given records that touch a tile.
    fn draw<S: Simd>(
        &self,
        simd: S,
        view: &PixelView,
        tile: &mut Tile,
        clip: PixelRect,
        records: impl Iterator<Item = Range<usize>> + Clone,
        scratch: &mut Self::Scratch,
    );
}

/// Draws records in blocks; how many were handed to tiles.
pub(super) fn draw<R: DrawnRecords>(
    records: &R,
    blocks: &Blocks,
    packet: &ScenePacket,
    illumination: Option<Illumination<'_>>,
    bands: Vec<TileRow<'_>>,
) -> u64 {
    let held = records.held(packet);
    let painter = Painter::new(packet, held, illumination);
    let view = painter.view();
    let has_colors = matches!(held, Held::Sums { .. } | Held::BlendedColors | Held::SolidColors);
    // Enters the thread pool once, not for each step.
    rayon::scope(|_| {
        let lists = blocks.by_tile(view, painter.tiles, records.extent());
        let content = InBlocks {
            records,
            lists: &lists,
            view,
            are_rays_measured: packet.lighting() == Lighting::PerFragment && has_colors,
        };
        painter.paint(&content, bands);
        lists.handed_out()
    })
}

struct InBlocks<'a, R> {
    records: &'a R,
    lists: &'a TileLists,
    view: &'a PixelView,
    /// For light that is worked out at each pixel.
    are_rays_measured: bool,
}

impl<R: DrawnRecords> InTiles for InBlocks<'_, R> {
    type Scratch = R::Scratch;

    #[inline(always)]
    fn draw<S: Simd>(&self, simd: S, tile: &mut Tile, clip: PixelRect, number: usize, scratch: &mut Self::Scratch) {
        let records = self.lists.records(number);
        if self.are_rays_measured && records.len() > 0 {
            simd.vectorize(
                #[inline(always)]
                || raster::measure_rays(simd, self.view, tile),
            );
        }
        simd.vectorize(
            #[inline(always)]
            || {
                self.records.draw(simd, self.view, tile, clip, records, scratch);
            },
        );
    }
}
