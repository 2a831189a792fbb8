//! Traversal of a coded cloud: the parts that may touch each tile, and the level at which they are drawn.
//!
//! How it works: the tree is traversed from the root, nearer octants first. A node beyond the sides of the image, or
//! all of whose normals face away (their cone, Botsch et al. 2002 §4.2), is culled with all below it; the eye's nearest
//! corner of its box determines the level on which its cells get smaller than requested. Where that level is a few
//! below, the node is a *block*: all of it will be drawn on that level. Blocks are noted for the tiles that their boxes
//! and splats may touch. The descendants of a block on any level are consecutive nodes, so that a decoder of a block
//! reads masks and attributes in order.
//!
//! When it wins: invisible nodes are not visited, and from afar blocks are few and their levels high, so the render
//! time scales with the visible part of the cloud.

use super::code::Coded;
use super::transform::{Transform, in_view};
use crate::cloud::FINEST_NORMAL_BITS;
use crate::cloud::quantised_normals;
use crate::render::cpu::tile::Tiles;
use crate::render::cpu::view::PixelView;
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::ops::Range;

/// A node, all of which is drawn on one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Block {
    pub(super) node: usize,
    pub(super) level: u32,
    /// The level that is drawn.
    pub(super) drawn_level: u32,
    /// Projection of its centre.
    pub(super) center: Vec4,
}

/// A node that is visited.
#[derive(Debug, Clone, Copy)]
struct Visited {
    node: usize,
    level: u32,
    /// Projection of its centre.
    center: Vec4,
}

/// Goes through a tree.
pub(super) struct Traversal<'a> {
    pub(super) coded: &'a Coded<'a>,
    pub(super) view: &'a PixelView,
    pub(super) transform: &'a Transform,
    /// Reach of splats from their cell on each level, in scene units.
    pub(super) reaches: &'a [f32],
    /// Pixels of a length of 1 at a distance of 1.
    pub(super) px_per_slope: f32,
    /// The level of blocks for each level that is drawn.
    block_levels: Vec<u32>,
    octants: [usize; 8],
    cone_slack: f32,
}

impl<'a> Traversal<'a> {
    pub(super) fn new(
        coded: &'a Coded<'a>,
        view: &'a PixelView,
        transform: &'a Transform,
        reaches: &'a [f32],
        largest_normal_error: f32,
    ) -> Self {
        let cloud = coded.cloud;
        let block_level = |drawn: u32| {
            let count = cloud.level(drawn).len();
            let is_above = |&level: &u32| coded.block_nodes * cloud.level(level).len() <= count;
            (0..=drawn).rev().find(is_above).unwrap_or(0)
        };
        Self {
            coded,
            view,
            transform,
            reaches,
            px_per_slope: view.px_per_slope[0],
            block_levels: (0..=cloud.depth()).map(block_level).collect(),
            octants: transform.front_to_back(),
            // Both the axis and the drawn normal are off by this much; plus rounding.
            cone_slack: 2.0 * largest_normal_error + 2e-3,
        }
    }

    /// The blocks that may be seen, nearer octants of the root first.
    pub(super) fn blocks(&self) -> Vec<Block> {
        let cloud = self.coded.cloud;
        if cloud.attributes().is_empty() {
            return Vec::new();
        }
        let (mut blocks, mut roots) = (Vec::new(), Vec::new());
        // The nodes of two levels are enough tasks.
        let root = Visited {
            node: 0,
            level: 0,
            center: self.transform.root,
        };
        self.visit(root, &mut blocks, &mut |node| {
            roots.push(node);
        });
        let children = std::mem::take(&mut roots);
        for child in children {
            self.visit(child, &mut blocks, &mut |node| roots.push(node));
        }
        let below = roots.par_iter().flat_map_iter(|&root| {
            let mut blocks = Vec::new();
            self.descend(root, &mut blocks);
            blocks
        });
        blocks.par_extend(below);
        blocks
    }

    fn descend(&self, node: Visited, blocks: &mut Vec<Block>) {
        let mut waiting = vec![node];
        while let Some(node) = waiting.pop() {
            let first = waiting.len();
            self.visit(node, blocks, &mut |child| waiting.push(child));
            // The last one pushed is visited first.
            waiting[first..].reverse();
        }
    }

