//! Surfels with normals of the screen: without any estimation before, drawn as others are, by both renderers.

use crate::common::{camera_at, draw, draw_on_cpu};
use glam::{DVec3, Vec3};
use pointreel::cloud::{Frame, Positions, RawCloud, oct_decode};
use pointreel::scene::{
    BackFaces, Background, Clip, ClipShape, Content, Environment, LightRig, Lighting, NormalSource, Primitive, Scene,
    ScenePacket, Style, SurfelColors, pick,
};
use pointreel::sequence::{ColorSource, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use std::sync::Arc;

const SIZE: [u32; 2] = [320, 240];

fn style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Surfel;
        style.colors.source = ColorSource::Uniform;
        style.surfels.normals = NormalSource::Screen;
        style.surfels.back_faces = BackFaces::Drawn;
        style.backdrop.background = Background::solid([0, 0, 0]);
    })
}

/// Points of a sphere around the origin, without normals unless they are `given`.
fn sphere(count: usize, style: &Style, given: bool) -> (PreparedFrame, PrepareCounters) {
    let shape = Sequence::of(Shape::Sphere.frame(count)).frame(0).unwrap();
    let positions: Vec<[f32; 3]> = shape.positions().iter().map(Vec3::to_array).collect();
    let mut raw = RawCloud::from_positions(Positions::F32(positions));
    if given {
        raw.attributes.normals = Some(shape.normals().unwrap().iter().map(Vec3::to_array).collect());
    }
    let counters = PrepareCounters::default();
    let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap());
    let frame = prepare(0, frame, 0.0, &Scene::needs(style), &counters);
    (frame, counters)
}

fn packet_of(scene: &mut Scene, frame: &PreparedFrame, style: &Style) -> ScenePacket {
    let distance = 3.0 * f64::from(frame.frame.bounds().radius());
    scene.packet(frame, DVec3::ZERO, &camera_at(distance), style, SIZE)
}

#[test]
fn a_frame_without_normals_can_be_drawn_lit() {
    let (frame, counters) = sphere(8_000, &style(), false);
    assert!(frame.shapes.is_none());
    assert_eq!(counters.surfaces_estimated(), 0);
    let mut scene = Scene::default();
    let packet = packet_of(&mut scene, &frame, &style());
    let Content::Surfels(surfels) = &packet.content else {
        panic!("{:?}", packet.content.record_count());
    };
    let stats = scene.screen_stats().unwrap();
    assert_eq!(stats.visible, surfels.points.len());
    // The half of the sphere that faces the eye, and some of its silhouette.
    let share = stats.visible as f64 / stats.points as f64;
    assert!((0.2..0.5).contains(&share), "{share}");
    for (point, shape) in surfels.points.iter().zip(&*surfels.shapes) {
        let outwards = Vec3::from_array(point.position).normalize();
        let cosine = oct_decode(shape.normal).dot(outwards);
        // Silhouettes are seen at grazing angles.
        assert!(cosine > 0.8 || outwards.z < 0.45, "{cosine} at {outwards}");
    }
}

#[test]
fn both_renderers_draw_the_same_closed_image() {
    let (frame, _) = sphere(8_000, &style(), false);
    let packet = packet_of(&mut Scene::default(), &frame, &style());
    let (cpu, gpu) = (draw_on_cpu(&packet), draw(&packet));
    let differing = cpu.pixels().zip(gpu.pixels());
    let differing = differing.filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 3));
    assert!(differing.count() < 100);
    // No holes inside.
    for y in 108..132 {
        for x in 148..172 {
            assert_ne!(cpu.get_pixel(x, y).0[..3], [0, 0, 0], "{x} {y}");
        }
    }
}

#[test]
fn records_are_reused_as_long_as_nothing_changes() {
    let (frame, _) = sphere(5_000, &style(), false);
    let mut scene = Scene::default();
    let first = packet_of(&mut scene, &frame, &style());
    assert_eq!(packet_of(&mut scene, &frame, &style()), first);
    let turned = scene.packet(&frame, DVec3::ZERO, &camera_at(9.0), &style(), SIZE);
    assert_ne!(turned.content, first.content);
    let points = style().with(|style| style.primitive = Primitive::Point);
    packet_of(&mut scene, &frame, &points);
    assert!(scene.screen_stats().is_none());
}

#[test]
fn white_surfaces_in_white_light_from_all_sides_are_white() {
    let style = style().with(|style| {
        style.colors.one_color = [255; 3];
        style.light.lighting = Lighting::Physical;
        style.light.rig = LightRig::None;
        style.light.environment = Environment::Uniform;
    });
    let (frame, _) = sphere(8_000, &style, false);
    let image = draw_on_cpu(&packet_of(&mut Scene::default(), &frame, &style));
    for y in 108..132 {
        for x in 148..172 {
            let [red, green, blue, _] = image.get_pixel(x, y).0;
            assert!(red.min(green).min(blue) >= 254, "{x} {y}: {red} {green} {blue}");
        }
    }
}

#[test]
fn the_drawn_point_is_picked() {
    // The left half, without the right one behind it.
    let clip = Clip::to(ClipShape::Box {
        min: DVec3::splat(-9.0),
        max: DVec3::new(0.05, 9.0, 9.0),
    });
    for clip in [None, Some(clip)] {
        let mut clipped = style();
        clipped.of_sequence.clip = clip;
        let (frame, _) = sphere(8_000, &clipped, false);
        let packet = packet_of(&mut Scene::default(), &frame, &clipped);
        let mut picked = 0;
        for y in (60..180).step_by(7) {
            for x in (100..220).step_by(7) {
                let Some(slot) = pick(&packet, &frame, [f64::from(x) + 0.5, f64::from(y) + 0.5], 0.0) else {
                    continue;
                };
                picked += 1;
                let position = frame.points[slot].position;
                // Where the right half is cut away, splats of the back extend beyond the cut and are visible.
                let is_outside_cut = clip.is_some() && position[0] > -0.15;
                assert!(position[2] > -0.1 || is_outside_cut, "nothing hidden: {position:?}");
                let drawn = packet.content.points().unwrap();
                assert!(drawn.iter().any(|point| point.position == position), "{position:?}");
            }
        }
        assert!(picked > 20, "{picked}");
    }
}

#[test]
fn normal_errors_are_shown_in_color_and_reported() {
    let style = style().with(|style| {
        style.surfels.normals = NormalSource::Neighbours;
        style.surfels.shown = SurfelColors::NormalErrors;
        style.light.lighting = Lighting::PerFragment;
    });
    let (frame, _) = sphere(8_000, &style, true);
    let mut scene = Scene::default();
    let packet = packet_of(&mut scene, &frame, &style);
    assert_eq!(packet.style.light.lighting, Lighting::Unlit);
    let errors = scene.screen_stats().unwrap().errors.unwrap();
    let shares = errors.below_1_deg + errors.below_22_5_deg + errors.above_22_5_deg;
    assert!((shares - 1.0).abs() < 1e-9);
    assert!(errors.mean_deg < 5.0 && errors.above_22_5_deg < 0.1, "{errors:?}");
    // At the centre they are small: blue.
    let [red, green, blue, _] = draw_on_cpu(&packet).get_pixel(160, 120).0;
    assert!(blue > 180 && red < 80 && green < 130, "{red} {green} {blue}");
}
