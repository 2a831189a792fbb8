//! A sphere with a texture, drawn by rays from several places.

use super::*;
use crate::cloud::Positions;
use crate::rgbd::{Camera, ColorImage, Distortion};
use crate::stereo::Consistency;
use crate::stereo::cloud;
use crate::stereo::consistent;
use glam::{DAffine3, DMat3, DVec2, DVec3};

const SIZE: [u32; 2] = [160, 140];

fn camera() -> Camera {
    Camera::new(SIZE, DVec2::splat(200.0), DVec2::new(81.5, 68.0), Distortion::None).unwrap()
}

/// Four away from the centre of the sphere, which has radius 1, and turned to it.
fn poses(count: usize) -> Vec<DAffine3> {
    let pose = |index: usize| {
        let angle = 0.12 * (index as f64 - (count as f64 - 1.0) / 2.0);
        let place = DVec3::new(4.0 * angle.sin(), 0.15 * (index % 2) as f64, -4.0 * angle.cos());
        let z = -place.normalize();
        let x = DVec3::Y.cross(z).normalize();
        let matrix3 = DMat3::from_cols(x, z.cross(x), z).transpose();
        DAffine3 {
            matrix3,
            translation: -(matrix3 * place),
        }
    };
    (0..count).map(pose).collect()
}

/// The depth of the sphere, and the colour: waves of the place on it, and one colour next to it.
fn trace(camera: &Camera, pose: DAffine3, pixel: DVec2) -> Option<(f64, [u8; 3])> {
    let world = pose.inverse();
    let from = world.translation;
    let ray = camera.ray(pixel).unwrap();
    let direction = world.matrix3 * ray;
    let (a, b, c) = (direction.dot(direction), from.dot(direction), from.dot(from) - 1.0);
    let root = b * b - a * c;
    if root < 0.0 {
        return None;
    }
    let along = (-b - root.sqrt()) / a;
    let at = from + direction * along;
    let wave = |a: f64, b: f64, c: f64| (a * at.x + b * at.y + c * at.z).sin();
    let sum = wave(29.0, 7.0, 13.0) + wave(-17.0, 31.0, 5.0) + wave(11.0, -37.0, 23.0) + wave(41.0, 19.0, -3.0);
    let level = (127.0 + 31.0 * sum) as u8;
    Some((along, [level, level, level / 2]))
}

fn posed_image(camera: &Camera, pose: DAffine3) -> ColorImage {
    let [width, height] = SIZE;
    let pixels = (0..width * height).map(|at| DVec2::new(f64::from(at % width), f64::from(at / width)));
    let color = |pixel| trace(camera, pose, pixel).map_or([60; 3], |(_, color)| color);
    ColorImage::new(SIZE, pixels.map(color).collect()).unwrap()
}

struct Scene {
    camera: Camera,
    poses: Vec<DAffine3>,
    posed_images: Vec<ColorImage>,
}

impl Scene {
    fn new(count: usize) -> Self {
        let camera = camera();
        let poses = poses(count);
        let posed_images = poses.iter().map(|&pose| posed_image(&camera, pose)).collect();
        Self {
            camera,
            poses,
            posed_images,
        }
    }

    fn views(&self) -> Vec<View<'_>> {
        let view = |(image, &camera_from_world)| View {
            image,
            camera: &self.camera,
            camera_from_world,
        };
        self.posed_images.iter().zip(&self.poses).map(view).collect()
    }
}

