//! The images of two sequences side by side, by both renderers.

use crate::common::{covered, difference, draw, draw_on_cpu};
use glam::{DVec2, DVec3, Vec3};
use image::RgbaImage;
use pointreel::app::{Command, Layout, State, StateOptions};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::scene::{Background, Primitive, Scene, ScenePacket, Settings};
use pointreel::sequence::{ColorSource, FrameEntry, Sequence, Shape};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Coordinates typical of surveys.
const SURVEY: DVec3 = DVec3::new(4_510_731.25, -3_911_168.5, 2_207_744.75);

/// A sequence that begins as a smaller cloud nearby.
const NEAR: &[(DVec3, f64)] = &[
    (DVec3::new(4_510_731.25, -3_911_168.0, 2_207_744.5), 0.25),
    (SURVEY, 1.0),
];

/// Points of a torus, one frame per position and factor of its size.
fn tori(frames: &'static [(DVec3, f64)]) -> Arc<Sequence> {
    let source = |number: u64| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("/scans/torus/{number}.ply"))
    };
    let sources = (0..frames.len() as u64).map(source).collect();
    let torus = Sequence::of(Shape::Torus.frame(4000)).frame(0).unwrap();
    let torus: Vec<DVec3> = torus.positions().iter().map(|p| p.as_dvec3()).collect();
    Arc::new(Sequence::with_decoder(sources, move |source| {
        let (place, size) = frames[source.number.unwrap_or(0) as usize];
        let positions = torus.iter().map(|p| (place + size * *p).to_array());
        Ok(RawCloud::from_positions(Positions::F64(positions.collect())))
    }))
}

/// A window of `width` × 200 pixels without a screen, on both sequences at frame `frame`, all loaded.
fn window(a: &Arc<Sequence>, b: &Arc<Sequence>, primitive: Primitive, frame: usize) -> State {
    let mut state = State::new(StateOptions {
        paused: true,
        ..StateOptions::default()
    });
    state.open(Arc::clone(a));
    // The style of the document that is now open.
    state.style = Settings::default().with(|style| {
        style.primitive = primitive.into();
        // Height ranges differ between the sequences.
        style.colors = ColorSource::Uniform.into();
        style.backdrop.background = Background::solid([0; 3]);
    });
    state.compare_with(Arc::clone(b));
    state.update(Duration::ZERO);
    state.player.as_mut().unwrap().seek(frame, Duration::ZERO);
    let needs = Scene::needs(&state.style.decided());
    for index in 0..a.len() {
        state.player.as_ref().unwrap().loader().wait(index, &needs).unwrap();
        let companion = &state.features.split_view.as_ref().unwrap().companion;
        companion.loader().wait(index, &needs).unwrap();
    }
    state.update(Duration::ZERO);
    state.viewport.size_px = [240, 200];
    state.viewport.other_size_px = [240, 200];
    state.run(Command::RESET_VIEW);
    state
}

fn packets(state: &mut State) -> [ScenePacket; 2] {
    [state.next_packet(), state.next_other_packet()].map(Option::unwrap)
}

/// Both images by the CPU, and both by the adapter.
fn drawn_by_each(packets: &[ScenePacket; 2]) -> [[RgbaImage; 2]; 2] {
    [packets.each_ref().map(draw_on_cpu), packets.each_ref().map(draw)]
}

#[test]
fn a_sequence_compared_with_itself_has_equal_halves_and_no_error() {
    const HERE: &[(DVec3, f64)] = &[(SURVEY, 1.0)];
    for primitive in [Primitive::Surfel, Primitive::Voxel, Primitive::Point] {
        let (a, b) = (tori(HERE), tori(HERE));
        let mut state = window(&a, &b, primitive, 0);
        state.features.split_view.as_mut().unwrap().layout = Layout::Wipe;
        let packets = packets(&mut state);
        assert_eq!(packets[0].view, packets[1].view);
        for [left, right] in drawn_by_each(&packets) {
            assert!(covered(&left, [0; 3]) > 1500, "{primitive:?}");
            assert_eq!(difference(&left, &right), (0, 0), "{primitive:?}");
            state.compare_pictures(left, right);
            let begin = Instant::now();
            let map = loop {
                state.update(Duration::ZERO);
                if let Some(difference) = &state.pictures().unwrap().difference {
                    assert_eq!(difference.flip, 0.0);
                    assert_eq!(difference.psnr_db, f64::INFINITY);
                    break Arc::clone(&difference.map);
                }
                assert!(begin.elapsed() < Duration::from_mins(1), "no answer");
                std::thread::sleep(Duration::from_millis(2));
            };
            let first = map.get_pixel(0, 0);
            assert!(map.pixels().all(|pixel| pixel == first), "an error map of one colour");
        }
    }
}

