//! Octrees: distance of a point from the centre of the leaf that is drawn for it, by acceptable loss δ.
//!
//! A leaf is a cube of edge h, so no point is farther from its centre than half the diagonal, √3/2 · h. For points that
//! lie anywhere in their leaves with equal probability the mean would be 0.480 · h (half the mean distance from the
//! centre of a cube to its points, 0.960 for an edge of 2). Each point is looked up by its position in f64, with none
//! of the code that built the tree; a point whose cell is not a leaf is counted.

use super::columns::{LEAVES, row};
use crate::bench::BenchError;
use crate::bench::report::{Cell, Row};
use crate::bench::run::Run;
use crate::bench::statistics::mean;
use crate::levels::octree::{Octree, StopCriterion};
use crate::sequence::PreparedFrame;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Acceptable losses, percent.
const DELTAS_PERCENT: [u8; 5] = [2, 5, 10, 25, 50];

/// Largest distance of a point of a cube from its centre, in edges: √3/2.
const BOUND_EDGES: f64 = 0.866_025_403_784_438_6;

/// Measurements of one sequence, for each of [`DELTAS_PERCENT`].
#[derive(Default)]
pub(super) struct LeafSamples([DeltaSamples; DELTAS_PERCENT.len()]);

#[derive(Default)]
struct DeltaSamples {
    points: Vec<f64>,
    loss: Vec<f64>,
    depth: Vec<f64>,
    leaves: Vec<f64>,
    edge: Vec<f64>,
    distance_mean: Vec<f64>,
    distance_mean_edges: Vec<f64>,
    distance_max_edges: f64,
    points_without_leaf: usize,
}

impl LeafSamples {
    pub(super) fn measure(&mut self, run: &Run<'_>, frame: &PreparedFrame) -> Result<(), BenchError> {
        let positions = frame.frame.positions();
        let colors: Vec<[u8; 4]> = frame.points.iter().map(|point| point.color).collect();
        for (delta_percent, samples) in DELTAS_PERCENT.into_iter().zip(&mut self.0) {
            run.check_cancelled()?;
            let stop = StopCriterion::Loss(f32::from(delta_percent) / 100.0);
            let tree = Octree::build_in(frame.frame.cube(), positions, &colors, stop);
            samples.add(positions, &tree);
        }
        Ok(())
    }

    pub(super) fn rows(&self, sequence: &str) -> impl Iterator<Item = Row> {
        let rows = DELTAS_PERCENT.into_iter().zip(&self.0);
        rows.map(move |(delta_percent, samples)| samples.row(sequence, delta_percent))
    }
}

impl DeltaSamples {
    fn add(&mut self, positions: &[Vec3], tree: &Octree) {
        let edge = f64::from(tree.cube().edge) / f64::from(1u32 << tree.depth());
        let distances = leaf_distances(positions, tree);
        self.points.push(positions.len() as f64);
        self.points_without_leaf += positions.len() - distances.len();
        self.loss.push(f64::from(tree.loss()));
        self.depth.push(f64::from(tree.depth()));
        self.leaves.push(tree.leaf_count() as f64);
        self.edge.push(edge);
        self.distance_mean.push(mean(&distances));
        self.distance_mean_edges.push(mean(&distances) / edge);
        let farthest = distances.iter().copied().fold(0.0, f64::max);
        self.distance_max_edges = self.distance_max_edges.max(farthest / edge);
    }

    fn row(&self, sequence: &str, delta_percent: u8) -> Row {
        let mean_of = |samples: &[f64]| Cell::Number(mean(samples));
        row(
            LEAVES,
            &[
                ("sequence", Cell::Text(sequence.to_owned())),
                ("delta", Cell::Number(f64::from(delta_percent) / 100.0)),
                ("points", mean_of(&self.points)),
                ("loss", mean_of(&self.loss)),
                ("depth", mean_of(&self.depth)),
                ("leaves", mean_of(&self.leaves)),
                ("cell_edge", mean_of(&self.edge)),
                ("leaf_distance_mean", mean_of(&self.distance_mean)),
                ("leaf_distance_mean_edges", mean_of(&self.distance_mean_edges)),
                ("leaf_distance_max_edges", Cell::Number(self.distance_max_edges)),
                ("leaf_distance_bound_edges", Cell::Number(BOUND_EDGES)),
                ("points_without_leaf", Cell::Number(self.points_without_leaf as f64)),
            ],
        )
    }
}

/// Returns the distance from each point that has a leaf to the centre of the voxel that is drawn for it, scene units.
fn leaf_distances(positions: &[Vec3], tree: &Octree) -> Vec<f64> {
    let cube = tree.cube();
    let cells_along = f64::from(1u32 << tree.depth());
    let cell_of = |place: DVec3| {
        let cell = (place - cube.min) / f64::from(cube.edge) * cells_along;
        // The upper faces of the cube belong to the last cells.
        cell.to_array().map(|index| index.floor().min(cells_along - 1.0) as u32)
    };
    // A cell centre is half an edge away from the next cell, whatever the rounding.
    let centers: HashMap<[u32; 3], DVec3> = tree
        .level_voxels(tree.depth())
        .iter()
        .map(|voxel| Vec3::from_array(voxel.center).as_dvec3())
        .map(|center| (cell_of(center), center))
        .collect();
    let distance = |position: &Vec3| {
        let place = position.as_dvec3();
        centers.get(&cell_of(place)).map(|center| place.distance(*center))
    };
    positions.iter().filter_map(distance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_to_the_middles() {
        // Four corners of a cube of edge 2 and a point: at depth 1, cells of edge 1.
        let positions = [
            Vec3::ZERO,
            Vec3::new(2.0, 0.0, 0.0),
            Vec3::new(0.0, 2.0, 0.0),
            Vec3::new(1.5, 1.5, 1.75),
            Vec3::new(2.0, 2.0, 2.0),
        ];
        let tree = Octree::build(&positions, &[[0; 4]; 5], StopCriterion::Loss(0.25));
        assert_eq!((tree.depth(), tree.leaf_count()), (1, 4));
        let distances = leaf_distances(&positions, &tree);
        let corner = BOUND_EDGES;
        for (found, expected) in distances.iter().zip([corner, corner, corner, 0.25, corner]) {
            assert!((found - expected).abs() < 1e-6, "{distances:?}");
        }
        // A point that the tree does not contain.
        let elsewhere = leaf_distances(&[Vec3::new(0.5, 0.5, 1.5)], &tree);
        assert_eq!(elsewhere, [0.0f64; 0]);
        let mut samples = DeltaSamples::default();
        samples.add(&positions, &tree);
        assert!((samples.distance_max_edges - BOUND_EDGES).abs() < 1e-6);
        assert!((samples.distance_mean[0] - (4.0 * corner + 0.25) / 5.0).abs() < 1e-6);
        assert_eq!((samples.edge[0], samples.points_without_leaf), (1.0, 0));
    }
}