    /// Adds a node to the blocks, or calls `divide` with its children, or drops it.
    fn visit(&self, visited: Visited, blocks: &mut Vec<Block>, divide: &mut impl FnMut(Visited)) {
        let Visited { node, level, center } = visited;
        let cloud = self.coded.cloud;
        let midpoint = in_view(self.view, center);
        let edge = cloud.cube().cell_edge(level);
        let nearest = center.z - self.transform.half_depth(level);
        let drawn_level = self.drawn_level(level, nearest);
        let half = self.view.rotate_extent(Vec3::splat(0.5 * edge));
        let reach = self.reach(node, level);
        if self
            .view
            .covered_px(midpoint, half + Vec3::splat(reach), 2.0)
            .is_empty()
            || (self.coded.cull_back_faces && self.faces_away(node, midpoint, edge))
        {
            return;
        }
        if level >= self.block_levels[drawn_level as usize].min(drawn_level) {
            blocks.push(Block {
                node,
                level,
                drawn_level,
                center,
            });
            return;
        }
        let mask = cloud.masks()[node];
        let first = cloud.first_child(node);
        for &octant in &self.octants {
            if mask >> octant & 1 != 0 {
                let before = (u32::from(mask) & ((1 << octant) - 1)).count_ones();
                let center = center + self.transform.to_child[level as usize + 1][octant];
                divide(Visited {
                    node: first + before as usize,
                    level: level + 1,
                    center,
                });
            }
        }
    }

    /// The level from `level` on whose cells, at some distance, are no larger than requested.
    fn drawn_level(&self, level: u32, nearest: f32) -> u32 {
        let deepest = self.coded.deepest_level.min(self.coded.cloud.depth());
        if nearest <= self.view.near || nearest.is_nan() {
            return deepest.max(level);
        }
        let per_edge = self.px_per_slope / nearest;
        let is_small = |&level: &u32| self.coded.cloud.cube().cell_edge(level) * per_edge < self.coded.lod_px;
        (level..deepest).find(is_small).unwrap_or(deepest.max(level))
    }

    /// Returns an upper bound of the reach of splats below a node from its cell: no more than the largest of all levels
    /// that may be drawn, nor than its own splat, which covers them.
    fn reach(&self, node: usize, level: u32) -> f32 {
        let edge = self.coded.cloud.cube().cell_edge(level);
        let own = self.coded.cloud.attributes()[node].radius_edges() * edge;
        self.reaches[level as usize].min(self.coded.largest_scale() * (own + edge))
    }

    fn faces_away(&self, node: usize, midpoint: Vec3, edge: f32) -> bool {
        let attributes = &self.coded.cloud.attributes()[node];
        let distance = midpoint.length();
        let sphere_radius = LARGEST_OFFSET_DIAGONAL * edge;
        if distance <= sphere_radius {
            return false;
        }
        let opening = attributes.cone() + (sphere_radius / distance).asin() + self.cone_slack;
        let normal = quantised_normals(FINEST_NORMAL_BITS)[attributes.normal() as usize];
        let facing = self.view.rotate(normal).dot(midpoint) / distance;
        opening < std::f32::consts::FRAC_PI_2 && facing > opening.sin()
    }

    /// The blocks of every tile.
    pub(super) fn by_tile(&self, blocks: &[Block], tiles: Tiles) -> BlockLists {
        let covered: Vec<[Range<usize>; 2]> = blocks
            .par_iter()
            .with_min_len(256)
            .map(|block| {
                let edge = self.coded.cloud.cube().cell_edge(block.level);
                let midpoint = in_view(self.view, block.center);
                let half = self.view.rotate_extent(Vec3::splat(0.5 * edge));
                let reach = self.reaches[block.drawn_level as usize].min(self.reach(block.node, block.level));
                let slack = 1e-5 * (midpoint.abs() + half);
                let half = half + Vec3::splat(reach) + slack;
                Tiles::covered_by(self.view.covered_px(midpoint, half, 2.0))
            })
            .collect();
        let mut lists = vec![Vec::new(); tiles.count()];
        for (block, [columns, rows]) in covered.iter().enumerate() {
            for row in rows.clone() {
                for column in columns.clone() {
                    lists[tiles.columns * row + column].push(block as u32);
                }
            }
        }
        BlockLists { lists }
    }
}

/// Half the diagonal of a cube of edge 1.
const LARGEST_OFFSET_DIAGONAL: f32 = crate::levels::octree::coded::LARGEST_OFFSET;

/// The blocks of every tile, in their order.
#[derive(Debug)]
pub(super) struct BlockLists {
    pub(super) lists: Vec<Vec<u32>>,
}

#[cfg(test)]
mod tests;
