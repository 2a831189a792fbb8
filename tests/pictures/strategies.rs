//! All instancing strategies draw the same image, byte for byte, from the same packet.

use crate::common::{self, camera_at, draw_with, plain, software, sphere, surfels, voxels};
use glam::Vec3;
use pointreel::cloud::VoxelRecord;
use pointreel::render::Renderer;
use pointreel::render::gpu::{ContextOptions, GpuRenderer};
use pointreel::scene::{
    BackFaces, Background, Camera, Content, Kernel, Lighting, PointLight, PointShape, PointSizing, PointStyle,
    Primitive, Scene, ScenePacket, SplatFilter, SplatGeometry, Splatting, Strategy, Style, UpAxis,
};
use pointreel::sequence::{PrepareCounters, Sequence, prepare};
use std::sync::Arc;

/// Draws `packet` with every strategy and asserts that the images are equal and not empty.
fn assert_agreement(renderer: &mut GpuRenderer, packet: &ScenePacket, what: &str) {
    let mut reference = None;
    for &strategy in Strategy::ALL {
        let mut packet = packet.clone();
        packet.style.drawing.strategy = strategy;
        let image = draw_with(renderer, &packet);
        let empty = *image.get_pixel(0, 0);
        assert!(
            image.pixels().any(|&pixel| pixel != empty),
            "{what}, {strategy}: nothing was drawn"
        );
        let reference = reference.get_or_insert_with(|| image.clone());
        assert_eq!(
            common::difference(reference, &image),
            (0, 0),
            "{what}: {strategy} differs from {} in (pixels, most)",
            Strategy::ALL[0]
        );
    }
}

/// Each of `first` with each of `second`.
fn pairs<'a, A, B>(first: &'a [A], second: &'a [B]) -> impl Iterator<Item = (&'a A, &'a B)> {
    first.iter().flat_map(|a| second.iter().map(move |b| (a, b)))
}

fn gradient() -> Background {
    Background {
        top: [10, 20, 30],
        bottom: [200, 190, 180],
    }
}

/// Cells of levels 3 to 5 in the shell of a sphere of radius 1.
fn shell_voxels() -> Vec<VoxelRecord> {
    sphere(700, 1.0)
        .into_iter()
        .enumerate()
        .map(|(i, surfel)| VoxelRecord {
            center: surfel.position.to_array(),
            color: surfel.color,
            level: 3 + (i % 3) as u8,
        })
        .collect()
}

/// A camera whose near plane and sides cut the unit sphere.
fn close_camera() -> Camera {
    Camera {
        azimuth_deg: 25.0,
        elevation_deg: -35.0,
        ..camera_at(1.2)
    }
}

#[test]
fn surfels_in_all_modes_and_lights() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(1500, 1.0);
    for primitive in [Primitive::Surfel, Primitive::Ellipse, Primitive::Sprite] {
        for &splatting in Splatting::ALL {
            for &lighting in Lighting::ALL {
                let style = plain().with(|style| {
                    style.primitive = primitive;
                    style.surfels.splatting = splatting;
                    crate::common::set_lighting(style, lighting);
                    style.backdrop.background = gradient();
                });
                let packet = surfels(&cloud, &close_camera(), style, [120, 90]);
                let what = format!("{primitive}, {splatting}, light {lighting}");
                assert_agreement(&mut renderer, &packet, &what);
            }
        }
    }
}

#[test]
fn surfels_of_every_geometry() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(1500, 1.0);
    for (&geometry, &splatting) in pairs(SplatGeometry::ALL, Splatting::ALL) {
        for lighting in [Lighting::PerVertex, Lighting::Lambert] {
            for (primitive, filter) in [
                (Primitive::Surfel, SplatFilter::Off),
                (Primitive::Ellipse, SplatFilter::Ewa),
            ] {
                let style = plain().with(|style| {
                    style.primitive = primitive;
                    style.surfels.geometry = geometry;
                    style.surfels.filter = filter;
                    style.surfels.splatting = splatting;
                    style.light.lighting = lighting;
                });
                let packet = surfels(&cloud, &close_camera(), style, [120, 90]);
                let what = format!("{primitive}, {geometry}, {splatting}, light {lighting}");
                assert_agreement(&mut renderer, &packet, &what);
            }
        }
    }
}

