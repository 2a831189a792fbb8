//! Orthographic images of both renderers against parallel rays in f64.

use crate::common::{self, Surfel, draw, draw_on_cpu, surfels};
use glam::{DVec2, DVec3, Vec3};
use pointreel::cloud::PointRecord;
use pointreel::math::Aabb;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::scene::{
    Background, Camera, Content, Lighting, PacketParams, Primitive, Projection, ScenePacket, Style, UpAxis,
};
use std::sync::Arc;

const SIZE: [u32; 2] = [1280, 720];

/// As far from zero as the surface of the earth is from its centre.
const ECEF: DVec3 = DVec3::new(4_510_720.0, -3_911_168.0, 2_207_744.0);

fn style(primitive: Primitive) -> Style {
    Style::default().with(|style| {
        style.primitive = primitive;
        style.points.size_px = 1.0;
        style.light.lighting = Lighting::Unlit;
        style.backdrop.background = Background::solid([0; 3]);
    })
}

fn camera_around(bounds: &Aabb, origin: DVec3) -> Camera {
    let mut camera = Camera {
        azimuth_deg: 37.0,
        elevation_deg: 24.0,
        projection: Projection::Orthographic,
        ..Camera::framing(bounds, origin, UpAxis::Z)
    };
    camera.frame_bounds(bounds, origin);
    camera
}

fn packet_of(points: Vec<PointRecord>, camera: &Camera, origin: DVec3) -> ScenePacket {
    let positions: Vec<Vec3> = points.iter().map(|point| Vec3::from_array(point.position)).collect();
    ScenePacket {
        viewport_px: SIZE,
        view: camera.transform(origin, SIZE),
        style: style(Primitive::Point).painted(),
        content: Content::Points(Arc::new(points)),
        ground: None,
        posed_images: None,
        params: PacketParams::default(),
        bounds: Aabb::from_points(&positions),
    }
}

/// The pixel of a position under parallel rays, by definition: the plane through the target is as large as perspective
/// shows it.
fn parallel_px(camera: &Camera, place: DVec3) -> DVec2 {
    let [azimuth, elevation] = [camera.azimuth_deg, camera.elevation_deg].map(f64::to_radians);
    // With Z up, seen from -Y at an azimuth of 0.
    let right = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
    let back = DVec3::new(
        azimuth.sin() * elevation.cos(),
        -azimuth.cos() * elevation.cos(),
        elevation.sin(),
    );
    let up = back.cross(right);
    let offset = place - camera.target_in_world;
    let half_height = camera.distance * (0.5 * camera.fov_deg).to_radians().tan();
    let px_per_unit = 0.5 * f64::from(SIZE[1]) / half_height;
    let center = 0.5 * DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
    center + px_per_unit * DVec2::new(offset.dot(right), -offset.dot(up))
}

/// Evenly within and on the unit sphere.
fn ball(count: usize) -> Vec<Vec3> {
    let golden = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let place = |index: usize| {
        let z = 1.0 - 2.0 * (index as f32 + 0.5) / count as f32;
        let turn = golden * index as f32;
        let radius = (1.0 - z * z).sqrt();
        // A fifth of them at each of several depths below the surface.
        let part = 1.0 - 0.2 * (index % 5) as f32;
        part * Vec3::new(radius * turn.cos(), radius * turn.sin(), z)
    };
    (0..count).map(place).collect()
}

fn numbered(places: &[Vec3]) -> Vec<PointRecord> {
    let records = places.iter().enumerate().map(|(index, place)| {
        let [blue, green, red, _] = (index as u32 + 1).to_le_bytes();
        PointRecord {
            position: place.to_array(),
            color: [red, green, blue, 255],
        }
    });
    records.collect()
}

fn number_of(pixel: image::Rgba<u8>) -> Option<usize> {
    let [red, green, blue, _] = pixel.0;
    (u32::from_le_bytes([blue, green, red, 0]) as usize).checked_sub(1)
}

