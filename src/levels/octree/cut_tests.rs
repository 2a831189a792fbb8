//! Cuts under a budget, and cuts that remember the one before.

use super::stop::Leaves;
use super::tests::{cell_of, view_from};
use super::*;
use crate::analysis::test_shapes::{self, Random, Sampled};
use crate::cloud::{PointRecord, ShapeRecord, oct_encode};
use crate::levels::cut::NodeRange;
use crate::levels::{Cut, CutHints, Levels as _, SelectView};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

fn torus_tree(count: usize) -> Octree {
    let torus = test_shapes::torus(count, 0.4, &mut Random(31));
    Octree::build(&torus.positions, &vec![[0; 4]; count], StopCriterion::Loss(0.02))
}

type CellIndex = (u32, [u32; 3]);

fn cells(tree: &Octree, cut: &Cut) -> Vec<CellIndex> {
    let mut voxels = Vec::new();
    tree.write_voxels(cut, &mut voxels);
    assert_eq!(voxels.len(), cut.node_count());
    voxels.iter().map(|voxel| cell_of(tree, voxel)).collect()
}

fn cut(tree: &Octree, view: &SelectView, before: Option<&Cut>) -> Cut {
    let hints = CutHints {
        before,
        ..CutHints::default()
    };
    tree.cut(view, hints)
}

#[test]
fn a_budget_is_used_to_within_one_threshold_step() {
    let tree = torus_tree(20_000);
    let view = view_from(Vec3::new(0.5, 2.0, 3.0), Vec3::ZERO, 0.5);
    let all = cut(&tree, &view, None).node_count();
    assert!(all > 10_000);
    for max_nodes in [1, 10, 300, 5000, all - 1, all, usize::MAX] {
        let best = tree.cut_at_most(max_nodes, &view, CutHints::default());
        let lod_px = best.lod_px();
        assert!(best.node_count() <= max_nodes);
        assert!(best.stats().visited_nodes >= best.node_count());
        let again = cut(&tree, &SelectView { lod_px, ..view }, None);
        assert_eq!(again.ranges, best.ranges);
        if max_nodes >= all {
            assert_eq!(lod_px, 0.5, "no coarser than asked");
        } else {
            // A 32nd of an octave finer would exceed the limit.
            let finer = SelectView {
                lod_px: (lod_px / 2f32.powf(0.032)).max(0.5),
                ..view
            };
            assert!(cut(&tree, &finer, None).node_count() > max_nodes);
        }
    }
}

/// A camera that trembles shows the same cells all the time, although many are at the threshold.
#[test]
fn a_small_move_back_and_forth_changes_no_level() {
    let tree = torus_tree(20_000);
    for stop in [StopCriterion::Loss(0.02), StopCriterion::PointsPerOctant(3)] {
        let tree = tree.with_stop(stop);
        let at = |distance: f32| view_from(Vec3::new(0.3, 0.4, 0.87) * distance, Vec3::ZERO, 6.0);
        let mut before = cut(&tree, &at(3.0), None);
        let first = cells(&tree, &before);
        let mut changes_without = 0;
        for step in 1..30 {
            let view = at(3.0 + 0.06 * (step as f32 * 1.7).sin());
            let now = cut(&tree, &view, Some(&before));
            assert_eq!(cells(&tree, &now), first, "step {step}");
            changes_without += usize::from(cells(&tree, &cut(&tree, &view, None)) != first);
            before = now;
        }
        assert!(changes_without > 20, "there was something to keep");
        // A large camera move changes the cells.
        let near = cut(&tree, &at(1.5), Some(&before));
        assert_ne!(cells(&tree, &near), first);
    }
}