#[test]
fn surfels_of_every_kernel() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(1500, 1.0);
    for &kernel in Kernel::ALL {
        for splatting in [Splatting::Regular, Splatting::TwoPass, Splatting::TwoPassEnlarged] {
            for lighting in [Lighting::PerFragment, Lighting::Lambert] {
                let style = plain().with(|style| {
                    style.surfels.kernel = kernel;
                    style.surfels.splatting = splatting;
                    style.light.lighting = lighting;
                });
                let packet = surfels(&cloud, &close_camera(), style, [120, 90]);
                assert_agreement(
                    &mut renderer,
                    &packet,
                    &format!("{kernel}, {splatting}, light {lighting}"),
                );
            }
        }
    }
}

#[test]
fn filtered_surfels_far_and_near() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(1500, 1.0);
    for primitive in [Primitive::Surfel, Primitive::Ellipse, Primitive::Sprite] {
        for (lighting, filter) in [Lighting::Unlit, Lighting::PerVertex, Lighting::BlinnPhong]
            .into_iter()
            .flat_map(|lighting| [SplatFilter::Ewa, SplatFilter::Clamp].map(|filter| (lighting, filter)))
        {
            let style = plain().with(|style| {
                style.primitive = primitive;
                style.surfels.splatting = Splatting::TwoPass;
                style.surfels.filter = filter;
                style.light.lighting = lighting;
            });
            for camera in [close_camera(), camera_at(20.0)] {
                let packet = surfels(&cloud, &camera, style, [120, 90]);
                let what = format!(
                    "{primitive} filtered by {filter}, light {lighting}, from {}",
                    camera.distance
                );
                assert_agreement(&mut renderer, &packet, &what);
            }
        }
    }
}

#[test]
fn a_real_frame_in_every_mode_and_primitive() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let sequence = Sequence::demo();
    let frame = Arc::new(sequence.frame(9).unwrap());
    let mut scene = Scene::default();
    let mut agree = |style: Style, what: &str| {
        let needs = Scene::needs(&style);
        let frame = prepare(9, Arc::clone(&frame), 0.0, &needs, &PrepareCounters::default());
        let camera = Camera::framing(&frame.frame.bounds(), sequence.origin(), UpAxis::Y);
        let packet = scene.packet(&frame, sequence.origin(), &camera, &style, [160, 200]);
        assert_agreement(&mut renderer, &packet, what);
    };
    for &splatting in Splatting::ALL {
        let style = Style::default().with(|style| style.surfels.splatting = splatting);
        agree(style, &format!("demo, {splatting}"));
    }
    for primitive in [
        Primitive::Ellipse,
        Primitive::Sprite,
        Primitive::Voxel,
        Primitive::Point,
    ] {
        let style = Style {
            primitive,
            ..Style::default()
        };
        agree(style, &format!("demo, {primitive}"));
    }
}

#[test]
fn surfels_from_both_sides() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(1500, 1.0);
    let style = plain().with(|style| style.surfels.back_faces = BackFaces::Drawn);
    let packet = surfels(&cloud, &close_camera(), style, [90, 120]);
    assert_agreement(&mut renderer, &packet, "both sides");
}

/// Surfels that the rasteriser's grid may flip: compute passes must not drop one that others draw.
#[test]
fn small_surfels_seen_nearly_edge_on() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let mut cloud = sphere(4000, 1.0);
    for (i, surfel) in cloud.iter_mut().enumerate() {
        // One to four pixels large in the image, and tilted by up to 6 degrees away from the eye or towards it.
        surfel.radius = 0.02 + 0.02 * (i % 4) as f32;
        let across = surfel.normal.with_z(0.0).normalize();
        let away = (surfel.position - 3.0 * Vec3::Z).normalize();
        let across = (across - across.dot(away) * away).normalize();
        let turned = 0.1 * ((i % 101) as f32 / 50.0 - 1.0);
        surfel.normal = (across + turned * away).normalize();
    }
    for splatting in [Splatting::Regular, Splatting::NoDepth, Splatting::TwoPass] {
        let mut style = plain();
        style.surfels.splatting = splatting;
        style.surfels.back_faces = BackFaces::Culled;
        let packet = surfels(&cloud, &camera_at(3.0), style, [150, 150]);
        assert_agreement(&mut renderer, &packet, &format!("edge on, {splatting}"));
    }
}

#[test]
fn voxels_in_all_lights() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    for &lighting in Lighting::ALL {
        let style = plain().with(|style| {
            style.primitive = Primitive::Voxel;
            crate::common::set_lighting(style, lighting);
            style.backdrop.background = gradient();
        });
        let mut packet = voxels(shell_voxels(), 2.0, &close_camera(), style, [120, 90]);
        assert_agreement(&mut renderer, &packet, &format!("voxels, light {lighting}"));
        let Content::Voxels(voxels) = &mut packet.content else {
            panic!("a packet of voxels");
        };
        let centers = voxels.records.iter().map(|voxel| voxel.center);
        voxels.normals = Some(Arc::new(common::shapes_towards(centers)));
        let what = format!("voxels, light {lighting} on normals");
        assert_agreement(&mut renderer, &packet, &what);
    }
}

