//! The k nearest neighbours of the eight points of one bucket, found together and exactly.
//!
//! How it works: the points are first compared with each other and the buckets of their row, those split off last
//! first, which bounds the distance of their neighbours; then the tree is climbed to its top, and at every step the
//! other children are descended into as far as their boxes are within the worst of the eight bounds.
//!
//! A register holds the distances of the *eight searching points* to one candidate. This row is stored for each
//! candidate near enough for one of the eight, and for each searching point the k smallest distances so far
//! ([`super::smallest_rows`]). The candidates with the k smallest distances are found once, at the end, by comparing
//! all rows with the k-th.
//!
//! Equal distances are decided by the index in the file. Only where more candidates than k are within the k-th distance
//! must they be examined one by one. Pruning accounts for it as well: a box at exactly the bound is entered only if it
//! holds an index that could still win. Without that, points that all coincide would make every bucket visit every
//! other.
//!
//! When it wins: the descent is paid once for eight points, eight boxes are tested at once, and there is no branch, no
//! index and no heap in the hot loop.
//!
//! Pruning is exact in f32: subtraction, multiplication and addition round monotonically, so the distance to a box,
//! computed in the same order of operations, never exceeds the computed distance to a point inside.

use super::point_tree::{BoxRow, LANES, LaneRow, PointTree};
use super::smallest_rows::SmallestRows;
use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x8, mask32x8, u32x8};

/// Rows whose answers fit the bits of one lane.
const ROWS_PER_WORD: usize = u32::BITS as usize;

/// Words a lane, and the candidates they have bits for: with 16 neighbours nearly all searches keep fewer.
// With two words, 8 % of the buckets would have more candidates than there are bits (0.7 % with 12 neighbours); none
// has more than 128.
const WORDS: usize = 4;
const ROWS_PER_LIST: usize = WORDS * ROWS_PER_WORD;

/// Reusable search state of the points of one bucket.
#[derive(Debug)]
pub(super) struct BucketSearch<'a> {
    tree: &'a PointTree,
    k: usize,
    /// The bucket that searches, and how many points it has.
    bucket: usize,
    count: usize,
    /// Box of the searching points.
    min: [f32; 3],
    max: [f32; 3],
    /// Candidates that were near enough for one of them.
    row_count: usize,
    /// Squared distances to each of these candidates. The vectors only grow.
    rows: Vec<LaneRow>,
    /// The slots of these candidates.
    slots: Vec<u32>,
    /// The k smallest squared distances of each.
    nearest: SmallestRows,
    /// The worst k-th distance (squared) of all searching points.
    bound: f32,
    /// First file index from which points at exactly the bound cannot win; `None` until needed.
    tie_limit: Option<u32>,
    /// Stack of nodes still to be descended into.
    stack: Vec<Child>,
    /// Candidates of one searching point, where they have to be put in order.
    candidates: Vec<Candidate>,
}

/// A bucket (level 0) or a row of boxes that may hold neighbours.
#[derive(Debug, Clone, Copy)]
struct Child {
    /// Smaller for nodes to visit earlier: bits of the squared distance, then the smallest file index inside.
    rank: u64,
    level: u32,
    index: u32,
}

impl Child {
    fn distance_squared(&self) -> f32 {
        f32::from_bits((self.rank >> 32) as u32)
    }

    fn min_file_index(&self) -> u32 {
        self.rank as u32
    }
}

/// A candidate of one searching point.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    distance_squared: f32,
    file_index: u32,
    row: usize,
}

impl<'a> BucketSearch<'a> {
    pub(in crate::analysis) fn new(tree: &'a PointTree, k: usize) -> Self {
        Self {
            tree,
            k,
            bucket: 0,
            count: 0,
            min: [0.0; 3],
            max: [0.0; 3],
            row_count: 0,
            rows: vec![[0.0; LANES]; ROWS_PER_LIST],
            slots: vec![0; ROWS_PER_LIST],
            nearest: SmallestRows::new(k),
            bound: f32::INFINITY,
            tie_limit: None,
            stack: Vec::new(),
            candidates: Vec::new(),
        }
    }

