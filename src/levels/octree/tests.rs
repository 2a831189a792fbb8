//! The octree against brute force: sets of quantised cells, and a traversal that tests every cell on its own.

use super::*;
use crate::analysis::test_shapes::{self, Random};
use crate::cloud::VoxelRecord;
use crate::levels::{LodMetric, SelectStats, SelectView};
use crate::math::Cube;
use crate::math::{Containment, Frustum, morton};
use glam::{Mat4, Vec3, Vec4};
use proptest::prelude::*;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// Cells of a level by their integer coordinates, each with the summed colour and number of its points. By division in
/// f64, with none of the code under test but the cube.
fn cells_by_brute_force(positions: &[Vec3], colors: &[[u8; 4]], level: u32) -> BTreeMap<[u32; 3], ([f64; 3], f64)> {
    let cube = Cube::around(positions).unwrap();
    let cells_along = f64::from(1u32 << level);
    let mut cells = BTreeMap::new();
    for (position, color) in positions.iter().zip(colors) {
        let share = (position.as_dvec3() - cube.min) / f64::from(cube.edge);
        let cell = share
            .to_array()
            .map(|share| (share * cells_along).floor().min(cells_along - 1.0) as u32);
        let (sum, count) = cells.entry(cell).or_insert(([0.0; 3], 0.0));
        for (sum, &channel) in sum.iter_mut().zip(color) {
            *sum += f64::from(channel);
        }
        *count += 1.0;
    }
    cells
}

fn in_morton_order(cells: impl IntoIterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let mut cells: Vec<_> = cells.into_iter().collect();
    cells.sort_by_key(|&cell| morton::encode(cell));
    cells
}

pub(super) fn random_colors(count: usize, random: &mut Random) -> Vec<[u8; 4]> {
    (0..count).map(|_| (random.next_bits() as u32).to_le_bytes()).collect()
}

/// All results of a tree, against brute force.
fn check_tree(positions: &[Vec3], delta: f32) {
    let colors = random_colors(positions.len(), &mut Random(9));
    let tree = Octree::build(positions, &colors, StopCriterion::Loss(delta));
    let depth = tree.depth();
    let mut oct = Vec::new();
    for level in 0..=depth {
        let expected = cells_by_brute_force(positions, &colors, level);
        oct.push(expected.len());
        let voxels = tree.level_voxels(level);
        assert_eq!(voxels.len(), expected.len(), "level {level}");
        let order = in_morton_order(expected.keys().copied());
        for (voxel, cell) in voxels.iter().zip(order) {
            assert_eq!(u32::from(voxel.level), level);
            assert_eq!(Vec3::from_array(voxel.center), tree.cube().cell_center(level, cell));
            let (sum, count) = expected[&cell];
            for (found, sum) in voxel.color.into_iter().zip(sum) {
                assert!(
                    (f64::from(found) - sum / count).abs() <= 0.501,
                    "{found} for {}",
                    sum / count
                );
            }
        }
    }
    assert_eq!(tree.level_counts(), oct);
    assert_eq!(tree.leaf_count(), oct[depth as usize]);
    assert_eq!(tree.internal_count(), oct[..depth as usize].iter().sum::<usize>());
    assert_eq!(tree.node_count(), tree.internal_count() + tree.leaf_count());
    assert_eq!(tree.masks().len(), tree.internal_count());

    // The stop criterion: the depth is the first level that need not be subdivided.
    let point_count = positions.len() as f64;
    let distinct = cells_by_brute_force(positions, &colors, morton::LEVELS).len();
    let ends_at = |level: u32| {
        let cells = oct[level as usize];
        level == morton::LEVELS || cells as f64 / point_count >= 1.0 - f64::from(delta) - 1e-12 || cells == distinct
    };
    assert!(ends_at(depth));
    assert!((0..depth).all(|level| !ends_at(level)));
    let loss = 1.0 - oct[depth as usize] as f64 / point_count;
    assert!((f64::from(tree.loss()) - loss).abs() < 1e-6);

    let read_back = Octree::cells_from_masks(&tree.masks(), depth).unwrap();
    let expected = cells_by_brute_force(positions, &colors, depth);
    assert_eq!(read_back, in_morton_order(expected.into_keys()));
}

