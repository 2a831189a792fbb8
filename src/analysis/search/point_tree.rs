//! A k-d tree over points in buckets of eight: the order in which analysis works, and the boxes that searches prune by.
//!
//! How it works: the points are split at the median of the longest side of their box until eight are left, with the
//! median rounded to a whole bucket. So bucket `b` holds the *slots* `8 b .. 8 b + 8`, points that are close in space
//! are close in memory, and the tree needs no pointers. Three splits on top of each other are one [`BoxRow`]: the boxes
//! of eight children, tested with one register for each side. Row `r` of the lowest level has the buckets `8 r .. 8 r +
//! 8`, row `r` of any other the rows `8 r .. 8 r + 8` of the level below.
//!
//! When it wins: over a uniform grid wherever density varies. A cluster with an outlier a million times its size away,
//! or a LiDAR's sweep, is split as evenly as a sphere; even points that all coincide are shared out among buckets.
//!
//! Coordinates are scaled by a power of two into −1..1, which is exact, so that squared distances neither overflow nor
//! (for clouds of one scale) underflow.

use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::sync::OnceLock;

/// Points a bucket, and boxes a row: one SIMD register.
pub(in crate::analysis) const LANES: usize = 8;

/// One number for each of eight points or boxes.
pub(in crate::analysis) type LaneRow = [f32; LANES];

/// Below this many points a split is not worth handing to another thread.
const PARALLEL_SPLIT: usize = 4096;

/// Points in slot order, and the boxes above them.
#[derive(Debug)]
pub(in crate::analysis) struct PointTree {
    points: Vec<SlotPoint>,
    /// The slot of each point of the file, computed on demand: searches do not need it.
    slots: OnceLock<Vec<u32>>,
    pub(in crate::analysis) buckets: Vec<Bucket>,
    /// Boxes of the buckets first, one row at the end; none without points.
    pub(in crate::analysis) levels: Vec<Vec<BoxRow>>,
    /// Scene units of one scaled unit: a power of two.
    unit: f32,
}

/// The coordinates of eight slots. Places without a point are so far away that the square of their distance is
/// infinite.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Bucket {
    pub(in crate::analysis) x: LaneRow,
    pub(in crate::analysis) y: LaneRow,
    pub(in crate::analysis) z: LaneRow,
}

/// The boxes of eight children, side by side. Those without points are inside out and infinitely far.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct BoxRow {
    pub(in crate::analysis) min: [LaneRow; 3],
    pub(in crate::analysis) max: [LaneRow; 3],
    /// The smallest file index in each, to decide between equal distances.
    pub(super) min_file_index: [u32; LANES],
}

impl BoxRow {
    fn new(children: &[NodeBox]) -> Self {
        let child = |lane: usize| children.get(lane).copied().unwrap_or(NodeBox::EMPTY);
        let row = |value: &dyn Fn(NodeBox) -> f32| std::array::from_fn(|lane| value(child(lane)));
        Self {
            min: [0, 1, 2].map(|axis| row(&|child| child.min[axis])),
            max: [0, 1, 2].map(|axis| row(&|child| child.max[axis])),
            min_file_index: std::array::from_fn(|lane| child(lane).min.w.to_bits()),
        }
    }
}

/// The box of some points, and the file indices in it: a [`SlotPoint`] in each corner.
#[derive(Debug, Clone, Copy)]
struct NodeBox {
    min: Vec4,
    max: Vec4,
}

impl NodeBox {
    const EMPTY: Self = Self {
        min: Vec4::INFINITY,
        max: Vec4::NEG_INFINITY,
    };

    fn around(points: &[SlotPoint]) -> Self {
        points.iter().fold(Self::EMPTY, |node, point| Self {
            min: node.min.min(point.register()),
            max: node.max.max(point.register()),
        })
    }

    fn union(nodes: &[Self]) -> Self {
        nodes.iter().fold(Self::EMPTY, |union, node| Self {
            min: union.min.min(node.min),
            max: union.max.max(node.max),
        })
    }
}

/// A point in its slot, or while it moves there: fits one register of four.
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(16))]
pub(in crate::analysis) struct SlotPoint {
    /// In scaled units.
    pub(in crate::analysis) position: Vec3,
    /// Its index in the file.
    pub(in crate::analysis) file_index: u32,
}

