//! Images of surfaces whose normals are known.

use super::windows::plane_around;
use super::*;
use proptest::prelude::*;

const SIZE_PX: [u32; 2] = [160, 120];

const FOCAL_PX: f32 = 130.0;

/// Points that a camera sees at depths by the ray; holes where there is none.
fn seen(depth: impl Fn([f32; 2]) -> Option<f32>) -> Vec<Vec3> {
    let [width, height] = SIZE_PX;
    let point = |column: u32, row: u32| {
        let ray = [(column, width), (row, height)].map(|(at, edge)| (at as f32 - edge as f32 / 2.0) / FOCAL_PX);
        depth(ray).map_or(Vec3::NAN, |z| Vec3::new(ray[0] * z, ray[1] * z, z))
    };
    let rows = 0..height;
    rows.flat_map(|row| (0..width).map(move |column| (column, row)))
        .map(|(column, row)| point(column, row))
        .collect()
}

/// The depth of a plane with this normal and distance from the camera, as far as it is before the camera.
fn plane(normal: Vec3, distance: f32) -> impl Fn([f32; 2]) -> Option<f32> {
    let normal = normal.normalize();
    move |[x, y]| {
        let z = -distance / normal.dot(Vec3::new(x, y, 1.0));
        (z > 0.0 && z < 100.0).then_some(z)
    }
}

/// Depths as a structured-light camera has them: disparities in steps of an eighth of a pixel, of a focal length of
/// 585 pixels and a base of 7.5 cm.
fn in_steps(depth: impl Fn([f32; 2]) -> Option<f32>) -> impl Fn([f32; 2]) -> Option<f32> {
    let steps_at_a_metre = 8.0 * 585.0 * 0.075;
    move |ray| depth(ray).map(|z| steps_at_a_metre / (steps_at_a_metre / z).round())
}

fn depth_normals(size_px: [u32; 2], points: &[Vec3]) -> Vec<Vec3> {
    put_on_planes(size_px, &mut points.to_vec())
}

fn degrees_off(normals: &[Vec3], points: &[Vec3], truth: impl Fn(Vec3) -> Vec3) -> Vec<f32> {
    let measured = normals.iter().zip(points).filter(|(_, point)| point.is_finite());
    let mut off: Vec<f32> = measured
        .map(|(normal, &point)| normal.angle_between(truth(point)).to_degrees())
        .collect();
    off.sort_by(f32::total_cmp);
    off
}

#[test]
fn planes_have_exact_normals_up_to_their_borders() {
    for normal in [Vec3::NEG_Z, Vec3::new(0.3, -0.2, -1.0), Vec3::new(0.0, -1.0, -0.05)] {
        let points = seen(plane(normal, 1.3));
        let off = degrees_off(&depth_normals(SIZE_PX, &points), &points, |_| normal);
        assert!(
            off.len() > 5_000 && off[off.len() - 1] < 0.02,
            "{normal}: {:?}",
            off.last()
        );
    }
}

#[test]
fn holes_have_no_normal_and_undetermined_ones_face_the_camera() {
    let is_seen = |[x, y]: [f32; 2]| (x.abs() < 0.002 && y > 0.0).then_some(2.0);
    let points = seen(is_seen);
    for (normal, point) in depth_normals(SIZE_PX, &points).iter().zip(&points) {
        if point.is_finite() {
            assert!(normal.dot(point.normalize()) < -0.999_99, "{normal} at {point}");
        } else {
            assert_eq!(*normal, Vec3::ZERO);
        }
    }
    assert!(depth_normals([0, 3], &[]).is_empty());
    assert_eq!(depth_normals([1, 1], &[Vec3::new(0.0, 0.0, -1.0)]), [Vec3::ZERO]);
}

#[test]
fn sensor_quantisation_makes_no_terraces() {
    for tilt in [0.0_f32, 0.1, 0.3, 1.0] {
        let normal = Vec3::new(tilt, tilt / 2.0, -1.0);
        let points = seen(in_steps(plane(normal, 2.0)));
        let off = degrees_off(&depth_normals(SIZE_PX, &points), &points, |_| normal);
        let [median, max] = [off[off.len() / 2], off[off.len() * 95 / 100]];
        assert!(median < 2.0 && max < 6.0, "tilt {tilt}: {median}°, 95 % {max}°");
    }
}

#[test]
fn edges_and_corners_stay_sharp() {
    // A box in front of a wall, and the floor adjoining the wall.
    let [wall, floor] = [Vec3::NEG_Z, Vec3::NEG_Y];
    let shown = |ray: [f32; 2]| {
        let is_box = ray[0].abs() < 0.15 && (-0.2..0.1).contains(&ray[1]);
        let of_wall = plane(wall, if is_box { 1.5 } else { 2.0 })(ray);
        let of_floor = plane(floor, 0.6)(ray);
        let nearest = [(of_wall, wall), (of_floor, floor)].into_iter();
        let before = nearest.filter_map(|(depth, normal)| Some((depth?, normal)));
        before.min_by(|first, second| first.0.total_cmp(&second.0))
    };
    let points = seen(in_steps(|ray| shown(ray).map(|(depth, _)| depth)));
    let truth = |point: Vec3| shown([point.x / point.z, point.y / point.z]).unwrap().1;
    let off = degrees_off(&depth_normals(SIZE_PX, &points), &points, truth);
    let wrong = off.iter().filter(|&&off| off > 20.0).count() as f32 / off.len() as f32;
    assert!(wrong < 0.01, "{} % of the pixels", 100.0 * wrong);
}

