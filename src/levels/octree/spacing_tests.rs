//! Leaves as large as the spacing of points: constructed clouds whose spacing is known.

use super::stop::Leaves;
use super::tests::cell_of;
use super::*;
use crate::analysis::test_shapes::{self, Random};
use glam::Vec3;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

fn tree_of(positions: &[Vec3]) -> Octree {
    let colors = vec![[128; 4]; positions.len()];
    Octree::build(positions, &colors, StopCriterion::Spacing)
}

/// A lattice of this many points along each edge, from a corner, in a plane that is parallel to no face of the octree's
/// cube.
fn lattice(count: u32, spacing: f32, corner: Vec3) -> Vec<Vec3> {
    let u = Vec3::new(0.8, 0.36, 0.48);
    let v = Vec3::new(-0.6, 0.48, 0.64);
    let place = |i: u32| corner + spacing * (u * (i % count) as f32 + v * (i / count) as f32);
    (0..count * count).map(place).collect()
}

/// Leaf edges over the spacing: never smaller, and by powers of two at most twice the smallest that is closed.
const EDGES_PER_SPACING: std::ops::Range<f32> = 1.0..2.6;

fn only_leaf_edge(tree: &Octree) -> f32 {
    let Leaves::OnLevel(level) = tree.leaves else {
        panic!("leaves on several levels");
    };
    tree.cube().cell_edge(level)
}

/// The edge of most leaves.
fn usual_leaf_edge(tree: &Octree) -> f32 {
    let mut counts = HashMap::<u8, usize>::new();
    for voxel in tree.level_voxels(tree.depth()) {
        *counts.entry(voxel.level).or_default() += 1;
    }
    let usual = counts.into_iter().max_by_key(|&(_, count)| count);
    tree.cube().cell_edge(u32::from(usual.unwrap().0))
}

#[test]
fn leaves_of_a_lattice_are_a_few_spacings_long_at_any_scale() {
    for (count, spacing) in [(30, 1.0), (64, 0.01), (150, 7.0), (301, 1.0)] {
        let edge = only_leaf_edge(&tree_of(&lattice(count, spacing, Vec3::ZERO)));
        let spacings = edge / spacing;
        assert!(EDGES_PER_SPACING.contains(&spacings), "{count}: {spacings}");
    }
}

#[test]
fn points_in_a_row_are_a_row_of_voxels() {
    let row: Vec<Vec3> = (0..2_000).map(|i| Vec3::new(0.8, 0.0, 0.6) * i as f32).collect();
    let tree = tree_of(&row);
    let edge = only_leaf_edge(&tree);
    assert!((2.0..6.0).contains(&edge), "{edge}");
    // No gap: each cell touches the next along both axes.
    let mut cells: Vec<[u32; 3]> = tree
        .level_voxels(tree.depth())
        .iter()
        .map(|voxel| cell_of(&tree, voxel).1)
        .collect();
    cells.sort_unstable();
    let is_gap = |pair: &[[u32; 3]]| (0..3).any(|axis| pair[0][axis].abs_diff(pair[1][axis]) > 1);
    assert!(!cells.windows(2).any(is_gap));
}

/// Points many times at one place, or nearly so, are not a smaller spacing.
#[test]
fn duplicate_points_change_nothing() {
    let plain = lattice(100, 1.0, Vec3::ZERO);
    let expected = only_leaf_edge(&tree_of(&plain));
    let mut random = Random(3);
    for (copies, apart) in [(2, 0.0), (7, 0.0), (2, 1e-3), (4, 1e-3)] {
        let copied: Vec<Vec3> = plain
            .iter()
            .flat_map(|&place| (0..copies).map(move |copy| (place, copy)))
            .map(|(place, copy)| place + apart * copy as f32 * random.cube())
            .collect();
        let edge = usual_leaf_edge(&tree_of(&copied));
        // The cube around the points differs by a thousandth.
        assert!((edge / expected - 1.0).abs() < 0.01, "{copies}: {edge}");
    }
}

