//! A k-d tree over points in buckets of 16: the order in which analysis works, and the boxes that searches prune by.
//!
//! How it works: the points are split at the median of the longest side of their box until 16 are left, with the median
//! rounded to a whole bucket. So bucket `b` holds the *slots* `16 b .. 16 b + 16`, points that are close in space are
//! close in memory, and the tree needs no pointers: node `i` has the children `2 i` and `2 i + 1`, the root is 1.
//!
//! When it wins: over a uniform grid wherever density varies. A cluster with an outlier a million times its size away,
//! or a laser scanner's sweep, is split as evenly as a sphere; even points that all coincide are shared out among buckets.
//!
//! Coordinates are scaled by a power of two into −1..1, which is exact, so that squared distances neither overflow nor
//! (for clouds of one scale) underflow.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// Points a bucket: two SIMD registers of eight.
pub(super) const BUCKET: usize = 16;

/// Below this many points a split is not worth handing to another thread.
const PARALLEL_SPLIT: usize = 4096;

/// Points in slot order, and the boxes above them.
#[derive(Debug)]
pub(super) struct PointTree {
    /// Scaled positions by slot.
    positions: Vec<Vec3>,
    /// Which point of the file is in each slot.
    file_index: Vec<u32>,
    /// The slot of each point of the file.
    slot: Vec<u32>,
    pub(super) buckets: Vec<Bucket>,
    /// Boxes of the nodes; those of leaves start at [`PointTree::first_leaf`]. Beyond the last bucket boxes are empty.
    pub(super) nodes: Vec<NodeBox>,
    /// The smallest file index in each node, to decide between equal distances.
    pub(super) min_file_index: Vec<u32>,
    /// Scene units of one scaled unit: a power of two.
    unit: f32,
}

/// The coordinates of 16 slots. Places without a point are so far away that the square of their distance is infinite.
#[derive(Debug, Clone)]
pub(super) struct Bucket {
    pub(super) x: [f32; BUCKET],
    pub(super) y: [f32; BUCKET],
    pub(super) z: [f32; BUCKET],
}

/// The box of a node: two SIMD registers, of which the last lane is 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeBox {
    pub(super) min: Vec4,
    pub(super) max: Vec4,
}

impl NodeBox {
    const EMPTY: Self = Self {
        min: Vec4::new(f32::INFINITY, f32::INFINITY, f32::INFINITY, 0.0),
        max: Vec4::new(f32::NEG_INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY, 0.0),
    };

    /// The box around some points.
    pub(super) fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points
            .into_iter()
            .map(|point| point.extend(0.0))
            .fold(Self::EMPTY, |node, point| Self {
                min: node.min.min(point),
                max: node.max.max(point),
            })
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct SlotPoint {
    position: Vec3,
    file_index: u32,
}

fn box_of(points: &[SlotPoint]) -> NodeBox {
    NodeBox::around(points.iter().map(|point| point.position))
}

fn min_file_index_of(points: &[SlotPoint]) -> u32 {
    let indices = points.iter().map(|point| point.file_index);
    indices.min().unwrap_or(u32::MAX)
}

impl PointTree {
    /// Sorts finite `positions` into buckets.
    pub(super) fn new(positions: &[Vec3]) -> Self {
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
        let bucket_count = points.len().div_ceil(BUCKET);
        split(&mut points, bucket_count.next_power_of_two() / 2 * BUCKET);

        let mut slot = vec![0; points.len()];
        for (point, index) in points.iter().zip(0..) {
            slot[point.file_index as usize] = index;
        }
        Self {
            positions: points.iter().map(|point| point.position).collect(),
            file_index: points.iter().map(|point| point.file_index).collect(),
            slot,
            buckets: points.chunks(BUCKET).map(Bucket::new).collect(),
            nodes: bottom_up(
                points.chunks(BUCKET).map(box_of),
                NodeBox::EMPTY,
                NodeBox::union,
            ),
            min_file_index: bottom_up(
                points.chunks(BUCKET).map(min_file_index_of),
                u32::MAX,
                |&a, &b| a.min(b),
            ),
            unit,
        }
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    /// Scaled positions by slot.
    pub(super) fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Scene units of one scaled unit.
    pub(super) fn unit(&self) -> f32 {
        self.unit
    }

    /// The slot of a point of the file.
    pub(super) fn slot_of(&self, file_index: u32) -> u32 {
        self.slot[file_index as usize]
    }

    /// The point of the file in a slot.
    pub(super) fn file_index_of(&self, slot: u32) -> u32 {
        self.file_index[slot as usize]
    }

    /// Index of the first leaf in `nodes`; bucket `b` is leaf `first_leaf() + b`.
    pub(super) fn first_leaf(&self) -> usize {
        self.nodes.len() / 2
    }

    /// `values` by slot, rearranged to the order of the file.
    pub(super) fn to_file_order<T: Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        self.slot
            .par_iter()
            .with_min_len(1 << 13)
            .map(|&slot| values[slot as usize])
            .collect()
    }

