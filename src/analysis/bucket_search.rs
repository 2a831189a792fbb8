//! The k nearest neighbours of the 16 points of one bucket, found together and exactly.
//!
//! How it works: the points first meet those of their own bucket, which bounds how far their neighbours can be; then the
//! tree is climbed from the bucket to the root, and at every step the sibling subtree is descended into as far as its boxes
//! are within the worst of the 16 bounds.
//!
//! A register holds the distances of *eight searching points* to one candidate. Of the candidates that are near enough for
//! one of the eight, this row is kept, and for each searching point the k smallest distances so far: a candidate is sunk
//! into the k sorted registers by a smaller and a larger each, without branches, for eight points at a time. Which
//! candidates the k smallest distances belong to is asked once, at the end, by comparing all rows with the k-th.
//!
//! Equal distances are decided by the index in the file. Only where more candidates than k are within the k-th distance
//! must they be looked at one by one. Pruning knows about it as well: a box at exactly the bound is entered only if it
//! holds an index that could still win. Without that, points that all coincide would make every bucket visit every other.
//!
//! When it wins: descending is paid once for 16 points, and there is no branch, no index and no heap where most of the time
//! goes.
//!
//! Pruning is exact in f32: subtraction, multiplication and addition round monotonically, so the distance to a box, computed
//! in the same order of operations, never exceeds the computed distance to a point inside.

use super::point_tree::{BUCKET, NodeBox, PointTree};
use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x8};
use glam::Vec4;

/// Points that search in the lanes of one register.
const LANES: usize = 8;

/// One number for each of eight searching points.
type Row = [f32; LANES];

/// What is kept while the points of one bucket search; reused for the next.
#[derive(Debug)]
pub(super) struct BucketSearch<'a> {
    tree: &'a PointTree,
    /// Box of the searching points.
    around: NodeBox,
    halves: [Half<'a>; BUCKET / LANES],
    /// The worst k-th distance (squared) of all searching points.
    bound: f32,
    /// From which file index on points at exactly the bound cannot win; `None` until somebody asks.
    tie_limit: Option<u32>,
    /// Nodes to be descended into, with the squared distances of their boxes.
    stack: Vec<(u32, f32)>,
    /// One place more than a list has.
    scratch: Vec<u32>,
}

impl<'a> BucketSearch<'a> {
    pub(super) fn new(tree: &'a PointTree, k: usize) -> Self {
        Self {
            tree,
            around: tree.nodes[0],
            halves: [Half::new(tree, k), Half::new(tree, k)],
            bound: f32::INFINITY,
            tie_limit: None,
            stack: Vec::new(),
            scratch: vec![0; k + 1],
        }
    }

    /// Writes the k neighbours of each point of `bucket`, as slots. Inlined, so that it is compiled for each level of SIMD.
    #[inline(always)]
    pub(super) fn run<S: Simd>(&mut self, simd: S, bucket: usize, slots: &mut [u32]) {
        let leaf = self.tree.first_leaf() + bucket;
        self.around = self.tree.nodes[leaf];
        let first_slots = (BUCKET * bucket..).step_by(LANES);
        for (half, first_slot) in self.halves.iter_mut().zip(first_slots) {
            half.begin(first_slot);
        }
        self.meet(simd, bucket);
        let mut node = leaf;
        while node > 1 {
            self.push(node ^ 1);
            while let Some((below, distance_squared)) = self.stack.pop() {
                self.descend(simd, below as usize, distance_squared);
            }
            node /= 2;
        }
        let k = self.halves[0].k;
        for (half, lists) in self.halves.iter_mut().zip(slots.chunks_mut(LANES * k)) {
            half.write_lists(lists, &mut self.scratch);
        }
    }

    #[inline(always)]
    fn push(&mut self, node: usize) {
        let distance_squared = box_distance_squared(&self.around, &self.tree.nodes[node]);
        if distance_squared <= self.bound {
            self.stack.push((node as u32, distance_squared));
        }
    }