/// Positions of the records of a packet in its image.
fn on_picture(packet: &ScenePacket) -> Vec<DVec2> {
    let [width, height] = packet.viewport_px.map(f64::from);
    let place = |position: [f32; 3]| {
        let place = packet.view.to_view(Vec3::from_array(position)).as_dvec3();
        let [x, y] = packet.view.focal.map(f64::from);
        let ndc = DVec2::new(x * place.x, y * place.y) / -place.z;
        (ndc * DVec2::new(0.5, -0.5) + 0.5) * DVec2::new(width, height)
    };
    packet
        .content
        .points()
        .unwrap()
        .iter()
        .map(|point| place(point.position))
        .collect()
}

#[test]
fn equal_coordinates_coincide_whatever_the_origin_of_a_sequence() {
    // The first frame determines the origin: B starts as a smaller cloud nearby, whose own origin would be different.
    let a = tori(const { &[(SURVEY, 1.0), (SURVEY, 1.0)] });
    let (b, alone) = (tori(NEAR), tori(NEAR));
    let mut state = window(&a, &b, Primitive::Point, 1);
    assert_ne!(alone.origin(), a.origin());
    assert_eq!(b.origin(), a.origin());
    let packets_near = packets(&mut state);
    for [left, right] in drawn_by_each(&packets_near) {
        assert!(covered(&left, [0; 3]) > 1500);
        assert_eq!(difference(&left, &right), (0, 0));
    }
    // B starts at zero and keeps its origin there, relative to which f32 are half a unit apart at the survey: they
    // coincide up to that.
    let b = tori(const { &[(DVec3::ZERO, 1.0), (SURVEY, 1.0)] });
    let mut state = window(&a, &b, Primitive::Point, 1);
    assert_eq!(b.origin(), DVec3::ZERO);
    let [a, b] = packets(&mut state);
    let pixels_per_unit = f64::from(a.view.pixels_per_unit_at_1) / state.camera.distance;
    let (a, b) = (on_picture(&a), on_picture(&b));
    // Rounding may change the Morton order: match by the nearest.
    let farthest = a.iter().map(|place| {
        let distances = b.iter().map(|other| other.distance(*place));
        distances.fold(f64::INFINITY, f64::min)
    });
    let farthest = farthest.fold(0.0, f64::max);
    assert!(farthest < pixels_per_unit, "{farthest} of {pixels_per_unit}");
    assert!(farthest > 0.0);
}

#[test]
fn the_saved_image_matches_the_shown_one() {
    const HERE: &[(DVec3, f64)] = &[(DVec3::ZERO, 1.0)];
    let mut state = window(&tori(HERE), &tori(HERE), Primitive::Point, 0);
    let [red, blue] = [[200, 0, 0, 255], [0, 0, 200, 255]].map(image::Rgba);
    let picture = |width, color| RgbaImage::from_pixel(width, 4, color);
    let joined = state.joined(picture(3, red), Some(picture(5, blue)));
    assert_eq!(joined.dimensions(), (8, 4));
    assert_eq!((joined.get_pixel(2, 3), joined.get_pixel(3, 0)), (&red, &blue));
    let split_view = state.features.split_view.as_mut().unwrap();
    split_view.layout = Layout::Wipe;
    split_view.pictures.split = 0.25;
    let joined = state.joined(picture(8, red), Some(picture(8, blue)));
    assert_eq!(joined.dimensions(), (8, 4));
    assert_eq!((joined.get_pixel(1, 0), joined.get_pixel(2, 3)), (&red, &blue));
    state.run(Command::CLOSE_COMPARISON);
    let alone = state.joined(picture(8, red), Some(picture(8, blue)));
    assert_eq!(alone, picture(8, red));
}
