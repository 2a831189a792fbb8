//! The k nearest neighbours of every point, exactly.
//!
//! How it works: the 16 points of a bucket ([`super::point_tree`]) search together. They first meet each other, which bounds
//! how far their neighbours can be; then the tree is climbed from the bucket to the root, and at every step the sibling
//! subtree is descended into as far as its boxes are within the worst of the 16 bounds. In a bucket that is reached,
//! each of the searching points whose own bound reaches its box takes the distances to four points at a time.
//!
//! A candidate is one 64-bit number, the bits of its squared distance (which order like the distance, as it is not
//! negative) above its index in the file. Comparing these numbers breaks ties by index, also when pruning: a box at exactly
//! the bound is entered only if it holds an index that could still win. Without that, points that all coincide would make
//! every bucket visit every other. The number is read as an f64, positive and finite whatever the bits, because processors
//! take the smaller and the larger of two of those in one instruction, and lists are kept sorted with nothing else.
//!
//! When it wins: descending is paid once for 16 points, and the candidates of one point are in the cache for the next 15.
//!
//! Pruning is exact in f32: subtraction, multiplication and addition round monotonically, so the distance to a box, computed
//! in the same order of operations, never exceeds the computed distance to a point inside.

use super::point_tree::{BUCKET, NodeBox, PointTree};
use glam::{Vec3, Vec4};
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

    /// The neighbours of a point, nearest first, equally near ones by index; never the point itself.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.indices[index * self.per_point..(index + 1) * self.per_point]
    }
}

/// The `k` nearest neighbours of each of `positions` (finite), by squared distance in f32, then by index.
///
/// A point that coincides with another is its neighbour at distance 0.
pub fn nearest_neighbours(positions: &[Vec3], k: usize) -> Neighbours {
    let tree = PointTree::new(positions);
    let by_slot = tree.neighbours(k);
    let per_point = by_slot.per_point;
    let indices = (0..positions.len() as u32)
        .into_par_iter()
        .with_min_len(1 << 10)
        .flat_map_iter(|index| {
            let slots = by_slot.of(tree.slot_of(index) as usize);
            slots.iter().map(|&slot| tree.file_index_of(slot))
        })
        .collect();
    Neighbours { per_point, indices }
}

/// Buckets that one task searches for before it asks for more.
const BUCKETS_PER_TASK: usize = 32;

impl PointTree {
    /// [`nearest_neighbours`], with slots in place of indices, both as position and as value.
    pub(super) fn neighbours(&self, k: usize) -> Neighbours {
        let per_point = k.min(self.len().saturating_sub(1));
        let mut indices = vec![0; self.len() * per_point];
        if per_point > 0 {
            indices
                .par_chunks_mut(BUCKET * per_point * BUCKETS_PER_TASK)
                .enumerate()
                .for_each(|(task, lists)| {
                    let mut search = BucketSearch::new(self, per_point);
                    for (place, lists) in lists.chunks_mut(BUCKET * per_point).enumerate() {
                        search.run(task * BUCKETS_PER_TASK + place, lists);
                    }
                });
        }
        Neighbours { per_point, indices }
    }
}

/// A squared distance above a file index: the order of candidates.
type Candidate = f64;

fn candidate(distance_squared: f32, file_index: u32) -> Candidate {
    Candidate::from_bits(u64::from(distance_squared.to_bits()) << 32 | u64::from(file_index))
}

/// What a list holds before it is full: farther than any candidate.
fn unfilled() -> Candidate {
    candidate(f32::INFINITY, u32::MAX)
}

fn distance_squared_of(candidate: Candidate) -> f32 {
    f32::from_bits((candidate.to_bits() >> 32) as u32)
}

fn file_index_of(candidate: Candidate) -> u32 {
    candidate.to_bits() as u32
}

/// The lists of the points of one bucket while they grow; reused for the next.
struct BucketSearch<'a> {
    tree: &'a PointTree,
    k: usize,
    /// Slot of the first searching point.
    first_slot: usize,
    /// Number of searching points.
    count: usize,
    /// `k` candidates for each searching point, ascending.
    lists: Vec<Candidate>,
    /// Box of the searching points.
    around: NodeBox,
    /// The worst last candidate of all lists.
    bound: Candidate,
}

impl<'a> BucketSearch<'a> {
    fn new(tree: &'a PointTree, k: usize) -> Self {
        Self {
            tree,
            k,
            first_slot: 0,
            count: 0,
            lists: vec![unfilled(); BUCKET * k],
            around: tree.nodes[0],
            bound: unfilled(),
        }
    }