#[test]
fn surfaces_at_every_delta() {
    let mut random = Random(1);
    let torus = test_shapes::torus(20_000, 0.4, &mut random).moved(Vec3::new(3.0, -7.0, 0.5));
    for delta in [0.0, 0.02, 0.1, 0.5, 0.6] {
        check_tree(&torus.positions, delta);
    }
}

#[test]
fn lattices_on_cell_borders() {
    // 16 cells along each axis and points on all their borders, also for edges that no binary fraction divides.
    for step in [1.0, 0.1, 1.0 / 3.0, 49.0] {
        let lattice: Vec<Vec3> = (0..17 * 17 * 17)
            .map(|i| Vec3::new((i % 17) as f32, (i / 17 % 17) as f32, (i / 289) as f32) * step)
            .collect();
        check_tree(&lattice, 0.0);
        check_tree(&lattice, 0.3);
    }
}

#[test]
fn duplicates_collinear_coplanar_and_outliers() {
    let mut random = Random(2);
    let cloud: Vec<Vec3> = (0..1500).map(|_| random.cube()).collect();
    let doubled: Vec<Vec3> = cloud.iter().chain(&cloud).copied().collect();
    check_tree(&doubled, 0.02);
    let line: Vec<Vec3> = cloud.iter().map(|p| Vec3::new(p.x, 2.0, -1.0)).collect();
    check_tree(&line, 0.02);
    let sheet: Vec<Vec3> = cloud.iter().map(|p| Vec3::new(p.x, 2.0, p.z)).collect();
    check_tree(&sheet, 0.0);
    let outlier: Vec<Vec3> = cloud.iter().copied().chain([Vec3::splat(1e6)]).collect();
    check_tree(&outlier, 0.02);
    let far: Vec<Vec3> = cloud.iter().map(|&p| p + Vec3::splat(1e6)).collect();
    check_tree(&far, 0.05);
}

#[test]
fn an_empty_cloud_has_no_nodes() {
    let tree = Octree::build(&[], &[], StopCriterion::default());
    assert_eq!((tree.depth(), tree.node_count(), tree.loss()), (0, 0, 0.0));
    assert!(tree.masks().is_empty() && tree.level_counts().is_empty());
    assert!(tree.level_voxels(0).is_empty());
    let mut out = vec![bytemuck::Zeroable::zeroed()];
    let stats = tree.select(&view_from(Vec3::splat(5.0), Vec3::ZERO, 1.0), &mut out);
    assert_eq!(stats, SelectStats::default());
    assert!(out.is_empty());
}

#[test]
fn coincident_points_are_one_leaf() {
    for count in [1usize, 2, 1000] {
        let point = Vec3::new(4.0, -2.0, 9.0);
        let colors = vec![[10, 20, 30, 255]; count];
        let tree = Octree::build(&vec![point; count], &colors, StopCriterion::Loss(0.0));
        assert_eq!((tree.depth(), tree.node_count()), (0, 1));
        assert!((tree.loss() - (1.0 - 1.0 / count as f32)).abs() < 1e-6);
        assert_eq!(tree.level_voxels(0)[0].center, point.to_array());
        assert_eq!(tree.level_voxels(0)[0].color, [10, 20, 30]);
    }
}

#[test]
fn table_iii_counts_internal_nodes() {
    // This is the interpretation of the paper's column: nodes(h + 1) = nodes(h) + leaves(h).
    let torus = test_shapes::torus(10_000, 0.3, &mut Random(3));
    let colors = vec![[0; 4]; 10_000];
    let build = |delta| Octree::build(&torus.positions, &colors, StopCriterion::Loss(delta));
    let (coarse, fine) = (build(0.5), build(0.02));
    assert!(fine.depth() > coarse.depth());
    let between = fine.level_counts()[coarse.depth() as usize + 1..fine.depth() as usize]
        .iter()
        .sum::<usize>();
    assert_eq!(
        fine.internal_count(),
        coarse.internal_count() + coarse.leaf_count() + between
    );
}

