//! The point of a cloud nearest to a place, which need not be one of its points: used to compare clouds.
//!
//! How it works: the rows of boxes of the k-d tree ([`super::point_tree`]) are descended into, nearest box first, as
//! long as a box may hold a nearer point than the best so far. Equal distances are decided by the index in the file,
//! and a box at exactly the distance found is entered only if it holds a smaller one, so that points that all coincide
//! cost no more.
//!
//! Everything is computed in f64 from f32 coordinates: distances to boxes are rounded monotonically in the same order
//! of operations as those to points, so pruning loses nothing. Places may lie far outside the cloud.
//!
//! When it wins: over [`super::bucket_search`] where places have no bucket of their own to search from, and one
//! neighbour is wanted.

use super::point_tree::{BoxRow, LANES, PointTree};
use glam::{DVec3, Vec3};

/// A cloud that can be asked which of its points is nearest.
#[derive(Debug)]
pub struct NearestPoint {
    tree: PointTree,
}

/// The nearest point so far.
struct Nearest {
    distance_squared: f64,
    file_index: u32,
}

impl Nearest {
    fn is_beaten_by(&self, distance_squared: f64, file_index: u32) -> bool {
        distance_squared < self.distance_squared
            || (distance_squared == self.distance_squared && file_index < self.file_index)
    }
}

impl NearestPoint {
    /// Sorts finite `positions`.
    pub fn new(positions: &[Vec3]) -> Self {
        Self {
            tree: PointTree::new(positions),
        }
    }

    /// The index of the position nearest to a finite `place`, the smallest of equally near ones; `None` without
    /// positions.
    pub fn of(&self, place: Vec3) -> Option<u32> {
        let top_level = self.tree.levels.len().checked_sub(1)?;
        let place = place.as_dvec3() / f64::from(self.tree.unit());
        let mut nearest = Nearest {
            distance_squared: f64::INFINITY,
            file_index: u32::MAX,
        };
        self.descend(place, top_level, 0, &mut nearest);
        Some(nearest.file_index)
    }

    /// Visits the children of a row that may hold the nearest point.
    fn descend(&self, place: DVec3, level: usize, row: usize, nearest: &mut Nearest) {
        let boxes = &self.tree.levels[level][row];
        let distances = distances_squared(boxes, place);
        let mut lanes: [usize; LANES] = std::array::from_fn(|lane| lane);
        lanes.sort_unstable_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        for lane in lanes {
            // Boxes without points are infinitely far.
            if distances[lane] > nearest.distance_squared || distances[lane].is_infinite() {
                return;
            }
            if !nearest.is_beaten_by(distances[lane], boxes.min_file_index[lane]) {
                continue;
            }
            let child = LANES * row + lane;
            if level == 0 {
                self.meet(place, child, nearest);
            } else {
                self.descend(place, level - 1, child, nearest);
            }
        }
    }

    fn meet(&self, place: DVec3, bucket: usize, nearest: &mut Nearest) {
        let points = &self.tree.points()[LANES * bucket..];
        // Scalar: a single neighbour of an arbitrary position offers nothing to vectorise.
        for point in points.iter().take(LANES) {
            let distance_squared = squared(point.position.as_dvec3() - place);
            if nearest.is_beaten_by(distance_squared, point.file_index) {
                *nearest = Nearest {
                    distance_squared,
                    file_index: point.file_index,
                };
            }
        }
    }
}

/// To each of eight boxes, 0 inside.
fn distances_squared(boxes: &BoxRow, place: DVec3) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    for axis in 0..3 {
        let sides = boxes.min[axis].iter().zip(&boxes.max[axis]);
        for (sum, (&min, &max)) in sums.iter_mut().zip(sides) {
            let outside = (f64::from(min) - place[axis]).max(place[axis] - f64::from(max));
            let outside = outside.max(0.0);
            *sum += outside * outside;
        }
    }
    sums
}

/// Squared length, summed in the same order as for boxes.
fn squared(v: DVec3) -> f64 {
    v.x * v.x + v.y * v.y + v.z * v.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_shapes::{Random, sphere};
    use proptest::prelude::*;

    fn by_brute_force(positions: &[Vec3], place: Vec3) -> Option<u32> {
        let distance = |&(_, position): &(u32, &Vec3)| squared(position.as_dvec3() - place.as_dvec3());
        // The first of equal ones.
        let nearest = (0..).zip(positions).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map(|(index, _)| index)
    }

    proptest! {
        // Few distinct coordinates, so that points coincide and positions are equidistant from several; sizes around
        // whole rows.
        #[test]
        fn nearest_point_matches_brute_force(
            positions in prop::collection::vec(prop::array::uniform3(-6i8..6), 0..150),
            places in prop::collection::vec(prop::array::uniform3(-20i8..20), 1..20),
            scale in prop::sample::select(vec![1.0f32, 0.1, 3.0e-20, 7.0e25]),
        ) {
            let place = |at: &[i8; 3]| Vec3::from_array(at.map(f32::from)) * (0.5 * scale);
            let positions: Vec<Vec3> = positions.iter().map(place).collect();
            let cloud = NearestPoint::new(&positions);
            for at in places.iter().map(place) {
                prop_assert_eq!(cloud.of(at), by_brute_force(&positions, at));
            }
        }
    }

    #[test]
    fn nearest_point_is_right_for_surfaces_outliers_and_distant_queries() {
        let mut random = Random(7);
        let mut positions = sphere(3000, &mut random).positions;
        positions.push(Vec3::splat(1.0e9));
        let cloud = NearestPoint::new(&positions);
        for _ in 0..300 {
            for reach in [0.01, 1.0, 3.0, 1.0e5, 1.0e20] {
                let place = random.cube() * reach;
                assert_eq!(cloud.of(place), by_brute_force(&positions, place));
            }
        }
        for (index, &position) in (0..).zip(&positions) {
            assert_eq!(cloud.of(position), Some(index));
        }
    }

    #[test]
    fn points_that_all_coincide_are_not_all_visited() {
        let cloud = NearestPoint::new(&vec![Vec3::ONE; 100_000]);
        for _ in 0..10_000 {
            assert_eq!(cloud.of(Vec3::ZERO), Some(0));
        }
    }

    #[test]
    fn an_empty_cloud_has_no_nearest_point() {
        assert_eq!(NearestPoint::new(&[]).of(Vec3::ZERO), None);
    }
}
