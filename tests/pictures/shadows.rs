//! Shadows of constructed scenes, by both renderers: exactly where rays to the lamp are blocked.

use crate::common::{self, Surfel, camera_at, context, draw, draw_on_cpu, draw_with, plain, sphere, surfels, voxels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{MeshRecords, TriangleRecord, VertexRecord, VoxelRecord, oct_encode};
use pointreel::render::Renderer;
use pointreel::render::gpu::GpuRenderer;
use pointreel::scene::{
    BackFaces, Camera, Content, LightRig, Lighting, Lights, OnOff, PointLight, PointShape, PointSizing, Primitive,
    Projection, ScenePacket, Splatting, Strategy, Style,
};
use std::sync::Arc;

const SIZE: [u32; 2] = [200, 160];

/// The box that stands above the floor at height 0.
const BOX: [DVec3; 2] = [DVec3::new(-0.4, 0.5, -0.4), DVec3::new(0.4, 1.3, 0.4)];

fn lit(lighting: Lighting, splatting: Splatting) -> Style {
    plain().with(|style| {
        style.light.lighting = lighting;
        style.light.rig = LightRig::ThreePoint;
        style.light.shadows = OnOff::On;
        style.surfels.splatting = splatting;
        style.surfels.back_faces = BackFaces::Drawn;
    })
}

/// Points lit by their normals, as large as their surfels.
fn lit_points(shape: PointShape) -> Style {
    lit(Lighting::Lambert, Splatting::TwoPass).with(|style| {
        style.primitive = Primitive::Point;
        style.points.light = PointLight::Normals;
        style.points.sizing = PointSizing::Adaptive;
        style.points.shape = shape;
    })
}

fn camera() -> Camera {
    Camera {
        azimuth_deg: 15.0,
        elevation_deg: 40.0,
        fov_deg: 50.0,
        ..camera_at(5.0)
    }
}

/// Images without shadows and with them, by each renderer.
fn without_and_with(packet: &ScenePacket) -> [([RgbaImage; 2], &'static str); 2] {
    let mut without = packet.clone();
    without.style.light.shadows = OnOff::Off;
    [
        ([draw_on_cpu(&without), draw_on_cpu(packet)], "processor"),
        ([draw(&without), draw(packet)], "GPU"),
    ]
}

/// White disks on a rectangle around `midpoint`, with half edges along two directions.
fn rectangle(midpoint: Vec3, half_edges: [Vec3; 2]) -> Vec<Surfel> {
    const SPACING: f32 = 0.04;
    let [across, along] = half_edges.map(|half| (half.length() / SPACING).ceil() as i32);
    let normal = half_edges[0].cross(half_edges[1]).normalize();
    let places = (-across..=across).flat_map(|i| (-along..=along).map(move |j| [i, j]));
    let surfel = |[i, j]: [i32; 2]| Surfel {
        position: midpoint + half_edges[0] * (i as f32 / across as f32) + half_edges[1] * (j as f32 / along as f32),
        normal,
        radius: SPACING,
        color: [255; 3],
    };
    places.map(surfel).collect()
}

/// A floor and the box above it.
fn box_of_surfels(style: Style) -> ScenePacket {
    let mut cloud = rectangle(Vec3::ZERO, [2.0 * Vec3::Z, 2.0 * Vec3::X]);
    let [low, high] = BOX.map(|corner: DVec3| corner.as_vec3());
    let (midpoint, half) = (0.5 * (low + high), 0.5 * (high - low));
    for axis in 0..3 {
        let along = |axis: usize| half[axis % 3] * Vec3::AXES[axis % 3];
        for side in [-1.0f32, 1.0] {
            cloud.extend(rectangle(
                midpoint + side * along(axis),
                [side * along(axis + 1), along(axis + 2)],
            ));
        }
    }
    surfels(&cloud, &camera(), style, SIZE)
}

/// The same with triangles, two for each rectangle.
fn box_of_triangles(style: Style) -> ScenePacket {
    let [low, high] = BOX.map(|corner: DVec3| corner.as_vec3());
    let (midpoint, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut rectangles = vec![[Vec3::ZERO, 2.0 * Vec3::Z, 2.0 * Vec3::X]];
    for axis in 0..3 {
        let along = |axis: usize| half[axis % 3] * Vec3::AXES[axis % 3];
        rectangles.extend(
            [-1.0f32, 1.0].map(|side| [midpoint + side * along(axis), side * along(axis + 1), along(axis + 2)]),
        );
    }
    let corners = rectangles
        .iter()
        .flat_map(|&[midpoint, u, v]| [midpoint - u - v, midpoint + u - v, midpoint - u + v, midpoint + u + v]);
    let vertices: Vec<VertexRecord> = corners
        .map(|position| VertexRecord {
            position: position.to_array(),
            color: [255; 4],
            texture_place: [0.0; 2],
            normal: VertexRecord::NO_NORMAL,
            texture: VertexRecord::NO_TEXTURE,
        })
        .collect();
    let halves = (0..rectangles.len() as u32)
        .flat_map(|index| [[0, 1, 2], [2, 1, 3]].map(|half| half.map(|corner| 4 * index + corner)));
    let triangles = halves.map(|corners| {
        let [_, u, v] = rectangles[corners[0] as usize / 4];
        TriangleRecord {
            corners,
            normal: oct_encode(u.cross(v).normalize()),
        }
    });
    let mesh = MeshRecords::new(Arc::new(vertices), Arc::new(triangles.collect()));
    ScenePacket {
        content: Content::Mesh(Arc::new(mesh)),
        ..surfels(
            &rectangle(Vec3::ZERO, [2.0 * Vec3::Z, 2.0 * Vec3::X]),
            &camera(),
            style.with(|style| style.primitive = Primitive::Mesh),
            SIZE,
        )
    }
}

/// The same with cells with an edge of 1/16.
fn box_of_cells(style: Style) -> ScenePacket {
    const EDGE: f32 = 0.0625;
    let place = |cell: i32| (cell as f32 + 0.5) * EDGE;
    let mut centers: Vec<[f32; 3]> = (-32..32)
        .flat_map(|x| (-32..32).map(move |z| [place(x), -0.5 * EDGE, place(z)]))
        .collect();
    let cells = |axis: usize| {
        let [low, high] = BOX.map(|corner| (corner[axis] as f32 / EDGE).round() as i32);
        low..high
    };
    for x in cells(0) {
        for y in cells(1) {
            centers.extend(cells(2).map(|z| [place(x), place(y), place(z)]));
        }
    }
    let records = centers.into_iter().map(|center| VoxelRecord {
        center,
        color: [255; 3],
        level: 6,
    });
    let style = style.with(|style| style.primitive = Primitive::Voxel);
    voxels(records.collect(), 64.0 * EDGE, &camera(), style, SIZE)
}

/// Distance at which a ray enters a box; `None` where it does not.
fn enters([low, high]: [DVec3; 2], from: DVec3, ray: DVec3) -> Option<f64> {
    let [low, high] = [(low - from) / ray, (high - from) / ray];
    let (first, last) = (low.min(high).max_element(), low.max(high).min_element());
    (first < last && first > 0.0).then_some(first)
}

/// The result of rays for a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Floor {
    Lit,
    InShadow,
    /// Near the border of a shadow, or no floor at all.
    Unsure,
}

/// The floor at the centre of a pixel: in shadow if the box is between all positions within `margin` and the lamp.
fn floor_at(packet: &ScenePacket, to_lamp: DVec3, [x, y]: [u32; 2], margin: f64) -> Floor {
    let view = &packet.view;
    let [width, height] = SIZE.map(f64::from);
    let ndc = [
        2.0 * (f64::from(x) + 0.5) / width - 1.0,
        1.0 - 2.0 * (f64::from(y) + 0.5) / height,
    ];
    let slopes = [0, 1].map(|axis| ndc[axis] / f64::from(view.focal[axis]));
    let to_frame = view.view_from_frame_rotation.as_dmat3().transpose();
    let (eye, ray) = (
        view.eye_high.as_dvec3(),
        to_frame * DVec3::new(slopes[0], slopes[1], -1.0),
    );
    let place = eye - ray * (eye.y / ray.y);
    let near_box = BOX.map(|corner| corner + margin * (corner - DVec3::new(0.0, 0.9, 0.0)).signum());
    let is_floor = ray.y < 0.0 && place.x.abs().max(place.z.abs()) < 1.9 && enters(near_box, eye, ray).is_none();
    if !is_floor {
        return Floor::Unsure;
    }
    let around = [-margin, 0.0, margin].map(|x| [-margin, 0.0, margin].map(|z| place + DVec3::new(x, 0.0, z)));
    let shadows = around
        .as_flattened()
        .iter()
        .filter(|place| enters(BOX, **place, to_lamp).is_some());
    match shadows.count() {
        0 => Floor::Lit,
        9 => Floor::InShadow,
        _ => Floor::Unsure,
    }
}

/// The linear light of a channel.
fn linear(byte: u8) -> f64 {
    let channel = f64::from(byte) / 255.0;
    if channel <= 0.04045 {
        channel / 12.92
    } else {
        ((channel + 0.055) / 1.055).powf(2.4)
    }
}

#[test]
fn shadows_are_where_rays_to_the_lamp_meet_something() {
    let matt = |splatting| lit(Lighting::Lambert, splatting);
    let scenes = [
        (box_of_surfels(matt(Splatting::TwoPass)), 0.1, "surfels"),
        (box_of_surfels(matt(Splatting::Opaque)), 0.1, "opaque disks"),
        (box_of_cells(matt(Splatting::TwoPass)), 0.15, "cells"),
        (box_of_triangles(matt(Splatting::TwoPass)), 0.1, "triangles"),
        (box_of_surfels(lit_points(PointShape::Square)), 0.15, "square points"),
        (box_of_surfels(lit_points(PointShape::Disk)), 0.15, "round points"),
        (
            box_of_surfels(lit_points(PointShape::Gaussian)),
            0.15,
            "Gaussian points",
        ),
    ];
    for (packet, margin, what) in scenes {
        let lights = Lights::of(&packet).unwrap();
        let key = lights.key().unwrap();
        let to_frame = packet.view.view_from_frame_rotation.as_dmat3().transpose();
        let to_lamp = to_frame * key.place.truncate().as_dvec3();
        // The contribution of the key light to a white floor that faces up.
        let light_of_key = (key.color.as_dvec3() * to_lamp.y).z;
        for ([without, with], by) in without_and_with(&packet) {
            let mut counts = [0; 2];
            for (x, y, pixel) in with.enumerate_pixels() {
                let [after, before] = [pixel, without.get_pixel(x, y)].map(|pixel| pixel.0[2]);
                let floor = floor_at(&packet, to_lamp, [x, y], margin);
                match floor {
                    Floor::Unsure => continue,
                    Floor::Lit => assert!(before.abs_diff(after) <= 1, "{what}, {by}, {x} {y}: {before} {after}"),
                    Floor::InShadow => {
                        let lost = linear(before) - linear(after);
                        assert!(
                            (lost - light_of_key).abs() < 0.02,
                            "{what}, {by}, {x} {y}: {lost}, not {light_of_key}"
                        );
                    }
                }
                counts[usize::from(floor == Floor::Lit)] += 1;
            }
            assert!(counts[0] > 150 && counts[1] > 2000, "{what}, {by}: {counts:?}");
        }
    }
}

/// Its silhouette is the border of its shadow: there disks are before one another.
#[test]
fn a_sphere_does_not_shadow_its_lit_side() {
    let of_surfels = |splatting| (lit(Lighting::Lambert, splatting), format!("{splatting}"));
    let of_points = |shape| (lit_points(shape), format!("{shape} points"));
    for (count, (style, what), projection) in [
        (1000, of_surfels(Splatting::TwoPass), Projection::Perspective),
        (1000, of_surfels(Splatting::TwoPassEnlarged), Projection::Perspective),
        (10_000, of_surfels(Splatting::Enlarged), Projection::Orthographic),
        (10_000, of_surfels(Splatting::Opaque), Projection::Orthographic),
        (10_000, of_points(PointShape::Square), Projection::Perspective),
        (10_000, of_points(PointShape::Disk), Projection::Orthographic),
        (10_000, of_points(PointShape::Gaussian), Projection::Perspective),
    ] {
        let mut cloud = sphere(count, 1.0);
        for surfel in &mut cloud {
            surfel.color = [255; 3];
        }
        let camera = Camera {
            projection,
            ..camera_at(2.0)
        };
        let packet = surfels(&cloud, &camera, style, SIZE);
        let key = Lights::of(&packet).unwrap().key().unwrap().place.truncate();
        let midpoint = SIZE.map(|edge| 0.5 * edge as f32);
        for ([without, with], by) in without_and_with(&packet) {
            let mut checked = 0;
            for (x, y, pixel) in with.enumerate_pixels() {
                // Approximately the normal: exact for parallel rays.
                let radius_px = packet.view.pixels_per_unit_at_1 / (camera.distance as f32 * packet.view.telephoto);
                let aside = [
                    (x as f32 + 0.5 - midpoint[0]) / radius_px,
                    (midpoint[1] - y as f32 - 0.5) / radius_px,
                ];
                let rest = 1.0 - aside[0] * aside[0] - aside[1] * aside[1];
                if rest < 0.1 || Vec3::new(aside[0], aside[1], rest.sqrt()).dot(key) < 0.35 {
                    continue;
                }
                let max = (0..3)
                    .map(|channel| pixel.0[channel].abs_diff(without.get_pixel(x, y).0[channel]))
                    .max();
                assert!(
                    max <= Some(1),
                    "{count}, {what}, {projection:?}, {by}, {x} {y}: {max:?}"
                );
                checked += 1;
            }
            assert!(checked > 1500, "{checked}");
        }
    }
}

#[test]
fn a_plane_at_any_slope_does_not_shadow_itself() {
    for degrees in [-80.0, -60.0, -30.0, 0.0, 30.0, 60.0f32] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let cloud = rectangle(Vec3::ZERO, [1.2 * Vec3::X, 1.2 * Vec3::new(0.0, cos, sin)]);
        for splatting in [Splatting::TwoPass, Splatting::Opaque] {
            let packet = surfels(&cloud, &camera_at(2.0), lit(Lighting::BlinnPhong, splatting), SIZE);
            for ([without, with], by) in without_and_with(&packet) {
                let (_, max) = common::difference(&without, &with);
                assert!(max <= 1, "{degrees} degrees, {splatting}, {by}: {max}");
            }
        }
    }
}

/// As points face the screen, they are before and behind the plane that they are of.
#[test]
fn points_on_a_plane_do_not_shadow_each_other() {
    for degrees in [-60.0, -30.0, 0.0, 30.0, 60.0f32] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let cloud = rectangle(Vec3::ZERO, [1.2 * Vec3::X, 1.2 * Vec3::new(0.0, cos, sin)]);
        for &shape in PointShape::ALL {
            let packet = surfels(&cloud, &camera_at(2.0), lit_points(shape), SIZE);
            for ([without, with], by) in without_and_with(&packet) {
                let (_, max) = common::difference(&without, &with);
                assert!(max <= 1, "{degrees} degrees, {shape}, {by}: {max}");
            }
        }
    }
}

