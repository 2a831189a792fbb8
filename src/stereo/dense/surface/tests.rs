//! A textured wall around a square of one colour, seen by six images.

use super::*;
use crate::photos::{Photo, PhotoImage, SparsePoints, Texture};
use crate::rgbd::Distortion;
use glam::{DVec2, Vec2, Vec3};

const SIZE: [u32; 2] = [160, 120];
const WALL: f64 = 4.0;

/// Half of the edge of the square that shows nothing.
const PLAIN: f64 = 0.3;

fn camera() -> Camera {
    Camera::new(SIZE, DVec2::splat(150.0), DVec2::new(79.5, 59.5), Distortion::None).unwrap()
}

fn color(place: DVec2) -> u8 {
    if place.abs().max_element() < PLAIN {
        return 128;
    }
    let wave = |a: f64, b: f64| (a * place.x + b * place.y).sin();
    (128.0 + 30.0 * (wave(23.0, 7.0) + wave(-11.0, 29.0) + wave(37.0, -19.0) + wave(5.0, 41.0))) as u8
}

fn eye(number: usize) -> DVec3 {
    DVec3::new(0.3 * (number as f64 - 2.5), 0.1 * (number % 2) as f64, 0.0)
}

fn posed_image(number: usize) -> PosedImage {
    let pixels = (0..SIZE[0] * SIZE[1]).map(|at| {
        let pixel = DVec2::new(f64::from(at % SIZE[0]), f64::from(at / SIZE[0]));
        let level = color((eye(number) + WALL * camera().ray(pixel).unwrap()).truncate());
        [level, level, level / 2, u8::MAX]
    });
    PosedImage {
        name: String::new(),
        number,
        pinhole: camera(),
        camera_from_world: DAffine3::from_translation(-eye(number)),
        texture: Texture::new(PhotoImage::new(SIZE, pixels.collect()).unwrap()),
        is_masked: false,
        gain: Vec3::ONE,
        depth: None,
    }
}

/// Points on the wall, and one halfway to it whose tracks are of points on the wall.
fn set() -> ViewSet {
    let photo = |number: usize| Photo {
        name: number.to_string(),
        path: "seen.png".into(),
        camera: camera(),
        camera_from_world: DAffine3::from_translation(-eye(number)),
        mask: None,
        depth: None,
        depth_range: None,
    };
    let photos: Vec<Photo> = (0..6).map(photo).collect();
    let mut points = SparsePoints::default();
    let mut push = |position: DVec3, looks_at: DVec3| {
        let seen = photos.iter().enumerate().filter_map(|(number, photo)| {
            let pixel: Vec2 = photo.pixel(looks_at)?.as_vec2();
            Some(Observation {
                photo: number as u32,
                pixel,
            })
        });
        points.push(position, [128; 3], seen);
    };
    for at in 0..40 {
        let place = DVec3::new(0.2 * f64::from(at % 8) - 0.7, 0.25 * f64::from(at / 8) - 0.5, WALL);
        push(place, place);
    }
    push(DVec3::new(0.1, 0.0, 2.0), DVec3::new(0.2, 0.0, WALL));
    ViewSet {
        photos,
        points,
        ..ViewSet::default()
    }
}

fn posed_images() -> PosedImages {
    PosedImages::new((0..6).map(posed_image).collect(), Some(0.1))
}

#[test]
fn a_wall_untextured_in_its_center_is_complete_and_flat() {
    let origin = DVec3::new(0.0, 0.0, 3.0);
    let surface = photo_surface(&set(), &posed_images(), origin, &Progress::default()).unwrap();
    assert_eq!(surface.points.len(), surface.shapes.len());
    let places: Vec<Vec3> = surface.points.iter().map(|point| point.position.into()).collect();
    let off = places.iter().filter(|place| (place.z - 1.0).abs() > 0.08).count();
    assert!(off * 50 < places.len(), "{off} of {}", places.len());
    // Each square of 0.1 within the part that most images show has a disk: in the uniform square as well.
    for cell in 0..16 * 12 {
        let center = DVec2::new(0.1 * f64::from(cell % 16) - 0.75, 0.1 * f64::from(cell / 16) - 0.55).as_vec2();
        let is_here = |place: &&Vec3| (place.truncate() - center).abs().max_element() < 0.06;
        assert!(places.iter().any(|place| is_here(&place)), "{center}");
    }
    // Pixels are 0.027 wide there, and each position occurs about once.
    assert!(surface.shapes.iter().all(|shape| shape.radius < 0.1));
    assert!(places.len() < 3 * 160 * 120, "{}", places.len());
}

#[test]
fn images_with_depths_and_small_sets_get_no_separate_surface() {
    let surface = |posed_images: &PosedImages, set: &ViewSet| {
        photo_surface(set, posed_images, DVec3::ZERO, &Progress::default()).is_some()
    };
    assert!(!surface(&posed_images().without(&[1, 2, 3, 4]), &set()));
    let mut with_depth = posed_image(0);
    with_depth.depth = DepthImage::new([1, 1], vec![WALL as f32]);
    let all = std::iter::once(with_depth).chain((1..6).map(posed_image)).collect();
    assert!(!surface(&PosedImages::new(all, Some(0.1)), &set()));
    let has_cloud = ViewSet {
        points: SparsePoints::default(),
        points_file: Some("cloud.ply".into()),
        ..set()
    };
    assert!(!surface(&posed_images(), &has_cloud));
}

#[test]
fn points_are_valid_where_three_images_see_them() {
    let set = set();
    let last = set.points.len() - 1;
    let is_sound = |point: usize, track: &[Observation]| is_sound(&set, set.points.positions()[point], track);
    let track = set.points.track(20);
    assert!(is_sound(20, track));
    assert!(!is_sound(20, &track[..2]));
    assert!(!is_sound(last, set.points.track(last)));
    let mut same = track[..3].to_vec();
    same.fill(track[0]);
    assert!(!is_sound(20, &same));
}

#[test]
fn cancelling_returns_at_once() {
    let progress = Progress::default();
    progress.cancel();
    assert!(photo_surface(&set(), &posed_images(), DVec3::ZERO, &progress).is_none());
}
