//! Relighting of input images, by normals of their depths.

use super::*;
use pointreel::cloud::{Attributes, Frame, Positions, RawCloud};
use pointreel::rgbd::DepthImage;
use pointreel::scene::{LightRig, Lighting, PhotoRelight};
use pointreel::sequence::{ColorSource, PrepareCounters, prepare};

const RADIUS: f64 = 1.0;

/// A white ball. Its normals are tilted by up to so much of their length along each axis.
fn ball(tilt: f32) -> PreparedFrame {
    let count = 6_000;
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let directions = (0..count).map(|at| {
        let z = 1.0 - (2.0 * f64::from(at) + 1.0) / f64::from(count);
        let (sin, cos) = (golden * f64::from(at)).sin_cos();
        let aside = (1.0 - z * z).sqrt();
        DVec3::new(aside * cos, aside * sin, z)
    });
    let directions: Vec<DVec3> = directions.collect();
    let tilted = |(at, direction): (usize, &DVec3)| {
        let noise = |times: usize| (at * times % 101) as f32 / 50.0 - 1.0;
        let noise = Vec3::new(noise(37), noise(53), noise(71));
        (direction.as_vec3() + tilt * noise).normalize().to_array()
    };
    let raw = RawCloud {
        attributes: Attributes {
            colors: Some(vec![[255; 4]; directions.len()]),
            normals: Some(directions.iter().enumerate().map(tilted).collect()),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F64(
            directions
                .iter()
                .map(|direction| (RADIUS * direction).to_array())
                .collect(),
        ))
    };
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    // A single colour carries no information, and would not be shown automatically.
    let needs = Scene::needs(&style().with(|style| style.colors = ColorSource::File.into()));
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

/// Images of the ball in one colour, with its depths.
fn textured_ball(color: [u8; 3]) -> Arc<PosedImages> {
    let [red, green, blue] = color;
    let pinhole = pinhole(256);
    let depth = |camera_from_world: &DAffine3| {
        let world_from_camera = camera_from_world.inverse();
        let along = |at: u32| {
            let ray = pinhole
                .ray(glam::DVec2::new(f64::from(at % 256), f64::from(at / 256)))
                .unwrap();
            let (origin, way) = (world_from_camera.translation, world_from_camera.matrix3 * ray);
            let (a, b) = (way.length_squared(), -origin.dot(way));
            let below = b * b - a * (origin.length_squared() - RADIUS * RADIUS);
            // Rays have a depth of 1.
            if below < 0.0 {
                0.0
            } else {
                ((b - below.sqrt()) / a) as f32
            }
        };
        DepthImage::new([256; 2], (0..256 * 256).map(along).collect())
    };
    let posed_image = |(number, camera_from_world): (usize, DAffine3)| PosedImage {
        name: String::new(),
        number,
        pinhole: pinhole.clone(),
        texture: Texture::new(PhotoImage::new([256; 2], vec![[red, green, blue, 255]; 256 * 256]).unwrap()),
        depth: depth(&camera_from_world),
        camera_from_world,
        is_masked: false,
        gain: Vec3::ONE,
    };
    let all = poses().into_iter().enumerate().map(posed_image).collect();
    Arc::new(PosedImages::new(all, Some(0.5)))
}

fn lit(relight: PhotoRelight) -> Style {
    style().with(|style| {
        style.photos.relight = relight;
        style.light.lighting = Lighting::Lambert;
        style.light.rig = LightRig::Head;
    })
}

/// Mean difference of channels over the pixels that both show, and the fraction of these that differ by more than 8.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (f64, f64) {
    let shown = |pixel: &image::Rgba<u8>| pixel.0[..3] != [0; 3];
    let both = a.pixels().zip(b.pixels()).filter(|(a, b)| shown(a) && shown(b));
    let differences: Vec<u8> = both
        .flat_map(|(a, b)| [0, 1, 2].map(|channel| a[channel].abs_diff(b[channel])))
        .collect();
    assert!(differences.len() > 3 * 10_000);
    let count = differences.len() as f64;
    let sum: f64 = differences.iter().map(|&difference| f64::from(difference)).sum();
    let far = differences.iter().filter(|&&difference| difference > 8).count();
    (sum / count, far as f64 / count)
}