/// Unlit points receive no shadow; points of any size cast the shadows of their surfels.
#[test]
fn the_pixel_size_of_points_does_not_affect_shadows() {
    let of_size = |size_px| {
        let style = lit_points(PointShape::Square).with(|style| {
            style.points.sizing = PointSizing::Pixels;
            style.points.size_px = size_px;
        });
        draw_on_cpu(&box_of_surfels(style))
    };
    let without_shadow = draw_on_cpu(&{
        let mut packet = box_of_surfels(lit_points(PointShape::Square));
        packet.style.light.shadows = OnOff::Off;
        packet
    });
    let dark = |picture: &RgbaImage| {
        let pairs = picture.pixels().zip(without_shadow.pixels());
        pairs
            .filter(|(a, b)| b.0[2] > 0 && a.0[2] > 0 && a.0[2].saturating_add(40) < b.0[2])
            .count()
    };
    let [small, large] = [5.0, 9.0].map(|size_px| dark(&of_size(size_px)));
    assert!(small > 300 && small.abs_diff(large) < small / 4, "{small} {large}");
}

#[test]
fn lights_without_a_far_key_light_cast_none() {
    for rig in [LightRig::Head, LightRig::Paper] {
        let style = lit(Lighting::Lambert, Splatting::TwoPass).with(|style| style.light.rig = rig);
        for ([without, with], by) in without_and_with(&box_of_surfels(style)) {
            assert!(without == with, "{rig}, {by}");
        }
    }
}

