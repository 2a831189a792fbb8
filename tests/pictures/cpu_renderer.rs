//! The software renderer against the GPU's: the same images in every mode, shape and light.

use crate::common::{self, camera_at, draw, draw_on_cpu, sphere, surfels};
use glam::Vec3;
use image::RgbaImage;
use pointreel::cloud::VoxelRecord;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::scene::{
    BackFaces, Backdrop, Background, Content, EyeDome, Kernel, LightRig, LightStyle, Lighting, OnOff, PointLight,
    PointShape, PointSizing, PointStyle, Primitive, ScenePacket, SplatFilter, SplatGeometry, Splatting, Style,
    SurfelStyle, Voxels,
};
use std::sync::Arc;

pub(crate) const SIZE: [u32; 2] = [300, 220];

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
pub(crate) fn surfel_scene(style: Style, distance: f64) -> ScenePacket {
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
fn empty_content_shows_the_background() {
    let mut packet = surfel_scene(Style::default(), 1.9);
    packet.content = Content::Nothing;
    assert_same_picture(&packet, f64::INFINITY, 0.0);
    packet.content = Content::Points(Arc::default());
    packet.style.primitive = Primitive::Point;
    assert_same_picture(&packet, f64::INFINITY, 0.0);
}