    /// Writes the k neighbours of each point of `bucket`, as slots. Inlined, so that it is compiled for each level of
    /// SIMD.
    #[inline(always)]
    pub(super) fn run<S: Simd>(&mut self, simd: S, bucket: usize, lists: &mut [u32]) {
        self.begin(bucket);
        self.meet(simd, bucket);
        self.meet_siblings(simd);
        let mut node = bucket / LANES;
        for (level, rows) in self.tree.levels.iter().enumerate().skip(1) {
            let row = node / LANES;
            self.push(simd, level, row, &rows[row], node % LANES);
            while let Some(child) = self.stack.pop() {
                self.descend(simd, child);
            }
            node = row;
        }
        self.write_lists(simd, lists);
    }

    /// Clears the results.
    fn begin(&mut self, bucket: usize) {
        self.bucket = bucket;
        self.count = (self.tree.len() - LANES * bucket).min(LANES);
        let boxes = &self.tree.levels[0][bucket / LANES];
        let lane = bucket % LANES;
        self.min = boxes.min.map(|row| row[lane]);
        self.max = boxes.max.map(|row| row[lane]);
        self.row_count = 0;
        // Lanes without a point accept nothing.
        let nothing_found = std::array::from_fn(|lane| if lane < self.count { f32::INFINITY } else { -1.0 });
        self.nearest.reset(nothing_found);
        self.bound = f32::INFINITY;
        self.tie_limit = None;
    }

    /// Offers the points of the other buckets of the row to the searching points. Buckets whose lanes differ in low
    /// bits only were split last, so they are near: nothing needs to be put in order while all are within an infinite
    /// bound.
    #[inline(always)]
    fn meet_siblings<S: Simd>(&mut self, simd: S) {
        let (row, own) = (self.bucket / LANES, self.bucket % LANES);
        let boxes = &self.tree.levels[0][row];
        let distances_squared: LaneRow = self.distances_squared(simd, boxes).into();
        for difference in 1..LANES {
            let lane = own ^ difference;
            // Boxes without points are infinitely far.
            if distances_squared[lane] <= self.bound.min(f32::MAX) {
                self.meet(simd, LANES * row + lane);
            }
        }
    }