proptest! {
    #[test]
    fn any_cloud_agrees_with_brute_force(
        points in prop::collection::vec(prop::array::uniform3(-100i16..100), 1..120),
        scale in -20i32..20,
        delta in 0.0f32..0.6,
    ) {
        let scale = 2f32.powi(scale) * 0.7;
        let positions: Vec<Vec3> = points
            .into_iter()
            .map(|point| Vec3::from_array(point.map(f32::from)) * scale)
            .collect();
        check_tree(&positions, delta);
    }
}

/// The leaves where cells are divided while they hold more than `max_points` points that differ, by recursion over
/// lists.
fn leaves_by_brute_force(positions: &[Vec3], max_points: usize) -> BTreeMap<(u32, [u32; 3]), usize> {
    fn divide(
        level: u32,
        cell: [u32; 3],
        finest: &[[u32; 3]],
        max_points: usize,
        leaves: &mut BTreeMap<(u32, [u32; 3]), usize>,
    ) {
        let all_equal = finest.iter().all(|other| *other == finest[0]);
        if finest.len() <= max_points.max(1) || all_equal {
            leaves.insert((level, cell), finest.len());
            return;
        }
        let below = level + 1;
        let cell_of = |finest: &[u32; 3]| finest.map(|index| index >> (morton::LEVELS - below));
        let mut children: BTreeMap<[u32; 3], Vec<[u32; 3]>> = BTreeMap::new();
        for finest in finest {
            children.entry(cell_of(finest)).or_default().push(*finest);
        }
        for (cell, finest) in children {
            divide(below, cell, &finest, max_points, leaves);
        }
    }
    let codes = Cube::around(positions).unwrap().codes(positions);
    let finest: Vec<[u32; 3]> = codes.into_iter().map(morton::decode).collect();
    let mut leaves = BTreeMap::new();
    divide(0, [0; 3], &finest, max_points, &mut leaves);
    leaves
}

fn check_uneven_tree(positions: &[Vec3], max_points: u32) {
    let colors = random_colors(positions.len(), &mut Random(5));
    let stop = StopCriterion::PointsPerOctant(max_points);
    let tree = Octree::build(positions, &colors, stop);
    let expected = leaves_by_brute_force(positions, max_points as usize);
    let voxels = tree.level_voxels(tree.depth());
    let found: HashSet<_> = voxels.iter().map(|voxel| cell_of(&tree, voxel)).collect();
    assert_eq!(found.len(), voxels.len(), "no leaf twice");
    assert_eq!(found, expected.keys().copied().collect());
    assert_eq!(tree.leaf_count(), expected.len());
    let deepest = expected.keys().map(|(level, _)| *level).max();
    assert_eq!(Some(tree.depth()), deepest);
    let nodes: HashSet<_> = expected
        .keys()
        .flat_map(|&(level, cell)| (0..=level).map(move |up| (level - up, cell.map(|index| index >> up))))
        .collect();
    assert_eq!(tree.node_count(), nodes.len());
    // The mean colour of every leaf is the mean of its own points, whatever points are next to them in the order.
    let sums = |level: u32| cells_by_brute_force(positions, &colors, level);
    let by_level: Vec<_> = (0..=tree.depth()).map(sums).collect();
    for voxel in &voxels {
        let (level, cell) = cell_of(&tree, voxel);
        let (sum, count) = by_level[level as usize][&cell];
        for (found, sum) in voxel.color.into_iter().zip(sum) {
            assert!((f64::from(found) - sum / count).abs() <= 0.501);
        }
    }
}