#[test]
fn each_of_two_clouds_has_its_own_spacing() {
    let coarse = lattice(60, 1.0, Vec3::ZERO);
    let fine = lattice(60, 1.0 / 16.0, Vec3::new(-9.0, 70.0, 11.0));
    let tree = tree_of(&[coarse, fine].concat());
    let mut points_by_edge: HashMap<u32, usize> = HashMap::new();
    for voxel in tree.level_voxels(tree.depth()) {
        let edge = tree.cube().cell_edge(u32::from(voxel.level));
        let is_fine = voxel.center[1] > 69.5;
        let spacing = if is_fine { 1.0 / 16.0 } else { 1.0 };
        let spacings = edge / spacing;
        assert!(EDGES_PER_SPACING.contains(&spacings), "{spacings}");
        *points_by_edge.entry(u32::from(voxel.level)).or_default() += 1;
    }
    let [min, max] = [points_by_edge.keys().min(), points_by_edge.keys().max()];
    let levels = max.unwrap() - min.unwrap();
    assert!((3..=5).contains(&levels), "{points_by_edge:?}");
}

/// A point far from all others is as small as they are, and hides nothing.
#[test]
fn a_few_distant_points_do_not_get_large_cubes() {
    let sphere = test_shapes::sphere(20_000, &mut Random(9)).positions;
    let expected = only_leaf_edge(&tree_of(&sphere));
    let far = [Vec3::splat(40.0), Vec3::new(-30.0, 2.0, 8.0), Vec3::X * 3.0];
    let tree = tree_of(&[&sphere[..], &far].concat());
    for voxel in tree.level_voxels(tree.depth()) {
        let edge = tree.cube().cell_edge(u32::from(voxel.level));
        // The cubes around the two clouds differ, so their cells do by up to a factor of two.
        let ratio = edge / expected;
        assert!((0.5..=2.0).contains(&ratio), "{ratio} at {:?}", voxel.center);
    }
}

#[test]
fn few_coincident_and_no_points_are_handled() {
    assert_eq!(tree_of(&[]).node_count(), 0);
    for positions in [vec![Vec3::ONE], vec![Vec3::ONE; 500], vec![Vec3::ZERO, Vec3::ONE]] {
        let tree = tree_of(&positions);
        assert!(tree.leaf_count() >= 1);
        assert_eq!(tree.level_voxels(tree.depth()).len(), tree.leaf_count());
    }
}

/// The nodes that are counted are those there are, on all levels.
#[test]
fn nodes_are_counted_where_leaves_are_on_several_levels() {
    let mut random = Random(5);
    let mut cloud = test_shapes::torus(6_000, 0.4, &mut random).positions;
    cloud.extend((0..4_000).map(|_| 0.03 * random.cube() + Vec3::Z));
    cloud.extend((0..200).map(|_| 5.0 * random.cube()));
    let tree = tree_of(&cloud);
    assert!(matches!(tree.leaves, Leaves::InRuns(_)));
    let leaves = tree.level_voxels(tree.depth());
    assert_eq!(leaves.len(), tree.leaf_count());
    let nodes: HashSet<(u32, [u32; 3])> = leaves
        .iter()
        .map(|voxel| cell_of(&tree, voxel))
        .flat_map(|(level, cell)| (0..=level).map(move |up| (level - up, cell.map(|index| index >> up))))
        .collect();
    let expected: Vec<usize> = (0..=tree.depth())
        .map(|level| nodes.iter().filter(|node| node.0 == level).count())
        .collect();
    assert_eq!(tree.level_counts(), expected);
    // The counts when leaves are read from a file, one node after another.
    let again = Octree::with_leaves(tree.cube, Arc::clone(&tree.points), tree.leaves.clone());
    assert_eq!(again.level_counts(), tree.level_counts());
    assert_eq!(again.leaf_count(), tree.leaf_count());
}