impl SlotPoint {
    /// The position, and the bits of the index, which have the same order as a positive float.
    pub(in crate::analysis) fn register(&self) -> Vec4 {
        bytemuck::cast(*self)
    }
}

impl PointTree {
    /// Sorts finite `positions` into buckets.
    pub(in crate::analysis) fn new(positions: &[Vec3]) -> Self {
        let unit = power_of_two_at_least(
            positions
                .iter()
                .fold(Vec3::ZERO, |reach, position| reach.max(position.abs()))
                .max_element(),
        );
        let mut points: Vec<SlotPoint> = positions
            .iter()
            .zip(0..)
            .map(|(&position, file_index)| SlotPoint {
                position: position / unit,
                file_index,
            })
            .collect();
        let bucket_count = points.len().div_ceil(LANES);
        // Buckets cut from a Morton (Hilbert) order are built in less time, 3 (8) ms instead of 7, but their boxes
        // overlap so much that the search takes 38 (28) ms instead of 18 (100,000 points). A grid loses on outliers and
        // duplicates.
        split(&mut points, bucket_count.next_power_of_two() / 2 * LANES);

        let boxes = points.chunks(LANES).map(NodeBox::around).collect();
        Self {
            buckets: points.chunks(LANES).map(Bucket::new).collect(),
            points,
            slots: OnceLock::new(),
            levels: rows_above(boxes),
            unit,
        }
    }

    /// Frees the part that only searches need, the larger half.
    pub(in crate::analysis) fn forget_boxes(&mut self) {
        self.buckets = Vec::new();
        self.levels = Vec::new();
    }

    /// Number of points.
    pub(in crate::analysis) fn len(&self) -> usize {
        self.points.len()
    }

    /// The points by slot.
    pub(in crate::analysis) fn points(&self) -> &[SlotPoint] {
        &self.points
    }

    /// Scene units of one scaled unit.
    pub(in crate::analysis) fn unit(&self) -> f32 {
        self.unit
    }

    /// The slot of a point of the file.
    pub(in crate::analysis) fn slot_of(&self, file_index: u32) -> u32 {
        self.slots()[file_index as usize]
    }

    fn slots(&self) -> &[u32] {
        self.slots.get_or_init(|| {
            let mut slots = vec![0; self.points.len()];
            for (point, slot) in self.points.iter().zip(0..) {
                slots[point.file_index as usize] = slot;
            }
            slots
        })
    }

    /// `values` by slot, rearranged to the order of the file.
    pub(in crate::analysis) fn to_file_order<T: Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        at_slots(self.slots(), values)
    }

    /// Reduces the tree to its file order: the mapping back to the order of the file.
    pub(in crate::analysis) fn into_file_order(self) -> FileOrder {
        self.slots();
        FileOrder {
            slots: self.slots.into_inner().unwrap_or_default(),
        }
    }

    /// The points of the file in these slots, ascending.
    pub(in crate::analysis) fn to_file_indices(&self, slots: &[u32]) -> Vec<u32> {
        let points = slots.iter().map(|&slot| &self.points[slot as usize]);
        let mut indices: Vec<u32> = points.map(|point| point.file_index).collect();
        indices.sort_unstable();
        indices
    }

    /// `values` in the order of the file, rearranged by slot.
    pub(in crate::analysis) fn to_slot_order<T: Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        self.points
            .par_iter()
            .with_min_len(1 << 13)
            .map(|point| values[point.file_index as usize])
            .collect()
    }
}

/// File order: the slots of the points of a file in a tree.
#[derive(Debug)]
pub(in crate::analysis) struct FileOrder {
    slots: Vec<u32>,
}

impl FileOrder {
    /// `values` by slot, rearranged to the order of the file.
    pub(in crate::analysis) fn of<T: Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        at_slots(&self.slots, values)
    }
}

fn at_slots<T: Copy + Send + Sync>(slots: &[u32], values: &[T]) -> Vec<T> {
    let values = slots
        .par_iter()
        .with_min_len(1 << 13)
        .map(|&slot| values[slot as usize]);
    values.collect()
}

impl Bucket {
    fn new(points: &[SlotPoint]) -> Self {
        let axis =
            |axis: usize| std::array::from_fn(|place| points.get(place).map_or(f32::MAX, |point| point.position[axis]));
        Self {
            x: axis(0),
            y: axis(1),
            z: axis(2),
        }
    }
}

