//! Points of every size and shape, by both renderers: cases with known answers.

use crate::common::{Surfel, camera_at, covered, draw, plain, sphere, surfels};
use glam::Vec3;
use image::{Rgba, RgbaImage};
use pointreel::levels::Lod;
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{
    Background, Camera, Content, Lighting, OnOff, PointLight, PointShape, PointSizing, Primitive, Scene, ScenePacket,
    Splatting, Style, UpAxis,
};
use pointreel::sequence::{Needs, PrepareCounters, Sequence, prepare};
use std::sync::Arc;

const SIZE: [u32; 2] = [200, 160];
const BLACK: [u8; 3] = [0, 0, 0];

fn points(change: impl FnOnce(&mut Style)) -> Style {
    plain().with(|style| {
        style.primitive = Primitive::Point;
        change(style);
    })
}

/// From afar, small cells of the octree are one point each, of the cell's size.
#[test]
fn adaptive_points_of_levels_of_detail_are_fewer_and_leave_no_hole() {
    let sequence = Sequence::demo();
    let whole = points(|style| {
        style.points.sizing = PointSizing::Adaptive;
        style.points.shape = PointShape::Disk;
    });
    let coarse = whole.with(|style| {
        style.levels.surfel_lod = true;
        style.levels.lod = Lod::ThresholdPx(4.0);
    });
    let cloud = Arc::new(sequence.frame(0).unwrap());
    let packets = [whole, coarse].map(|style| {
        let needs = Scene::needs(&style);
        let frame = prepare(0, Arc::clone(&cloud), 0.0, &needs, &PrepareCounters::default());
        let camera = Camera::framing(&frame.frame.bounds(), sequence.origin(), UpAxis::Y);
        Scene::default().packet(&frame, sequence.origin(), &camera, &style, SIZE)
    });
    let [all, some] = packets.each_ref().map(|packet| packet.content.record_count());
    assert!(10 * some < 9 * all && some > 100, "{some} of {all}");
    let [of_all, of_some] = packets.each_ref().map(drawn_by_both);
    for (of_all, of_some) in of_all.iter().zip(&of_some) {
        let pairs = of_all.pixels().zip(of_some.pixels());
        let is_hole = |(all, some): &(&Rgba<u8>, &Rgba<u8>)| all.0[..3] != BLACK && some.0[..3] == BLACK;
        let holes = pairs.filter(is_hole).count();
        assert_eq!(holes, 0, "of {}", covered(of_all, BLACK));
    }
    // When sized in pixels, all points are drawn, whatever the surfel settings.
    let in_pixels = coarse.with(|style| style.points.sizing = PointSizing::Pixels);
    assert_eq!(in_pixels.levels_kind(), None);
}

/// While a frame has no radii yet, points are as far apart as most.
#[test]
fn adaptive_points_without_radii_are_sized_like_projected_ones() {
    let sequence = Sequence::demo();
    let cloud = Arc::new(sequence.frame(0).unwrap());
    let frame = prepare(0, cloud, 0.0, &Needs::default(), &PrepareCounters::default());
    assert!(frame.shapes.is_none());
    let camera = Camera::framing(&frame.frame.bounds(), sequence.origin(), UpAxis::Y);
    let [adaptive, projected] = [PointSizing::Adaptive, PointSizing::Projected].map(|sizing| {
        let style = points(|style| style.points.sizing = sizing);
        let packet = Scene::default().packet(&frame, sequence.origin(), &camera, &style, SIZE);
        assert!(matches!(packet.content, Content::Points(_)) && packet.params.point_spacing > 0.0);
        drawn_by_both(&packet)
    });
    assert!(adaptive == projected && covered(&adaptive[0], BLACK) > 1_000);
}

fn point(position: Vec3, radius: f32) -> Surfel {
    Surfel {
        position,
        normal: Vec3::Z,
        radius,
        color: [255; 3],
    }
}

/// Images of a packet by the CPU and by the GPU.
fn drawn_by_both(packet: &ScenePacket) -> [RgbaImage; 2] {
    let mut processor = CpuRenderer::new();
    processor.prepare(packet).unwrap();
    processor.render().unwrap();
    [processor.read_image().unwrap(), draw(packet)]
}

