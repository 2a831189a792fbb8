//! Surfels of nodes against sums over lists of points, and back-face culling against every point.

use super::tests::{random_colors, view_from};
use super::*;
use crate::analysis::test_shapes::{self, Random};
use crate::cloud::{PointRecord, ShapeRecord, oct_decode, oct_encode};
use crate::levels::{CutHints, Levels as _};
use crate::math::Cube;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::Arc;

/// A torus in Morton order, its surfels with radii that differ.
fn torus_surfels(count: usize, stop: StopCriterion) -> LodSurfels {
    let mut random = Random(77);
    let torus = test_shapes::torus(count, 0.4, &mut random);
    let cube = Cube::around(&torus.positions).unwrap();
    let order = crate::math::order_of_codes(&cube.codes(&torus.positions));
    let in_order = |values: &[Vec3]| -> Vec<Vec3> { order.iter().map(|&index| values[index as usize]).collect() };
    let positions = in_order(&torus.positions);
    let colors = random_colors(count, &mut random);
    let points: Vec<PointRecord> = positions
        .iter()
        .zip(&colors)
        .map(|(position, &color)| PointRecord {
            position: position.to_array(),
            color,
        })
        .collect();
    let shapes: Vec<ShapeRecord> = in_order(&torus.normals)
        .into_iter()
        .zip(0..)
        .map(|(normal, index)| ShapeRecord {
            normal: oct_encode(normal),
            radius: 0.01 + 0.001 * (index % 7) as f32,
            ellipse: 5,
            scalar: index as f32,
        })
        .collect();
    let octree = Octree::build(&positions, &colors, stop);
    LodSurfels::new(Arc::new(octree), Arc::new(points), Arc::new(shapes))
}

#[test]
fn the_surfel_of_a_node_is_the_mean_of_its_points_and_covers_them() {
    let surfels = torus_surfels(3_000, StopCriterion::Loss(0.02));
    let tree = surfels.octree();
    for level in [0, 1, 3, 5, tree.depth()] {
        let nodes: Vec<std::ops::Range<usize>> = {
            let firsts = (0..3_000)
                .filter(|&point| u32::from(tree.points.partings[point]) <= level)
                .chain([3_000]);
            let firsts: Vec<usize> = firsts.collect();
            firsts.windows(2).map(|ends| ends[0]..ends[1]).collect()
        };
        let found = surfels.level(level);
        assert_eq!(found.len(), nodes.len());
        for (surfel, node) in found.iter().zip(nodes) {
            let points = &surfels.records().0[node.clone()];
            let shapes = &surfels.records().1[node];
            assert_eq!(surfel.point_count as usize, points.len());
            let count = points.len() as f64;
            let position = |point: &PointRecord| Vec3::from_array(point.position);
            let mean: DVec3 = points.iter().map(|point| position(point).as_dvec3()).sum::<DVec3>() / count;
            assert!((mean - position(&surfel.point).as_dvec3()).length() < 1e-6);
            for channel in 0..4 {
                let sum: f64 = points.iter().map(|point| f64::from(point.color[channel])).sum();
                assert!((f64::from(surfel.point.color[channel]) - sum / count).abs() <= 0.501);
            }
            let scalar: f64 = shapes.iter().map(|shape| f64::from(shape.scalar)).sum::<f64>() / count;
            assert!((f64::from(surfel.shape.scalar) - scalar).abs() <= 1e-6 * scalar.max(1.0));
            let sum: Vec3 = shapes.iter().map(|shape| oct_decode(shape.normal)).sum();
            let normal = oct_decode(surfel.shape.normal);
            if sum.length() > 1e-3 {
                assert!((sum.normalize() - normal).length() < 1e-3);
                for shape in shapes {
                    assert!(normal.dot(oct_decode(shape.normal)) >= surfel.cone_cosine - 1e-3);
                }
            }
            // The disk extends to the far side of every point's disk.
            for (point, shape) in points.iter().zip(shapes) {
                let offset = position(point) - position(&surfel.point);
                let in_plane = (offset - normal * offset.dot(normal)).length();
                assert!(in_plane + shape.radius <= surfel.shape.radius * (1.0 + 1e-4) + 1e-6);
            }
        }
    }
}

#[test]
fn normals_that_cancel_out_have_no_cone() {
    let positions = [Vec3::ZERO, Vec3::splat(1e-3), Vec3::ONE];
    let points = positions.map(|position| PointRecord {
        position: position.to_array(),
        color: [9; 4],
    });
    let shapes = [Vec3::Z, Vec3::NEG_Z, Vec3::X].map(|normal| ShapeRecord {
        normal: oct_encode(normal),
        radius: 0.1,
        ellipse: 0,
        scalar: 0.0,
    });
    let octree = Octree::build(&positions, &[[9; 4]; 3], StopCriterion::Loss(0.0));
    let surfels = LodSurfels::new(Arc::new(octree), Arc::new(points.to_vec()), Arc::new(shapes.to_vec()));
    let level = surfels.level(1);
    assert_eq!(level.len(), 2);
    assert_eq!(level[0].cone_cosine, -1.0);
    assert_eq!(level[0].point_count, 2);
    assert_eq!((level[1].point, level[1].shape), (points[2], shapes[2]));
}

