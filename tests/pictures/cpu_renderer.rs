//! The software renderer against the GPU's, and against itself on other numbers of threads.

use crate::common::{self, camera_at, draw, draw_on_cpu, sphere, surfels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{PointRecord, VoxelRecord};
use pointreel::measure::{DepthImage, mean_squared_error, psnr_db};
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::truth::{Disks, Truth, TruthView};
use pointreel::render::{RenderError, Renderer};
use pointreel::scene::{
    BackFaces, Backdrop, Background, Camera, Content, EyeDome, Kernel, LightRig, LightStyle, Lighting, OnOff,
    PointLight, PointShape, PointSizing, PointStyle, Primitive, Scene, ScenePacket, SplatFilter, SplatGeometry,
    Splatting, Style, SurfelStyle, Voxels,
};
use pointreel::sequence::{Needs, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use proptest::prelude::*;
use std::sync::{Arc, LazyLock};

const SIZE: [u32; 2] = [300, 220];

/// Difference of two images: decibels, and the fraction of pixels with a channel that differs by more than `step`.
fn difference(a: &RgbaImage, b: &RgbaImage, step: u8) -> (f64, f64) {
    let psnr = psnr_db(mean_squared_error(a, b).unwrap());
    let differs = |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > step);
    let differing = a.pixels().zip(b.pixels()).filter(|&pair| differs(pair));
    (psnr, differing.count() as f64 / f64::from(a.width() * a.height()))
}

/// Equal images but for pixels on edges, which are rounded to either side.
#[track_caller]
fn assert_same_picture(packet: &ScenePacket, min_psnr_db: f64, max_differing: f64) {
    let (gpu, cpu) = (draw(packet), draw_on_cpu(packet));
    let (psnr, differing) = difference(&gpu, &cpu, 3);
    let Style {
        primitive,
        surfels: SurfelStyle { splatting, .. },
        light: LightStyle { lighting, .. },
        ..
    } = packet.style;
    let what = format!("{primitive} {splatting} {lighting}: {psnr:.1} dB, {differing:.5} differ");
    if let Some(folder) = std::env::var_os("POINTREEL_KEEP_PICTURES") {
        let name = what.split(':').next().unwrap().replace(' ', "_");
        for (picture, by) in [(&gpu, "gpu"), (&cpu, "cpu")] {
            let path = std::path::Path::new(&folder).join(format!("{name}_{by}.png"));
            picture.save(path).unwrap();
        }
    }
    assert!(psnr >= min_psnr_db && differing <= max_differing, "{what}");
}

/// Disks of several sizes, some of which cut the near plane and the borders of the image.
fn surfel_scene(style: Style, distance: f64) -> ScenePacket {
    let mut scene = sphere(3000, 1.0);
    for (index, surfel) in scene.iter_mut().enumerate() {
        surfel.radius *= 0.5 + (index % 7) as f32 / 4.0;
    }
    let mut camera = camera_at(distance);
    camera.azimuth_deg = 25.0;
    camera.elevation_deg = 17.0;
    surfels(&scene, &camera, style, SIZE)
}

/// Minimum decibels and maximum number of differing pixels.
fn agreement(splatting: Splatting) -> (f64, f64) {
    match splatting {
        // A GPU rounds to bytes whenever it blends: hundreds of layers may add up to a few steps.
        Splatting::Regular | Splatting::NoDepth | Splatting::Sorted => (50.0, 5e-4),
        // A pixel where two hard disks intersect shows either.
        Splatting::Opaque => (60.0, 5e-5),
        Splatting::Visibility | Splatting::TwoPass | Splatting::Enlarged | Splatting::TwoPassEnlarged => (60.0, 1e-5),
    }
}

#[test]
fn surfels_in_every_mode_and_light_from_far_and_near() {
    for &splatting in Splatting::ALL {
        for &lighting in Lighting::ALL {
            let style = Style::default().with(|style| {
                style.surfels.splatting = splatting;
                crate::common::set_lighting(style, lighting);
            });
            let (min_psnr_db, max_differing) = agreement(splatting);
            assert_same_picture(&surfel_scene(style, 1.9), min_psnr_db, max_differing);
        }
    }
    for distance in [0.4, 1.02, 30.0] {
        let style = Style::default().with(|style| {
            style.surfels.back_faces = BackFaces::Drawn;
            style.surfels.splatting = Splatting::TwoPassEnlarged;
        });
        assert_same_picture(&surfel_scene(style, distance), 55.0, 1e-5);
    }
}

#[test]
fn ellipses_and_sprites_in_every_mode_and_light() {
    for primitive in [Primitive::Ellipse, Primitive::Sprite] {
        for &splatting in Splatting::ALL {
            for &lighting in Lighting::ALL {
                let style = Style::default().with(|style| {
                    style.primitive = primitive;
                    style.surfels.splatting = splatting;
                    crate::common::set_lighting(style, lighting);
                });
                let (min_psnr_db, max_differing) = agreement(splatting);
                for distance in [1.9, 0.4] {
                    assert_same_picture(&surfel_scene(style, distance), min_psnr_db, max_differing);
                }
            }
        }
    }
}

#[test]
fn splats_of_every_geometry() {
    for &geometry in SplatGeometry::ALL {
        let style = Style::default().with(|style| style.surfels.geometry = geometry);
        for &splatting in Splatting::ALL {
            let style = style.with(|style| style.surfels.splatting = splatting);
            let (min_psnr_db, max_differing) = agreement(splatting);
            assert_same_picture(&surfel_scene(style, 1.9), min_psnr_db, max_differing);
        }
        for distance in [0.4, 1.02, 30.0] {
            let style = style.with(|style| {
                style.surfels.back_faces = BackFaces::Drawn;
                style.surfels.splatting = Splatting::TwoPassEnlarged;
            });
            assert_same_picture(&surfel_scene(style, distance), 55.0, 1e-5);
        }
    }
}

#[test]
fn splats_of_every_kernel() {
    for kernel in [Kernel::Hat, Kernel::Flat] {
        for splatting in [
            Splatting::Regular,
            Splatting::NoDepth,
            Splatting::Sorted,
            Splatting::TwoPass,
            Splatting::TwoPassEnlarged,
        ] {
            let style = Style::default().with(|style| {
                style.surfels.kernel = kernel;
                style.surfels.splatting = splatting;
            });
            let (min_psnr_db, max_differing) = agreement(splatting);
            // Half floats round sums of many weights that are all 1 more coarsely than Gaussian ones.
            assert_same_picture(&surfel_scene(style, 1.9), min_psnr_db.min(57.0), max_differing);
        }
    }
}

#[test]
fn filtered_splats_from_far_and_near() {
    for primitive in [Primitive::Surfel, Primitive::Ellipse, Primitive::Sprite] {
        for splatting in [Splatting::TwoPass, Splatting::Enlarged, Splatting::TwoPassEnlarged] {
            for (distance, filter) in [0.4, 1.9, 10.0, 60.0]
                .into_iter()
                .flat_map(|distance| [SplatFilter::Ewa, SplatFilter::Clamp].map(|filter| (distance, filter)))
            {
                let style = Style::default().with(|style| {
                    style.primitive = primitive;
                    style.surfels.splatting = splatting;
                    style.surfels.filter = filter;
                });
                assert_same_picture(&surfel_scene(style, distance), 55.0, 1e-5);
            }
        }
    }
}

#[test]
fn surfaces_under_every_rig_of_lights_with_eye_dome_lighting() {
    for &splatting in Splatting::ALL {
        for &rig in LightRig::ALL {
            let style = Style::default().with(|style| {
                style.surfels.splatting = splatting;
                style.light.lighting = Lighting::BlinnPhong;
                style.light.rig = rig;
                style.light.eye_dome = EyeDome::On;
            });
            let (min_psnr_db, max_differing) = agreement(splatting);
            assert_same_picture(&surfel_scene(style, 1.9), min_psnr_db, max_differing);
        }
    }
}

#[test]
fn surfaces_with_ambient_occlusion() {
    for &splatting in Splatting::ALL {
        for (distance, radius) in [(1.9, 1.0), (1.2, 4.0)] {
            let style = Style::default().with(|style| {
                style.surfels.splatting = splatting;
                style.light.lighting = Lighting::Lambert;
                style.light.ao = OnOff::On;
                style.light.ao_radius = radius;
            });
            let (min_psnr_db, _) = agreement(splatting);
            // A pixel on the other side of an edge is on the sampling lines of 24 others.
            assert_same_picture(&surfel_scene(style, distance), min_psnr_db.min(55.0), 5e-4);
        }
    }
}

#[test]
fn surfaces_with_shadows() {
    for &splatting in Splatting::ALL {
        for &rig in LightRig::ALL {
            let style = Style::default().with(|style| {
                style.surfels.splatting = splatting;
                style.light.lighting = Lighting::BlinnPhong;
                style.light.rig = rig;
                style.light.shadows = OnOff::On;
            });
            let (min_psnr_db, max_differing) = agreement(splatting);
            // At shadow borders both sample nearly the same texels of nearly the same maps.
            assert_same_picture(
                &surfel_scene(style, 1.9),
                min_psnr_db.min(50.0),
                max_differing.max(2e-3),
            );
        }
    }
}

#[test]
fn points_of_one_pixel_and_of_many() {
    for size_px in [1.0, 1.2, 2.0, 3.5, 16.0] {
        for &shape in PointShape::ALL {
            let style = Style {
                primitive: Primitive::Point,
                points: PointStyle {
                    size_px,
                    shape,
                    ..PointStyle::default()
                },
                ..Style::default()
            };
            // A software adapter rounds to a 256th of a pixel before it determines which one contains a point.
            assert_same_picture(&surfel_scene(style, 1.9), 38.0, 2e-3);
            assert_same_picture(&surfel_scene(style, 0.7), 38.0, 2e-3);
        }
    }
}

#[test]
fn points_sized_in_scene_units() {
    for sizing in [PointSizing::Projected, PointSizing::Adaptive] {
        for &shape in PointShape::ALL {
            let style = Style::default().with(|style| {
                style.primitive = Primitive::Point;
                style.points.sizing = sizing;
                style.points.shape = shape;
            });
            // From near to so far that most points have the minimum size.
            for distance in [0.7, 1.9, 30.0] {
                let mut packet = surfel_scene(style, distance);
                packet.params.point_spacing = 0.05;
                assert_same_picture(&packet, 38.0, 2e-3);
            }
        }
    }
}

#[test]
fn points_of_every_shape_in_every_light() {
    for sizing in [PointSizing::Pixels, PointSizing::Adaptive] {
        for &shape in PointShape::ALL {
            for &lighting in Lighting::ALL {
                let style = Style::default().with(|style| {
                    style.primitive = Primitive::Point;
                    style.points.sizing = sizing;
                    style.points.size_px = 5.0;
                    style.points.shape = shape;
                    style.points.light = PointLight::Normals;
                    crate::common::set_lighting(style, lighting);
                });
                // Blended points have no hard edges that rounding could move.
                let bounds = match shape {
                    PointShape::Gaussian => (55.0, 1e-4),
                    PointShape::Square | PointShape::Disk => (38.0, 2e-3),
                };
                assert_same_picture(&surfel_scene(style, 1.9), bounds.0, bounds.1);
            }
        }
    }
}

/// A round point `aside_px` to the right of and above the centre of the central pixel, as rows of `#` and `.`, as both
/// renderers draw it.
#[track_caller]
fn round_point(size_px: f32, aside_px: f32) -> Vec<String> {
    let style = Style {
        primitive: Primitive::Point,
        points: PointStyle {
            size_px,
            shape: PointShape::Disk,
            ..PointStyle::default()
        },
        backdrop: Backdrop {
            background: Background::solid([0; 3]),
            ..Backdrop::default()
        },
        ..Style::default()
    };
    let packet_of = |position: Vec3| {
        let mut points = sphere(1, 1.0);
        points[0].position = position;
        points[0].color = [255; 3];
        surfels(&points, &camera_at(3.0), style, [9, 9])
    };
    let midpoint = packet_of(Vec3::ZERO);
    let px_per_unit = 0.5 * 9.0 * midpoint.view.focal[1] / 3.0;
    let place = Vec3::new(aside_px, aside_px, 0.0) / px_per_unit;
    let packet = packet_of(place);
    let [cpu, gpu] = [draw_on_cpu(&packet), draw(&packet)].map(|image| {
        image
            .rows()
            .map(|row| row.map(|pixel| if pixel.0[0] > 0 { '#' } else { '.' }))
            .map(String::from_iter)
            .collect::<Vec<_>>()
    });
    assert_eq!(cpu, gpu, "processor and GPU");
    cpu
}

#[test]
fn a_round_point_covers_pixels_with_centers_in_its_circle() {
    let seven = [
        ".........",
        "...###...",
        "..#####..",
        ".#######.",
        ".#######.",
        ".#######.",
        "..#####..",
        "...###...",
        ".........",
    ];
    assert_eq!(round_point(7.0, 0.0), seven);
    // No pixel centre is in the circle: the pixel that contains the point is always drawn.
    let own = [
        ".........",
        ".........",
        ".........",
        ".........",
        "....#....",
        ".........",
        ".........",
        ".........",
        ".........",
    ];
    assert_eq!(round_point(1.2, 0.45), own);
    // Four pixel centres are inside it.
    let four = [
        ".........",
        ".........",
        ".........",
        "....##...",
        "....##...",
        ".........",
        ".........",
        ".........",
        ".........",
    ];
    assert_eq!(round_point(2.0, 0.45), four);
}

#[test]
fn voxels_in_every_light_from_outside_and_from_within() {
    // Cells of two levels in a cube of edge 2, the coarser ones above.
    let cells = (0..512u32).map(|cell| {
        let level = if cell % 3 == 0 { 4 } else { 3 };
        let corner = Vec3::new((cell % 8) as f32, (cell / 8 % 8) as f32, (cell / 64) as f32);
        VoxelRecord {
            center: ((corner + 0.5) * 0.25 - 1.0).to_array(),
            color: [cell as u8, (cell * 5) as u8, (cell * 11) as u8],
            level,
        }
    });
    let cells: Vec<VoxelRecord> = cells.filter(|cell| cell.color[1] % 4 != 0).collect();
    // Directions unrelated to the faces.
    let normals = common::shapes_towards(cells.iter().map(|cell| cell.center));
    let lights = Lighting::ALL
        .iter()
        .flat_map(|&lighting| [None, Some(Arc::new(normals.clone()))].map(|normals| (lighting, normals)));
    for (lighting, normals) in lights {
        for distance in [3.0, 0.9] {
            let mut packet = surfel_scene(
                Style::default().with(|style| {
                    style.primitive = Primitive::Voxel;
                    crate::common::set_lighting(style, lighting);
                }),
                distance,
            );
            packet.content = Content::Voxels(Voxels {
                records: Arc::new(cells.clone()),
                normals: normals.clone(),
                cube_edge: 2.0,
            });
            assert_same_picture(&packet, 52.0, 1e-4);
        }
    }
}

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
fn empty_content_shows_the_background() {
    let mut packet = surfel_scene(Style::default(), 1.9);
    packet.content = Content::Nothing;
    assert_same_picture(&packet, f64::INFINITY, 0.0);
    packet.content = Content::Points(Arc::default());
    packet.style.primitive = Primitive::Point;
    assert_same_picture(&packet, f64::INFINITY, 0.0);
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
