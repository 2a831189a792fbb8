//! Images with known answers, and both kinds of truth compared with each other.

use super::*;
use crate::cloud::{Ellipse, PointRecord, ShapeRecord, encode_ellipse, oct_encode};
use crate::measure::{DepthTolerance, SurfaceError, flip};
use crate::scene::{Background, Camera, Lighting, PicturePlane, Projection, UpAxis};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use glam::Vec3;
use std::sync::Arc;

const GREY: Background = Background::solid([119; 3]);

/// From the front, `distance` away from the centre, with a cotangent of 1: a slope of 1 is at the upper edge.
fn front(distance: f64) -> Camera {
    Camera {
        target_in_world: DVec3::ZERO,
        distance,
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        fov_deg: 90.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    }
}

fn unlit(camera: &Camera, size_px: [u32; 2]) -> TruthView {
    TruthView::new(camera, DVec3::ZERO, size_px, Lighting::Unlit, GREY)
}

fn disk(position: [f32; 3], radius: f32, color: [u8; 3]) -> (PointRecord, ShapeRecord) {
    let [red, green, blue] = color;
    let point = PointRecord {
        position,
        color: [red, green, blue, 255],
    };
    let shape = ShapeRecord {
        normal: oct_encode(Vec3::Z),
        radius,
        ellipse: 0,
        scalar: 0.0,
    };
    (point, shape)
}

fn of_disks(disks: &[(PointRecord, ShapeRecord)], view: &TruthView) -> Truth {
    let (points, shapes): (Vec<_>, Vec<_>) = disks.iter().copied().unzip();
    let disks = Disks {
        points: &points,
        shapes: &shapes,
        are_ellipses: false,
        cull_back_faces: true,
    };
    Truth::of_disks(&disks, view)
}

#[test]
fn a_disk_has_its_area_depth_and_color() {
    // 100 pixels for a slope of 1; a radius of 0.5 at distance 2 is 25 pixels.
    let view = unlit(&front(2.0), [200, 200]);
    let truth = of_disks(&[disk([0.0; 3], 0.5, [219, 119, 19])], &view);
    // Red exceeds the background by 100 where a pixel is covered.
    let sum: f64 = truth.image.pixels().map(|pixel| f64::from(pixel[0]) - 119.0).sum();
    let area_px = sum / 100.0;
    let expected_px = std::f64::consts::PI * 625.0;
    assert!(
        (area_px - expected_px).abs() < 0.002 * expected_px,
        "{area_px} for {expected_px}"
    );
    let at = |x: usize, y: usize| truth.depth.depth[200 * y + x];
    assert_eq!(at(100, 100), 2.0);
    assert_eq!(at(20, 100), f32::INFINITY);
    assert_eq!(truth.tolerance[200 * 100 + 100], 1.0);
    assert_eq!(truth.image.get_pixel(100, 100).0, [219, 119, 19, 255]);
    assert_eq!(truth.image.get_pixel(3, 3).0, [119, 119, 119, 255]);
}

#[test]
fn near_disks_hide_far_ones_and_blend_with_those_of_their_surface() {
    let view = unlit(&front(10.0), [64, 64]);
    let near = disk([0.0, 0.0, 0.0], 2.0, [200, 0, 0]);
    // A quarter of a radius behind: the same surface, the same centre, the same weight.
    let beside = disk([0.0, 0.0, -0.5], 2.1, [0, 200, 0]);
    let far = disk([0.0, 0.0, -5.0], 4.0, [0, 0, 200]);
    let center = |disks: &[_]| of_disks(disks, &view).image.get_pixel(32, 32).0;
    assert_eq!(center(&[far, near]), [200, 0, 0, 255]);
    let [red, green, blue, _] = center(&[beside, far, near]);
    assert!(
        red.abs_diff(100) <= 2 && green.abs_diff(100) <= 2 && blue == 0,
        "{red} {green} {blue}"
    );
}

