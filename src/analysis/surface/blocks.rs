//! Normals and radii block by block, so that the neighbours of all points are never in memory at once.
//!
//! How it works: slots of the k-d tree that follow each other are close in space, so nearly all neighbours of a block
//! of them are in it. A block is searched, fitted and measured by the same functions as a whole cloud; then the radii
//! of a point's neighbours, which limit its own, are summed up while its list still exists. Only points with a
//! neighbour beyond the block keep their lists until all cells are measured: 2 to 5 % of a surface. All operations and
//! their order are the same as for the whole cloud, so results are bit-identical.
//!
//! When it wins: wherever the lists are not needed afterwards. Twelve neighbours of 13.8 million points are 660 MB,
//! those at the block borders 30.

use super::normals;
use super::options::{DEFAULT_NEIGHBOURS, PlaneFit};
use super::radii::{self, Limits};
use super::robust_planes;
use super::steps::{NEIGHBOURS_STEPS, PLANES_STEPS, RADII_STEPS};
use crate::analysis::search::neighbours::Neighbours;
use crate::analysis::search::point_tree::{LANES, PointTree};
use crate::progress::Progress;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Consecutive slots, whole buckets: their neighbours are 800 KB, which a core's own cache holds.
const POINTS_PER_BLOCK: usize = 2048 * LANES;

/// A surface in the order of the slots.
#[derive(Debug)]
pub(in crate::analysis) struct SlotSurface {
    /// Unit normals of any sign.
    pub(in crate::analysis) normals: Vec<Vec3>,
    /// In scene units; positive and finite.
    pub(in crate::analysis) radii: Vec<f32>,
    /// Slots of the points whose neighbours define no plane, ascending.
    pub(in crate::analysis) without_plane: Vec<u32>,
}

/// Points of a block with neighbours beyond it.
#[derive(Debug, Default)]
struct Rim {
    slots: Vec<u32>,
    /// The neighbours of each, one list after the other.
    lists: Vec<u32>,
    /// Slots of the block whose neighbours define no plane.
    without_plane: Vec<u32>,
}

/// The planes of all points, from `k` neighbours each, and their radii, from the default number. Advances `progress` by
/// the steps of these stages; `None` once it is cancelled.
pub(in crate::analysis) fn surface(
    tree: &PointTree,
    k: usize,
    fit: PlaneFit,
    progress: &Progress,
) -> Option<SlotSurface> {
    let count = tree.len();
    let mut normals = vec![Vec3::Z; count];
    let mut cells = vec![0.0; count];
    let mut sums = vec![0.0; count];
    let rims: Vec<Rim> = normals
        .par_chunks_mut(POINTS_PER_BLOCK)
        .zip(cells.par_chunks_mut(POINTS_PER_BLOCK))
        .zip(sums.par_chunks_mut(POINTS_PER_BLOCK))
        .enumerate()
        .map(|(block, ((normals, cells), sums))| {
            if progress.is_cancelled() {
                return Rim::default();
            }
            let first = block * POINTS_PER_BLOCK;
            let slots = first..first + normals.len();
            // Lists for one block at a time: 13.8 million points take 1.0 GB, against 1.7 GB with the lists of all
            // points at once.
            let neighbours = tree.neighbours_of(slots.clone(), k);
            let mut planes = normals::fit_planes(tree, &neighbours, slots.clone());
            if fit == PlaneFit::Robust {
                robust_planes::refine(tree, &neighbours, first, &planes.without_plane, &mut planes.normals);
            }
            let neighbours = match k {
                DEFAULT_NEIGHBOURS => neighbours,
                _ => tree.neighbours_of(slots.clone(), DEFAULT_NEIGHBOURS),
            };
            let measured = radii::cell_radii(tree, &neighbours, &planes.normals, slots.clone());
            normals.copy_from_slice(&planes.normals);
            cells.copy_from_slice(&measured);
            progress.advance((NEIGHBOURS_STEPS + PLANES_STEPS + RADII_STEPS) * normals.len());
            Rim {
                without_plane: planes.without_plane,
                ..sum_up(&neighbours, slots, &measured, sums)
            }
        })
        .collect();
    if progress.is_cancelled() {
        return None;
    }
    let per_point = DEFAULT_NEIGHBOURS.min(count.saturating_sub(1));
    let of_rims = rims.iter().flat_map(|rim| {
        let lists = rim.lists.chunks_exact(per_point.max(1));
        rim.slots.iter().zip(lists)
    });
    for (&slot, list) in of_rims {
        let inverse = list.iter().map(|&other| radii::inverse_of(cells[other as usize]));
        sums[slot as usize] = radii::sum_in_order(inverse);
    }
    let limits = Limits::new(tree, radii::sample(count).map(|slot| cells[slot]));
    let mut radii = cells;
    radii
        .par_iter_mut()
        .zip(&sums)
        .with_min_len(1 << 12)
        .for_each(|(radius, &sum)| *radius = limits.radius(*radius, per_point, sum));
    let without_plane = rims.into_iter().flat_map(|rim| rim.without_plane);
    Some(SlotSurface {
        normals,
        radii,
        without_plane: without_plane.collect(),
    })
}

/// Writes the summed up inverse `cells` of the neighbours of each slot of a block to `sums`, except at the border of
/// the block.
fn sum_up(neighbours: &Neighbours, slots: Range<usize>, cells: &[f32], sums: &mut [f32]) -> Rim {
    let inverse: Vec<f32> = cells.iter().map(|&cell| radii::inverse_of(cell)).collect();
    let mut rim = Rim::default();
    for (slot, sum) in slots.clone().zip(sums) {
        let list = neighbours.of(slot);
        if list.iter().all(|&other| slots.contains(&(other as usize))) {
            let of_list = list.iter().map(|&other| inverse[other as usize - slots.start]);
            *sum = radii::sum_in_order(of_list);
        } else {
            rim.slots.push(slot as u32);
            rim.lists.extend_from_slice(list);
        }
    }
    rim
}