    #[inline(always)]
    fn descend<S: Simd>(&mut self, simd: S, node: usize, distance_squared: f32) {
        if distance_squared > self.bound {
            return;
        }
        if distance_squared == self.bound && self.tree.min_file_index[node] >= self.tie_limit() {
            return;
        }
        let first_leaf = self.tree.first_leaf();
        if node >= first_leaf {
            if node - first_leaf < self.tree.buckets.len() {
                self.meet(simd, node - first_leaf);
            }
            return;
        }
        // The nearer child is taken first: it tightens the bound for the other. Of two equally near ones, that with the
        // lowest index is.
        let [low, high] = [2 * node, 2 * node + 1];
        let distance_to =
            |child: usize| box_distance_squared(&self.around, &self.tree.nodes[child]);
        let (to_low, to_high) = (distance_to(low), distance_to(high));
        let index_in = |child: usize| self.tree.min_file_index[child];
        let high_first = to_high < to_low || (to_high == to_low && index_in(high) < index_in(low));
        let (low, high) = ((low as u32, to_low), (high as u32, to_high));
        let (first, second) = if high_first { (high, low) } else { (low, high) };
        self.stack.push(second);
        self.stack.push(first);
    }

    /// Offers the points of a bucket to all searching points.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, simd: S, bucket: usize) {
        self.tie_limit = None;
        self.bound = 0.0;
        for half in &mut self.halves {
            half.meet(simd, bucket);
            self.bound = self.bound.max(half.bound);
        }
    }

    /// Of the points at exactly the bound, those from this file index on cannot be among the nearest.
    #[cold]
    fn tie_limit(&mut self) -> u32 {
        if let Some(limit) = self.tie_limit {
            return limit;
        }
        let bound = self.bound;
        let limits = self.halves.iter_mut().map(|half| half.tie_limit(bound));
        let limit = limits.max().unwrap_or(u32::MAX);
        self.tie_limit = Some(limit);
        limit
    }
}

/// Eight searching points.
#[derive(Debug)]
struct Half<'a> {
    tree: &'a PointTree,
    k: usize,
    /// Slot of the first of them.
    first_slot: usize,
    /// How many there really are.
    count: usize,
    /// Box of them.
    around: NodeBox,
    /// Candidates that were near enough for one of them.
    row_count: usize,
    /// Squared distances to each of these candidates. The vectors only grow.
    rows: Vec<Row>,
    /// The slots of these candidates.
    slots: Vec<u32>,
    /// The k smallest squared distances, ascending.
    nearest: Vec<Row>,
    /// The largest of the k-th.
    bound: f32,
    /// Candidates of one searching point, where they have to be put in order.
    candidates: Vec<Candidate>,
}

impl<'a> Half<'a> {
    fn new(tree: &'a PointTree, k: usize) -> Self {
        Self {
            tree,
            k,
            first_slot: 0,
            count: 0,
            around: tree.nodes[0],
            row_count: 0,
            rows: Vec::new(),
            slots: Vec::new(),
            nearest: vec![[f32::INFINITY; LANES]; k],
            bound: f32::INFINITY,
            candidates: Vec::new(),
        }
    }

    /// Forgets what was found, for the points from `first_slot` on.
    fn begin(&mut self, first_slot: usize) {
        self.first_slot = first_slot;
        self.count = self.tree.len().saturating_sub(first_slot).min(LANES);
        let searching = &self.tree.positions()[first_slot.min(self.tree.len())..][..self.count];
        self.around = NodeBox::around(searching.iter().copied());
        self.row_count = 0;
        self.nearest.fill([f32::INFINITY; LANES]);
        self.bound = if self.count == 0 { -1.0 } else { f32::INFINITY };
    }

    #[inline(always)]
    fn meet<S: Simd>(&mut self, simd: S, bucket: usize) {
        let below = &self.tree.nodes[self.tree.first_leaf() + bucket];
        if box_distance_squared(&self.around, below) > self.bound {
            return;
        }
        let lanes = self.first_slot % BUCKET..self.first_slot % BUCKET + LANES;
        let searching = &self.tree.buckets[self.first_slot / BUCKET];
        let candidates = &self.tree.buckets[bucket];
        let x = f32x8::from_slice(simd, &searching.x[lanes.clone()]);
        let y = f32x8::from_slice(simd, &searching.y[lanes.clone()]);
        let z = f32x8::from_slice(simd, &searching.z[lanes]);
        // Where a candidate's own lane would be, if it is one of the searching points.
        let first_lane = (BUCKET * bucket).wrapping_sub(self.first_slot);
        // All are written, and those that are near enough stay: whether one is, no processor can guess.
        if self.rows.len() < self.row_count + BUCKET {
            self.rows.resize(2 * self.row_count + BUCKET, [0.0; LANES]);
            self.slots.resize(self.rows.len(), 0);
        }
        let rows = &mut self.rows[self.row_count..][..BUCKET];
        let slots = &mut self.slots[self.row_count..][..BUCKET];
        let kth = f32x8::from_slice(simd, &self.nearest[self.k - 1]);
        let mut near = 0;
        for place in 0..BUCKET {
            let dx = f32x8::splat(simd, candidates.x[place]) - x;
            let dy = f32x8::splat(simd, candidates.y[place]) - y;
            let dz = f32x8::splat(simd, candidates.z[place]) - z;
            let distances = dx * dx + dy * dy + dz * dz;
            distances.store_slice(&mut rows[near]);
            slots[near] = (BUCKET * bucket + place) as u32;
            let own_lane = first_lane.wrapping_add(place);
            if own_lane < LANES {
                // No point is its own neighbour.
                rows[near][own_lane] = f32::INFINITY;
            }
            near += usize::from(distances.simd_le(kth).any_true());
        }
        for row in &rows[..near] {
            sink(simd, &mut self.nearest, f32x8::from_slice(simd, row));
        }
        self.row_count += near;
        let kth = &self.nearest[self.k - 1][..self.count];
        self.bound = kth.iter().copied().fold(0.0, f32::max);
    }