#[test]
fn leaves_hold_at_most_the_given_number_of_points() {
    let mut random = Random(21);
    let torus = test_shapes::torus(5000, 0.4, &mut random);
    for max_points in [0, 1, 2, 8, 100, 4999, 5000] {
        check_uneven_tree(&torus.positions, max_points);
    }
    // Dense and sparse parts, and duplicates that nothing can separate.
    let mut cloud: Vec<Vec3> = (0..300).map(|_| random.cube()).collect();
    cloud.extend((0..300).map(|_| random.cube() * 1e-3));
    cloud.extend([Vec3::splat(0.25); 50]);
    check_uneven_tree(&cloud, 8);
    check_uneven_tree(&[Vec3::ONE; 30], 8);
    check_uneven_tree(&[Vec3::ONE], 8);
}

/// Building for another stop criterion from an existing tree must give the same tree as a build from nothing.
#[test]
fn changing_the_stop_criterion_matches_rebuilding() {
    use StopCriterion::{Depth, Loss, PointsPerOctant, Spacing};
    let torus = test_shapes::torus(40_000, 0.4, &mut Random(17));
    let colors = random_colors(40_000, &mut Random(18));
    let stops = [
        Loss(0.02),
        Loss(0.5),
        Loss(0.0),
        Depth(0),
        Depth(7),
        Depth(99),
        PointsPerOctant(4),
        Spacing,
    ];
    for from in stops {
        let tree = Octree::build(&torus.positions, &colors, from);
        for to in stops {
            let fresh = Octree::build(&torus.positions, &colors, to);
            assert!(tree.with_stop(to) == fresh, "{from:?} to {to:?}");
        }
    }
    let none = Octree::build(&[], &[], Loss(0.1));
    assert_eq!(none.with_stop(Depth(3)).node_count(), 0);
    let deep = Octree::build(&torus.positions, &colors, Depth(9));
    assert_eq!(deep.depth(), 9);
    assert!(Arc::ptr_eq(&deep.points, &deep.with_stop(Depth(4)).points));
}

/// A 60° view with the near plane at 0.05 and 500 pixels along the height.
pub(super) fn view_from(eye: Vec3, target: Vec3, lod_px: f32) -> SelectView {
    let forward = (target - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let up = right.cross(forward);
    let view = Mat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        (-forward).extend(0.0),
        eye.extend(1.0),
    )
    .inverse();
    let focal = 3f32.sqrt();
    let projection = Mat4::from_cols(
        Vec4::new(focal / 1.5, 0.0, 0.0, 0.0),
        Vec4::new(0.0, focal, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 0.0, -1.0),
        Vec4::new(0.0, 0.0, 0.05, 0.0),
    );
    SelectView {
        frustum: Frustum::from_clip_matrix(&(projection * view)),
        eye,
        pixels_per_unit_at_1: focal * 250.0,
        lod_px,
        metric: LodMetric::default(),
        deepest_level: SelectView::ALL_LEVELS,
    }
}

/// Cells as (level, cell), found by testing each cell of each level and those above it, one by one.
fn visible_by_brute_force(
    tree: &Octree,
    positions: &[Vec3],
    view: &SelectView,
    is_leaf: impl Fn(u32, [u32; 3]) -> bool,
) -> HashSet<(u32, [u32; 3])> {
    let cube = tree.cube();
    let depth = tree.depth();
    let is_visible = |level: u32, cell: [u32; 3]| {
        let radius = 0.5 * 3f32.sqrt() * cube.cell_edge(level);
        view.frustum.sphere(cube.cell_center(level, cell), radius) != Containment::Outside
    };
    let stops = |level: u32, cell: [u32; 3]| {
        let edge = cube.cell_edge(level);
        let distance = (cube.cell_center(level, cell) - view.eye).abs() - 0.5 * edge;
        let nearest = distance.max(Vec3::ZERO).length_squared();
        is_leaf(level, cell) || view.lod_px > 0.0 && nearest > (edge * view.pixels_per_unit_at_1 / view.lod_px).powi(2)
    };
    let colors = vec![[0; 4]; positions.len()];
    let mut emitted = HashSet::new();
    for level in 0..=depth {
        for cell in cells_by_brute_force(positions, &colors, level).into_keys() {
            let above = |up: u32| (level - up, cell.map(|coordinate| coordinate >> up));
            let reached = (1..=level).all(|up| {
                let (level, cell) = above(up);
                is_visible(level, cell) && !stops(level, cell)
            });
            if reached && is_visible(level, cell) && stops(level, cell) {
                emitted.insert((level, cell));
            }
        }
    }
    emitted
}