#[test]
fn an_ellipse_has_its_area_and_direction_and_is_a_disk_where_ellipses_are_disabled() {
    let view = unlit(&front(2.0), [200, 200]);
    let (point, shape) = disk([0.0; 3], 0.5, [219, 119, 19]);
    let axis = Vec3::new(0.6, 0.8, 0.0);
    let ellipse = encode_ellipse(shape.normal, Ellipse { axis, ratio: 0.25 });
    let picture = |are_ellipses| {
        let disks = Disks {
            points: &[point],
            shapes: &[ShapeRecord { ellipse, ..shape }],
            are_ellipses,
            cull_back_faces: true,
        };
        Truth::of_disks(&disks, &view).image
    };
    assert_eq!(picture(false), of_disks(&[(point, shape)], &view).image);
    let image = picture(true);
    let longer = 0.5 * (2.0f64 / (1.0 + 0.0625)).sqrt();
    let expected_px = std::f64::consts::PI * longer * 0.25 * longer * 2500.0;
    let sum: f64 = image.pixels().map(|pixel| f64::from(pixel[0]) - 119.0).sum();
    assert!(
        (sum / 100.0 / expected_px - 1.0).abs() < 0.005,
        "{sum} for {expected_px}"
    );
    // Rows are counted downwards.
    let at = |along: f64, across: f64| {
        let place = DVec3::new(0.6, -0.8, 0.0) * along + DVec3::new(0.8, 0.6, 0.0) * across;
        let [x, y] = [place.x, place.y].map(|offset| (100.0 + 50.0 * offset) as u32);
        image.get_pixel(x, y).0[0]
    };
    for (share, expected) in [(0.93, 219), (1.07, 119)] {
        let shorter = 0.25 * longer;
        for side in [-1.0, 1.0] {
            assert_eq!(at(side * share * longer, 0.0), expected);
            // A pixel is an eighth of the shorter half axis.
            assert_eq!(at(0.0, side * (shorter + (share - 1.0) * longer)), expected);
        }
    }
}

#[test]
fn splats_facing_away_behind_the_eye_or_outside_the_image_are_not_visible() {
    let view = unlit(&front(2.0), [40, 30]);
    let (point, shape) = disk([0.0; 3], 0.5, [255; 3]);
    let away = ShapeRecord {
        normal: oct_encode(Vec3::NEG_Z),
        ..shape
    };
    let behind = disk([0.0, 0.0, 3.0], 0.5, [255; 3]);
    let beside = disk([9.0, 0.0, 0.0], 0.5, [255; 3]);
    let without_area = disk([0.0; 3], 0.0, [255; 3]);
    let truth = of_disks(&[(point, away), behind, beside, without_area], &view);
    assert!(truth.depth.depth.iter().all(|depth| depth.is_infinite()));
    assert!(truth.image.pixels().all(|pixel| pixel.0 == [119, 119, 119, 255]));
}

#[test]
fn rays_hit_shapes_where_their_formulas_say() {
    // Along the view axis, at the distance of 5.
    let depth_in_center = |shape: Shape, azimuth_deg: f64, elevation_deg: f64, x_px: f64| {
        let camera = Camera {
            azimuth_deg,
            elevation_deg,
            ..front(5.0)
        };
        let view = unlit(&camera, [200, 200]);
        let frame_from_view = view.view_from_frame.transpose();
        let traced = RayTraced {
            shape,
            cull_back_faces: true,
        };
        traced.depth(view.eye, frame_from_view * view.ray([x_px, 100.0]))
    };
    let tube = f64::from(Shape::TUBE);
    let cases = [
        (Shape::Sphere, 30.0, 40.0, 100.0, Some(4.0)),
        (Shape::Cube, 0.0, 0.0, 100.0, Some(4.0)),
        // Across a corner edge.
        (Shape::Cube, 45.0, 0.0, 100.0, Some(5.0 - 2f64.sqrt())),
        // Through the hole, and past it.
        (Shape::Torus, 0.0, 0.0, 100.0, None),
        (Shape::Torus, 0.0, 0.0, 120.0, Some(5.0 - tube)),
        (Shape::Torus, 90.0, 0.0, 100.0, Some(5.0 - 1.0 - tube)),
        // From above its centre, and its edge from the side.
        (Shape::Saddle, 0.0, 0.0, 100.0, Some(5.0)),
    ];
    for (shape, azimuth, elevation, x_px, expected) in cases {
        let depth = depth_in_center(shape, azimuth, elevation, x_px);
        // At 120 the ray meets the ring's circle at distance 5: it hits the tube off the axis of the ring.
        let tolerance = if x_px == 100.0 { 1e-9 } else { 0.05 };
        match (depth, expected) {
            (Some(depth), Some(expected)) => {
                assert!(
                    (depth - expected).abs() < tolerance,
                    "{shape:?}: {depth} for {expected}"
                );
            }
            _ => assert_eq!(depth, expected, "{shape:?} from {azimuth}"),
        }
    }
}