/// For any hints in addition to the view: no cell is drawn that a tenth more or less than the threshold forbids, each
/// leaf in view is covered once, and every decision is the one that a cell by itself would make. The order is that of a
/// plain traversal.
#[test]
fn cuts_match_visiting_cells_one_by_one() {
    let even = torus_surfels(4_000, 1);
    // Cells with more points than are examined together.
    let crowded = torus_surfels(300, 50);
    // Leaves on several levels.
    let uneven = uneven_surfels();
    let mut random = Random(8);
    let (mut cached, mut hidden) = (0, 0);
    for round in 0..200 {
        let surfels = [&even, &crowded, &uneven][round % 3];
        let tree = surfels.octree();
        let eye = random.cube() * 4.0;
        let target = random.cube() * 0.3;
        let lod_px = [2.0, 5.0, 12.0][random.next_bits() as usize % 3];
        let view = view_from(eye, target, lod_px);
        let moved = view_from(
            eye + random.cube() * [0.01, 0.2][random.next_bits() as usize % 2],
            target,
            lod_px,
        );
        let before = cut(tree, &moved, None);
        let mut found = Vec::new();
        for (before, back_faces) in [
            (None, None),
            (Some(&before), None),
            (None, Some(surfels)),
            (Some(&before), Some(surfels)),
        ] {
            let cut = tree.cut_between(&view, before, back_faces);
            let cells = cells(tree, &cut);
            let visited_nodes = cut.stats().visited_nodes;
            assert!((cells.len()..=tree.node_count()).contains(&visited_nodes));
            assert_eq!(cells, cells_one_by_one(tree, &view, before, back_faces), "{round}");
            found.push(cells);
        }
        cached += usize::from(found[1] != found[0]);
        hidden += usize::from(found[2] != found[0]);
    }
    assert!(cached > 30 && hidden > 100, "hints mattered: {cached} {hidden}");
}

/// Surfels at this many places on a torus, several points in each.
fn torus_surfels(places: usize, points_per_place: usize) -> LodSurfels {
    let torus = test_shapes::torus(places, 0.4, &mut Random(31));
    surfels_of(&torus, points_per_place, StopCriterion::Depth(6))
}

/// Surfels of a torus and of a ball before it that is much denser.
fn uneven_surfels() -> LodSurfels {
    let mut random = Random(32);
    let mut ball = test_shapes::sphere(1_000, &mut random);
    for position in &mut ball.positions {
        *position = 0.05 * *position + Vec3::Y;
    }
    let both = test_shapes::torus(3_000, 0.4, &mut random).and(ball);
    let surfels = surfels_of(&both, 1, StopCriterion::Spacing);
    assert!(matches!(surfels.octree().leaves, Leaves::InRuns(_)));
    surfels
}

fn surfels_of(sampled: &Sampled, points_per_place: usize, stop: StopCriterion) -> LodSurfels {
    let cube = crate::math::Cube::around(&sampled.positions).unwrap();
    let order = crate::math::order_of_codes(&cube.codes(&sampled.positions));
    let places = order
        .iter()
        .flat_map(|&place| std::iter::repeat_n(place as usize, points_per_place));
    let points = places.clone().map(|place| PointRecord {
        position: sampled.positions[place].to_array(),
        color: [0; 4],
    });
    let shapes = places.map(|place| ShapeRecord {
        normal: oct_encode(sampled.normals[place]),
        radius: 0.01,
        ellipse: 0,
        scalar: 0.0,
    });
    let points: Vec<PointRecord> = points.collect();
    let positions: Vec<Vec3> = points.iter().map(|point| point.position.into()).collect();
    let colors = vec![[0; 4]; points.len()];
    let tree = Octree::build(&positions, &colors, stop);
    LodSurfels::new(Arc::new(tree), Arc::new(points), Arc::new(shapes.collect()))
}

