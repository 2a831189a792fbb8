//! Position error: the distance of points from the voxels that represent them.

use super::Octree;
use crate::math::morton::LEVELS;
use glam::Vec3;

impl Octree {
    /// Returns the root mean square (RMS) distance from points to the centres of their leaves, which is at most √3/2 of
    /// a leaf's edge; computed over at most `max_points` of them, sampled evenly. `None` without points, and if
    /// `positions`, which the tree was built from, are not in Morton order.
    pub fn position_error(&self, positions: &[Vec3], max_points: usize) -> Option<f32> {
        if !self.points.are_as_given || positions.is_empty() {
            return None;
        }
        let step = positions.len().div_ceil(max_points.max(1));
        let squared = |slot: usize| {
            let level = self.leaf_level(slot);
            let finest = self.points.cells[slot].coordinates();
            let cell = finest.map(|coordinate| coordinate >> (LEVELS - level));
            let away = positions[slot] - self.cube.cell_center(level, cell);
            f64::from(away.length_squared())
        };
        let taken = (0..positions.len()).step_by(step);
        let count = taken.len() as f64;
        Some((taken.map(squared).sum::<f64>() / count).sqrt() as f32)
    }

    /// The level of the leaf that has a point.
    fn leaf_level(&self, slot: usize) -> u32 {
        if let Some(level) = self.leaves.only_level(&(slot..slot + 1)) {
            return level;
        }
        let mut node = self.root();
        while !self.is_leaf(node.level, &node.points) {
            let mut children = self.points.children(&node).map(|(_, child)| child);
            let child = children.find(|child| child.points.contains(&slot));
            drop(children);
            match child {
                Some(child) => node = child,
                None => break,
            }
        }
        node.level
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_shapes::{self, Random};
    use crate::levels::octree::StopCriterion;
    use crate::math::Cube;

    #[test]
    fn position_error_matches_visiting_cells_one_by_one() {
        let torus = test_shapes::torus(3_000, 0.4, &mut Random(5)).positions;
        let cube = Cube::around(&torus).unwrap();
        let order = crate::math::order_of_codes(&cube.codes(&torus));
        let positions: Vec<Vec3> = order.iter().map(|&index| torus[index as usize]).collect();
        let colors = vec![[0; 4]; positions.len()];
        for (stop, max) in [
            (StopCriterion::Loss(0.3), None),
            (StopCriterion::PointsPerOctant(5), Some(5)),
        ] {
            let tree = Octree::build(&positions, &colors, stop);
            let cell = |level: u32, point: Vec3| {
                let cells = f64::from(level).exp2();
                let place = (point.as_dvec3() - cube.min) / f64::from(cube.edge);
                (place * cells).floor().min(glam::DVec3::splat(cells - 1.0))
            };
            let squared = |point: &Vec3| {
                let are_few = |level: &u32| {
                    let here = cell(*level, *point);
                    let others = positions.iter().filter(|other| cell(*level, **other) == here);
                    max.is_none_or(|max| others.count() <= max)
                };
                let level = max.map_or(tree.depth(), |_| (0..=LEVELS).find(are_few).unwrap());
                let edge = f64::from(cube.edge) / f64::from(level).exp2();
                let center = (cell(level, *point) + 0.5) * edge + cube.min;
                point.as_dvec3().distance_squared(center)
            };
            let expected = positions.iter().map(squared).sum::<f64>() / positions.len() as f64;
            let expected = expected.sqrt() as f32;
            let found = tree.position_error(&positions, usize::MAX).unwrap();
            assert!((found - expected).abs() < 1e-4 * expected, "{found}, {expected}");
            let by_some = tree.position_error(&positions, 500).unwrap();
            assert!((by_some - expected).abs() < 0.1 * expected, "{by_some}, {expected}");
        }
        let shuffled = Octree::build(&torus, &colors, StopCriterion::Loss(0.3));
        assert_eq!(shuffled.position_error(&torus, 500), None);
        let none = Octree::build(&[], &[], StopCriterion::Loss(0.3));
        assert_eq!(none.position_error(&[], 500), None);
    }
}