#[test]
fn points_are_within_half_a_pixel_of_their_parallel_projection() {
    let places = ball(4_000);
    let bounds = Aabb::from_points(&places);
    for origin in [DVec3::ZERO, ECEF] {
        let camera = camera_around(&bounds, origin);
        let packet = packet_of(numbered(&places), &camera, origin);
        for (by, image) in [("CPU", draw_on_cpu(&packet)), ("GPU", draw(&packet))] {
            let (mut largest, mut seen) = (0f64, 0);
            for (x, y, &pixel) in image.enumerate_pixels() {
                let Some(index) = number_of(pixel) else {
                    continue;
                };
                let expected = parallel_px(&camera, origin + places[index].as_dvec3());
                let corner = DVec2::new(f64::from(x), f64::from(y));
                // Distance to the square of the pixel.
                let inside = expected.clamp(corner, corner + 1.0);
                largest = largest.max(expected.distance(inside));
                seen += 1;
            }
            // Points of several shells fall on one pixel.
            assert!(seen > 3_700, "{by}: {seen} points are seen");
            assert!(largest < 0.5, "{by}: {largest} px");
        }
    }
}

#[test]
fn nearer_points_hide_farther_ones() {
    let bounds = Aabb {
        min: Vec3::splat(-0.6),
        max: Vec3::splat(0.6),
    };
    let camera = camera_around(&bounds, ECEF);
    let eye = (camera.eye_in_world() - ECEF).normalize();
    // Pairs whose second point is a thousandth of the sphere's radius behind the first.
    let firsts: Vec<DVec3> = ball(300).iter().map(|place| 0.9 * place.as_dvec3()).collect();
    let mut places = Vec::new();
    for (index, &first) in firsts.iter().enumerate() {
        let pair = [first, first - 1e-3 * f64::from(bounds.radius()) * eye];
        let order = if index.is_multiple_of(2) { [0, 1] } else { [1, 0] };
        places.extend(order.map(|which| pair[which].as_vec3()));
    }
    let is_front = |index: usize| (index / 2 + index).is_multiple_of(2);
    let packet = packet_of(numbered(&places), &camera, ECEF);
    for (by, image) in [("CPU", draw_on_cpu(&packet)), ("GPU", draw(&packet))] {
        let mut fronts = 0;
        for (x, y, &pixel) in image.enumerate_pixels() {
            let Some(index) = number_of(pixel) else {
                continue;
            };
            // On the border of two pixels both may be visible.
            let place = parallel_px(&camera, ECEF + places[index].as_dvec3());
            let from_border = (place.fract() - 0.5).abs().max_element();
            assert!(is_front(index) || from_border > 0.25, "{by}: {x} {y}");
            fronts += usize::from(is_front(index));
        }
        assert!(fronts > 280, "{by}: {fronts}");
    }
}

#[test]
fn surfels_are_drawn_identically_wherever_they_are() {
    let mut scene: Vec<Surfel> = common::sphere(3_000, 1.0);
    let positions: Vec<Vec3> = scene.iter().map(|surfel| surfel.position).collect();
    let camera = camera_around(&Aabb::from_points(&positions), DVec3::ZERO);
    for surfel in &mut scene {
        surfel.color = [200; 3];
    }
    let packet = surfels(&scene, &camera, style(Primitive::Surfel), SIZE);
    let [cpu, gpu] = [draw_on_cpu(&packet), draw(&packet)];
    let psnr = psnr_db(mean_squared_error(&cpu, &gpu).unwrap());
    assert!(psnr > 45.0, "{psnr} dB");
    // A sphere that fills the height except for a twentieth.
    let radius_px = 0.95 * 0.5 * f64::from(SIZE[1]) / 3f64.sqrt();
    let covered = common::covered(&cpu, [0; 3]) as f64;
    let disk = std::f64::consts::PI * radius_px * radius_px;
    assert!((covered / disk - 1.0).abs() < 0.05, "{covered} of {disk}");

    // Two surfels facing the eye, one far in front of the other: the same number of pixels each.
    let back = (camera.eye_in_world().normalize()).as_vec3();
    let aside = back.any_orthonormal_vector();
    let surfel = |place: Vec3, color| Surfel {
        position: place,
        normal: back,
        radius: 0.2,
        color,
    };
    let pair = [
        surfel(back * 0.9 + aside * 0.4, [255, 0, 0]),
        surfel(-back * 0.9 - aside * 0.4, [0, 255, 0]),
    ];
    let packet = surfels(&pair, &camera, style(Primitive::Surfel), SIZE);
    for image in [draw_on_cpu(&packet), draw(&packet)] {
        let count = |channel: usize| {
            let pixels = image.pixels();
            pixels.filter(|pixel| pixel.0[channel] > 100).count() as f64
        };
        let ratio = count(0) / count(1);
        assert!(count(1) > 1_000.0 && (ratio - 1.0).abs() < 0.02, "{ratio}");
    }
}
