//! Points of every size and shape, by both renderers: cases with known answers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use common::{Surfel, camera_at, covered, draw, plain, surfels};
use glam::Vec3;
use image::RgbaImage;
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{PointShape, PointSizing, Primitive, ScenePacket, Style};

const SIZE: [u32; 2] = [200, 160];
const BLACK: [u8; 3] = [0, 0, 0];

fn points(change: impl FnOnce(&mut Style)) -> Style {
    plain().with(|style| {
        style.primitive = Primitive::Point;
        change(style);
    })
}

fn point(position: Vec3, radius: f32) -> Surfel {
    Surfel {
        position,
        normal: Vec3::Z,
        radius,
        color: [255; 3],
    }
}

/// The same packet as the processor and as the GPU draws it.
fn drawn_by_both(packet: &ScenePacket) -> [RgbaImage; 2] {
    let mut processor = CpuRenderer::new();
    processor.prepare(packet).unwrap();
    processor.render().unwrap();
    [processor.read_image().unwrap(), draw(packet)]
}

/// 90 degrees are 160 pixels high: a length at a distance is 80 times as many pixels as it is of the distance.
#[test]
fn a_point_of_the_scene_is_as_large_as_its_length_is_at_its_distance() {
    for (sizing, spacing, radius) in [
        (PointSizing::Projected, 0.25 / 2f32.sqrt(), 9.0),
        (PointSizing::Adaptive, 9.0, 0.125),
    ] {
        for (distance, edge_px) in [(1.0, 20), (2.0, 10), (5.0, 4), (10.0, 2)] {
            let style = points(|style| {
                style.points.sizing = sizing;
                style.of_sequence.point_spacing = spacing;
            });
            // No corner is in the middle of a pixel.
            let place = Vec3::new(0.003, 0.003, 0.0) * distance;
            let packet = surfels(&[point(place, radius)], &camera_at(f64::from(distance)), style, SIZE);
            for image in drawn_by_both(&packet) {
                assert_eq!(covered(&image, BLACK), edge_px * edge_px, "{sizing} {distance}");
            }
            let double = packet.style.with(|style| style.points.scale = 2.0);
            let packet = ScenePacket {
                style: double,
                ..packet
            };
            for image in drawn_by_both(&packet) {
                assert_eq!(
                    covered(&image, BLACK),
                    4 * edge_px * edge_px,
                    "{sizing} {distance}, twice as large"
                );
            }
        }
    }
}

#[test]
fn no_point_vanishes_however_far_it_is() {
    let places: Vec<Surfel> = (0..1000)
        .map(|index| {
            let (column, row) = ((index % 40) as f32, (index / 40) as f32);
            // Five pixels apart, and at another place in each.
            let x_px = 5.0 * column + 1.5 + (0.618 * index as f32).fract();
            let y_px = 5.0 * row + 1.5 + (0.414 * index as f32).fract();
            let distance = 1e4 * (1.0 + (index % 7) as f32);
            let slope = Vec3::new((x_px - 100.0) / 80.0, (80.0 - y_px) / 80.0, -1.0);
            point(slope * distance, 0.01)
        })
        .collect();
    for sizing in [PointSizing::Projected, PointSizing::Adaptive] {
        for &shape in PointShape::ALL {
            let style = points(|style| {
                style.points.sizing = sizing;
                style.points.shape = shape;
                style.of_sequence.point_spacing = 0.01;
            });
            // The eye is in the origin.
            let mut packet = surfels(&places, &camera_at(1.0), style, SIZE);
            packet.view.eye_high = [0.0; 3].into();
            packet.view.eye_low = [0.0; 3].into();
            for image in drawn_by_both(&packet) {
                for (index, (column, row)) in (0..1000).map(|index| (index, (index % 40, index / 40))) {
                    let cell = (0..25).map(|px| image.get_pixel(5 * column + px % 5, 5 * row + px / 5));
                    let shown = cell.filter(|pixel| pixel.0[0] > 128).count();
                    assert!(
                        (1..=4).contains(&shown),
                        "{sizing} {shape}, point {index}: {shown} pixels"
                    );
                }
            }
        }
    }
}
