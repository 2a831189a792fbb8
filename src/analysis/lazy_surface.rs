//! Planes and radii of the points that somebody asks for, and of no others but those that these depend on.
//!
//! How it works: the tree over all points is built at once, as every search needs it. Its slots are divided into blocks, and
//! a block is searched, fitted and measured when one of its points is asked for the first time, by the same functions as
//! all of them in [`super::estimate_planes`] and [`super::estimate_surface`], so that the bits are the same. Points that
//! follow each other in Morton order (a node of an octree, what a view shows) lie in few blocks, as both orders keep
//! together what is close in space.
//!
//! A plane depends on the neighbours of its point alone. A radius is limited by the cells of the neighbours, so the blocks
//! around those asked for are measured as well, but no further: cells depend on planes alone. It is limited by the median of the
//! cloud, too, which is that of a fixed sample ([`radii::sample`]): the buckets of eight slots that hold the sample, 4096 points at
//! most, are measured with the first radii that are asked for, and forgotten.
//!
//! When it wins: where less than all is asked for. Searching, fitting and measuring go with the blocks, the tree (a quarter to a
//! third of the whole) and the sample do not. Blocks are small, so that little is measured around them.

use super::neighbours::Neighbours;
use super::point_tree::{LANES, PointTree};
use super::radii::{self, Limits};
use super::{Planes, normals, orientation};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::OnceLock;

/// Planes and radii of blocks of points, each estimated once, when it is first asked for. May be asked from several threads.
#[derive(Debug)]
pub struct LazySurface {
    tree: PointTree,
    k: usize,
    sensor: Option<Vec3>,
    blocks: Vec<Block>,
    /// With the number of points that were measured for them.
    limits: OnceLock<(Limits, usize)>,
}

/// Points that have been looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Estimated {
    /// Points whose planes are known: those of all blocks that were asked for planes or have cells.
    pub planes: usize,
    /// Points whose cells are known: those of all blocks that were asked for radii, and around them.
    pub cells: usize,
    /// Points that were measured for the median of the cloud, once.
    pub sampled: usize,
}

/// Consecutive slots: whole buckets.
const POINTS_PER_BLOCK: usize = 8 * LANES;

#[derive(Debug, Default)]
struct Block {
    /// Normals of any sign.
    planes: OnceLock<normals::SlotPlanes>,
    cells: OnceLock<Cells>,
}

/// What radii are worked out from.
#[derive(Debug)]
struct Cells {
    neighbours: Neighbours,
    /// Of the cells, in the order of the slots.
    radii: Vec<f32>,
}

impl LazySurface {
    /// Prepares the planes and radii of finite `positions`, best in Morton order, from `k` neighbours each. Normals point to
    /// `sensor` if there is one; else each has any sign.
    pub fn new(positions: &[Vec3], k: usize, sensor: Option<Vec3>) -> Self {
        let tree = PointTree::new(positions);
        let block_count = tree.len().div_ceil(POINTS_PER_BLOCK);
        Self {
            tree,
            k,
            sensor,
            blocks: (0..block_count).map(|_| Block::default()).collect(),
            limits: OnceLock::new(),
        }
    }

    /// The planes of consecutive points, the same as [`super::estimate_planes`] finds (or [`super::estimate_surface`], with a
    /// sensor and [`super::DEFAULT_NEIGHBOURS`]); `without_plane` has indices among all points.
    ///
    /// # Panics
    /// Precondition: there are such points.
    pub fn planes(&self, points: Range<usize>) -> Planes {
        let slots = self.slots_of(points.clone());
        self.for_blocks_of(slots.iter().copied(), |block| {
            self.planes_of(block);
        });
        let mut planes = Planes {
            normals: Vec::with_capacity(slots.len()),
            without_plane: Vec::new(),
        };
        for (point, slot) in points.zip(slots) {
            let block = self.planes_of(slot / POINTS_PER_BLOCK);
            let mut normal = block.normals[slot % POINTS_PER_BLOCK];
            if let Some(sensor) = self.sensor {
                let normal = std::slice::from_mut(&mut normal);
                orientation::face_sensor(&self.tree, sensor, slot, normal);
            }
            planes.normals.push(normal);
            if block.without_plane.binary_search(&(slot as u32)).is_ok() {
                planes.without_plane.push(point as u32);
            }
        }
        planes
    }