/// Cell by cell, from the definition.
fn cells_one_by_one(
    tree: &Octree,
    view: &SelectView,
    before: Option<&Cut>,
    back_faces: Option<&LodSurfels>,
) -> Vec<CellIndex> {
    struct Plain<'a> {
        tree: &'a Octree,
        view: &'a SelectView,
        back_faces: Option<&'a LodSurfels>,
        levels_before: HashMap<usize, u32>,
    }
    impl Plain<'_> {
        fn visit(&self, node: &NodeRange, cell: [u32; 3], found: &mut Vec<CellIndex>) {
            let (view, cube) = (self.view, self.tree.cube());
            let edge = cube.cell_edge(node.level);
            let center = cube.cell_center(node.level, cell);
            let radius = 0.5 * 3f32.sqrt() * edge;
            let hides = |surfels: &LodSurfels| surfels.all_face_away(node, view.eye, center, radius);
            if view.frustum.sphere(center, radius) == crate::math::Containment::Outside
                || self.back_faces.is_some_and(hides)
            {
                return;
            }
            let nearest = ((center - view.eye).abs() - 0.5 * edge).max(Vec3::ZERO).length();
            let edge_px = f64::from(edge * view.pixels_per_unit_at_1 / nearest);
            let lod_px = f64::from(view.lod_px);
            let level_before = self.levels_before.get(&node.points.start);
            let is_divided = match level_before {
                Some(_) if edge_px >= 1.1 * lod_px => true,
                Some(_) if edge_px < 0.9 * lod_px => false,
                Some(&level) => level > node.level,
                None => edge_px >= lod_px,
            };
            if self.tree.is_leaf(node.level, &node.points) || !is_divided {
                found.push((node.level, cell));
                return;
            }
            let mut children: Vec<_> = self.tree.points.children(node).collect();
            if node.level < 2 {
                let eye_octant = view.eye.cmpgt(center).bitmask();
                children.sort_by_key(|(octant, _)| octant ^ eye_octant);
            }
            for (octant, child) in children {
                let cell = std::array::from_fn(|axis| 2 * cell[axis] + (octant >> axis & 1));
                self.visit(&child, cell, found);
            }
        }
    }
    let of_range = |range: &NodeRange| {
        let level = range.level;
        range.points.clone().map(move |point| (point, level))
    };
    let before = before.iter().flat_map(|cut| &cut.ranges);
    let plain = Plain {
        tree,
        view,
        back_faces,
        levels_before: before.flat_map(of_range).collect(),
    };
    let mut found = Vec::new();
    plain.visit(&tree.root(), [0; 3], &mut found);
    found
}

#[test]
fn a_budgeted_threshold_is_retained_while_it_fits() {
    let tree = torus_tree(20_000);
    let at = |distance: f32| view_from(Vec3::new(0.5, 2.0, distance), Vec3::ZERO, 0.5);
    let first = tree.cut_at_most(3_000, &at(3.0), CutHints::default());
    let lod_px = first.lod_px();
    let hints = CutHints {
        before: Some(&first),
        ..CutHints::default()
    };
    // From farther away fewer cells are needed, but not many fewer.
    let cached = tree.cut_at_most(3_000, &at(3.1), hints);
    assert_eq!(cached.lod_px(), lod_px);
    assert!((2_250..=3_000).contains(&cached.node_count()));
    let finer = tree.cut_at_most(3_000, &at(12.0), hints);
    assert!(finer.lod_px() < lod_px && finer.node_count() <= 3_000);
    let coarser = tree.cut_at_most(300, &at(3.0), hints);
    assert!(coarser.lod_px() > lod_px && coarser.node_count() <= 300);
}

#[test]
fn root_octants_are_ordered_nearest_first() {
    let tree = torus_tree(20_000);
    let view = view_from(Vec3::new(2.5, 1.5, -3.0), Vec3::ZERO, 0.0);
    let cut = cut(&tree, &view, None);
    assert_eq!(cut.node_count(), tree.leaf_count(), "all of it is in view");
    let cube = tree.cube();
    let midpoint = cube.cell_center(0, [0; 3]);
    let differs = |octant: u32| {
        (0..3).fold(0, |axes, axis| {
            let is_upper = octant >> axis & 1 == 1;
            axes | u32::from(is_upper != (view.eye[axis] > midpoint[axis])) << axis
        })
    };
    let order: Vec<u32> = cut
        .ranges
        .iter()
        .map(|range| differs(tree.points.cells[range.points.start].octant(1)))
        .collect();
    assert!(order.is_sorted(), "{order:?}");
    assert!(order.len() >= 8);
}
