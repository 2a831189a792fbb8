//! Tile binning: the records that may touch each tile of the image.
//!
//! How it works: records stand in an order in which neighbours in the list are neighbours in space (Morton), so the box
//! around sixty-four of them is small. A box is projected instead of its records, and its block is noted for every tile
//! that it may cover. The blocks of a tile come in their order, and so do the records of a block: blending follows the
//! order of the cloud, and the result does not depend on threads.

use super::tile::Tiles;
use super::view::PixelView;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of records of a block.
pub(super) const BLOCK: usize = 64;

/// Blocks that are worth handing to another thread.
const BLOCKS_PER_TASK: usize = 256;

/// A record's place, and how far from it something may be drawn, in scene units.
pub(super) trait Placed: Sync {
    fn len(&self) -> usize;
    fn position(&self, record: usize) -> [f32; 3];
    fn reach(&self, record: usize) -> f32;
}

/// Extent to which records are drawn beyond their positions: the sum of these.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Extent {
    /// A factor on [`Placed::reach`].
    pub(super) scale: f32,
    /// Scene units.
    pub(super) margin: f32,
    /// Pixels.
    pub(super) margin_px: f32,
}

/// Boxes around blocks of records.
#[derive(Debug)]
pub(in crate::render) struct Blocks {
    boxes: Vec<BlockBox>,
    record_count: usize,
}

#[derive(Debug, Clone, Copy)]
struct BlockBox {
    min: Vec3,
    max: Vec3,
    /// The largest of its records.
    reach: f32,
}

impl Blocks {
    pub(super) fn of(records: &impl Placed) -> Self {
        let record_count = records.len();
        let block = |block: usize| {
            let mut around = BlockBox {
                min: Vec3::INFINITY,
                max: Vec3::NEG_INFINITY,
                reach: 0.0,
            };
            for record in records_of(block, record_count) {
                let position = Vec3::from_array(records.position(record));
                around.min = around.min.min(position);
                around.max = around.max.max(position);
                around.reach = around.reach.max(records.reach(record));
            }
            around
        };
        let boxes = (0..record_count.div_ceil(BLOCK))
            .into_par_iter()
            .with_min_len(BLOCKS_PER_TASK)
            .map(block)
            .collect();
        Self { boxes, record_count }
    }

    /// The blocks of every tile.
    pub(super) fn by_tile(&self, view: &PixelView, tiles: Tiles, extent: Extent) -> TileLists {
        let covered: Vec<[Range<usize>; 2]> = self
            .boxes
            .par_iter()
            .with_min_len(BLOCKS_PER_TASK)
            .map(|block| {
                // Halved first: the sum of two extremes may overflow.
                let (low, high) = (0.5 * block.min, 0.5 * block.max);
                let center = view.rotate(view.offset_from_eye((low + high).to_array()));
                let half = view.rotate_extent(high - low) + Vec3::splat(extent.scale * block.reach + extent.margin);
                // Allows for rounding in the projection to pixels.
                let slack = 1e-5 * (center.abs() + half);
                Tiles::covered_by(view.covered_px(center, half + slack, extent.margin_px))
            })
            .collect();
        let mut ends = vec![0u32; tiles.count()];
        for_each_tile(&covered, tiles, |_, tile| ends[tile] += 1);
        let mut next = 0;
        for end in &mut ends {
            next += std::mem::replace(end, next);
        }
        let mut blocks = vec![0u32; next as usize];
        for_each_tile(&covered, tiles, |block, tile| {
            blocks[ends[tile] as usize] = block as u32;
            ends[tile] += 1;
        });
        TileLists {
            blocks,
            ends,
            record_count: self.record_count,
        }
    }
}

fn for_each_tile(covered: &[[Range<usize>; 2]], tiles: Tiles, mut visit: impl FnMut(usize, usize)) {
    for (block, [columns, rows]) in covered.iter().enumerate() {
        for row in rows.clone() {
            for column in columns.clone() {
                visit(block, tiles.columns * row + column);
            }
        }
    }
}

fn records_of(block: usize, record_count: usize) -> Range<usize> {
    BLOCK * block..record_count.min(BLOCK * (block + 1))
}

/// The blocks of every tile, ascending.
#[derive(Debug)]
pub(super) struct TileLists {
    blocks: Vec<u32>,
    /// End of the list of each tile.
    ends: Vec<u32>,
    record_count: usize,
}

impl TileLists {
    /// The records that may touch a tile, ascending.
    pub(super) fn records(&self, tile: usize) -> impl ExactSizeIterator<Item = Range<usize>> + Clone {
        let start = tile.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.blocks[start as usize..self.ends[tile] as usize]
            .iter()
            .map(|&block| records_of(block as usize, self.record_count))
    }

    /// Records handed to tiles, each as often as it is.
    pub(super) fn handed_out(&self) -> u64 {
        (self.blocks.len() * BLOCK) as u64
    }
}