#[test]
fn ray_hits_are_on_the_shape_with_nothing_in_front() {
    let camera = Camera {
        azimuth_deg: 33.0,
        elevation_deg: 21.0,
        ..front(3.0)
    };
    let view = unlit(&camera, [24, 24]);
    let frame_from_view = view.view_from_frame.transpose();
    let height = |shape: Shape, p: DVec3| match shape {
        Shape::Sphere => p.length() - 1.0,
        Shape::Torus => (p.truncate().length() - 1.0).hypot(p.z) - f64::from(Shape::TUBE),
        Shape::Cube => p.abs().max_element() - 1.0,
        Shape::Saddle => p.z - p.x * p.x + p.y * p.y,
    };
    for shape in Shape::ALL {
        let traced = RayTraced {
            shape,
            cull_back_faces: false,
        };
        let mut met = 0;
        for pixel in 0..24 * 24 {
            let ray = view.ray([f64::from(pixel % 24) + 0.5, f64::from(pixel / 24) + 0.5]);
            let direction = frame_from_view * ray;
            let depth = traced.depth(view.eye, direction);
            met += usize::from(depth.is_some());
            if let Some(depth) = depth {
                assert!(height(shape, view.eye + direction * depth).abs() < 1e-9, "{shape:?}");
            }
            // In steps of a thousandth up to the hit, the sign of the function does not change on the shape.
            let sign_at = |t: f64| height(shape, view.eye + direction * t) > 0.0;
            let last = depth.map_or(6.0, |depth| depth - 1e-3);
            let steps = (last / 1e-3) as usize;
            let crossed = (1..steps).map(|step| step as f64 * 1e-3).find(|&t| {
                sign_at(t) != sign_at(t - 1e-3)
                    && shape.is_within(view.eye + direction * t)
                    && shape.is_within(view.eye + direction * (t - 1e-3))
            });
            assert_eq!(crossed, None, "{shape:?}, pixel {pixel}, met at {depth:?}");
        }
        assert!(met > 50, "{shape:?}: {met}");
    }
}

fn sampled(shape: Shape, count: usize) -> PreparedFrame {
    let frame = Sequence::of(shape.frame(count)).frame(0).unwrap();
    let needs = Needs {
        shapes: true,
        ..Needs::default()
    };
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

#[test]
fn the_ground_truth_of_a_sampled_shape_is_close_to_that_of_the_shape() {
    for shape in [Shape::Sphere, Shape::Torus] {
        let camera = Camera {
            azimuth_deg: 40.0,
            elevation_deg: 55.0,
            fov_deg: 45.0,
            ..front(4.5)
        };
        let view = TruthView::new(&camera, DVec3::ZERO, [160, 120], Lighting::PerFragment, GREY);
        let traced = RayTraced {
            shape,
            cull_back_faces: true,
        };
        let exact = Truth::of_shape(traced, &view, 0.01);
        let [few, many] = [2_000, 8_000].map(|count| {
            let frame = sampled(shape, count);
            let disks = Disks {
                points: &frame.points,
                shapes: frame.shapes.as_ref().unwrap(),
                are_ellipses: false,
                cull_back_faces: true,
            };
            let truth = Truth::of_disks(&disks, &view);
            let holes = SurfaceError::of(&exact.depth, &truth.depth, DepthTolerance::Everywhere(0.1));
            // Disks of points near the outline do not extend as far as the shape everywhere.
            assert!(holes.unwrap().hole_share() < 0.005, "{shape:?}");
            flip(&exact.image, &truth.image).unwrap().mean()
        });
        // With four times the points these are twice as close to each other, and the surface is approximated two to
        // four times as accurately.
        assert!(few < 0.06 && many < 0.5 * few, "{shape:?}: {few}, then {many}");
    }
}
