//! The software renderer by itself: on other numbers of threads, with extreme records, against double precision, and
//! a closed sphere without holes.

use crate::common::{camera_at, draw_on_cpu, sphere, surfels};
use crate::cpu_renderer::{SIZE, surfel_scene};
use glam::{DVec3, Vec3};
use pointreel::cloud::{PointRecord, VoxelRecord};
use pointreel::measure::{DepthImage, mean_squared_error, psnr_db};
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::truth::{Disks, Truth, TruthView};
use pointreel::render::{RenderError, Renderer};
use pointreel::scene::{Background, Camera, Content, Primitive, Scene, ScenePacket, Splatting, Style, Voxels};
use pointreel::sequence::{Needs, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use proptest::prelude::*;
use std::sync::{Arc, LazyLock};

#[test]
fn images_do_not_depend_on_thread_count() {
    let packet = surfel_scene(Style::default(), 1.9);
    let expected = draw_on_cpu(&packet);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(|| draw_on_cpu(&packet)) == expected);
    }
}

#[test]
fn rendering_needs_preparation_and_happens_once_per_packet() {
    let mut renderer = CpuRenderer::new();
    assert!(matches!(renderer.render(), Err(RenderError::NothingPrepared)));
    assert!(matches!(renderer.read_image(), Err(RenderError::NothingPrepared)));
    let packet = surfel_scene(Style::default(), 1.9);
    for _ in 0..2 {
        renderer.prepare(&packet).unwrap();
        renderer.render().unwrap();
    }
    assert_eq!(renderer.stats().frames, 1);
    let mut huge = packet.clone();
    huge.viewport_px = [40_000, 10];
    assert!(matches!(renderer.prepare(&huge), Err(RenderError::TooLarge { .. })));
}

/// Numbers of all sizes and no size: an image or nothing, and never a panic.
#[test]
fn extreme_records_are_handled() {
    let extremes = [0.0, 1e-45, -1e-38, 1e-20, 1.0, 1e30, -3e38, f32::MAX];
    let mut scene = sphere(600, 1.0);
    for (index, surfel) in scene.iter_mut().enumerate() {
        let pick = |factor: usize| extremes[index * factor % extremes.len()];
        if index % 3 == 0 {
            surfel.position = Vec3::new(pick(1), pick(3), pick(5));
        }
        surfel.radius = pick(7);
    }
    for size in [[1, 1], [64, 48], [16_384, 3]] {
        for &primitive in &[Primitive::Point, Primitive::Surfel] {
            for &splatting in Splatting::ALL {
                for distance in [1e-30, 1.5, 1e20] {
                    let style = Style::default().with(|style| {
                        style.primitive = primitive;
                        style.surfels.splatting = splatting;
                    });
                    let packet = surfels(&scene, &camera_at(distance), style, size);
                    assert_eq!(draw_on_cpu(&packet).dimensions(), (size[0], size[1]));
                }
            }
        }
    }
}

