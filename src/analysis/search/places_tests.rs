//! Points that lie where others do.

use super::places::Places;
use crate::analysis::estimate_surface;
use crate::analysis::splat_ellipses;
use crate::analysis::splat_radii;
use crate::analysis::test_shapes::{self, Random};
use glam::Vec3;

/// Each point five times in a row.
fn five_times<T: Copy>(values: &[T]) -> Vec<T> {
    values.iter().flat_map(|&value| [value; 5]).collect()
}

#[test]
fn duplicates_change_neither_normals_nor_radii() {
    let points = test_shapes::sphere(700, &mut Random(3)).positions;
    let alone = estimate_surface(&points, None);
    let copied = estimate_surface(&five_times(&points), None);
    assert_eq!(copied.normals, five_times(&alone.normals));
    assert_eq!(copied.radii, five_times(&alone.radii));
    assert!(copied.without_plane.is_empty());
    let normals = five_times(&alone.normals);
    assert_eq!(
        splat_radii(&five_times(&points), &normals),
        five_times(&splat_radii(&points, &alone.normals))
    );
    assert_eq!(
        splat_ellipses(&five_times(&points), &normals),
        five_times(&splat_ellipses(&points, &alone.normals))
    );
}

#[test]
fn all_copies_of_points_without_a_plane_are_reported() {
    let line: Vec<Vec3> = (0..20).map(|place| Vec3::X * place as f32).collect();
    let alone = estimate_surface(&line, None);
    let copied = estimate_surface(&five_times(&line), None);
    assert_eq!(copied.without_plane.len(), 5 * alone.without_plane.len());
    assert_eq!(copied.without_plane.len(), 100);
}

#[test]
fn a_few_duplicates_count_as_ordinary_points() {
    let mut points = vec![Vec3::ONE; 2];
    points.extend((0..40).map(|place| Vec3::Y * place as f32));
    assert!(Places::of(&points).is_none());
    assert!(Places::of(&[]).is_none());
    assert!(Places::of(&[Vec3::ZERO; 3]).is_some_and(|places| places.positions.len() == 1));
}
