//! Ambient occlusion of constructed surfaces, by both renderers: the expected shading of planes, corners and steps.

use crate::common::{self, Surfel, camera_at, draw, draw_on_cpu, plain, surfels};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::math::Aabb;
use pointreel::scene::{
    AmbientOcclusion, BackFaces, Camera, Lighting, OnOff, Projection, ScenePacket, Splatting, Style,
};

/// Odd, so that the centre of a pixel is on the axis of the view.
const EDGE_PX: u32 = 241;

/// The radius of balls in these scenes.
const RADIUS: f32 = 1.0;

fn style(lighting: Lighting, splatting: Splatting) -> Style {
    plain().with(|style| {
        style.light.lighting = lighting;
        style.light.ao = OnOff::On;
        style.surfels.splatting = splatting;
        style.surfels.back_faces = BackFaces::Drawn;
    })
}

/// The scene with ambient occlusion, whose balls have the radius above.
fn packet_of(cloud: &[Surfel], camera: &Camera, style: Style) -> ScenePacket {
    let mut packet = surfels(cloud, camera, style, [EDGE_PX; 2]);
    let radius = |packet: &ScenePacket| {
        let occlusion = AmbientOcclusion::of(packet).unwrap();
        occlusion.near_radius_px * packet.view.near / packet.view.pixels_per_unit_at_1
    };
    let half = packet.bounds.radius() / (3f32.sqrt() * radius(&packet)) * RADIUS;
    packet.bounds = Aabb::from_points(&[Vec3::splat(-half), Vec3::splat(half)]);
    assert!((radius(&packet) - RADIUS).abs() < 1e-4);
    packet
}

