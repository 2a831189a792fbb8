//! The k nearest neighbours of every point, exactly.
//!
//! Sets of neighbours are found one bucket at a time ([`super::bucket_search`]); this module distributes them over
//! threads and puts them in order for other modules.

use super::bucket_search::BucketSearch;
use super::point_tree::{LANES, PointTree};
use fearless_simd::{Level, dispatch};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Nearest neighbours of every point: equally many for each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Neighbours {
    per_point: usize,
    /// The first point that has a list here.
    first: usize,
    /// The lists of [`POINTS_PER_PIECE`] points each, one after the other. One piece for all would be megabytes that
    /// are filled with zeros before they are written; these never leave the nearest cache in between.
    pieces: Vec<Vec<u32>>,
}

/// Points whose lists are written by one task: whole buckets.
const POINTS_PER_PIECE: usize = 64 * LANES;

impl Neighbours {
    /// Lists of consecutive points, written in pieces by `write`.
    fn by_pieces(points: Range<usize>, per_point: usize, write: impl Fn(Range<usize>, &mut [u32]) + Sync) -> Self {
        let pieces = (0..points.len().div_ceil(POINTS_PER_PIECE)).into_par_iter();
        let pieces = pieces.map(|piece| {
            let first = points.start + piece * POINTS_PER_PIECE;
            let points = first..points.end.min(first + POINTS_PER_PIECE);
            let mut lists = vec![0; points.len() * per_point];
            // A single point has no neighbours.
            if per_point > 0 {
                write(points, &mut lists);
            }
            lists
        });
        Self {
            per_point,
            first: points.start,
            pieces: pieces.collect(),
        }
    }

    /// Neighbours per point: the requested k, or the number of other points if smaller.
    pub fn per_point(&self) -> usize {
        self.per_point
    }

    /// The neighbours of a point, never the point itself.
    pub fn of(&self, index: usize) -> &[u32] {
        let place = index - self.first;
        let start = place % POINTS_PER_PIECE * self.per_point;
        &self.pieces[place / POINTS_PER_PIECE][start..start + self.per_point]
    }
}

/// The `k` nearest neighbours of each of `positions` (finite), by squared distance in f32, then by index; in this
/// order.
///
/// A point that coincides with another is its neighbour at distance 0.
// kiddo, the k-d tree crate, answers one point at a time: its tree and 16 neighbours of 1,000,000 points in Morton
// order took 5.5 times as long as tree, neighbours and normals here (2 threads). Its SIMD needs a nightly compiler.
pub fn nearest_neighbours(positions: &[Vec3], k: usize) -> Neighbours {
    let tree = PointTree::new(positions);
    let by_slot = tree.neighbours(k);
    Neighbours::by_pieces(0..positions.len(), by_slot.per_point, |points, lists| {
        let mut order = Vec::new();
        for (list, index) in lists.chunks_exact_mut(by_slot.per_point).zip(points) {
            tree.write_in_order(index as u32, &by_slot, &mut order, list);
        }
    })
}

impl PointTree {
    /// Finds [`nearest_neighbours`] with slots instead of indices, both as position and as value, and in no order.
    pub(in crate::analysis) fn neighbours(&self, k: usize) -> Neighbours {
        self.neighbours_of(0..self.len(), k)
    }

    /// [`PointTree::neighbours`] of some consecutive slots alone. Precondition: the first one begins a bucket.
    pub(in crate::analysis) fn neighbours_of(&self, slots: Range<usize>, k: usize) -> Neighbours {
        let per_point = k.min(self.len().saturating_sub(1));
        let level = Level::new();
        Neighbours::by_pieces(slots, per_point, |slots, lists| {
            let mut search = BucketSearch::new(self, per_point);
            let first_bucket = slots.start / LANES;
            for (place, lists) in lists.chunks_mut(LANES * per_point).enumerate() {
                dispatch!(level, simd => search.run(simd, first_bucket + place, lists));
            }
        })
    }

    /// Writes the neighbours of a point of the file as points of the file, nearest first, equally near ones by index.
    /// `order` is scratch.
    fn write_in_order(&self, file_index: u32, by_slot: &Neighbours, order: &mut Vec<(f32, u32)>, list: &mut [u32]) {
        let slot = self.slot_of(file_index) as usize;
        let point = self.points()[slot].position;
        order.clear();
        order.extend(by_slot.of(slot).iter().map(|&other| {
            let other = self.points()[other as usize];
            (squared(other.position - point), other.file_index)
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
