//! Expected answers of an octree, found by testing every cell on its own.

use glam::Vec3;
use pointreel::cloud::VoxelRecord;
use pointreel::levels::SelectView;
use pointreel::levels::octree::Octree;
use pointreel::math::Cube;
use pointreel::math::{Containment, morton};
use std::collections::HashSet;

/// Cell of a level that holds `position`, by division in f64; the upper faces of the cube belong to the last cells.
fn cell_of(cube: &Cube, position: Vec3, level: u32) -> [u32; 3] {
    let along = f64::from(1u32 << level);
    let share = (position.as_dvec3() - cube.min) / f64::from(cube.edge);
    share
        .to_array()
        .map(|share| (share * along).floor().min(along - 1.0) as u32)
}

fn cells(cube: &Cube, positions: &[Vec3], level: u32) -> HashSet<[u32; 3]> {
    let cells = positions.iter().map(|&position| cell_of(cube, position, level));
    cells.collect()
}

fn level_and_cell(cube: &Cube, voxel: &VoxelRecord) -> (u32, [u32; 3]) {
    let level = u32::from(voxel.level);
    (level, cell_of(cube, Vec3::from_array(voxel.center), level))
}

/// Leaves hold all points and nothing else, each point is near the centre of its leaf, and the depth is the first that
/// loses little enough.
pub(crate) fn check_octree(name: &str, tree: &Octree, positions: &[Vec3], delta: f32) {
    let (cube, depth) = (tree.cube(), tree.depth());
    assert!(
        cube.min.is_finite() && cube.edge.is_finite() && cube.edge > 0.0,
        "{name}"
    );
    let leaves: HashSet<_> = Octree::cells_from_masks(&tree.masks(), depth)
        .unwrap()
        .into_iter()
        .collect();
    assert!(leaves == cells(&cube, positions, depth), "{name}: leaves");
    assert_eq!(tree.leaf_count(), leaves.len(), "{name}");

    let drawn = tree.level_voxels(depth);
    assert_eq!(drawn.len(), leaves.len(), "{name}");
    let half_diagonal = 0.75f64.sqrt() * f64::from(cube.edge) / f64::from(1u32 << depth);
    // Centres are f32 like the positions.
    let reach = cube.min.as_vec3().abs().max_element() + cube.edge;
    let rounding = 4.0 * f64::from(f32::EPSILON * reach);
    let centers: std::collections::HashMap<_, _> = drawn
        .iter()
        .map(|voxel| (level_and_cell(&cube, voxel).1, Vec3::from_array(voxel.center)))
        .collect();
    for &position in positions {
        let center = centers[&cell_of(&cube, position, depth)];
        let distance = (position.as_dvec3() - center.as_dvec3()).length();
        assert!(
            distance <= half_diagonal + rounding,
            "{name}: {distance} from the middle of a leaf of half diagonal {half_diagonal}"
        );
    }

    let count = positions.len() as f64;
    let loss = 1.0 - leaves.len() as f64 / count;
    assert!((f64::from(tree.loss()) - loss).abs() < 1e-6, "{name}: loss");
    let distinct = cells(&cube, positions, morton::LEVELS).len();
    let ends_at = |level: u32| {
        let found = cells(&cube, positions, level).len();
        found as f64 >= (1.0 - f64::from(delta)) * count - 1e-9 || found == distinct
    };
    assert!(depth == morton::LEVELS || ends_at(depth), "{name}: depth {depth}");
    assert!(!(0..depth).any(ends_at), "{name}: depth {depth} is not the first");
}

/// A traversal emits exactly the cells that are reached when every cell of every level is tested.
pub(crate) fn check_visible_set(name: &str, tree: &Octree, positions: &[Vec3], view: &SelectView) {
    let (cube, depth) = (tree.cube(), tree.depth());
    let is_visible = |level: u32, cell: [u32; 3]| {
        let radius = 0.5 * 3f32.sqrt() * cube.cell_edge(level);
        view.frustum.sphere(cube.cell_center(level, cell), radius) != Containment::Outside
    };
    let stops = |level: u32, cell: [u32; 3]| {
        let edge = cube.cell_edge(level);
        let offset = (cube.cell_center(level, cell) - view.eye).abs() - 0.5 * edge;
        let nearest_squared = offset.max(Vec3::ZERO).length_squared();
        let [edge, pixels, lod_px] = [edge, view.pixels_per_unit_at_1, view.lod_px].map(f64::from);
        level == depth || lod_px > 0.0 && nearest_squared > (edge * pixels / lod_px).powi(2) as f32
    };
    let mut expected = HashSet::new();
    for level in 0..=depth {
        for cell in cells(&cube, positions, level) {
            let is_reached = (1..=level).all(|up| {
                let above = cell.map(|coordinate| coordinate >> up);
                is_visible(level - up, above) && !stops(level - up, above)
            });
            if is_reached && is_visible(level, cell) && stops(level, cell) {
                expected.insert((level, cell));
            }
        }
    }
    let found = visible_set(tree, view);
    let missing = expected.difference(&found).count();
    let unexpected = found.difference(&expected).count();
    assert!(
        found == expected,
        "{name}: of {} cells {missing} are missing, {unexpected} are not among them, τ {}",
        expected.len(),
        view.lod_px
    );
}

/// Level and coordinates of the emitted cells, none twice.
pub(crate) fn visible_set(tree: &Octree, view: &SelectView) -> HashSet<(u32, [u32; 3])> {
    let mut voxels = Vec::new();
    let stats = tree.select(view, &mut voxels);
    let cube = tree.cube();
    let found: HashSet<_> = voxels.iter().map(|voxel| level_and_cell(&cube, voxel)).collect();
    assert_eq!((found.len(), stats.emitted), (voxels.len(), voxels.len()));
    found
}