    /// The radii of consecutive points in scene units, the same as [`super::estimate_surface`] finds with
    /// [`super::DEFAULT_NEIGHBOURS`]; positive and finite.
    ///
    /// # Panics
    /// Precondition: there are such points.
    pub fn radii(&self, points: Range<usize>) -> Vec<f32> {
        if points.is_empty() {
            return Vec::new();
        }
        let slots = self.slots_of(points);
        self.for_blocks_of(slots.iter().copied(), |block| {
            self.cells_of(block);
        });
        let neighbours_of =
            |&slot: &usize| self.cells_of(slot / POINTS_PER_BLOCK).neighbours.of(slot);
        let around = slots.iter().flat_map(neighbours_of);
        self.for_blocks_of(around.map(|&slot| slot as usize), |block| {
            self.cells_of(block);
        });
        let (limits, _) = self.limits();
        let cell_of = |slot| self.cells_of(slot / POINTS_PER_BLOCK).radii[slot % POINTS_PER_BLOCK];
        let radius = |slot: &usize| {
            let neighbours = neighbours_of(slot);
            // From zero and in this order, as for all at once: another sum may differ in its last bit.
            let sum = neighbours.iter().fold(0.0, |sum, &neighbour| {
                sum + radii::inverse_of(cell_of(neighbour as usize))
            });
            limits.radius(cell_of(*slot), neighbours.len(), sum)
        };
        slots.par_iter().with_min_len(1 << 10).map(radius).collect()
    }

    /// How many points have been looked at.
    pub fn estimated(&self) -> Estimated {
        let planes = self.blocks.iter().filter_map(|block| block.planes.get());
        let cells = self.blocks.iter().filter_map(|block| block.cells.get());
        Estimated {
            planes: planes.map(|planes| planes.normals.len()).sum(),
            cells: cells.map(|cells| cells.radii.len()).sum(),
            sampled: self.limits.get().map_or(0, |&(_, sampled)| sampled),
        }
    }

    fn slots_of(&self, points: Range<usize>) -> Vec<usize> {
        let slot_of = |point| self.tree.slot_of(point as u32) as usize;
        points.map(slot_of).collect()
    }

    /// Does something once for each block that one of `slots` is in.
    fn for_blocks_of(&self, slots: impl Iterator<Item = usize>, estimate: impl Fn(usize) + Sync) {
        let mut is_asked = vec![false; self.blocks.len()];
        for slot in slots {
            is_asked[slot / POINTS_PER_BLOCK] = true;
        }
        let asked: Vec<usize> = (0..is_asked.len())
            .filter(|&block| is_asked[block])
            .collect();
        asked.par_iter().for_each(|&block| estimate(block));
    }

    fn slots_of_block(&self, block: usize) -> Range<usize> {
        let first = block * POINTS_PER_BLOCK;
        first..self.tree.len().min(first + POINTS_PER_BLOCK)
    }

    // None of what follows is estimated inside of `get_or_init`: a thread that waits for its share of the work may take up other
    // work, and come by here again. If two estimate the same, one of them is dropped.

    fn planes_of(&self, block: usize) -> &normals::SlotPlanes {
        let known = &self.blocks[block].planes;
        known.get().unwrap_or_else(|| {
            let slots = self.slots_of_block(block);
            let neighbours = self.tree.neighbours_of(slots.clone(), self.k);
            let planes = normals::fit_planes(&self.tree, &neighbours, slots);
            known.get_or_init(|| planes)
        })
    }

    /// Neighbours are searched for again where planes alone were asked for before, as most are never asked for again.
    fn cells_of(&self, block: usize) -> &Cells {
        let Block { planes, cells } = &self.blocks[block];
        cells.get().unwrap_or_else(|| {
            let slots = self.slots_of_block(block);
            let neighbours = self.tree.neighbours_of(slots.clone(), self.k);
            let planes = planes.get().unwrap_or_else(|| {
                let fitted = normals::fit_planes(&self.tree, &neighbours, slots.clone());
                planes.get_or_init(|| fitted)
            });
            let radii = radii::cell_radii(&self.tree, &neighbours, &planes.normals, slots);
            cells.get_or_init(|| Cells { neighbours, radii })
        })
    }

    fn limits(&self) -> &(Limits, usize) {
        self.limits.get().unwrap_or_else(|| {
            let sample: Vec<usize> = radii::sample(self.tree.len()).collect();
            let measured = sample.par_iter().map(|&slot| {
                let first = slot / LANES * LANES;
                let bucket = first..self.tree.len().min(first + LANES);
                let neighbours = self.tree.neighbours_of(bucket.clone(), self.k);
                let planes = normals::fit_planes(&self.tree, &neighbours, bucket.clone());
                let radii =
                    radii::cell_radii(&self.tree, &neighbours, &planes.normals, bucket.clone());
                (radii[slot - first], bucket.len())
            });
            let (cells, counts): (Vec<f32>, Vec<usize>) = measured.unzip();
            let limits = Limits::new(&self.tree, cells.into_iter());
            self.limits.get_or_init(|| (limits, counts.iter().sum()))
        })
    }
}
