//! Planes of the points that somebody asks for, and of no others.
//!
//! How it works: the tree over all points is built at once, as every search needs it. Its slots are divided into blocks, and
//! a block is searched and fitted when one of its points is asked for the first time, by the same functions as all of them
//! in [`super::estimate_planes`], so that the bits are the same. Points that follow each other in Morton order (a node of an
//! octree, what a view shows) lie in few blocks, as both orders keep together what is close in space.
//!
//! When it wins: where less than all is asked for. Searching and fitting go with the blocks, the tree (a quarter to a third of the whole)
//! does not.

use super::neighbours::POINTS_PER_PIECE;
use super::point_tree::PointTree;
use super::{Planes, normals, orientation};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::OnceLock;

/// Planes of blocks of points, each estimated once, when it is first asked for. May be asked from several threads.
#[derive(Debug)]
pub struct LazyPlanes {
    tree: PointTree,
    k: usize,
    sensor: Option<Vec3>,
    blocks: Vec<OnceLock<normals::SlotPlanes>>,
}

impl LazyPlanes {
    /// Prepares the planes of finite `positions`, best in Morton order, from `k` neighbours each. Normals point to `sensor` if
    /// there is one; else each has any sign.
    pub fn new(positions: &[Vec3], k: usize, sensor: Option<Vec3>) -> Self {
        let tree = PointTree::new(positions);
        let block_count = tree.len().div_ceil(POINTS_PER_PIECE);
        Self {
            tree,
            k,
            sensor,
            blocks: (0..block_count).map(|_| OnceLock::new()).collect(),
        }
    }

    /// The planes of consecutive points, the same as [`super::estimate_planes`] finds (or [`super::estimate_surface`], with a
    /// sensor and [`super::DEFAULT_NEIGHBOURS`]); `without_plane` has indices among all points.
    ///
    /// # Panics
    /// Precondition: there are such points.
    pub fn of(&self, points: Range<usize>) -> Planes {
        let slots: Vec<usize> = points
            .clone()
            .map(|point| self.tree.slot_of(point as u32) as usize)
            .collect();
        let mut blocks: Vec<usize> = slots.iter().map(|slot| slot / POINTS_PER_PIECE).collect();
        blocks.sort_unstable();
        blocks.dedup();
        blocks.par_iter().for_each(|&block| {
            self.block(block);
        });
        let mut planes = Planes {
            normals: Vec::with_capacity(slots.len()),
            without_plane: Vec::new(),
        };
        for (point, slot) in points.zip(slots) {
            let block = self.block(slot / POINTS_PER_PIECE);
            planes.normals.push(block.normals[slot % POINTS_PER_PIECE]);
            if block.without_plane.binary_search(&(slot as u32)).is_ok() {
                planes.without_plane.push(point as u32);
            }
        }
        planes
    }

    /// Points whose planes have been estimated: those of all blocks that were asked for.
    pub fn estimated_points(&self) -> usize {
        let estimated = self.blocks.iter().filter_map(OnceLock::get);
        estimated.map(|block| block.normals.len()).sum()
    }

    fn block(&self, block: usize) -> &normals::SlotPlanes {
        if let Some(planes) = self.blocks[block].get() {
            return planes;
        }
        // Not inside of `get_or_init`: a thread that waits for its share of the work may take up other work, and come by here
        // again. If two estimate the same, one of them is dropped.
        let first_slot = block * POINTS_PER_PIECE;
        let slots = first_slot..self.tree.len().min(first_slot + POINTS_PER_PIECE);
        let neighbours = self.tree.neighbours_of(slots.clone(), self.k);
        let mut planes = normals::fit_planes(&self.tree, &neighbours, slots);
        if let Some(sensor) = self.sensor {
            orientation::face_sensor(&self.tree, sensor, first_slot, &mut planes.normals);
        }
        self.blocks[block].get_or_init(|| planes)
    }
}
