//! Surfels of the screen that a graphics card makes: those of the processor, drawn alike by all strategies, without an
//! upload for each view.

use crate::common::{camera_at, context, cost, difference, draw_with};
use crate::data::shared;
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::gpu::{Context, ContextOptions, GpuRenderer};
use pointreel::scene::{
    BackFaces, Background, Camera, Content, NormalSource, Primitive, Scene, ScenePacket, Strategy, Style, pick,
};
use pointreel::sequence::{ColorSource, OpenOptions, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use std::sync::Arc;

const SIZE: [u32; 2] = [320, 240];
const POINTS: usize = 8000;

fn style() -> Style {
    let style = Style::default().with(|style| {
        style.primitive = Primitive::Surfel;
        style.colors.source = ColorSource::Uniform;
        style.surfels.normals = NormalSource::Screen;
        style.surfels.back_faces = BackFaces::Drawn;
        style.backdrop.background = Background::solid([0, 0, 0]);
    });
    style.drawn_by(false)
}

/// Points of a shape, without normals.
fn shape(shape: Shape) -> PreparedFrame {
    let points = Sequence::of(shape.frame(POINTS)).frame(0).unwrap();
    let positions = points.positions().iter().map(Vec3::to_array).collect();
    let frame = Frame::from_raw(RawCloud::from_positions(Positions::F32(positions)), DVec3::ZERO).unwrap();
    prepared(frame)
}

fn prepared(frame: Frame) -> PreparedFrame {
    prepare(
        0,
        Arc::new(frame),
        0.0,
        &Scene::needs(&style()),
        &PrepareCounters::default(),
    )
}

fn packet(scene: &mut Scene, frame: &PreparedFrame, style: &Style, distance: f64) -> ScenePacket {
    let camera = camera_at(distance * f64::from(frame.frame.bounds().radius()));
    let packet = scene.packet(frame, DVec3::ZERO, &camera, style, SIZE);
    assert!(matches!(packet.content, Content::Visible(_)));
    packet
}

/// A renderer whose adapter makes surfels, though it is a program.
fn making(context: Arc<Context>) -> GpuRenderer {
    let mut renderer = GpuRenderer::new(context).unwrap();
    renderer.set_makes_surfels(true);
    renderer
}

/// Pixels of which a channel differs by more than rounding.
fn differing(a: &RgbaImage, b: &RgbaImage) -> usize {
    let pixels = a.pixels().zip(b.pixels());
    let is_off = |a: &[u8; 4], b: &[u8; 4]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 8);
    pixels.filter(|(a, b)| is_off(&a.0, &b.0)).count()
}

#[test]
fn pictures_are_those_of_the_processors_surfels() {
    let mut renderer = making(context());
    for of in [Shape::Sphere, Shape::Torus] {
        let frame = shape(of);
        for distance in [1.5, 3.0, 12.0] {
            let packet = packet(&mut Scene::default(), &frame, &style(), distance);
            renderer.set_makes_surfels(true);
            let made = draw_with(&mut renderer, &packet);
            renderer.set_makes_surfels(false);
            let uploaded = draw_with(&mut renderer, &packet);
            let lit = uploaded.pixels().filter(|pixel| pixel.0[..3] != [0; 3]).count();
            let differing = differing(&made, &uploaded);
            assert!(
                lit > 200 && differing * 100 <= lit,
                "{of:?} from {distance}: {differing} of {lit}"
            );
        }
    }
}

#[test]
fn a_recording_of_a_depth_camera_is_drawn_alike() {
    let Some(path) = shared("rgbd/open3d_redwood_5frames") else {
        return;
    };
    let sequence = Sequence::open(&[path], &OpenOptions::default()).unwrap();
    let frame = prepared(sequence.frame(0).unwrap());
    let bounds = frame.frame.bounds();
    let mut renderer = making(context());
    for azimuth_deg in [0.0, 30.0] {
        let camera = Camera {
            target_in_world: sequence.origin() + bounds.center().as_dvec3(),
            azimuth_deg,
            elevation_deg: 10.0,
            ..camera_at(1.5 * f64::from(bounds.radius()))
        };
        let packet = Scene::default().packet(&frame, sequence.origin(), &camera, &style(), SIZE);
        assert!(matches!(packet.content, Content::Visible(_)));
        renderer.set_makes_surfels(true);
        let made = draw_with(&mut renderer, &packet);
        renderer.set_makes_surfels(false);
        let uploaded = draw_with(&mut renderer, &packet);
        let differing = differing(&made, &uploaded);
        let pixels = (SIZE[0] * SIZE[1]) as usize;
        assert!(
            differing * 100 <= pixels,
            "{azimuth_deg} degrees: {differing} of {pixels}"
        );
    }
}

