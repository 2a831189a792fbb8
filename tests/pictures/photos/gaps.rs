//! Gaps in a surface of points, closed where input images show that something is there.

use super::*;
use pointreel::cloud::{Attributes, Frame, Positions, RawCloud};
use pointreel::rgbd::DepthImage;
use pointreel::scene::EyeDome;
use pointreel::sequence::{PrepareCounters, prepare};

/// Position of the wall.
const WALL_Z: f64 = 0.5;

/// Half an edge of the hole in its points.
const HOLE: f64 = 0.12;

/// Bluish points of a wall that are missing at its centre.
fn holed_wall() -> PreparedFrame {
    wall_without(|along| along.iter().all(|along| along.abs() <= HOLE))
}

/// Bluish points of a wall, but for those that are missing.
fn wall_without(is_missing: impl Fn([f64; 2]) -> bool) -> PreparedFrame {
    let (places, colors) = wall(WALL_Z as f32, 1.0, [0, 60, 200, 255]);
    let is_there = |place: &[f32; 3]| !is_missing([place[0], place[1]].map(f64::from));
    let (places, colors): (Vec<_>, Vec<_>) = places
        .into_iter()
        .zip(colors)
        .filter(|(place, _)| is_there(place))
        .unzip();
    let raw = RawCloud {
        attributes: Attributes {
            normals: Some(vec![[0.0, 0.0, 1.0]; places.len()]),
            colors: Some(colors),
            // Larger ones would cover the hole.
            radii: Some(vec![0.04; places.len()]),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F32(places))
    };
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    prepare(
        0,
        Arc::new(frame),
        0.0,
        &Scene::needs(&style()),
        &PrepareCounters::default(),
    )
}

/// Two images in which the wall is red; measured depths see through a hole that is twice as wide as this.
fn red_wall(seen_through: Option<f64>) -> PosedImages {
    let posed_image = |number: usize, azimuth_deg: f64| {
        let (pinhole, camera_from_world) = (pinhole(512), pose(azimuth_deg, 0.0));
        let world_from_camera = camera_from_world.inverse();
        let distances = (0..512 * 512).map(|at| {
            let pixel = glam::DVec2::new(f64::from(at % 512), f64::from(at / 512));
            let ray = world_from_camera.matrix3 * pinhole.ray(pixel).unwrap();
            let place = world_from_camera.translation + ray * ((WALL_Z - world_from_camera.translation.z) / ray.z);
            let is_hole = seen_through.is_some_and(|half| place.truncate().abs().max_element() < half);
            camera_from_world.transform_point3(place).z as f32 * if is_hole { 3.0 } else { 1.0 }
        });
        PosedImage {
            name: String::new(),
            number,
            texture: Texture::new(PhotoImage::new([512; 2], vec![[200, 0, 0, 255]; 512 * 512]).unwrap()),
            depth: seen_through.map(|_| DepthImage::new([512; 2], distances.collect()).unwrap()),
            pinhole: pinhole.clone(),
            camera_from_world,
            is_masked: false,
            gain: Vec3::ONE,
        }
    };
    PosedImages::new(vec![posed_image(0, -10.0), posed_image(1, 10.0)], Some(0.35))
}

fn gaps(percent: f32) -> Style {
    style().with(|style| style.photos.gaps = percent)
}

/// Of the pixels around the centre, which contain the hole: the red ones, and the empty ones.
fn red_and_empty(picture: &RgbaImage) -> (usize, usize) {
    let center = EDGE_PX / 2 - 25..EDGE_PX / 2 + 25;
    let (mut red, mut empty) = (0, 0);
    for (x, y) in center.clone().flat_map(|y| center.clone().map(move |x| (x, y))) {
        let [r, g, b, _] = picture.get_pixel(x, y).0;
        red += usize::from(r > 190 && g < 10 && b < 10);
        empty += usize::from([r, g, b] == [0; 3]);
    }
    (red, empty)
}