#[test]
fn a_relit_sphere_matches_its_geometry_even_where_its_points_are_wrong() {
    let rough = ball(0.2).with_photos(textured_ball([10, 20, 30]));
    for view in held_out() {
        let camera = camera_at(&view);
        let geometry = draw_on_cpu(&packet(&ball(0.0), &camera, &lit(PhotoRelight::Off)));
        let fresh = draw_on_cpu(&packet(&rough, &camera, &lit(PhotoRelight::DepthOnly)));
        keep(&geometry, "ball_geometry.png");
        keep(&fresh, "ball_anew.png");
        let (mean, far) = difference(&geometry, &fresh);
        assert!(mean < 1.5 && far < 0.02, "mean {mean}, {far} far");
        let own = draw_on_cpu(&packet(&ball(0.2), &camera, &lit(PhotoRelight::Off)));
        let (mean_of_points, _) = difference(&geometry, &own);
        assert!(
            mean_of_points > 2.0 * mean,
            "{mean_of_points} by points, {mean} by depths"
        );
    }
}

#[test]
fn relit_images_are_their_colors_times_the_light() {
    let camera = camera_at(&held_out()[2]);
    let frame = ball(0.0).with_photos(textured_ball([200, 100, 50]));
    let fresh = draw_on_cpu(&packet(&frame, &camera, &lit(PhotoRelight::Photos)));
    let center = fresh.get_pixel(EDGE_PX / 2, EDGE_PX / 2);
    // The headlight on surfaces facing the eye.
    for (channel, color) in [200, 100, 50].into_iter().enumerate() {
        assert!(center[channel].abs_diff(color) <= 3, "{center:?}");
    }
    let sides = fresh.pixels().filter(|pixel| pixel[0] > 0 && pixel[0] < 150).count();
    assert!(sides > 1_000, "{sides} pixels are darker");
}

/// Lighting of splats becomes lighting of the surface where images are relit, and else none.
#[test]
fn relighting_defaults_to_the_headlight() {
    let camera = camera_at(&held_out()[1]);
    let frame = ball(0.0).with_photos(textured_ball([180, 180, 180]));
    let drawn = |lighting: Lighting, relight: PhotoRelight| {
        let style = style().with(|style| {
            style.light.lighting = lighting;
            style.photos.relight = relight;
        });
        draw_on_cpu(&packet(&frame, &camera, &style))
    };
    let unlit = drawn(Lighting::Unlit, PhotoRelight::Off);
    assert_eq!(drawn(Lighting::PerFragment, PhotoRelight::Off), unlit);
    let fresh = drawn(Lighting::PerFragment, PhotoRelight::Photos);
    assert_eq!(fresh, drawn(Lighting::Lambert, PhotoRelight::Photos));
    assert!(difference(&fresh, &unlit).0 > 5.0);
}

#[test]
fn both_renderers_relight_images() {
    let of_ball = ball(0.1).with_photos(textured_ball([200, 100, 50]));
    let of_scene = FRAME.with_photos(Arc::clone(&PHOTOS));
    // Depth maps of the scene are rendered from its disks, with discontinuities between them.
    for (name, frame, relight) in [
        ("ball", &of_ball, PhotoRelight::Photos),
        ("ball", &of_ball, PhotoRelight::DepthOnly),
        ("scene", &of_scene, PhotoRelight::Photos),
    ] {
        let style = lit(relight);
        let camera = camera_at(&held_out()[1]);
        let packet = Scene::default().packet(frame, DVec3::ZERO, &camera, &style, [320, 240]);
        let [cpu, gpu] = [draw_on_cpu(&packet), draw(&packet)];
        keep(&cpu, &format!("{name}_{relight}_cpu.png"));
        keep(&gpu, &format!("{name}_{relight}_gpu.png"));
        let channels = cpu.as_raw().iter().zip(gpu.as_raw());
        let far = channels.filter(|(a, b)| a.abs_diff(**b) > 8).count();
        assert!(
            far * 100 <= cpu.as_raw().len(),
            "{name}, {relight}: {far} channels differ"
        );
    }
}
