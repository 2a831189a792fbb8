//! Pairs of many kinds, and one drawn by rays.

use super::*;
use crate::stereo::Matching;
use crate::stereo::OnProcessor;
use crate::stereo::View;
use crate::stereo::depths_of_pair;
use glam::DQuat;
use proptest::prelude::*;

fn camera(size: [u32; 2], focal: f64) -> Camera {
    let center = DVec2::new(f64::from(size[0]) * 0.52, f64::from(size[1]) * 0.47);
    Camera::new(size, DVec2::new(focal, 1.02 * focal), center, Distortion::None).unwrap()
}

/// A camera at `place` that looks to `target`, turned about its axis.
fn pose(place: DVec3, target: DVec3, turn: f64) -> DAffine3 {
    let z = (target - place).normalize();
    let x = DVec3::Y.cross(z).normalize();
    let upright = DMat3::from_cols(x, z.cross(x), z).transpose();
    let matrix3 = DMat3::from_rotation_z(turn) * upright;
    DAffine3 {
        matrix3,
        translation: -(matrix3 * place),
    }
}

fn triangulated(rectified: &Rectified, pixels: [DVec2; 2]) -> DVec3 {
    // The midpoint of the shortest line between two rays.
    let rays = [0, 1].map(|index| {
        let pose = rectified.camera_from_world()[index];
        let direction = pose.matrix3.transpose() * rectified.cameras()[index].ray(pixels[index]).unwrap();
        (center_of(pose), direction)
    });
    let [(p, a), (q, b)] = rays;
    let between = q - p;
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let along = (between.dot(a) * bb - between.dot(b) * ab) / (aa * bb - ab * ab);
    let other = (between.dot(a) * ab - between.dot(b) * aa) / (aa * bb - ab * ab);
    (p + along * a + q + other * b) / 2.0
}

proptest! {
    /// Side by side, one above the other, swapped, turned, far from the origin.
    #[test]
    fn partners_share_a_line_and_lead_back_to_their_place(
        angle in 0.0..std::f64::consts::TAU,
        distance in 0.05..0.8_f64,
        forward in -0.1..0.1_f64,
        turns in [-0.3..0.3_f64, -0.3..0.3_f64],
        orientation in 0.0..std::f64::consts::TAU,
        origin in prop_oneof![Just(0.0), Just(1000.0)],
        points in proptest::collection::vec([-0.5..0.5_f64, -0.4..0.4_f64, -0.5..0.5_f64], 20),
    ) {
        let cameras = [camera([640, 480], 500.0), camera([600, 500], 530.0)];
        let world = DAffine3::from_rotation_translation(
            DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), orientation),
            DVec3::new(origin, -origin, 2.0 * origin),
        );
        let step = DVec3::new(distance * angle.cos(), distance * angle.sin(), distance * forward);
        let poses = [
            pose(DVec3::ZERO, DVec3::Z * 3.0, turns[0]),
            pose(step, DVec3::Z * 3.0 + 0.3 * step, turns[1]),
        ]
        .map(|pose| pose * world.inverse());
        let rectified = Rectified::new([&cameras[0], &cameras[1]], poses).unwrap();
        let places = rectified.places();
        for point in points {
            let point = world.transform_point3(DVec3::from_array(point) + DVec3::Z * 3.0);
            let seen = [0, 1].map(|index| {
                let pose = rectified.camera_from_world()[index];
                rectified.cameras()[index].pixel(pose.transform_point3(point)).unwrap()
            });
            prop_assert!((seen[0].y - seen[1].y).abs() <= 1e-7, "{} and {}", seen[0], seen[1]);
            for index in 0..2 {
                let original = cameras[index].pixel(poses[index].transform_point3(point)).unwrap();
                let warped = through(&rectified.rectified_from_pixels()[index], original).unwrap();
                prop_assert!(warped.distance(seen[index]) <= 1e-7, "{warped} and {}", seen[index]);
            }
            let disparity = seen[0].x - seen[1].x;
            let found = places.point(seen[0], disparity).unwrap();
            let scale = point.length().max(1.0);
            let expected = triangulated(&rectified, seen);
            prop_assert!(found.distance(expected) <= 1e-9 * scale, "{found} and {expected}");
            prop_assert!(found.distance(point) <= 1e-8 * scale, "{found} and {point}");
        }
        // Farther points have smaller disparities, down to infinity's.
        let infinite = rectified.cameras()[0].principal_px().x - rectified.cameras()[1].principal_px().x;
        prop_assert_eq!(places.point(DVec2::new(100.0, 100.0), infinite - 0.5), None);
    }
}

/// A texture of places.
fn wall(point: DVec3) -> [u8; 3] {
    let wave = |a: f64, b: f64| (a * point.x + b * point.y).sin();
    let sum = wave(31.0, 17.0) + wave(-23.0, 41.0) + wave(47.0, -5.0) + wave(11.0, 53.0) + wave(67.0, 61.0);
    let level = (127.5 + 25.0 * sum) as u8;
    [level, level, 255 - level]
}