pub(super) fn cell_of(tree: &Octree, voxel: &VoxelRecord) -> (u32, [u32; 3]) {
    let level = u32::from(voxel.level);
    let offset = (Vec3::from_array(voxel.center) - tree.cube().min.as_vec3()) / tree.cube().cell_edge(level);
    (level, offset.to_array().map(|coordinate| coordinate as u32))
}

#[test]
fn the_visible_set_matches_brute_force() {
    let mut random = Random(4);
    let mut torus = test_shapes::torus(2_000, 0.4, &mut random);
    // A part of it is much denser.
    let dense = test_shapes::sphere(1_000, &mut random).positions;
    let dense = dense.into_iter().map(|place| 0.04 * place + Vec3::X);
    torus.positions.extend(dense);
    let colors = random_colors(3_000, &mut random);
    let even = Octree::build(&torus.positions, &colors, StopCriterion::Loss(0.02));
    let uneven = even.with_stop(StopCriterion::PointsPerOctant(3));
    let uneven_leaves = leaves_by_brute_force(&torus.positions, 3);
    let by_spacing = even.with_stop(StopCriterion::Spacing);
    let voxels = by_spacing.level_voxels(by_spacing.depth());
    let spacing_leaves: HashSet<_> = voxels.iter().map(|v| cell_of(&by_spacing, v)).collect();
    let levels: HashSet<u32> = spacing_leaves.iter().map(|(level, _)| *level).collect();
    assert!(levels.len() > 1, "leaves are on several levels: {levels:?}");
    let mut out = Vec::new();
    let mut levels_seen = HashSet::new();
    for round in 0..200 {
        // Inside the cloud, near it and far away; looking at it and past it.
        let distance = 0.1 * 100f32.powf(random.unit());
        let eye = random.cube() * distance;
        let target = random.cube();
        let lod_px = [0.0, 1.0, 3.0, 10.0, 80.0][random.next_bits() as usize % 5];
        let view = view_from(eye, target, lod_px);
        let tree = [&even, &uneven, &by_spacing][round % 3];
        let is_leaf = |level: u32, cell: [u32; 3]| match round % 3 {
            0 => level == even.depth(),
            1 => uneven_leaves.contains_key(&(level, cell)),
            _ => spacing_leaves.contains(&(level, cell)),
        };
        let stats = tree.select(&view, &mut out);
        let expected = visible_by_brute_force(tree, &torus.positions, &view, is_leaf);
        let found: HashSet<_> = out.iter().map(|voxel| cell_of(tree, voxel)).collect();
        assert_eq!(found.len(), out.len(), "no voxel twice");
        assert_eq!(found, expected, "eye {eye} target {target} lod {lod_px}");
        assert_eq!(stats.emitted, out.len());
        assert!(stats.visited_nodes >= out.len());
        levels_seen.extend(found.into_iter().map(|(level, _)| level));
    }
    assert!(levels_seen.len() >= 6, "levels of detail were exercised");
}

#[test]
fn no_point_in_view_is_lost() {
    let mut random = Random(5);
    let sphere = test_shapes::sphere(5_000, &mut random);
    let tree = Octree::build(&sphere.positions, &vec![[0; 4]; 5_000], StopCriterion::Loss(0.05));
    let mut out = Vec::new();
    for lod_px in [0.0, 2.0, 50.0] {
        let view = view_from(Vec3::new(1.4, 0.3, 0.2), Vec3::new(0.0, 0.4, 0.0), lod_px);
        tree.select(&view, &mut out);
        let cells: HashSet<_> = out.iter().map(|voxel| cell_of(&tree, voxel)).collect();
        let mut in_view = 0;
        for (&point, code) in sphere.positions.iter().zip(tree.cube().codes(&sphere.positions)) {
            if view.frustum.sphere(point, 0.0) == Containment::Outside {
                continue;
            }
            in_view += 1;
            let finest = morton::decode(code);
            assert!((0..=tree.depth()).any(|level| {
                let cell = finest.map(|coordinate| coordinate >> (morton::LEVELS - level));
                cells.contains(&(level, cell))
            }));
        }
        assert!(in_view > 500);
    }
}