#[test]
fn all_strategies_and_sizes_of_chunks_draw_the_same_bytes() {
    let frame = shape(Shape::Torus);
    let few = ContextOptions {
        prefer_software: true,
        max_chunk_records: Some(1000),
    };
    let few = Context::headless(&few).unwrap();
    for primitive in [Primitive::Surfel, Primitive::Sprite] {
        let mut first: Option<RgbaImage> = None;
        for &strategy in Strategy::ALL {
            for context in [context(), Arc::clone(&few)] {
                let style = style().with(|style| {
                    style.primitive = primitive;
                    style.drawing.strategy = strategy;
                });
                let packet = packet(&mut Scene::default(), &frame, &style, 3.0);
                let picture = draw_with(&mut making(context), &packet);
                let first = first.get_or_insert_with(|| picture.clone());
                assert_eq!(difference(first, &picture), (0, 0), "{primitive} by {strategy}");
            }
        }
    }
}

#[test]
fn a_moving_view_uploads_nothing_and_a_still_one_costs_nothing() {
    let frame = shape(Shape::Sphere);
    for &strategy in Strategy::ALL {
        let style = style().with(|style| style.drawing.strategy = strategy);
        let mut renderer = making(context());
        let mut scene = Scene::default();
        let first = cost(&mut renderer, &packet(&mut scene, &frame, &style, 3.0));
        assert_eq!(
            first.uploaded_bytes,
            16 * frame.points.len() as u64,
            "{strategy}: points alone"
        );
        for distance in [2.9, 5.0] {
            let moved = cost(&mut renderer, &packet(&mut scene, &frame, &style, distance));
            assert_eq!((moved.frames, moved.uploads), (1, 0), "{strategy}");
            let still = cost(&mut renderer, &packet(&mut scene, &frame, &style, distance));
            assert_eq!((still.frames, still.uploads, still.passes), (0, 0, 0), "{strategy}");
        }
        assert!(scene.screen_stats().is_none(), "the processor has nothing to do");
    }
}

#[test]
fn programs_that_draw_take_the_surfels_of_the_processor_unless_they_are_told() {
    let frame = shape(Shape::Sphere);
    let mut scene = Scene::default();
    let packet = packet(&mut scene, &frame, &style(), 3.0);
    let mut renderer = GpuRenderer::new(context()).unwrap();
    let drawn = draw_with(&mut renderer, &packet);
    let visible = scene.screen_stats().unwrap().visible as u64;
    assert_eq!(renderer.stats().uploaded_bytes, 32 * visible);
    // Those are the same records as in a packet of its own.
    let surfels = packet.content.gathered().unwrap();
    let of_processor = ScenePacket {
        content: Content::Surfels(surfels),
        ..packet.clone()
    };
    assert!(draw_with(&mut renderer, &of_processor) == drawn);
    let mut processor = CpuRenderer::new();
    let mut of = |packet: &ScenePacket| {
        processor.prepare(packet).unwrap();
        processor.render().unwrap();
        processor.read_image().unwrap()
    };
    assert!(
        of(&packet) == of(&of_processor),
        "the software renderer draws them, too"
    );
}

#[test]
fn what_is_picked_is_a_visible_point() {
    let frame = shape(Shape::Sphere);
    let packet = packet(&mut Scene::default(), &frame, &style(), 3.0);
    let slot = pick(&packet, &frame, [160.5, 120.5], 0.0).unwrap();
    assert!(frame.points[slot].position[2] > 0.0);
}