/// Points of a unit sphere with the radii that the program estimates.
fn sampled_sphere() -> PreparedFrame {
    let frame = Sequence::of(Shape::Sphere.frame(3_000)).frame(0).unwrap();
    let needs = Needs {
        shapes: true,
        ..Needs::default()
    };
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

fn packet_of(frame: &PreparedFrame, camera: &Camera, style: &Style, size_px: [u32; 2]) -> ScenePacket {
    Scene::default().packet(frame, DVec3::ZERO, camera, style, size_px)
}

fn draw_depths(packet: &ScenePacket) -> DepthImage {
    let mut renderer = CpuRenderer::new();
    renderer.prepare(packet).unwrap();
    renderer.draw_depths().unwrap()
}

#[test]
fn depths_and_colors_match_the_double_precision_reference() {
    let frame = sampled_sphere();
    let camera = Camera {
        azimuth_deg: 20.0,
        elevation_deg: -35.0,
        ..camera_at(2.5)
    };
    let style = Style::default().with(|style| {
        style.surfels.splatting = Splatting::TwoPass;
        style.backdrop.background = Background::solid([119; 3]);
    });
    let packet = packet_of(&frame, &camera, &style, SIZE);
    let disks = Disks {
        points: &frame.points,
        shapes: frame.shapes.as_ref().unwrap(),
        are_ellipses: false,
        cull_back_faces: true,
    };
    let view = TruthView::new(
        &camera,
        DVec3::ZERO,
        SIZE,
        style.light.lighting,
        style.backdrop.background,
    );
    let truth = Truth::of_disks(&disks, &view);
    let depths = draw_depths(&packet);
    // Where the edge of a disk passes through a pixel centre, rounding decides. Elsewhere a thousandth of a splat is
    // the precision of f32 for planes seen nearly edge-on, on which pixels are far apart.
    let differing = depths
        .depth
        .iter()
        .zip(&truth.depth.depth)
        .zip(&truth.tolerance)
        .filter(|&((&found, &expected), &diameter)| {
            let is_nothing = found.is_infinite() && expected.is_infinite();
            let is_same = is_nothing || (found - expected).abs() <= 1e-3 * diameter;
            !is_same
        })
        .count();
    assert!(differing <= 20, "{differing} pixels of another disk");
    // One sample at the centre instead of 64, and 16-bit weights instead of f64.
    let psnr = psnr_db(mean_squared_error(&truth.image, &draw_on_cpu(&packet)).unwrap());
    assert!(psnr > 40.0, "{psnr} dB");
}

#[test]
fn depths_of_points_and_voxels_match_their_distances() {
    let camera = camera_at(3.0);
    let mut packet = surfel_scene(
        Style {
            primitive: Primitive::Voxel,
            ..Style::default()
        },
        3.0,
    );
    packet.content = Content::Voxels(Voxels {
        records: Arc::new(vec![VoxelRecord {
            center: [0.0; 3],
            color: [9; 3],
            level: 1,
        }]),
        normals: None,
        cube_edge: 2.0,
    });
    let midpoint = (SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize;
    // Along an axis, a cell of edge 1 around the origin is hit half a unit in front of it.
    packet.view = Camera {
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        ..camera
    }
    .transform(DVec3::ZERO, SIZE);
    let depths = draw_depths(&packet);
    assert!(
        (depths.depth[midpoint] - 2.5).abs() < 1e-5,
        "{}",
        depths.depth[midpoint]
    );
    assert_eq!(depths.depth[0], f32::INFINITY);
    packet.style.primitive = Primitive::Point;
    packet.style.points.size_px = 3.0;
    packet.content = Content::Points(Arc::new(vec![PointRecord {
        position: [0.0; 3],
        color: [9; 4],
    }]));
    let depths = draw_depths(&packet);
    assert!(
        (depths.depth[midpoint] - 3.0).abs() < 1e-5,
        "{}",
        depths.depth[midpoint]
    );
    let shown = depths.depth.iter().filter(|depth| depth.is_finite()).count();
    assert_eq!(shown, 9);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// From anywhere: the pixels within the outline do not depend on the background. Two-pass-enlarged lets none of
    /// it through: wherever a disk of the first pass is seen, its own enlarged splat alone is opaque, and so are those
    /// around a hole. The first pass alone has holes where rays graze disks that are just large enough to close
    /// the surface. (Enlarging both passes closes less than the second alone: the edge of a splat hides the splat that
    /// would fill it.)
    #[test]
    fn no_background_shines_through_a_closed_sphere(
        azimuth_deg in -180.0f64..180.0,
        elevation_deg in -90.0f64..90.0,
        distance in 1.15f64..8.0,
    ) {
        static SPHERE: LazyLock<PreparedFrame> = LazyLock::new(sampled_sphere);
        let camera = Camera { azimuth_deg, elevation_deg, ..camera_at(distance) };
        let size_px = [240, 200];
        let focal = 1.0 / (0.5 * camera.fov_deg).to_radians().tan();
        // The outline of the sphere, minus the part that disks near its silhouette may miss.
        let outline_px = 0.5 * f64::from(size_px[1]) * focal / (distance * distance - 1.0).sqrt();
        let within_px = 0.97 * outline_px - 1.0;
        // From afar the sphere has fewer than a thousand pixels: then one of them may be a hole.
        let modes = [(Splatting::TwoPassEnlarged, None), (Splatting::Visibility, Some(1000))];
        for (splatting, pixels_per_hole) in modes {
            let draw = |background: [u8; 3]| {
                let style = Style::default().with(|style| {
style.surfels.splatting = splatting;
style.backdrop.background = Background::solid(background);
});
                draw_on_cpu(&packet_of(&SPHERE, &camera, &style, size_px))
            };
            let (on_black, on_white) = (draw([0; 3]), draw([255; 3]));
            let within = on_black.enumerate_pixels().filter(|(x, y, _)| {
                let from_center = (f64::from(*x) - 119.5).hypot(f64::from(*y) - 99.5);
                from_center <= within_px
            });
            let is_open: Vec<bool> = within.map(|(x, y, pixel)| pixel != on_white.get_pixel(x, y)).collect();
            let open = is_open.iter().filter(|&&open| open).count();
            let max_open = pixels_per_hole.map_or(0, |pixels: usize| is_open.len().div_ceil(pixels));
            prop_assert!(open <= max_open, "{open} of {} pixels, {splatting}", is_open.len());
        }
    }
}