#[test]
fn a_higher_threshold_never_draws_more() {
    let mut random = Random(6);
    let torus = test_shapes::torus(20_000, 0.4, &mut random);
    let tree = Octree::build(&torus.positions, &vec![[0; 4]; 20_000], StopCriterion::Loss(0.02));
    let mut out = Vec::new();
    let emitted: Vec<usize> = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 1e9]
        .into_iter()
        .map(|lod_px| {
            let view = view_from(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, lod_px);
            tree.select(&view, &mut out).emitted
        })
        .collect();
    assert_eq!(emitted[0], tree.leaf_count(), "all of it is in view");
    assert!(emitted.windows(2).all(|pair| pair[0] >= pair[1]), "{emitted:?}");
    assert!(emitted[5] < emitted[0] / 2, "{emitted:?}");
    assert_eq!(emitted[6], 1);
}

#[test]
fn a_level_is_drawn_completely() {
    let torus = test_shapes::torus(5_000, 0.4, &mut Random(32));
    let colors = vec![[7; 4]; 5_000];
    let mut out = Vec::new();
    for stop in [
        StopCriterion::Loss(0.02),
        StopCriterion::PointsPerOctant(5),
        StopCriterion::Spacing,
    ] {
        let tree = Octree::build(&torus.positions, &colors, stop);
        for deepest_level in [0, 1, 4, tree.depth(), SelectView::ALL_LEVELS] {
            let view = SelectView {
                deepest_level,
                ..view_from(Vec3::new(0.0, 3.0, 5.0), Vec3::ZERO, 0.0)
            };
            tree.select(&view, &mut out);
            let cells =
                |voxels: &[VoxelRecord]| -> HashSet<_> { voxels.iter().map(|voxel| cell_of(&tree, voxel)).collect() };
            let expected = tree.level_voxels(deepest_level.min(tree.depth()));
            assert_eq!(cells(&out), cells(&expected), "level {deepest_level}");
        }
    }
}

#[test]
fn an_eye_inside_the_cloud_refines_around_itself() {
    let torus = test_shapes::torus(5_000, 0.4, &mut Random(7));
    let tree = Octree::build(&torus.positions, &vec![[0; 4]; 5_000], StopCriterion::Loss(0.02));
    let eye = torus.positions[0];
    // The frustum contains everything, so that it hides nothing; distances are from the eye.
    let view = SelectView {
        eye,
        ..view_from(Vec3::splat(4.0), Vec3::ZERO, 100.0)
    };
    let mut out = Vec::new();
    tree.select(&view, &mut out);
    let reached = |voxel: &VoxelRecord| {
        u32::from(voxel.level) == tree.depth()
            && (Vec3::from_array(voxel.center) - eye).abs().max_element() <= tree.cube().cell_edge(tree.depth())
    };
    assert!(out.iter().any(reached));
}

#[test]
fn the_output_vector_is_reused() {
    let sphere = test_shapes::sphere(5_000, &mut Random(8));
    let tree = Octree::build(&sphere.positions, &vec![[0; 4]; 5_000], StopCriterion::Loss(0.05));
    let view = view_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 0.0);
    let mut out = Vec::new();
    let first = tree.select(&view, &mut out);
    let (address, copy) = (out.as_ptr(), out.clone());
    assert_eq!(tree.select(&view, &mut out), first);
    assert_eq!(out.as_ptr(), address);
    assert_eq!(out, copy);
}
