//! The k nearest neighbours of every point, exactly.
//!
//! Sets of neighbours are found a bucket at a time ([`super::bucket_search`]); here they are shared out among threads, and
//! put in order for those who ask from outside.

use super::bucket_search::BucketSearch;
use super::point_tree::{LANES, PointTree};
use fearless_simd::{Level, dispatch};
use glam::Vec3;
use rayon::prelude::*;

/// Nearest neighbours of every point: equally many for each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Neighbours {
    per_point: usize,
    indices: Vec<u32>,
}

impl Neighbours {
    /// Neighbours a point: the k asked for, or as many as there are other points.
    pub fn per_point(&self) -> usize {
        self.per_point
    }

    /// The neighbours of a point, never the point itself.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.indices[index * self.per_point..(index + 1) * self.per_point]
    }
}

/// The `k` nearest neighbours of each of `positions` (finite), by squared distance in f32, then by index; in this order.
///
/// A point that coincides with another is its neighbour at distance 0.
pub fn nearest_neighbours(positions: &[Vec3], k: usize) -> Neighbours {
    let tree = PointTree::new(positions);
    let by_slot = tree.neighbours(k);
    let per_point = by_slot.per_point;
    let mut indices = vec![0; positions.len() * per_point];
    if per_point > 0 {
        indices
            .par_chunks_mut(per_point)
            .zip(0..positions.len() as u32)
            .with_min_len(1 << 10)
            .for_each_init(Vec::new, |order, (list, index)| {
                tree.write_in_order(index, &by_slot, order, list);
            });
    }
    Neighbours { per_point, indices }
}

/// Buckets that one task searches for before it asks for more.
const BUCKETS_PER_TASK: usize = 64;

impl PointTree {
    /// [`nearest_neighbours`] with slots in place of indices, both as position and as value, and in no order.
    pub(super) fn neighbours(&self, k: usize) -> Neighbours {
        let per_point = k.min(self.len().saturating_sub(1));
        let mut indices = vec![0; self.len() * per_point];
        if per_point > 0 {
            let level = Level::new();
            indices
                .par_chunks_mut(LANES * per_point * BUCKETS_PER_TASK)
                .enumerate()
                .for_each(|(task, lists)| {
                    let mut search = BucketSearch::new(self, per_point);
                    let first = task * BUCKETS_PER_TASK;
                    for (place, lists) in lists.chunks_mut(LANES * per_point).enumerate() {
                        dispatch!(level, simd => search.run(simd, first + place, lists));
                    }
                });
        }
        Neighbours { per_point, indices }
    }

    /// Writes the neighbours of a point of the file as points of the file, nearest first, equally near ones by index.
    /// `order` is scratch.
    fn write_in_order(
        &self,
        file_index: u32,
        by_slot: &Neighbours,
        order: &mut Vec<(f32, u32)>,
        list: &mut [u32],
    ) {
        let slot = self.slot_of(file_index) as usize;
        let point = self.positions()[slot];
        order.clear();
        order.extend(by_slot.of(slot).iter().map(|&other| {
            let distance_squared = squared(self.positions()[other as usize] - point);
            (distance_squared, self.file_index_of(other))
        }));
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (index, (_, found)) in list.iter_mut().zip(order.iter()) {
            *index = *found;
        }
    }
}

/// Added in the order in which the search adds.
fn squared(v: Vec3) -> f32 {
    v.x * v.x + v.y * v.y + v.z * v.z
}