    /// Pushes those of eight children that are near enough, the nearest on top; among equally near ones, the lowest
    /// index. Excludes lane `own`.
    #[inline(always)]
    fn push<S: Simd>(&mut self, simd: S, level: usize, row: usize, boxes: &BoxRow, own: usize) {
        let distances_squared = self.distances_squared(simd, boxes);
        // Boxes without points are infinitely far.
        let near = distances_squared.simd_le(f32x8::splat(simd, self.bound.min(f32::MAX)));
        if !near.any_true() {
            return;
        }
        let distances_squared: LaneRow = distances_squared.into();
        let mut lanes = bits_of(simd, near) & !(1 << own);
        let pushed_before = self.stack.len();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let distance = u64::from(distances_squared[lane].to_bits());
            self.stack.push(Child {
                rank: distance << 32 | u64::from(boxes.min_file_index[lane]),
                level: level as u32,
                index: (LANES * row + lane) as u32,
            });
            let mut place = self.stack.len() - 1;
            while place > pushed_before && self.stack[place - 1].rank < self.stack[place].rank {
                self.stack.swap(place - 1, place);
                place -= 1;
            }
        }
    }

    /// Squared distances from the searching points to eight boxes, at least.
    #[inline(always)]
    fn distances_squared<S: Simd>(&self, simd: S, boxes: &BoxRow) -> f32x8<S> {
        let x = self.gap(simd, boxes, 0);
        let y = self.gap(simd, boxes, 1);
        let z = self.gap(simd, boxes, 2);
        // Summed in the same order as the distances of points.
        x * x + y * y + z * z
    }

    /// Computes the minimum distance of the searching points from eight boxes along an axis.
    #[inline(always)]
    fn gap<S: Simd>(&self, simd: S, boxes: &BoxRow, axis: usize) -> f32x8<S> {
        let above = f32x8::from_slice(simd, &boxes.min[axis]) - self.max[axis];
        let below = f32x8::splat(simd, self.min[axis]) - f32x8::from_slice(simd, &boxes.max[axis]);
        above.max(below).max(0.0)
    }

    #[inline(always)]
    fn descend<S: Simd>(&mut self, simd: S, child: Child) {
        let distance_squared = child.distance_squared();
        if distance_squared > self.bound {
            return;
        }
        if distance_squared == self.bound && child.min_file_index() >= self.tie_limit() {
            return;
        }
        let index = child.index as usize;
        match child.level.checked_sub(1) {
            None => self.meet(simd, index),
            Some(level) => {
                let level = level as usize;
                let boxes = &self.tree.levels[level][index];
                self.push(simd, level, index, boxes, LANES);
            }
        }
    }

    /// Offers the points of a bucket to the searching points.
    #[inline(always)]
    fn meet<S: Simd>(&mut self, simd: S, bucket: usize) {
        let searching = &self.tree.buckets[self.bucket];
        let candidates = &self.tree.buckets[bucket];
        let x = f32x8::from_slice(simd, &searching.x);
        let y = f32x8::from_slice(simd, &searching.y);
        let z = f32x8::from_slice(simd, &searching.z);
        // All are written, and those that are near enough are retained: the branch would be unpredictable.
        if self.rows.len() < self.row_count + LANES {
            self.rows.resize(2 * self.row_count + LANES, [0.0; LANES]);
            self.slots.resize(self.rows.len(), 0);
        }
        let Some(rows) = self.rows[self.row_count..].first_chunk_mut::<LANES>() else {
            return;
        };
        let slots = &mut self.slots[self.row_count..][..LANES];
        let kth = f32x8::from_slice(simd, self.nearest.largest());
        let is_own = bucket == self.bucket;
        let mut near = 0;
        for place in 0..LANES {
            let dx = f32x8::splat(simd, candidates.x[place]) - x;
            let dy = f32x8::splat(simd, candidates.y[place]) - y;
            let dz = f32x8::splat(simd, candidates.z[place]) - z;
            let distances = dx * dx + dy * dy + dz * dz;
            distances.store_slice(&mut rows[near]);
            slots[near] = (LANES * bucket + place) as u32;
            if is_own {
                // No point is its own neighbour.
                rows[near][place] = f32::INFINITY;
            }
            near += usize::from(distances.simd_le(kth).any_true());
        }
        if near == 0 {
            return;
        }
        self.nearest.offer(simd, rows, near);
        self.row_count += near;
        let kth = f32x8::from_slice(simd, self.nearest.largest());
        let of_halves = kth.max(kth.slide::<4>(kth));
        let of_quarters = of_halves.max(of_halves.slide::<2>(of_halves));
        self.bound = of_quarters[0].max(of_quarters[1]);
        self.tie_limit = None;
    }

    /// Returns the tie limit: of the points at exactly the bound, those from this file index on cannot be among the
    /// nearest.
    ///
    /// Keeps only the candidates that count: many at equal distances would otherwise be compared over and over.
    #[cold]
    fn tie_limit(&mut self) -> u32 {
        if let Some(limit) = self.tie_limit {
            return limit;
        }
        let mut limit = 0;
        let mut retained = vec![false; self.row_count];
        for lane in 0..self.count {
            self.put_in_order(lane);
            for candidate in &self.candidates {
                retained[candidate.row] = true;
            }
            if self.nearest.largest()[lane] == self.bound {
                let kth = self.candidates.get(self.k - 1);
                limit = limit.max(kth.map_or(u32::MAX, |kth| kth.file_index));
            }
        }
        self.row_count = 0;
        for (row, _) in retained.iter().enumerate().filter(|&(_, &retained)| retained) {
            self.rows[self.row_count] = self.rows[row];
            self.slots[self.row_count] = self.slots[row];
            self.row_count += 1;
        }
        self.tie_limit = Some(limit);
        limit
    }

    /// Sets `candidates` to the k nearest of the searching point in a lane, or all if there are fewer, in order.
    fn put_in_order(&mut self, lane: usize) {
        // Places without a point are infinitely far.
        let kth = self.nearest.largest()[lane].min(f32::MAX);
        let within = self.rows[..self.row_count]
            .iter()
            .map(|distances_squared| distances_squared[lane])
            .enumerate()
            .filter(|&(_, distance_squared)| distance_squared <= kth)
            .map(|(row, distance_squared)| Candidate {
                distance_squared,
                file_index: self.tree.points()[self.slots[row] as usize].file_index,
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
    fn write_lists<S: Simd>(&mut self, simd: S, lists: &mut [u32]) {
        let kth = f32x8::from_slice(simd, self.nearest.largest());
        let mut words = [[0; LANES]; WORDS];
        let rows = &self.rows[..self.row_count];
        for (words, rows) in words.iter_mut().zip(rows.chunks(ROWS_PER_WORD)) {
            rows_within(simd, rows, kth).store_slice(words);
        }
        let fits_words = self.row_count <= ROWS_PER_LIST;
        for (lane, list) in lists.chunks_exact_mut(self.k).enumerate() {
            let half = |low: usize| u64::from(words[low][lane]) | u64::from(words[low + 1][lane]) << ROWS_PER_WORD;
            let (near, far) = (half(0), half(2));
            let near_count = near.count_ones() as usize;
            match self.slots.first_chunk::<ROWS_PER_LIST>() {
                Some(slots) if fits_words && near_count + far.count_ones() as usize == self.k => {
                    let (near_slots, far_slots) = slots.split_at(ROWS_PER_LIST / 2);
                    let (near_list, far_list) = list.split_at_mut(near_count);
                    write_slots(near, near_slots, near_list);
                    write_slots(far, far_slots, far_list);
                }
                _ => {
                    self.put_in_order(lane);
                    for (slot, candidate) in list.iter_mut().zip(&self.candidates) {
                        *slot = self.slots[candidate.row];
                    }
                }
            }
        }
    }
}

/// Writes the slots of the rows whose bits are set. Precondition: `list` has as many entries as set bits, of 64.
#[inline(always)]
fn write_slots(mut rows_within: u64, slots: &[u32], list: &mut [u32]) {
    let Some(slots) = slots.first_chunk::<{ u64::BITS as usize }>() else {
        return;
    };
    for slot in list {
        // The remainder tells the compiler that the index is in bounds.
        *slot = slots[rows_within.trailing_zeros() as usize % slots.len()];
        rows_within &= rows_within.wrapping_sub(1);
    }
}

/// For each of at most 32 rows one bit, in each lane whether its distance is not above the k-th.
#[inline(always)]
fn rows_within<S: Simd>(simd: S, rows: &[LaneRow], kth: f32x8<S>) -> u32x8<S> {
    let zero = u32x8::splat(simd, 0);
    let mut words = zero;
    for (bit, row) in rows.iter().enumerate() {
        let is_within = f32x8::from_slice(simd, row).simd_le(kth);
        words |= simd.select_u32x8(is_within, u32x8::splat(simd, 1 << bit), zero);
    }
    words
}

/// One bit for each lane that is true.
#[inline(always)]
fn bits_of<S: Simd>(simd: S, mask: mask32x8<S>) -> u32 {
    let lane_bits = u32x8::from_slice(simd, &[1, 2, 4, 8, 16, 32, 64, 128]);
    let bits = simd.select_u32x8(mask, lane_bits, u32x8::splat(simd, 0));
    let bits = bits | bits.slide::<4>(bits);
    let bits = bits | bits.slide::<2>(bits);
    bits[0] | bits[1]
}
