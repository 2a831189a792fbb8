use super::*;
use crate::analysis::{SurfaceOptions, estimate_surface_fast};
use crate::cloud::{Frame, Positions, RawCloud};
use crate::scene::{Camera, ClipShape, PicturePlane, Projection, UpAxis};
use glam::{DVec3, Vec4};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};

const VIEWPORT_PX: [u32; 2] = [160, 120];

/// From `distance` away along +Z, looking at the origin.
fn camera(distance: f64) -> Camera {
    Camera {
        target_in_world: DVec3::ZERO,
        distance,
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        fov_deg: 60.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    }
}

fn in_morton_order(positions: &[Vec3]) -> Vec<Vec3> {
    let positions = positions.iter().map(Vec3::to_array).collect();
    let raw = RawCloud::from_positions(Positions::F32(positions));
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    frame.positions().to_vec()
}

/// A square lattice in the plane of `x` and `y` through `center`.
fn plate(center: Vec3, [x, y]: [Vec3; 2], points_along: u16) -> Vec<Vec3> {
    let step = |index: u16| 2.0 * f32::from(index) / f32::from(points_along - 1) - 1.0;
    let places = (0..points_along).flat_map(|row| (0..points_along).map(move |column| (column, row)));
    places
        .map(|(column, row)| center + step(column) * x + step(row) * y)
        .collect()
}

fn retained(positions: &[Vec3], camera: &Camera, clip: Option<&Clip>) -> Vec<Vec3> {
    let view = camera.transform(DVec3::ZERO, VIEWPORT_PX);
    let slots = points_in_view(positions, &view, VIEWPORT_PX, clip);
    assert!(slots.is_sorted_by(|a, b| a < b), "each once");
    slots.iter().map(|&slot| positions[slot as usize]).collect()
}

#[test]
fn points_hidden_by_a_plate_are_excluded_until_it_is_clipped() {
    let edges = [Vec3::X, Vec3::Y];
    let [front, back] = [0.5, -0.5].map(|z| plate(Vec3::new(0.0, 0.0, z), edges, 300));
    // Seen from the centre of the front plate, the back one is smaller.
    let positions = in_morton_order(&[front, back].concat());
    let camera = camera(3.0);
    let all = retained(&positions, &camera, None);
    // Runs that span both plates retain points of both.
    let hidden = all.iter().filter(|position| position.z < 0.0).count();
    assert!(50 * hidden < all.len(), "{hidden} of {}", all.len());

    let clip = Clip::to(ClipShape::Plane {
        normal: DVec3::NEG_Z,
        offset: 0.0,
    });
    let behind = retained(&positions, &camera, Some(&clip));
    assert!(!behind.is_empty() && behind.iter().all(|position| position.z < 0.0));
}

#[test]
fn a_dense_plate_retains_one_to_three_points_per_pixel_and_a_sparse_one_all() {
    let edges = [Vec3::X, Vec3::Y];
    // Its edge in pixels: 2 · 120 / 2 / tan 30° / 3.
    let edge_px = 2.0 * 60.0 / f64::to_radians(30.0).tan() / 3.0;
    let dense = in_morton_order(&plate(Vec3::ZERO, edges, 600));
    let count = retained(&dense, &camera(3.0), None).len() as f64;
    assert!(
        (1.0..3.0).contains(&(count / (edge_px * edge_px))),
        "{count} of {}",
        edge_px * edge_px
    );
    let sparse = in_morton_order(&plate(Vec3::ZERO, edges, 30));
    assert_eq!(retained(&sparse, &camera(3.0), None).len(), sparse.len());
}

#[test]
fn points_retained_at_a_grazing_angle_define_the_plane_of_a_floor() {
    let floor = plate(Vec3::new(0.0, -0.2, 0.0), [2.0 * Vec3::X, 2.0 * Vec3::Z], 900);
    let floor = in_morton_order(&floor);
    let retained = retained(&floor, &camera(3.0), None);
    assert!((2_000..200_000).contains(&retained.len()), "{}", retained.len());
    let surface = estimate_surface_fast(&retained, None, SurfaceOptions::AUTO);
    let upright = surface.normals.iter().filter(|normal| normal.y.abs() > 0.999);
    let share = upright.count() as f64 / retained.len() as f64;
    assert!(share > 0.999, "{share}");
}

#[test]
fn the_number_of_retained_points_is_bounded() {
    let wall = plate(Vec3::ZERO, [2.0 * Vec3::X, 2.0 * Vec3::Y], 2000);
    let wall = in_morton_order(&wall);
    let viewport_px = [4000, 3000];
    let view = camera(3.0).transform(DVec3::ZERO, viewport_px);
    let retained = points_in_view(&wall, &view, viewport_px, None).len() as f64;
    // Each piece retains a whole number of points.
    let pieces = (wall.len() / POINTS_PER_PIECE) as f64;
    assert!(
        (0.9 * MAX_POINTS..MAX_POINTS + pieces).contains(&retained),
        "{retained}"
    );
}

#[test]
fn nothing_is_retained_of_empty_clouds_or_behind_the_eye() {
    assert!(retained(&[], &camera(3.0), None).is_empty());
    let behind = in_morton_order(&plate(Vec3::new(0.0, 0.0, 5.0), [Vec3::X, Vec3::Y], 50));
    assert!(retained(&behind, &camera(3.0), None).is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// By the matrix of the projection, point by point.
    #[test]
    fn only_chunks_with_the_nearest_point_of_a_pixel_are_retained(
        places in prop::collection::vec(prop::array::uniform3(-2.0_f32..2.0), 0..4000),
        distance in 1.0_f64..6.0,
    ) {
        let view = camera(distance).transform(DVec3::ZERO, VIEWPORT_PX);
        let in_clip_space = |position: Vec3| view.clip_from_view() * view.to_view(position).extend(1.0);
        let in_pixels = |clip: Vec4| {
            let [x, y] = [clip.x / clip.w, clip.y / clip.w];
            [(x + 1.0) * 80.0, (1.0 - y) * 60.0]
        };
        let places: Vec<Vec3> = places.into_iter().map(Vec3::from_array).collect();
        let mut positions = in_morton_order(&places);
        // At the border of a pixel rounding decides.
        positions.retain(|&position| {
            let is_off_border = |at: f32| (at - at.round()).abs() > 1e-4;
            in_pixels(in_clip_space(position)).into_iter().all(is_off_border)
        });
        let mut nearest = HashMap::new();
        let mut in_picture = HashSet::new();
        for (slot, &position) in positions.iter().enumerate() {
            let clip = in_clip_space(position);
            let [column, row] = in_pixels(clip);
            let is_inside = (0.0..160.0).contains(&column) && (0.0..120.0).contains(&row);
            if is_inside && clip.w >= view.near {
                in_picture.insert(slot as u32);
                let seen = nearest.entry((column as u32, row as u32)).or_insert((clip.w, slot));
                if clip.w < seen.0 {
                    *seen = (clip.w, slot);
                }
            }
        }
        let seen: HashSet<usize> = nearest.values().map(|(_, slot)| slot / POINTS_PER_PIECE).collect();
        let slots = points_in_view(&positions, &view, VIEWPORT_PX, None);
        prop_assert!(slots.iter().all(|slot| in_picture.contains(slot)));
        let retained: HashSet<usize> = slots.iter().map(|&slot| slot as usize / POINTS_PER_PIECE).collect();
        prop_assert_eq!(retained, seen);
    }
}