/// Images without ambient occlusion and with it, by each renderer.
fn without_and_with(packet: &ScenePacket) -> [([RgbaImage; 2], &'static str); 2] {
    let mut without = packet.clone();
    without.style.light.ao = OnOff::Off;
    [
        ([draw_on_cpu(&without), draw_on_cpu(packet)], "processor"),
        ([draw(&without), draw(packet)], "GPU"),
    ]
}

/// White disks `0.06` apart on a plane through the origin, from -`half` to `half` along two directions.
fn plane(along: [Vec3; 2], half: f32) -> Vec<Surfel> {
    let normal = along[0].cross(along[1]).normalize();
    let steps = (half / 0.06) as i32;
    let places = (-steps..=steps).flat_map(|i| (-steps..=steps).map(move |j| [i, j].map(|step| 0.06 * step as f32)));
    let surfel = |[i, j]: [f32; 2]| Surfel {
        position: i * along[0] + j * along[1],
        normal,
        radius: 0.06,
        color: [255; 3],
    };
    places.map(surfel).collect()
}

/// Two walls at a right angle, that meet in the y axis and open towards +z.
fn corner() -> Vec<Surfel> {
    let right = Vec3::new(1.0, 0.0, 1.0).normalize();
    let left = Vec3::new(-1.0, 0.0, 1.0).normalize();
    let of_wall = |along: Vec3, other: Vec3| {
        let wall = plane([Vec3::Y, along], 4.0).into_iter();
        let half = wall.filter(move |surfel| surfel.position.dot(along) >= -1e-3);
        half.map(move |surfel| Surfel {
            normal: other,
            ..surfel
        })
    };
    of_wall(right, left).chain(of_wall(left, right)).collect()
}

fn linear(byte: u8) -> f32 {
    let channel = f32::from(byte) / 255.0;
    if channel <= 0.04045 {
        channel / 12.92
    } else {
        ((channel + 0.055) / 1.055).powf(2.4)
    }
}

#[test]
fn planes_are_not_darkened() {
    let slopes = [0.0, 20.0, 45.0, 70.0f32];
    for (&splatting, projection) in [
        (&Splatting::Opaque, Projection::Perspective),
        (&Splatting::TwoPassEnlarged, Projection::Perspective),
        (&Splatting::TwoPass, Projection::Orthographic),
    ] {
        for degrees in slopes {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let cloud = plane([Vec3::new(0.8, 0.6, 0.0), Vec3::new(-0.6 * cos, 0.8 * cos, sin)], 3.0);
            let camera = Camera {
                projection,
                ..camera_at(4.0)
            };
            let packet = packet_of(&cloud, &camera, style(Lighting::Lambert, splatting));
            for ([without, with], by) in without_and_with(&packet) {
                let (_, max) = common::difference(&without, &with);
                assert!(max <= 1, "{splatting}, {projection:?}, {degrees} degrees, {by}: {max}");
            }
        }
    }
}

/// For a ball whose centre is on a wall at `distance` radii from the other one: the fraction of the half before the
/// wall that is behind the other one, a half of a cap of the ball.
fn hidden_in_corner(distance: f32) -> f32 {
    let beyond = (1.0 - distance).max(0.0);
    beyond * beyond * (2.0 + distance) / 4.0
}

/// The fraction of light that is left in the central row of pixels, with the distance from the y axis of the position
/// on the right wall that each shows.
fn light_along_corner(pictures: &[RgbaImage; 2], packet: &ScenePacket) -> Vec<(f32, f32)> {
    let view = &packet.view;
    let center = EDGE_PX / 2;
    let seen = |x: u32| {
        let ndc = (2.0 * x as f32 + 1.0) / EDGE_PX as f32 - 1.0;
        let ray = view.view_from_frame_rotation.transpose() * Vec3::new(ndc / view.focal[0], 0.0, -1.0);
        let wall = Vec3::new(1.0, 0.0, -1.0).normalize();
        let eye = view.eye_high + view.eye_low;
        let place = eye - ray * (eye.dot(wall) / ray.dot(wall));
        let [without, with] = pictures
            .each_ref()
            .map(|picture| linear(picture.get_pixel(x, center).0[0]));
        (place.dot(Vec3::new(1.0, 0.0, 1.0).normalize()), with / without)
    };
    let all = (center..EDGE_PX).map(seen);
    all.filter(|(distance, _)| (0.0..2.5).contains(distance)).collect()
}

/// From any distance and side, in both projections. 24 lines of whole pixels measure the ball to a few parts in a
/// hundred of its volume.
#[test]
fn a_corner_is_as_dark_as_the_volume_behind_its_walls() {
    let views = [
        (4.0, 0.0, 0.0, Projection::Perspective),
        (8.0, 0.0, 0.0, Projection::Perspective),
        (6.0, -15.0, 0.0, Projection::Perspective),
        (6.0, 20.0, 0.0, Projection::Perspective),
        (6.0, 0.0, 0.0, Projection::Orthographic),
    ];
    let cloud = corner();
    for (distance, azimuth_deg, elevation_deg, projection) in views {
        let camera = Camera {
            azimuth_deg,
            elevation_deg,
            projection,
            ..camera_at(distance)
        };
        let packet = packet_of(&cloud, &camera, style(Lighting::Lambert, Splatting::Opaque));
        for (pictures, by) in without_and_with(&packet) {
            let light = light_along_corner(&pictures, &packet);
            assert!(light.len() > 20, "{}", light.len());
            for (place, left) in light {
                // Disks of the other wall extend beyond its edge.
                if place < 0.1 {
                    continue;
                }
                let expected = 1.0 - hidden_in_corner(place / RADIUS);
                assert!(
                    (left - expected).abs() < 0.04,
                    "from {distance}, {azimuth_deg} degrees, {projection:?}, {by}: {left} at {place}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn objects_far_in_front_of_a_plane_do_not_darken_it() {
    let mut cloud = plane([Vec3::X, Vec3::Y], 3.0);
    let sheet = plane([Vec3::X, Vec3::Y], 1.0).into_iter();
    cloud.extend(sheet.map(|surfel| Surfel {
        position: surfel.position + 3.5 * Vec3::Z,
        ..surfel
    }));
    let packet = packet_of(&cloud, &camera_at(8.0), style(Lighting::Lambert, Splatting::Opaque));
    for ([without, with], by) in without_and_with(&packet) {
        let (_, max) = common::difference(&without, &with);
        assert!(max <= 1, "{by}: {max}");
    }
}

#[test]
fn highlights_and_the_background_are_not_darkened() {
    let mut cloud = corner();
    for surfel in &mut cloud {
        surfel.color = [0; 3];
    }
    let style = style(Lighting::BlinnPhong, Splatting::TwoPass);
    let camera = Camera {
        target_in_world: DVec3::new(0.0, 3.0, 0.0),
        ..camera_at(6.0)
    };
    let packet = packet_of(&cloud, &camera, style);
    for ([without, with], by) in without_and_with(&packet) {
        assert!(with == without, "{by}");
        let shining = with.pixels().filter(|pixel| pixel.0[0] > 20).count();
        assert!(shining > 100, "{by}: {shining} pixels shine");
    }
}

#[test]
fn strength_scales_the_occluded_light() {
    let cloud = corner();
    let light_with = |strength: f32| {
        let mut style = style(Lighting::Lambert, Splatting::Opaque);
        style.light.ao_strength = strength;
        let packet = packet_of(&cloud, &camera_at(6.0), style);
        without_and_with(&packet).map(|(pictures, _)| light_along_corner(&pictures, &packet))
    };
    for (half, whole) in light_with(0.5).into_iter().zip(light_with(1.0)) {
        for ((place, half), (_, whole)) in half.into_iter().zip(whole) {
            assert!(
                (2.0 * (1.0 - half) - (1.0 - whole)).abs() < 0.03,
                "{place}: {half} {whole}"
            );
        }
    }
}