/// Splits `points` at `half` (a power of two of buckets, and at least half of them) and both parts again.
fn split(points: &mut [SlotPoint], half: usize) {
    if half < LANES {
        return;
    }
    if points.len() <= half {
        return split(points, half / 2);
    }
    // Boxes cut at the median instead of at a measured place save 5 % of the tree and cost 40 % of the search.
    let node = NodeBox::around(points);
    // Compiled separately for each axis.
    match (node.max - node.min).truncate().max_position() {
        0 => part_at(points, half, |point| point.position.x),
        1 => part_at(points, half, |point| point.position.y),
        _ => part_at(points, half, |point| point.position.z),
    }
    let parallel = points.len() > PARALLEL_SPLIT;
    let (low, high) = points.split_at_mut(half);
    if parallel {
        rayon::join(|| split(low, half / 2), || split(high, half / 2));
    } else {
        split(low, half / 2);
        split(high, half / 2);
    }
}

/// Moves the `count` points with the smallest coordinates to the front.
#[inline]
fn part_at(points: &mut [SlotPoint], count: usize, coordinate: impl Fn(&SlotPoint) -> f32) {
    // Partitioning out of place at a bracket of two sampled values took a quarter longer than this selection; counting
    // instead of sorting the last sixteen points made no difference.
    points.select_nth_unstable_by(count, |a, b| {
        // The values are finite, so there is an order; and where only "less" is needed, this is one instruction.
        let order = coordinate(a).partial_cmp(&coordinate(b));
        order.unwrap_or(Ordering::Equal)
    });
}

/// The rows of all levels above these boxes.
fn rows_above(mut boxes: Vec<NodeBox>) -> Vec<Vec<BoxRow>> {
    let mut levels = Vec::new();
    while !boxes.is_empty() && (levels.is_empty() || boxes.len() > 1) {
        levels.push(boxes.chunks(LANES).map(BoxRow::new).collect());
        boxes = boxes.chunks(LANES).map(NodeBox::union).collect();
    }
    levels
}

/// The smallest power of two not below `value`, kept away from the ends of the f32 range; 1 for 0.
fn power_of_two_at_least(value: f32) -> f32 {
    if value == 0.0 {
        return 1.0;
    }
    let exponent = f64::from(value).log2().ceil().clamp(-100.0, 127.0);
    exponent.exp2() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_powers_of_two() {
        assert_eq!(power_of_two_at_least(0.0), 1.0);
        assert_eq!(power_of_two_at_least(1.0), 1.0);
        assert_eq!(power_of_two_at_least(1.5), 2.0);
        assert_eq!(power_of_two_at_least(0.3), 0.5);
        assert!(power_of_two_at_least(f32::MAX).is_finite());
        assert!(1.0 / power_of_two_at_least(f32::MIN_POSITIVE) < f32::INFINITY);
    }

    #[test]
    fn every_point_has_one_slot_and_lies_in_its_boxes() {
        for count in [0, 1, 15, 16, 17, 31, 33, 500, 20_000] {
            let positions: Vec<Vec3> = (0..count)
                .map(|i| Vec3::new((i * 37 % 101) as f32, (i * 53 % 97) as f32, (i % 13) as f32))
                .collect();
            let tree = PointTree::new(&positions);
            let mut seen: Vec<u32> = tree.points().iter().map(|point| point.file_index).collect();
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..count as u32));
            for (slot, point) in tree.points().iter().enumerate() {
                let file_index = point.file_index;
                assert_eq!(point.position * tree.unit(), positions[file_index as usize]);
                assert_eq!(tree.slot_of(file_index), slot as u32);
                let place = point.position.to_array();
                for (level, rows) in tree.levels.iter().enumerate() {
                    let node = slot / LANES.pow(level as u32 + 1);
                    let (row, lane) = (&rows[node / LANES], node % LANES);
                    let is_inside = |axis: usize| (row.min[axis][lane]..=row.max[axis][lane]).contains(&place[axis]);
                    assert!((0..3).all(is_inside));
                    assert!(row.min_file_index[lane] <= file_index);
                }
            }
            let top_rows = tree.levels.last().map_or(0, Vec::len);
            assert_eq!(top_rows, usize::from(count > 0));
            let there_and_back = tree.to_file_order(&tree.to_slot_order(&positions));
            assert_eq!(there_and_back, positions);
        }
    }
}