#[test]
fn points_of_one_and_of_several_pixels() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(5000, 1.0);
    let sizes = [1.0, 2.0, 5.0].into_iter();
    for (size_px, &shape) in sizes.flat_map(|size_px| PointShape::ALL.iter().map(move |shape| (size_px, shape))) {
        let style = Style {
            primitive: Primitive::Point,
            points: PointStyle {
                size_px,
                shape,
                ..PointStyle::default()
            },
            ..plain()
        };
        let packet = surfels(&cloud, &close_camera(), style, [120, 90]);
        assert_agreement(&mut renderer, &packet, &format!("points of {size_px} px, {shape}"));
    }
}

#[test]
fn points_sized_in_scene_units() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(5000, 1.0);
    for sizing in [PointSizing::Projected, PointSizing::Adaptive] {
        for &shape in PointShape::ALL {
            let style = plain().with(|style| {
                style.primitive = Primitive::Point;
                style.points.sizing = sizing;
                style.points.shape = shape;
            });
            let mut packet = surfels(&cloud, &close_camera(), style, [120, 90]);
            packet.params.point_spacing = 0.03;
            assert_agreement(&mut renderer, &packet, &format!("{sizing} points, {shape}"));
        }
    }
}

#[test]
fn points_of_every_shape_in_every_light() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let cloud = sphere(1500, 1.0);
    for sizing in [PointSizing::Pixels, PointSizing::Adaptive] {
        for (&shape, &lighting) in PointShape::ALL
            .iter()
            .flat_map(|shape| Lighting::ALL.iter().map(move |lighting| (shape, lighting)))
        {
            let style = plain().with(|style| {
                style.primitive = Primitive::Point;
                style.points.sizing = sizing;
                style.points.size_px = 5.0;
                style.points.shape = shape;
                style.points.light = PointLight::Normals;
                crate::common::set_lighting(style, lighting);
                style.backdrop.background = gradient();
            });
            let packet = surfels(&cloud, &close_camera(), style, [120, 90]);
            let what = format!("{sizing} points, {shape}, light {lighting}");
            assert_agreement(&mut renderer, &packet, &what);
        }
    }
}

#[test]
fn many_batches_and_chunks_draw_the_same_as_one() {
    let cloud = sphere(10_000, 1.0);
    let mut whole = GpuRenderer::new(common::context()).unwrap();
    // Not a multiple, so that neither batches nor workgroups end with a chunk.
    let chunked = common::open(&ContextOptions {
        max_chunk_records: Some(777),
        ..software()
    });
    let mut chunked = GpuRenderer::new(chunked).unwrap();
    for &geometry in SplatGeometry::ALL {
        let style = plain().with(|style| {
            style.surfels.splatting = Splatting::NoDepth;
            style.surfels.geometry = geometry;
        });
        let packet = surfels(&cloud, &close_camera(), style, [120, 90]);
        let reference = draw_with(&mut whole, &packet);
        for &strategy in Strategy::ALL {
            let mut packet = packet.clone();
            packet.style.drawing.strategy = strategy;
            let image = draw_with(&mut chunked, &packet);
            let what = format!("{geometry}, {strategy}");
            assert_eq!(common::difference(&reference, &image), (0, 0), "{what} in chunks");
            assert_eq!(chunked.stats().draw_calls, 13, "{what}: one draw a chunk");
        }
    }
}

#[test]
fn the_compute_strategy_leaves_nothing_of_an_earlier_cloud() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let style = plain().with(|style| style.drawing.strategy = Strategy::Compute);
    let full = surfels(&sphere(1500, 1.0), &camera_at(3.0), style, [64, 64]);
    let empty = surfels(&[], &camera_at(3.0), style, [64, 64]);
    assert!(common::covered(&draw_with(&mut renderer, &full), [0, 0, 0]) > 250);
    assert_eq!(common::covered(&draw_with(&mut renderer, &empty), [0, 0, 0]), 0);
}

#[test]
fn extreme_positions_and_sizes_agree_too() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let mut cloud = sphere(200, 1.0);
    for (i, surfel) in cloud.iter_mut().enumerate() {
        match i % 4 {
            0 => surfel.radius = 0.0,
            1 => surfel.position *= 1e6,
            2 => surfel.normal = Vec3::Y,
            _ => {}
        }
    }
    let packet = surfels(&cloud, &close_camera(), plain(), [64, 64]);
    assert_agreement(&mut renderer, &packet, "extremes");
}