#[test]
fn gaps_are_closed_where_images_show_something() {
    let frame = holed_wall();
    let camera = camera_at(&pose(4.0, 3.0));
    let drawn = |posed_images: PosedImages, percent: f32| {
        let frame = frame.with_photos(Arc::new(posed_images));
        let packet = packet(&frame, &camera, &gaps(percent));
        let [cpu, gpu] = [draw_on_cpu(&packet), draw(&packet)];
        keep(&cpu, &format!("gaps_{percent}_cpu.png"));
        keep(&gpu, &format!("gaps_{percent}_gpu.png"));
        let apart = cpu
            .as_raw()
            .iter()
            .zip(gpu.as_raw())
            .filter(|(a, b)| a.abs_diff(**b) > 8);
        assert!(apart.count() * 200 <= cpu.as_raw().len());
        cpu
    };
    let (_, open) = red_and_empty(&drawn(red_wall(None), 0.0));
    assert!(open > 50, "there is a hole: {open}");
    assert_eq!(red_and_empty(&drawn(red_wall(None), 10.0)), (2500, 0));
    // It is wider than that, except at its corners.
    let (_, narrowly) = red_and_empty(&drawn(red_wall(None), 4.0));
    assert!(narrowly > open * 9 / 10, "{narrowly} of {open}");
    // A handle is still a handle.
    let (_, seen_through) = red_and_empty(&drawn(red_wall(Some(HOLE)), 10.0));
    assert!(seen_through > open / 2, "{seen_through} of {open}");
}

/// Along itself it is open to both borders of the image.
#[test]
fn slits_are_closed_along_their_whole_length() {
    for axis in [0, 1] {
        let frame = wall_without(|along| along[axis].abs() < 0.06);
        let frame = frame.with_photos(Arc::new(red_wall(None)));
        let drawn = |percent: f32| {
            let packet = packet(&frame, &camera_at(&pose(4.0, 3.0)), &gaps(percent));
            [draw_on_cpu(&packet), draw(&packet)].map(|picture| red_and_empty(&picture))
        };
        for (open, narrow) in drawn(0.0).into_iter().zip(drawn(3.0)) {
            assert!(open.1 > 100, "there is a slit: {}", open.1);
            // The limit is more than half of its width, but not between the edges of two disks.
            assert!(narrow.1 * 10 > open.1 * 9, "axis {axis}: {} of {}", narrow.1, open.1);
        }
        assert_eq!(drawn(12.0), [(2500, 0); 2], "axis {axis}");
    }
}

/// Input images see through it, and only its surroundings determine a colour.
#[test]
fn specks_take_the_surrounding_color_and_larger_holes_stay() {
    let drawn = |half: f64, percent: f32| {
        let frame = wall_without(|_| false).with_photos(Arc::new(red_wall(Some(half))));
        let packet = packet(&frame, &camera_at(&pose(4.0, 3.0)), &gaps(percent));
        [draw_on_cpu(&packet), draw(&packet)].map(|picture| red_and_empty(&picture))
    };
    assert_eq!(drawn(0.003, 0.0), [(2499, 1); 2]);
    assert_eq!(drawn(0.003, 5.0), [(2500, 0); 2]);
    let larger = drawn(0.01, 0.0);
    assert!(larger[0].1 >= 4, "there is a hole: {larger:?}");
    // A tenth of the former is less than its width, and a tenth of the latter more.
    assert_eq!(drawn(0.01, 2.0), larger);
    assert_eq!(drawn(0.01, 15.0), [(2500, 0); 2]);
    // A handle is still a handle.
    let handle = drawn(0.03, 0.0);
    assert_eq!(drawn(0.03, 10.0), handle);
}

/// Light from depths falls before.
#[test]
fn gaps_are_closed_with_eye_dome_lighting() {
    let frame = holed_wall().with_photos(Arc::new(red_wall(None)));
    let lit = gaps(10.0).with(|style| style.light.eye_dome = EyeDome::On);
    let packet = packet(&frame, &camera_at(&pose(4.0, 3.0)), &lit);
    for picture in [draw_on_cpu(&packet), draw(&packet)] {
        assert_eq!(red_and_empty(&picture).1, 0);
    }
}

/// The outline of the wall is where it was.
#[test]
fn outlines_do_not_move() {
    let frame = holed_wall().with_photos(Arc::new(red_wall(None)));
    let packet_of = |percent| packet(&frame, &camera_at(&pose(4.0, 3.0)), &gaps(percent));
    let [open, closed] = [0.0, 10.0].map(|percent| draw_on_cpu(&packet_of(percent)));
    let center = EDGE_PX / 2 - 40..EDGE_PX / 2 + 40;
    let changed = open
        .enumerate_pixels()
        .zip(closed.pixels())
        .filter(|((x, y, open), closed)| {
            let is_in_hole = center.contains(x) && center.contains(y);
            !is_in_hole && open != closed && open.0[..3] == [0; 3]
        });
    assert_eq!(changed.count(), 0);
}

/// A large image is drawn in tiles.
#[test]
fn image_tiles_include_the_surroundings_they_need() {
    let frame = holed_wall().with_photos(Arc::new(red_wall(None)));
    let packet = packet(&frame, &camera_at(&pose(4.0, 3.0)), &gaps(4.0));
    // The reach of gaps, and of specks next to them.
    assert_eq!(pointreel::scene::halo_px(&packet), 20 + 2);
}