    /// See [`BucketSearch::tie_limit`]; 0 if none of the k-th distances is `bound`.
    ///
    /// Keeps only the candidates that count: many at equal distances would otherwise be compared over and over.
    fn tie_limit(&mut self, bound: f32) -> u32 {
        let mut limit = 0;
        let mut kept = vec![false; self.row_count];
        for lane in 0..self.count {
            self.put_in_order(lane);
            for candidate in &self.candidates {
                kept[candidate.row] = true;
            }
            if self.nearest[self.k - 1][lane] == bound {
                let kth = self.candidates.get(self.k - 1);
                limit = limit.max(kth.map_or(u32::MAX, |kth| kth.file_index));
            }
        }
        self.row_count = 0;
        for (row, _) in kept.iter().enumerate().filter(|&(_, &kept)| kept) {
            self.rows[self.row_count] = self.rows[row];
            self.slots[self.row_count] = self.slots[row];
            self.row_count += 1;
        }
        limit
    }

    /// Sets `candidates` to the k nearest of the searching point in a lane, or as many as there are, in order.
    fn put_in_order(&mut self, lane: usize) {
        // Places without a point are infinitely far.
        let kth = self.nearest[self.k - 1][lane].min(f32::MAX);
        let within = self.rows[..self.row_count]
            .iter()
            .map(|distances_squared| distances_squared[lane])
            .enumerate()
            .filter(|&(_, distance_squared)| distance_squared <= kth)
            .map(|(row, distance_squared)| Candidate {
                distance_squared,
                file_index: self.tree.file_index_of(self.slots[row]),
                row,
            });
        self.candidates.clear();
        self.candidates.extend(within);
        self.candidates.sort_unstable_by(|a, b| {
            let by_distance = a.distance_squared.total_cmp(&b.distance_squared);
            by_distance.then(a.file_index.cmp(&b.file_index))
        });
        self.candidates.truncate(self.k);
    }

    /// Writes the k nearest candidates of each searching point, as slots.
    #[inline(always)]
    fn write_lists(&mut self, lists: &mut [u32], scratch: &mut [u32]) {
        let kth = self.nearest[self.k - 1];
        for (lane, list) in lists.chunks_exact_mut(self.k).enumerate() {
            let mut found = 0;
            for (distances_squared, &slot) in self.rows[..self.row_count].iter().zip(&self.slots) {
                let within = distances_squared[lane] <= kth[lane];
                // Overwritten until a slot that is within the k-th distance moves on.
                scratch[found.min(self.k)] = slot;
                found += usize::from(within);
            }
            list.copy_from_slice(&scratch[..self.k]);
            if found > self.k {
                self.put_in_order(lane);
                for (slot, candidate) in list.iter_mut().zip(&self.candidates) {
                    *slot = self.slots[candidate.row];
                }
            }
        }
    }
}

/// A candidate of one searching point.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    distance_squared: f32,
    file_index: u32,
    row: usize,
}

/// Puts `distances` where they belong in the ascending registers `nearest` and drops what is largest.
#[inline(always)]
fn sink<S: Simd>(simd: S, nearest: &mut [Row], distances: f32x8<S>) {
    let mut sinking = distances;
    for row in nearest {
        let here = f32x8::from_slice(simd, row);
        here.min(sinking).store_slice(row);
        sinking = here.max(sinking);
    }
}

#[inline(always)]
fn box_distance_squared(a: &NodeBox, b: &NodeBox) -> f32 {
    let apart = (b.min - a.max).max(a.min - b.max).max(Vec4::ZERO);
    // Added in the order in which the distances of points are.
    apart.x * apart.x + apart.y * apart.y + apart.z * apart.z
}