/// Zooming and panning leave the lamp where it is in the cloud; turning does not.
#[test]
fn the_shadow_map_is_redrawn_when_the_light_or_the_cloud_changes() {
    let mut renderer = GpuRenderer::new(context()).unwrap();
    let mut packet = box_of_surfels(lit(Lighting::Lambert, Splatting::TwoPass));
    let mut passes = |packet: &ScenePacket| {
        let before = renderer.stats().passes;
        draw_with(&mut renderer, packet);
        renderer.stats().passes - before
    };
    let first = passes(&packet);
    let mut nearer = camera();
    nearer.zoom(0.8);
    nearer.pan_px(5.0, 3.0, f64::from(SIZE[1]));
    packet.view = nearer.transform(DVec3::ZERO, SIZE);
    assert_eq!(passes(&packet), first - 1);
    nearer.orbit(20.0, 0.0);
    packet.view = nearer.transform(DVec3::ZERO, SIZE);
    assert_eq!(passes(&packet), first);
    if let Content::Surfels(surfels) = &mut packet.content {
        surfels.points = std::sync::Arc::new(surfels.points.to_vec());
    }
    assert_eq!(passes(&packet), first);
}

#[test]
fn every_strategy_casts_the_same_shadows() {
    for packet in [
        box_of_surfels(lit(Lighting::Lambert, Splatting::TwoPass)),
        box_of_cells(lit(Lighting::Lambert, Splatting::TwoPass)),
    ] {
        let pictures = Strategy::ALL.iter().map(|&strategy| {
            let mut packet = packet.clone();
            packet.style.drawing.strategy = strategy;
            draw(&packet)
        });
        let pictures: Vec<RgbaImage> = pictures.collect();
        assert!(
            pictures.windows(2).all(|pair| pair[0] == pair[1]),
            "{}",
            packet.style.primitive
        );
    }
}
