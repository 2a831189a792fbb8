//! Antialiasing: edges against the area that they cover, flat areas, and both renderers against each other.

use crate::common::{camera_at, draw, draw_on_cpu, plain, sphere, surfels, voxels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::VoxelRecord;
use pointreel::math::Aabb;
use pointreel::measure::{flip, mean_squared_error, psnr_db};
use pointreel::render::truth::{Disks, Truth, TruthView};
use pointreel::scene::{
    Antialiasing, Background, Camera, Content, GroundPlane, Lighting, Primitive, ScenePacket, Splatting, Style, UpAxis,
};

const SIZE: [u32; 2] = [160, 120];

fn draw_on_both(packet: &ScenePacket) -> [(RgbaImage, &'static str); 2] {
    [(draw_on_cpu(packet), "processor"), (draw(packet), "GPU")]
}

fn with(packet: &ScenePacket, antialiasing: Antialiasing) -> ScenePacket {
    let mut packet = packet.clone();
    packet.style.drawing.antialiasing = antialiasing;
    packet
}

/// From where edges of a cube are seen at many slopes.
fn camera() -> Camera {
    Camera {
        azimuth_deg: 27.0,
        elevation_deg: 17.0,
        fov_deg: 50.0,
        ..camera_at(3.0)
    }
}

/// One white cube of edge 1 around the origin, on black.
fn cube() -> ScenePacket {
    let style = plain().with(|style| style.primitive = Primitive::Voxel);
    let record = VoxelRecord {
        center: [0.0; 3],
        color: [255; 3],
        level: 0,
    };
    voxels(vec![record], 1.0, &camera(), style, SIZE)
}

/// Returns true if a ray meets the cube.
fn meets_cube(eye: DVec3, ray: DVec3) -> bool {
    let [low, high] = [-0.5, 0.5].map(|side| (DVec3::splat(side) - eye) / ray);
    low.min(high).max_element() < low.max(high).min_element()
}

/// The area of each pixel that the cube covers, by 16×16 rays.
fn covered_by_cube(packet: &ScenePacket) -> Vec<f64> {
    const RAYS: u32 = 16;
    let view = &packet.view;
    let eye = view.eye_high.as_dvec3() + view.eye_low.as_dvec3();
    let to_frame = view.view_from_frame_rotation.as_dmat3().transpose();
    let [width, height] = SIZE;
    let ndc = |px: u32, sample: u32, edge: u32| {
        2.0 * (f64::from(px) + (f64::from(sample) + 0.5) / f64::from(RAYS)) / f64::from(edge) - 1.0
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let share = |[x, y]: [u32; 2]| {
        let samples = (0..RAYS * RAYS).filter(|sample| {
            let right = ndc(x, sample % RAYS, width) / f64::from(view.focal[0]);
            let up = -ndc(y, sample / RAYS, height) / f64::from(view.focal[1]);
            meets_cube(eye, to_frame * DVec3::new(right, up, -1.0))
        });
        samples.count() as f64 / f64::from(RAYS * RAYS)
    };
    pixels.map(share).collect()
}

/// Mean and largest error of the pixels that the outline of the cube crosses.
fn errors_of_outline(picture: &RgbaImage, covered: &[f64]) -> (f64, f64) {
    let edges = picture
        .pixels()
        .zip(covered)
        .filter(|&(_, &share)| 0.0 < share && share < 1.0);
    let errors: Vec<f64> = edges
        .map(|(pixel, share)| (f64::from(pixel.0[0]) / 255.0 - share).abs())
        .collect();
    assert!(errors.len() > 150, "{}", errors.len());
    (
        errors.iter().sum::<f64>() / errors.len() as f64,
        errors.iter().copied().fold(0.0, f64::max),
    )
}

/// A pixel without antialiasing is off by a quarter in the mean. Four samples leave steps of a quarter; FXAA has no
/// samples, but its lines are straight, as the outline is.
#[test]
fn slanted_edges_cover_pixels_by_their_area() {
    let packet = cube();
    let covered = covered_by_cube(&packet);
    for (antialiasing, max_mean) in [(Antialiasing::Fxaa, 0.07), (Antialiasing::Supersample, 0.1)] {
        for (picture, by) in draw_on_both(&with(&packet, antialiasing)) {
            let (mean, max) = errors_of_outline(&picture, &covered);
            assert!(mean < max_mean, "{antialiasing}, {by}: {mean}");
            if antialiasing == Antialiasing::Supersample {
                assert!(max < 0.35, "{by}: {max}");
            }
        }
    }
    for (picture, by) in draw_on_both(&packet) {
        let (mean, _) = errors_of_outline(&picture, &covered);
        assert!(mean > 0.2, "{by}: {mean}");
    }
}

/// Pixels around which all are of one colour, two pixels wide.
fn flat(picture: &RgbaImage) -> Vec<[u32; 2]> {
    let [width, height] = [picture.width(), picture.height()];
    let places = (2..height - 2).flat_map(|y| (2..width - 2).map(move |x| [x, y]));
    let is_flat = |&[x, y]: &[u32; 2]| {
        let own = picture.get_pixel(x, y);
        (y - 2..=y + 2).all(|y| (x - 2..=x + 2).all(|x| picture.get_pixel(x, y) == own))
    };
    places.filter(is_flat).collect()
}

#[test]
fn flat_areas_are_unchanged() {
    let mut packet = cube();
    packet.style.backdrop.background = Background::solid([30, 61, 97]);
    for antialiasing in [Antialiasing::Fxaa, Antialiasing::Supersample] {
        let smoothed = draw_on_both(&with(&packet, antialiasing));
        for ((plain, by), (smooth, _)) in draw_on_both(&packet).into_iter().zip(smoothed) {
            let places = flat(&plain);
            assert!(places.len() > 10_000, "{}", places.len());
            for [x, y] in places {
                let [before, after] = [&plain, &smooth].map(|picture| picture.get_pixel(x, y).0);
                assert_eq!(before, after, "{antialiasing}, {by}, {x} {y}");
            }
            assert!(plain != smooth, "{antialiasing}, {by}");
        }
    }
}

fn sphere_in(style: Style, count: u32) -> ScenePacket {
    surfels(&sphere(count, 1.0), &camera(), style, SIZE)
}

/// Where renderers differ without antialiasing, they may differ with it; FXAA finds another edge where a pixel is
/// another one.
#[test]
fn both_renderers_smooth_every_primitive_alike() {
    let of_points = plain().with(|style| {
        style.primitive = Primitive::Point;
        style.points.size_px = 3.0;
    });
    let opaque = plain().with(|style| style.surfels.splatting = Splatting::Opaque);
    let lit = plain().with(|style| style.light.lighting = Lighting::BlinnPhong);
    for antialiasing in [Antialiasing::Fxaa, Antialiasing::Supersample] {
        let surfaces = [plain(), opaque, lit].map(|style| (sphere_in(style, 2000), 48.0));
        for (packet, min_db) in surfaces
            .into_iter()
            .chain([(sphere_in(of_points, 2000), 35.0), (cube(), 48.0)])
        {
            let packet = with(&packet, antialiasing);
            let [(cpu, _), (gpu, _)] = draw_on_both(&packet);
            let db = psnr_db(mean_squared_error(&cpu, &gpu).unwrap());
            let primitive = packet.style.primitive;
            assert!(db >= min_db, "{antialiasing}, {primitive}: {db:.1} dB");
        }
    }
}

#[test]
fn points_and_grid_lines_keep_their_size() {
    let style = plain().with(|style| {
        style.primitive = Primitive::Point;
        style.points.size_px = 5.0;
    });
    let mut packet = sphere_in(style, 400);
    let unit = Aabb::from_points(&[-Vec3::ONE, Vec3::ONE]);
    packet.ground = Some(GroundPlane::under(
        &unit,
        DVec3::ZERO,
        UpAxis::Y,
        Background::solid([0; 3]),
    ));
    let light = |picture: &RgbaImage| picture.pixels().map(|pixel| f64::from(pixel.0[1])).sum::<f64>();
    for (picture, by) in draw_on_both(&packet) {
        let supersampled = draw_on_both(&with(&packet, Antialiasing::Supersample));
        for (smooth, _) in supersampled {
            let ratio = light(&smooth) / light(&picture);
            assert!((ratio - 1.0).abs() < 0.03, "{by}: {ratio}");
        }
    }
}

/// FLIP against the ray-traced ground truth of the same disks; the figures of `benches/README.md`.
#[test]
fn antialiased_images_are_closer_to_the_ground_truth() {
    for splatting in [Splatting::TwoPass, Splatting::Opaque] {
        let style = plain().with(|style| style.surfels.splatting = splatting);
        let packet = sphere_in(style, 2000);
        let Content::Surfels(content) = &packet.content else {
            panic!("no surfels");
        };
        let disks = Disks {
            points: &content.points,
            shapes: &content.shapes,
            are_ellipses: false,
            cull_back_faces: true,
        };
        let background = style.backdrop.background;
        let view = TruthView::new(&camera(), DVec3::ZERO, SIZE, Lighting::Unlit, background);
        let truth = Truth::of_disks(&disks, &view).image;
        let error = |antialiasing| {
            let picture = draw_on_cpu(&with(&packet, antialiasing));
            flip(&truth, &picture).unwrap().mean()
        };
        let [none, fxaa, supersample] = [Antialiasing::None, Antialiasing::Fxaa, Antialiasing::Supersample].map(error);
        assert!(
            supersample < fxaa && fxaa < none,
            "{splatting}: {none} {fxaa} {supersample}"
        );
    }
}
