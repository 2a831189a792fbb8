//! Tests of the order of a cut against the distances along rays from the eye.

use super::tests::{cell_of, view_from};
use super::*;
use crate::analysis::test_shapes::Random;
use crate::levels::SelectView;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Octants of the root, and theirs: cells of this level come in order.
const LEVEL: u32 = 2;

/// The cells of [`LEVEL`] in drawing order, each once.
fn cells_in_order(tree: &Octree, view: &SelectView) -> Vec<[u32; 3]> {
    let mut voxels = Vec::new();
    tree.select(view, &mut voxels);
    let mut cells: Vec<[u32; 3]> = Vec::new();
    for voxel in &voxels {
        let (level, cell) = cell_of(tree, voxel);
        let cell = cell.map(|along| along >> (level - LEVEL));
        if cells.last() != Some(&cell) {
            assert!(!cells.contains(&cell), "{cell:?} comes twice");
            cells.push(cell);
        }
    }
    cells
}

/// Returns the distance from the eye to the nearest point of a cell of a level.
fn distance(tree: &Octree, eye: Vec3, level: u32, cell: [u32; 3]) -> f64 {
    let edge = f64::from(tree.cube().cell_edge(level));
    let low = tree.cube().min + edge * DVec3::from_array(cell.map(f64::from));
    let nearest = eye.as_dvec3().clamp(low, low + edge);
    nearest.distance(eye.as_dvec3())
}

/// The cell that a ray from the eye meets first comes first, so no cell comes after one that it may hide.
#[test]
fn potential_occluders_come_first() {
    let mut random = Random(12);
    // Few enough for one thread, and enough to be distributed.
    for count in [4_000, 40_000] {
        let positions: Vec<Vec3> = (0..count).map(|_| random.cube()).collect();
        let tree = Octree::build(&positions, &vec![[0; 4]; count], StopCriterion::Depth(5));
        let (min, edge) = (tree.cube().min, f64::from(tree.cube().edge));
        let (mut met, mut whole) = (0, 0);
        for _ in 0..40 {
            let eye = random.cube() * 3.0;
            let view = view_from(eye, random.cube() * 0.5, 0.0);
            let cells = cells_in_order(&tree, &view);
            let place_of: HashMap<[u32; 3], usize> =
                cells.iter().enumerate().map(|(place, &cell)| (cell, place)).collect();
            for _ in 0..200 {
                let way = random.cube().as_dvec3() - eye.as_dvec3();
                let mut last = None;
                // From the eye to twice the distance of the target.
                for step in 0..400 {
                    let share = (eye.as_dvec3() + way * (f64::from(step) / 200.0) - min) / edge;
                    if share.min_element() < 0.0 || share.max_element() >= 1.0 {
                        continue;
                    }
                    let cell = share.to_array().map(|along| (4.0 * along) as u32);
                    let Some(&place) = place_of.get(&cell) else {
                        continue;
                    };
                    assert!(
                        last.is_none_or(|last| last <= place),
                        "{cell:?} comes too early from {eye}"
                    );
                    met += usize::from(last != Some(place));
                    last = Some(place);
                }
            }
            // The nearest octant is the very first, if none is out of view.
            let octant = |cell: &[u32; 3]| cell.map(|along| along >> 1);
            let octants: Vec<_> = cells.iter().map(octant).collect();
            let all: std::collections::HashSet<_> = octants.iter().collect();
            if all.len() == 8 {
                whole += 1;
                let distances = octants.iter().map(|&octant| distance(&tree, eye, 1, octant));
                let least = distances.fold(f64::INFINITY, f64::min);
                assert!(distance(&tree, eye, 1, octants[0]) <= least + 1e-6);
            }
        }
        assert!(met > 10_000 && whole > 5, "something was compared: {met} {whole}");
    }
}