/// 90 degrees are 160 pixels high: a length at a distance is 80 times as many pixels as it is of the distance.
#[test]
fn a_scene_sized_point_is_as_large_as_its_projected_length() {
    for (sizing, spacing, radius) in [
        (PointSizing::Projected, 0.25 / 2f32.sqrt(), 9.0),
        (PointSizing::Adaptive, 9.0, 0.125),
    ] {
        for (distance, edge_px) in [(1.0, 20), (2.0, 10), (5.0, 4), (10.0, 2)] {
            let style = points(|style| style.points.sizing = sizing);
            // No corner is at a pixel centre.
            let place = Vec3::new(0.003, 0.003, 0.0) * distance;
            let mut packet = surfels(&[point(place, radius)], &camera_at(f64::from(distance)), style, SIZE);
            packet.params.point_spacing = spacing;
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
fn no_point_vanishes_at_any_distance() {
    let places: Vec<Surfel> = (0..1000)
        .map(|index| {
            let (column, row) = ((index % 40) as f32, (index / 40) as f32);
            // Five pixels apart, and at a different position within each pixel.
            let x_px = 5.0 * column + 1.5 + (0.618 * index as f32).fract();
            let y_px = 5.0 * row + 1.5 + (0.414 * index as f32).fract();
            let distance = 1e4 * (1.0 + (index % 7) as f32);
            let slope = Vec3::new((x_px - 100.0) / 80.0, (80.0 - y_px) / 80.0, -1.0);
            point(slope * distance, 0.01)
        })
        .collect();
    let lights = [PointLight::None, PointLight::Normals];
    for (&sizing, light) in PointSizing::ALL
        .iter()
        .flat_map(|sizing| lights.map(|light| (sizing, light)))
    {
        for &shape in PointShape::ALL {
            let style = points(|style| {
                style.points.sizing = sizing;
                style.points.size_px = 1.0;
                style.points.shape = shape;
                style.points.light = light;
                style.light.lighting = Lighting::Lambert;
            });
            // The eye is at the origin.
            let mut packet = surfels(&places, &camera_at(1.0), style, SIZE);
            packet.params.point_spacing = 0.01;
            packet.view.eye_high = [0.0; 3].into();
            packet.view.eye_low = [0.0; 3].into();
            for image in drawn_by_both(&packet) {
                for (index, (column, row)) in (0..1000).map(|index| (index, (index % 40, index / 40))) {
                    let cell = (0..25).map(|px| image.get_pixel(5 * column + px % 5, 5 * row + px / 5));
                    let shown = cell.filter(|pixel| pixel.0[0] > 128).count();
                    assert!(
                        (1..=4).contains(&shown),
                        "{sizing} {shape} {light}, point {index}: {shown} pixels"
                    );
                }
            }
        }
    }
}

/// Adaptive points are disks that face the screen, as large as surfels are: where surfels do so by themselves the image
/// is the same, in any light.
#[test]
fn adaptive_points_are_surfels_that_face_the_screen() {
    let mut cloud = sphere(700, 1.0);
    for surfel in &mut cloud {
        surfel.normal = Vec3::Z;
    }
    for (shape, splatting) in [
        (PointShape::Disk, Splatting::Opaque),
        (PointShape::Gaussian, Splatting::TwoPass),
    ] {
        for &lighting in Lighting::ALL {
            let as_points = points(|style| {
                style.points.sizing = PointSizing::Adaptive;
                style.points.shape = shape;
                style.points.light = PointLight::Normals;
                style.surfels.splatting = splatting;
                style.surfels.rims = OnOff::Off;
                crate::common::set_lighting(style, lighting);
            });
            let as_surfels = as_points.with(|style| style.primitive = Primitive::Surfel);
            // The background shines through the soft edges of surfels only.
            let on_white = as_surfels.with(|style| style.backdrop.background = Background::solid([255; 3]));
            let [of_points, of_surfels, of_surfels_on_white] = [as_points, as_surfels, on_white]
                .map(|style| drawn_by_both(&surfels(&cloud, &camera_at(2.0), style, SIZE)));
            for by in 0..2 {
                let pixels = of_points[by].pixels().zip(of_surfels[by].pixels());
                let pixels = pixels.zip(of_surfels_on_white[by].pixels());
                let opaque = pixels.filter(|((_, on_black), on_white)| on_black == on_white);
                let steps: Vec<u8> = opaque.map(|((point, surfel), _)| step(*point, *surfel)).collect();
                assert!(steps.len() > 4_000, "{shape} {lighting}: {}", steps.len());
                // On edges, corners computed in a different order may be rounded to another pixel.
                let jumps = steps.iter().filter(|&&step| step > 2).count();
                assert!(jumps <= 3, "{shape} {lighting}: {jumps} of {} differ", steps.len());
            }
        }
    }
}

fn step(a: Rgba<u8>, b: Rgba<u8>) -> u8 {
    let steps = a.0.iter().zip(b.0).map(|(a, b)| a.abs_diff(b));
    steps.max().unwrap_or(0)
}

/// As points that face the screen stand behind one another on slopes, their edges are opaque.
#[test]
fn no_background_shines_through_gaussian_points() {
    let style = points(|style| {
        style.points.sizing = PointSizing::Adaptive;
        style.points.shape = PointShape::Gaussian;
    });
    let on_white = style.with(|style| style.backdrop.background = Background::solid([255; 3]));
    let cloud = sphere(1500, 1.0);
    let [on_black, on_white] =
        [style, on_white].map(|style| drawn_by_both(&surfels(&cloud, &camera_at(2.0), style, SIZE)));
    for (on_black, on_white) in on_black.iter().zip(&on_white) {
        for (x, y, pixel) in on_black.enumerate_pixels() {
            let other = on_white.get_pixel(x, y);
            let is_background = pixel.0[..3] == BLACK && other.0[..3] == [255; 3];
            assert!(
                is_background || step(*pixel, *other) <= 1,
                "{x} {y}: {pixel:?} {other:?}"
            );
        }
    }
}

/// Two of them that overlap in depth, seen from the side at which either is in front.
#[test]
fn gaussian_points_blend_and_others_do_not() {
    let mut pair = [
        point(Vec3::new(-0.1, 0.0, 0.05), 0.5),
        point(Vec3::new(0.1, 0.0, 0.0), 0.5),
    ];
    pair[0].color = [250, 0, 0];
    pair[1].color = [0, 250, 0];
    for &shape in PointShape::ALL {
        let style = points(|style| {
            style.points.sizing = PointSizing::Adaptive;
            style.points.shape = shape;
        });
        for image in drawn_by_both(&surfels(&pair, &camera_at(2.0), style, SIZE)) {
            let [red, green, _, _] = image.get_pixel(SIZE[0] / 2, SIZE[1] / 2).0;
            if shape == PointShape::Gaussian {
                // Equally far from the centres of both, as nearly as perspective permits.
                assert!(
                    red.abs_diff(125) < 12 && red.abs_diff(250 - green) <= 1,
                    "{red} {green}"
                );
            } else {
                assert_eq!([red, green], [250, 0], "{shape}");
            }
        }
    }
}

#[test]
fn points_without_normals_are_drawn_as_without_light() {
    let cloud = sphere(700, 1.0);
    for &shape in PointShape::ALL {
        let unlit = points(|style| style.points.shape = shape);
        let lit = unlit.with(|style| {
            style.points.light = PointLight::Normals;
            style.light.lighting = Lighting::BlinnPhong;
        });
        let expected = surfels(&cloud, &camera_at(2.0), unlit, SIZE);
        let packet = ScenePacket {
            style: lit.painted(),
            ..expected.clone()
        };
        assert!(matches!(packet.content, Content::Points(_)));
        assert!(drawn_by_both(&packet) == drawn_by_both(&expected), "{shape}");
    }
}

#[test]
fn depths_of_blended_points_match_their_disks() {
    let style = points(|style| {
        style.points.sizing = PointSizing::Adaptive;
        style.points.shape = PointShape::Gaussian;
        style.points.light = PointLight::Normals;
        style.light.lighting = Lighting::Lambert;
    });
    let camera = Camera {
        azimuth_deg: 30.0,
        ..camera_at(4.0)
    };
    let packet = surfels(&[point(Vec3::ZERO, 1.0)], &camera, style, SIZE);
    let mut renderer = CpuRenderer::new();
    renderer.prepare(&packet).unwrap();
    let depths = renderer.draw_depths().unwrap();
    let shown = |x: u32, y: u32| (f64::from(x) - 99.5).hypot(f64::from(y) - 79.5) <= 20.0;
    for (place, depth) in (0..).zip(depths.depth) {
        let expected = if shown(place % SIZE[0], place / SIZE[0]) {
            4.0
        } else {
            f32::INFINITY
        };
        assert!((depth - expected).abs() < 1e-4 || depth == expected, "{place}: {depth}");
    }
}