    /// `values` in the order of the file, rearranged by slot.
    pub(super) fn to_slot_order<T: Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        self.file_index
            .par_iter()
            .with_min_len(1 << 13)
            .map(|&index| values[index as usize])
            .collect()
    }
}

impl Bucket {
    fn new(points: &[SlotPoint]) -> Self {
        let axis = |axis: usize| {
            std::array::from_fn(|place| {
                points
                    .get(place)
                    .map_or(f32::MAX, |point| point.position[axis])
            })
        };
        Self {
            x: axis(0),
            y: axis(1),
            z: axis(2),
        }
    }
}

/// Splits `points` at `half` (a power of two of buckets, and at least half of them) and both parts again.
fn split(points: &mut [SlotPoint], half: usize) {
    // Halves of a bucket are close together, too: they search on their own (see bucket_search).
    if half < BUCKET / 2 {
        return;
    }
    if points.len() <= half {
        return split(points, half / 2);
    }
    let node = box_of(points);
    let axis = (node.max - node.min).max_position();
    points.select_nth_unstable_by(half, |a, b| a.position[axis].total_cmp(&b.position[axis]));
    let parallel = points.len() > PARALLEL_SPLIT;
    let (low, high) = points.split_at_mut(half);
    if parallel {
        rayon::join(|| split(low, half / 2), || split(high, half / 2));
    } else {
        split(low, half / 2);
        split(high, half / 2);
    }
}

/// Values of all nodes from those of the buckets: `join` of two children is that of their parent.
fn bottom_up<T: Copy>(
    buckets: impl ExactSizeIterator<Item = T>,
    of_nothing: T,
    join: impl Fn(&T, &T) -> T,
) -> Vec<T> {
    let first_leaf = buckets.len().next_power_of_two();
    let mut nodes = vec![of_nothing; 2 * first_leaf];
    for (node, bucket) in nodes[first_leaf..].iter_mut().zip(buckets) {
        *node = bucket;
    }
    for index in (1..first_leaf).rev() {
        nodes[index] = join(&nodes[2 * index], &nodes[2 * index + 1]);
    }
    nodes
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
            let mut seen: Vec<u32> = tree.file_index.clone();
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..count as u32));
            for (slot, position) in tree.positions().iter().enumerate() {
                assert_eq!(
                    *position * tree.unit(),
                    positions[tree.file_index[slot] as usize]
                );
                assert_eq!(tree.slot_of(tree.file_index[slot]), slot as u32);
                let mut node = tree.first_leaf() + slot / BUCKET;
                while node > 0 {
                    let NodeBox { min, max } = tree.nodes[node];
                    let place = position.extend(0.0);
                    assert!(min.cmple(place).all() && max.cmpge(place).all());
                    assert!(tree.min_file_index[node] <= tree.file_index[slot]);
                    node /= 2;
                }
            }
            let there_and_back = tree.to_file_order(&tree.to_slot_order(&positions));
            assert_eq!(there_and_back, positions);
        }
    }
}