/// A camera's image of the plane n · x = 3.
fn posed_image(camera: &Camera, pose: DAffine3, normal: DVec3) -> ColorImage {
    let [width, height] = camera.size_px();
    let from = center_of(pose);
    let pixels = (0..height).flat_map(|v| (0..width).map(move |u| DVec2::new(f64::from(u), f64::from(v))));
    let color = |pixel| {
        let ray = pose.matrix3.transpose() * camera.ray(pixel).unwrap();
        wall(from + ray * ((3.0 - normal.dot(from)) / normal.dot(ray)))
    };
    ColorImage::new([width, height], pixels.map(color).collect()).unwrap()
}

#[test]
fn depths_of_a_wall_are_found_by_horizontal_and_vertical_pairs() {
    let cameras = [camera([240, 200], 260.0), camera([220, 210], 250.0)];
    let normal = DVec3::new(0.2, -0.1, 1.0);
    for (step, turn) in [
        (DVec3::new(0.25, 0.02, 0.0), 0.02),
        (DVec3::new(0.01, 0.25, 0.0), -0.03),
        (DVec3::new(-0.2, -0.1, 0.02), 0.3),
    ] {
        let poses = [pose(DVec3::ZERO, DVec3::Z * 3.0, 0.0), pose(step, DVec3::Z * 3.0, turn)];
        let posed_images = [0, 1].map(|index| posed_image(&cameras[index], poses[index], normal));
        let views = [0, 1].map(|index| View {
            image: &posed_images[index],
            camera: &cameras[index],
            camera_from_world: poses[index],
        });
        let depths = depths_of_pair(views, &OnProcessor, &Matching::default(), None).unwrap();
        let [width, height] = cameras[0].size_px();
        let mut errors = Vec::new();
        for (at, &depth) in depths.metres().iter().enumerate().filter(|(_, depth)| **depth > 0.0) {
            let pixel = DVec2::new((at % width as usize) as f64, (at / width as usize) as f64);
            let ray = cameras[0].ray(pixel).unwrap();
            let truth = 3.0 / normal.dot(poses[0].matrix3.transpose() * ray);
            errors.push((f64::from(depth) / truth - 1.0).abs());
        }
        errors.sort_by(f64::total_cmp);
        let count = errors.len();
        assert!(
            count * 100 >= 70 * (width * height) as usize,
            "{count} of {width} × {height}, {step}"
        );
        // Here, a tenth of a pixel is 3 ‰ of the depth.
        let (median, max) = (errors[count / 2], errors[count * 95 / 100]);
        assert!(median <= 2e-3 && max <= 8e-3, "{median} {max} of {step}");
    }
}

#[test]
fn reasons_against_rectification_are_distinguished() {
    let pinhole = camera([64, 48], 60.0);
    let lens = Distortion::Brown {
        k: [0.1, 0.0, 0.0],
        p: [0.0; 2],
    };
    let curved = Camera::new([64, 48], DVec2::splat(60.0), DVec2::new(32.0, 24.0), lens).unwrap();
    let here = pose(DVec3::ZERO, DVec3::Z, 0.0);
    let neighbor = pose(DVec3::X, DVec3::new(1.0, 0.0, 5.0), 0.0);
    let of = |cameras, poses| Rectified::new(cameras, poses).unwrap_err();
    let pinholes = [&pinhole, &pinhole];
    assert_eq!(
        of([&pinhole, &curved], [here, neighbor]),
        StereoError::NoPinhole { view: 1 }
    );
    let scaled = DAffine3::from_scale(DVec3::splat(2.0)) * here;
    assert_eq!(of(pinholes, [scaled, neighbor]), StereoError::NoPose { view: 0 });
    let nowhere = DAffine3::from_translation(DVec3::NAN);
    assert_eq!(of(pinholes, [here, nowhere]), StereoError::NoPose { view: 1 });
    assert_eq!(of(pinholes, [here, here]), StereoError::NoBaseline);
    let ahead = pose(DVec3::Z, DVec3::Z * 2.0, 0.0);
    assert!(matches!(of(pinholes, [here, ahead]), StereoError::NotSideBySide(_)));
    let away = pose(DVec3::X, DVec3::new(1.0, 0.0, -5.0), 0.0);
    assert!(matches!(of(pinholes, [here, away]), StereoError::NotSideBySide(_)));
    let rectified = Rectified::new(pinholes, [here, neighbor]).unwrap();
    let small = ColorImage::new([2, 2], vec![[0; 3]; 4]).unwrap();
    let error = rectified.image(1, &small).unwrap_err();
    assert!(error.to_string().contains("2 × 2"), "{error}");
}