/// Depths of view `index` from all others.
fn depths_of(views: &[View<'_>], index: usize, sweep: &PlaneSweep) -> DepthImage {
    let others: Vec<View<'_>> = (0..views.len())
        .filter(|&other| other != index)
        .map(|other| views[other])
        .collect();
    sweep.depths(&views[index], &others).unwrap()
}

#[test]
fn sphere_depths_are_found_and_those_agreed_by_three_views_are_on_it() {
    let scene = Scene::new(5);
    let views = scene.views();
    let sweep = PlaneSweep::between(2.5, 5.0);
    let maps: Vec<DepthImage> = (0..5).map(|index| depths_of(&views, index, &sweep)).collect();

    let mut errors = Vec::new();
    let mut of_sphere = 0;
    for (at, &depth) in maps[2].metres().iter().enumerate() {
        let pixel = DVec2::new(f64::from(at as u32 % SIZE[0]), f64::from(at as u32 / SIZE[0]));
        if let Some((truth, _)) = trace(&scene.camera, scene.poses[2], pixel) {
            of_sphere += 1;
            if depth > 0.0 {
                errors.push((f64::from(depth) - truth).abs());
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let count = errors.len();
    assert!(count * 100 >= 70 * of_sphere, "{count} of {of_sphere}");
    // A tenth of a pixel in the adjacent views, in which positions on the front move by 10 px per unit of depth.
    assert!(errors[count / 2] <= 0.01, "{}", errors[count / 2]);

    let retained = consistent(&maps, &views, Consistency::default()).unwrap();
    let points = cloud(&retained, &views).unwrap();
    let Positions::F64(positions) = &points.positions else {
        panic!("places in the world are not rounded");
    };
    assert_eq!(points.attributes.colors.as_ref().unwrap().len(), positions.len());
    assert!(
        positions.len() * 100 >= 5 * 60 * of_sphere,
        "{} of {of_sphere} in each",
        positions.len()
    );
    let mut off: Vec<f64> = positions
        .iter()
        .map(|&at| (DVec3::from_array(at).length() - 1.0).abs())
        .collect();
    off.sort_by(f64::total_cmp);
    let of = |percent: usize| off[(off.len() - 1) * percent / 100];
    // The uniform colour next to the sphere seems as near as its edge to any window that contains both.
    assert!(
        of(50) <= 0.005 && of(90) <= 0.02 && of(99) <= 0.1,
        "{} {} {}",
        of(50),
        of(90),
        of(99)
    );
}

#[test]
fn two_views_are_enough_and_local_selection_finds_the_same() {
    let scene = Scene::new(2);
    let views = scene.views();
    let mut sweep = PlaneSweep::between(2.5, 5.0);
    for gathering in [sweep.gathering, Gathering::Local { radius_px: 3 }] {
        sweep.gathering = gathering;
        let depths = depths_of(&views, 0, &sweep);
        let center = depths.metres()[(SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize];
        assert!((center - 3.0).abs() < 0.02, "{center} by {gathering:?}");
    }
}

#[test]
fn any_number_of_threads_finds_the_same_depths() {
    let scene = Scene::new(3);
    let views = scene.views();
    let sweep = PlaneSweep::between(2.5, 5.0);
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| depths_of(&views, 1, &sweep))
    };
    assert_eq!(of(1), of(3));
}

#[test]
fn progress_reaches_its_end_and_a_cancelled_sweep_reports_it() {
    let scene = Scene::new(3);
    let views = scene.views();
    let sweep = PlaneSweep::between(2.5, 5.0);
    let progress = Progress::default();
    progress.set(0, PlaneSweep::STEPS);
    let observed = sweep.depths_observed(&views[0], &views[1..], &progress).unwrap();
    assert_eq!(progress.done(), PlaneSweep::STEPS);
    assert_eq!(observed, sweep.depths(&views[0], &views[1..]).unwrap());
    let stopped = Progress::told_to(|progress| {
        if progress.done() == 4 {
            progress.cancel();
        }
    });
    let result = sweep.depths_observed(&views[0], &views[1..], &stopped);
    assert_eq!(result, Err(StereoError::Cancelled));
    assert!(stopped.done() < PlaneSweep::STEPS, "{} steps", stopped.done());
}

/// Views that are turned about their axes, and one that is nearer.
#[test]
fn rotated_and_nearer_views_find_the_same_depths() {
    let mut scene = Scene::new(3);
    for (pose, (degrees, nearer)) in scene.poses.iter_mut().zip([(25.0_f64, 0.0), (0.0, 0.0), (-10.0, 0.4)]) {
        let turn = DAffine3::from_rotation_z(degrees.to_radians());
        *pose = turn * DAffine3::from_translation(DVec3::new(0.0, 0.0, -nearer)) * *pose;
    }
    scene.posed_images = scene
        .poses
        .iter()
        .map(|&pose| posed_image(&scene.camera, pose))
        .collect();
    let views = scene.views();
    let depths = depths_of(&views, 1, &PlaneSweep::between(2.5, 5.0));
    let mut errors = Vec::new();
    for (at, &depth) in depths.metres().iter().enumerate().filter(|(_, depth)| **depth > 0.0) {
        let pixel = DVec2::new(f64::from(at as u32 % SIZE[0]), f64::from(at as u32 / SIZE[0]));
        if let Some((truth, _)) = trace(&scene.camera, scene.poses[1], pixel) {
            errors.push((f64::from(depth) - truth).abs());
        }
    }
    errors.sort_by(f64::total_cmp);
    assert!(errors.len() > 3000, "{} pixels", errors.len());
    assert!(errors[errors.len() / 2] <= 0.02, "{}", errors[errors.len() / 2]);
}

#[test]
fn untextured_areas_have_no_depth() {
    let scene = Scene::new(3);
    let even = ColorImage::new(SIZE, vec![[9; 3]; (SIZE[0] * SIZE[1]) as usize]).unwrap();
    let mut views = scene.views();
    for view in &mut views {
        view.image = &even;
    }
    assert_eq!(depths_of(&views, 0, &PlaneSweep::between(2.5, 5.0)).valid_count(), 0);
}

#[test]
fn invalid_views_and_depths_are_reported() {
    let scene = Scene::new(3);
    let views = scene.views();
    let sweep = PlaneSweep::between(2.5, 5.0);
    assert_eq!(sweep.depths(&views[0], &[]), Err(StereoError::TooFewViews(1)));
    let small = ColorImage::new([3, 2], vec![[0; 3]; 6]).unwrap();
    let wrong = View {
        image: &small,
        ..views[1]
    };
    let error = sweep.depths(&views[0], &[views[1], wrong]).unwrap_err();
    assert!(matches!(error, StereoError::OtherCamera { view: 2, .. }), "{error}");
    for (near, far, planes) in [
        (0.0, 1.0, 64),
        (2.0, 1.0, 64),
        (1.0, f64::NAN, 64),
        (1.0, 2.0, 1),
        (1.0, 2.0, 1 << 40),
    ] {
        let planes = Some(planes);
        let sweep = PlaneSweep {
            near,
            far,
            planes,
            ..sweep.clone()
        };
        assert!(
            matches!(sweep.depths(&views[0], &views[1..]), Err(StereoError::NoDepths { .. })),
            "{near} {far}"
        );
    }
    let maps = vec![DepthImage::new(SIZE, vec![3.0; (SIZE[0] * SIZE[1]) as usize]).unwrap(); 2];
    let default = Consistency::default();
    assert_eq!(
        consistent(&maps, &views, default),
        Err(StereoError::CountsDiffer { maps: 2, views: 3 })
    );
    assert_eq!(
        cloud(&maps, &views).unwrap_err(),
        StereoError::CountsDiffer { maps: 2, views: 3 }
    );
}