    /// Writes the lists of the points of `bucket`, as slots.
    fn run(&mut self, bucket: usize, slots: &mut [u32]) {
        let leaf = self.tree.first_leaf() + bucket;
        self.first_slot = bucket * BUCKET;
        self.count = slots.len() / self.k;
        self.around = self.tree.nodes[leaf];
        self.lists.fill(unfilled());
        self.bound = unfilled();

        self.meet(bucket);
        let mut node = leaf;
        while node > 1 {
            self.descend(node ^ 1);
            node /= 2;
        }
        for (slot, &found) in slots.iter_mut().zip(&self.lists) {
            *slot = self.tree.slot_of(file_index_of(found));
        }
    }

    /// Recursion is bounded by the height of the tree.
    fn descend(&mut self, node: usize) {
        let first_leaf = self.tree.first_leaf();
        let below = &self.tree.nodes[node];
        let distance_squared = box_distance_squared(&self.around, below);
        if candidate(distance_squared, below.min_file_index) > self.bound {
            return;
        }
        if node >= first_leaf {
            if node - first_leaf < self.tree.buckets.len() {
                self.meet(node - first_leaf);
            }
            return;
        }
        // The nearer child first: it tightens the bound for the other.
        let [low, high] = [2 * node, 2 * node + 1];
        let distance_to =
            |child: usize| box_distance_squared(&self.around, &self.tree.nodes[child]);
        let swap = usize::from(distance_to(high) < distance_to(low));
        self.descend(low + swap);
        self.descend(high - swap);
    }

    /// Offers the points of `bucket` to all searching points.
    fn meet(&mut self, bucket: usize) {
        let tree = self.tree;
        let node = &tree.nodes[tree.first_leaf() + bucket];
        let bucket = &tree.buckets[bucket];
        let mut bound = 0.0;
        for (place, list) in self
            .lists
            .chunks_exact_mut(self.k)
            .enumerate()
            .take(self.count)
        {
            let slot = self.first_slot + place;
            let point = tree.positions()[slot];
            let nearest = point_box_distance_squared(point, node);
            if candidate(nearest, node.min_file_index) < list[list.len() - 1] {
                let own_index = tree.file_index_of(slot as u32);
                let [x, y, z] = point.to_array().map(Vec4::splat);
                for register in 0..BUCKET / 4 {
                    let dx = bucket.x[register] - x;
                    let dy = bucket.y[register] - y;
                    let dz = bucket.z[register] - z;
                    let distances = dx * dx + dy * dy + dz * dz;
                    let last = distance_squared_of(list[list.len() - 1]);
                    let mut near = distances.cmple(Vec4::splat(last)).bitmask();
                    while near != 0 {
                        let lane = near.trailing_zeros() as usize;
                        near &= near - 1;
                        let index = bucket.file_index[4 * register + lane];
                        if index != own_index {
                            insert(list, candidate(distances[lane], index));
                        }
                    }
                }
            }
            bound = larger(bound, list[list.len() - 1]);
        }
        self.bound = bound;
    }
}

/// Inserts into an ascending list of fixed length and drops the last. Every place is decided without a branch from
/// itself and the one before, so the places do not wait for each other.
fn insert(list: &mut [Candidate], new: Candidate) {
    let mut here = list[list.len() - 1];
    for place in (1..list.len()).rev() {
        let before = list[place - 1];
        list[place] = smaller(here, larger(before, new));
        here = before;
    }
    list[0] = smaller(here, new);
}

/// One instruction, unlike `f64::min`, which has to care for NaN.
fn smaller(a: Candidate, b: Candidate) -> Candidate {
    if a < b { a } else { b }
}

fn larger(a: Candidate, b: Candidate) -> Candidate {
    if a > b { a } else { b }
}

fn box_distance_squared(a: &NodeBox, b: &NodeBox) -> f32 {
    squared((b.min - a.max).max(a.min - b.max).max(Vec3::ZERO))
}

fn point_box_distance_squared(point: Vec3, node: &NodeBox) -> f32 {
    squared((node.min - point).max(point - node.max).max(Vec3::ZERO))
}

/// Added in the order in which the distances of points are.
fn squared(v: Vec3) -> f32 {
    v.x * v.x + v.y * v.y + v.z * v.z
}