#[test]
fn a_sphere_is_round() {
    let center = Vec3::new(0.1, 0.0, 2.0);
    let sphere = |[x, y]: [f32; 2]| {
        let ray = Vec3::new(x, y, 1.0).normalize();
        let along = ray.dot(center);
        let inside = 0.8 * 0.8 - (center.length_squared() - along * along);
        (inside > 0.0).then(|| ray.z * (along - inside.sqrt()))
    };
    let points = seen(sphere);
    let off = degrees_off(&depth_normals(SIZE_PX, &points), &points, |point| point - center);
    let [median, max] = [off[off.len() / 2], off[off.len() * 70 / 100]];
    assert!(median < 0.3 && max < 0.5, "{median}°, 70 % {max}°");
}

#[test]
fn noise_is_removed_from_planes_and_nothing_else_changes() {
    let [wall, box_before] = [plane(Vec3::new(0.2, 0.1, -1.0), 2.0), plane(Vec3::NEG_Z, 1.5)];
    let exact = |ray: [f32; 2]| {
        if ray[0].abs() < 0.203 {
            box_before(ray)
        } else {
            wall(ray)
        }
    };
    let mut points = seen(in_steps(exact));
    let outlier = 20 * SIZE_PX[0] as usize + 30;
    points[outlier] *= 0.8;
    let mut moved = points.clone();
    put_on_planes(SIZE_PX, &mut moved);
    assert_eq!(moved[outlier], points[outlier]);
    let off = |points: &[Vec3]| {
        let apart = (0..)
            .zip(points)
            .filter(|&(at, point)| at != outlier && point.is_finite());
        let apart = apart.map(|(_, point)| {
            (point.z.recip() - exact([point.x / point.z, point.y / point.z]).unwrap().recip()).powi(2)
        });
        (apart.sum::<f32>() / points.len() as f32).sqrt()
    };
    let [before, after] = [off(&points), off(&moved)];
    assert!(after < 0.5 * before, "{after}, {before} before");
    // Along their rays, and by less than a step.
    for (point, moved) in points.iter().zip(&moved).filter(|(point, _)| point.is_finite()) {
        assert!((*moved / moved.z - *point / point.z).length() < 1e-6);
        assert!((moved.z.recip() - point.z.recip()).abs() < 1.5 / (8.0 * 585.0 * 0.075));
    }
}

/// For any focal length.
#[test]
fn depths_alone_are_projected_onto_the_same_planes() {
    let points = seen(in_steps(plane(Vec3::new(0.2, 0.1, -1.0), 2.0)));
    let metres: Vec<f32> = points.iter().map(|point| point.z).collect();
    let mut moved = points.clone();
    put_on_planes(SIZE_PX, &mut moved);
    let alone = on_planes(&DepthImage::new(SIZE_PX, metres.clone()).unwrap());
    let apart = moved.iter().zip(alone.metres()).map(|(point, z)| (point.z - z).abs());
    assert!(apart.fold(0.0, f32::max) < 1e-4);
    let max = metres.iter().zip(alone.metres()).map(|(before, z)| (before - z).abs());
    assert!(max.fold(0.0, f32::max) > 1e-3);
    let holes = on_planes(&DepthImage::new([3, 2], vec![1.0, 0.0, 1.0, 0.0, 0.0, 2.0]).unwrap());
    assert_eq!(holes.metres(), [1.0, 0.0, 1.0, 0.0, 0.0, 2.0]);
}

proptest! {
    /// For any scene, normals are of unit length and towards the camera, holes have none, and windows by corners of the
    /// table are those by their pixels.
    #[test]
    fn any_image_has_valid_normals(
        width in 1_usize..40,
        depths in prop::collection::vec(
            prop_oneof![4 => 0.2_f32..8.0, 2 => Just(1.0_f32), 1 => Just(f32::NAN), 1 => Just(-1.0), 1 => Just(1e-42)],
            1..1500,
        ),
    ) {
        let height = depths.len() / width;
        let points: Vec<Vec3> = depths[..width * height]
            .iter()
            .enumerate()
            .map(|(at, &z)| Vec3::new((at % width) as f32 * 0.01 * z, (at / width) as f32 * 0.01 * z, z))
            .collect();
        let normals = depth_normals([width as u32, height as u32], &points);
        let pixels = Pixels::of([width, height], &points);
        for ((normal, point), ray) in normals.iter().zip(&points).zip(&pixels.rays) {
            if ray[2] == 0.0 {
                prop_assert_eq!(*normal, Vec3::ZERO);
            } else {
                prop_assert!((normal.length() - 1.0).abs() < 1e-5, "{} at {}", normal, point);
                let ray = Vec3::new(ray[0], ray[1], 1.0);
                prop_assert!(normal.dot(ray) < 1e-5 * ray.length(), "{} at {}", normal, point);
            }
        }
        let sums = Windows::of(&pixels, 0..height);
        for half in [2, 8] {
            for (at, plane) in sums.planes(half, 0..height).planes.iter().enumerate() {
                let alone = plane_around(&pixels, half, [at % width, at / width]);
                // Where rounding decides, either may have no plane.
                if !plane.factors.is_finite() || !plane.error.is_finite() || !alone.error.is_finite() {
                    continue;
                }
                let off = (plane.factors - alone.factors).length();
                prop_assert!(off < 1e-3 * alone.factors.length() + 1e-6, "{:?} and {:?}", plane, alone);
            }
        }
    }
}
