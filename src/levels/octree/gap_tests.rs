//! Gaps against a search of all cells.

use super::tests::{cell_of, view_from};
use super::*;
use crate::analysis::test_shapes::{self, Random};
use crate::levels::{CutHints, Levels as _, SelectView};
use crate::math::morton::LEVELS;
use glam::{IVec3, Vec3};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};

fn tree_of(positions: &[Vec3]) -> Octree {
    let color = |i: usize| [i, i >> 8, i >> 16, 0].map(|channel| channel as u8);
    let colors: Vec<[u8; 4]> = (0..positions.len()).map(color).collect();
    Octree::build(positions, &colors, StopCriterion::Spacing)
}

fn of_tree(tree: &Octree) -> &[Gap] {
    &tree.gaps
}

/// The gaps of a level by definition: cells without points that touch leaves, between two opposite ones with some or
/// closed before.
fn by_definition(tree: &Octree, level: u32) -> HashSet<[i32; 3]> {
    let cells = tree.points.cells.iter();
    let occupied: HashSet<IVec3> = cells
        .map(|cell| IVec3::from_array([0, 1, 2].map(|axis| cell.coordinate(axis, level) as i32)))
        .collect();
    let leaves: HashSet<IVec3> = tree
        .level_voxels(tree.depth())
        .iter()
        .filter(|voxel| u32::from(voxel.level) == level)
        .map(|voxel| cell_of(tree, voxel).1.map(|coordinate| coordinate as i32).into())
        .collect();
    let directions = (0..27).map(|at| IVec3::new(at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1));
    let directions: Vec<IVec3> = directions.filter(|&at| at != IVec3::ZERO).collect();
    let adjacent = |cells: &HashSet<IVec3>| -> HashSet<IVec3> {
        let cells = cells.iter();
        cells
            .flat_map(|&cell| directions.iter().map(move |&direction| cell + direction))
            .collect()
    };
    let candidates = &adjacent(&leaves) - &occupied;
    let mut filled = occupied.clone();
    for _ in 0..3 {
        let is_between = |cell: &&IVec3| {
            let opposite =
                |&direction: &IVec3| filled.contains(&(**cell + direction)) && filled.contains(&(**cell - direction));
            directions.iter().any(opposite)
        };
        let closed: HashSet<IVec3> = candidates.iter().filter(is_between).copied().collect();
        filled.extend(closed);
    }
    filled.difference(&occupied).map(IVec3::to_array).collect()
}

fn check(tree: &Octree) {
    let mut found: HashMap<u32, HashSet<[i32; 3]>> = HashMap::new();
    for gap in of_tree(tree) {
        let (level, cell) = (u32::from(gap.level), tree.cell_of_gap(gap));
        let place = cell.map(|coordinate| coordinate as i32);
        let is_new = found.entry(level).or_default().insert(place);
        assert!(is_new, "{gap:?} twice");
        // It is drawn by a whole leaf of its level that touches it.
        let [first, end] = gap.leaf.map(|point| point as usize);
        assert!(tree.is_leaf(level, &(first..end)));
        assert_eq!(tree.points.next_beginning(level, first + 1, tree.point_count()), end);
        assert!(u32::from(tree.points.partings[first]) <= level);
        for (axis, cell) in cell.into_iter().enumerate() {
            let adjacent = tree.points.cells[first].coordinate(axis, level);
            assert!(cell.abs_diff(adjacent) <= 1, "{gap:?}");
        }
    }
    for level in 0..=LEVELS {
        let expected = by_definition(tree, level);
        let found = found.remove(&level).unwrap_or_default();
        let differing: Vec<_> = found.symmetric_difference(&expected).collect();
        assert!(differing.is_empty(), "level {level}: {differing:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn gaps_match_a_search_of_all_cells(
        seed: u64,
        count in 1usize..3_000,
        stretch in prop::array::uniform3(0.001f32..1.0),
        cluster in 0usize..600,
    ) {
        let mut random = Random(seed);
        let mut positions = test_shapes::torus(count, 0.4, &mut random).positions;
        for position in &mut positions {
            *position *= Vec3::from_array(stretch);
        }
        // Leaves are on several levels.
        positions.extend((0..cluster).map(|_| 0.01 * random.cube() + Vec3::splat(0.2)));
        check(&tree_of(&positions));
    }
}

#[test]
fn missing_cells_of_a_plane_are_filled_and_none_beyond_its_edge() {
    // Four points per cell, of 16 cells along each edge; none in some, including ones at borders of blocks of 4.
    let holes = [[5, 5], [7, 8], [8, 3], [12, 12], [0, 9]];
    let mut positions = Vec::new();
    for x in 0..16 {
        for y in 0..16 {
            if !holes.contains(&[x, y]) {
                let at = |part: usize| [0.25, 0.75].map(|offset| offset + [x, y][part] as f32);
                positions.extend(at(0).iter().flat_map(|&x| at(1).map(|y| Vec3::new(x, y, 0.5))));
            }
        }
    }
    // The cube is the plane's own.
    positions.extend([Vec3::ZERO, Vec3::splat(16.0)]);
    let tree = tree_of(&positions);
    let flat: HashSet<[u32; 2]> = of_tree(&tree)
        .iter()
        .filter(|gap| gap.level == 4)
        .map(|gap| tree.cell_of_gap(gap))
        .filter(|cell| cell[2] == 0)
        .map(|[x, y, _]| [x, y])
        .collect();
    assert_eq!(flat, holes.into_iter().collect());
}

#[test]
fn filled_gaps_have_leaf_colors_and_distinct_positions() {
    let positions = test_shapes::sphere(20_000, &mut Random(4)).positions;
    let tree = tree_of(&positions);
    let view = view_from(Vec3::new(2.0, 3.0, 4.0), Vec3::ZERO, 0.0);
    let cut = tree.cut(&view, CutHints::default());
    let gaps = tree.gaps_of(&cut);
    assert_eq!(gaps.len(), of_tree(&tree).len());
    assert!(gaps.len() > 1_000, "{}", gaps.len());
    let (mut leaves, mut voxels) = (Vec::new(), Vec::new());
    tree.write_voxels(&cut, &mut leaves);
    tree.add_gap_voxels(&gaps, &mut voxels);
    let by_cell: HashMap<_, _> = leaves.iter().map(|leaf| (cell_of(&tree, leaf), leaf)).collect();
    for (gap, voxel) in gaps.iter().zip(&voxels) {
        let (level, cell) = (u32::from(gap.level), tree.cell_of_gap(gap));
        assert_eq!(cell_of(&tree, voxel), (level, cell));
        assert!(!by_cell.contains_key(&(level, cell)));
        let first = tree.points.cells[gap.leaf[0] as usize];
        let adjacent = [0, 1, 2].map(|axis| first.coordinate(axis, level));
        let leaf = by_cell[&(level, adjacent)];
        assert_eq!((leaf.color, leaf.level), (voxel.color, voxel.level));
    }
    // There are no gaps between coarser cells: they are closed.
    let coarse = tree.cut(
        &SelectView {
            deepest_level: 3,
            ..view
        },
        CutHints::default(),
    );
    assert!(tree.gaps_of(&coarse).is_empty());
    // Nor are there any where leaves are not as large as the spacing.
    assert!(of_tree(&tree.with_stop(StopCriterion::PAPER)).is_empty());
}