/// Checks that the surfels of a cut are those of its nodes, and that leaves are their points; that only back-facing
/// surfels are culled, and most of them.
#[test]
fn only_back_facing_nodes_are_culled() {
    let surfels = torus_surfels(30_000, StopCriterion::Loss(0.02));
    let (all_points, all_shapes) = surfels.records();
    let mut random = Random(3);
    let (mut points, mut shapes) = (Vec::new(), Vec::new());
    let (mut drawn, mut facing_away) = (0, 0);
    for _ in 0..12 {
        let eye = random.cube().normalize() * 4.0;
        let view = view_from(eye, Vec3::ZERO, 0.0);
        let hints = CutHints {
            culls_back_faces: true,
            before: None,
        };
        let cut = surfels.cut(&view, hints);
        surfels.write_surfels(&cut, &mut points, &mut shapes);
        assert_eq!(points.len(), shapes.len());
        // Scalars identify the points.
        let found: HashSet<u32> = shapes.iter().map(|shape| shape.scalar as u32).collect();
        assert_eq!(found.len(), points.len());
        for (index, (point, shape)) in all_points.iter().zip(all_shapes).enumerate() {
            let from_eye = Vec3::from_array(point.position) - eye;
            let faces_away = oct_decode(shape.normal).dot(from_eye) > 0.0;
            assert!(found.contains(&(index as u32)) || faces_away);
            facing_away += usize::from(faces_away);
        }
        drawn += found.len();
    }
    let skipped = 12 * all_points.len() - drawn;
    assert!(skipped * 10 > facing_away * 6, "{skipped} of {facing_away}");
}

#[test]
fn a_coarse_cut_is_drawn_as_surfels_of_its_levels() {
    for stop in [StopCriterion::Loss(0.02), StopCriterion::PointsPerOctant(4)] {
        let surfels = torus_surfels(20_000, stop);
        let tree = surfels.octree();
        let view = view_from(Vec3::new(0.5, 1.0, 2.5), Vec3::ZERO, 8.0);
        let cut = tree.cut(&view, CutHints::default());
        let levels: HashSet<u32> = cut.ranges.iter().map(|range| range.level).collect();
        assert!(levels.len() >= 2);
        let (mut points, mut shapes) = (Vec::new(), Vec::new());
        let mut expected = Vec::new();
        for range in &cut.ranges {
            if stop == StopCriterion::Loss(0.02) && range.level == tree.depth() {
                let (all_points, all_shapes) = surfels.records();
                expected.extend(range.points.clone().map(|point| (all_points[point], all_shapes[point])));
                continue;
            }
            let first = (0..range.points.start)
                .filter(|&point| u32::from(tree.points.partings[point]) <= range.level)
                .count();
            let count = range
                .points
                .clone()
                .filter(|&point| u32::from(tree.points.partings[point]) <= range.level)
                .count();
            let nodes = &surfels.level(range.level)[first..first + count];
            expected.extend(nodes.iter().map(|node| (node.point, node.shape)));
        }
        // Computed from the points below the cut at first, later from cached levels; those that were requested above
        // are cached.
        for surfels in [surfels.fresh(), surfels] {
            for _ in 0..4 {
                surfels.write_surfels(&cut, &mut points, &mut shapes);
                let found = points.iter().copied().zip(shapes.iter().copied());
                assert!(found.eq(expected.iter().copied()));
            }
        }
    }
}

/// Traversals that share the work of a level with others that want the same level: none waits for itself.
#[test]
fn concurrent_traversals_terminate() {
    let view = view_from(Vec3::new(0.5, 1.0, 3.5), Vec3::ZERO, 2.0);
    for _ in 0..5 {
        let surfels = torus_surfels(60_000, StopCriterion::Loss(0.02));
        let counts: Vec<usize> = (0..32)
            .into_par_iter()
            .map(|_| {
                let hints = CutHints {
                    culls_back_faces: true,
                    before: None,
                };
                let cut = surfels.cut(&view, hints);
                let (mut points, mut shapes) = (Vec::new(), Vec::new());
                surfels.write_surfels(&cut, &mut points, &mut shapes);
                points.len()
            })
            .collect();
        assert!(counts.iter().all(|&count| count == counts[0]), "{counts:?}");
    }
}
