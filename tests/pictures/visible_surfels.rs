//! Surfels of the screen made on a GPU: equal to the CPU's, drawn alike by all strategies, without an
//! upload for each view.

use crate::common::{camera_at, context, cost, difference, draw_with};
use crate::data::shared;
use glam::{DVec2, DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::gpu::{Context, ContextOptions, GpuRenderer};
use pointreel::rgbd::{self, DepthFrame, DepthSamples, DepthTable, Distortion, Filters, RayTable};
use pointreel::scene::{
    BackFaces, Background, Camera, Clip, ClipShape, Content, NormalSource, PointImages, Primitive, Scene, ScenePacket,
    Strategy, Style, pick,
};
use pointreel::sequence::{
    ColorSource, HeightAxis, OpenOptions, PrepareCounters, PreparedFrame, Sequence, Shape, prepare,
};
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

/// Pixels with a channel that differs by more than rounding.
fn differing(a: &RgbaImage, b: &RgbaImage) -> usize {
    let pixels = a.pixels().zip(b.pixels());
    let is_off = |a: &[u8; 4], b: &[u8; 4]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 8);
    pixels.filter(|(a, b)| is_off(&a.0, &b.0)).count()
}

#[test]
fn images_match_those_of_the_cpu_surfels() {
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
                lit > 100 && differing * 100 <= lit,
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

/// A frame of a depth camera: a ball before a wall, with noise and holes, and a colour for each pixel.
fn of_images(filters: Filters) -> PreparedFrame {
    let size_px = [160, 121];
    let camera = rgbd::Camera::new(size_px, DVec2::splat(150.0), DVec2::new(79.5, 60.0), Distortion::None).unwrap();
    let rays = Arc::new(RayTable::of(&camera));
    let millimetres: Vec<u16> = rays
        .rays()
        .iter()
        .zip(0_u32..)
        .map(|(&[x, y], at)| {
            let (square, noise) = (x * x + y * y + 1.0, (at.wrapping_mul(2_654_435_761) >> 20) % 5);
            // The ball has its centre 1.2 m away and a radius of 0.35 m.
            let under_root = 1.44 - square * (1.44 - 0.1225);
            let depth = if under_root > 0.0 {
                (1.2 - under_root.sqrt()) / square
            } else {
                1.8
            };
            if at % 13 == 5 {
                0
            } else {
                (1000.0 * depth) as u16 + noise as u16
            }
        })
        .collect();
    let colors: Vec<[u8; 3]> = (0..160 * 121).map(|at: u32| [200, at as u8, 90]).collect();
    let table = DepthTable::new(|number| f32::from(number) / 1000.0);
    let samples = Arc::new(DepthSamples::coded(millimetres, table));
    let images = DepthFrame::new(Vec::new(), samples, rays, Some(colors.clone()), filters).unwrap();
    let opaque = colors
        .iter()
        .map(|&[red, green, blue]| [red, green, blue, 255])
        .collect();
    let mut raw = rgbd::cloud(&images.filtered().unwrap(), images.rays(), Some(opaque));
    raw.made_from = Some(images.into_made_from());
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Scene::needs(&style_of_images());
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

fn style_of_images() -> Style {
    style().with(|style| style.colors.source = ColorSource::File)
}

/// Images from the camera's viewpoint and from the side.
fn packets_of_images(frame: &PreparedFrame, style: &Style) -> Vec<ScenePacket> {
    let packet = |azimuth_deg| {
        let camera = Camera {
            target_in_world: DVec3::new(0.0, 0.0, 1.2),
            azimuth_deg,
            ..camera_at(1.5)
        };
        Scene::default().packet(frame, DVec3::ZERO, &camera, style, SIZE)
    };
    [0.0, 140.0, 200.0].map(packet).to_vec()
}

fn images_of(packet: &ScenePacket) -> Option<&PointImages> {
    match &packet.content {
        Content::Visible(visible) => visible.images.as_ref(),
        _ => None,
    }
}

#[test]
fn depth_images_are_uploaded_instead_of_points_and_drawn_alike() {
    let frame = of_images(Filters::USUAL);
    let pixels = 160 * 121;
    for &strategy in Strategy::ALL {
        let style = style_of_images().with(|style| style.drawing.strategy = strategy);
        let mut renderer = making(context());
        for (place, packet) in packets_of_images(&frame, &style).iter().enumerate() {
            assert_eq!(images_of(packet).unwrap().one_color, None);
            let before = renderer.stats().uploaded_bytes;
            let made = draw_with(&mut renderer, packet);
            let uploaded = renderer.stats().uploaded_bytes - before;
            // Two bytes of depth and three of colour; once eight for rays, and the metres of all raw values.
            let expected = if place == 0 { 13 * pixels + 4 * 65536 } else { 0 };
            assert_eq!(uploaded, expected, "{strategy}");
            let mut of_processor = GpuRenderer::new(context()).unwrap();
            let uploaded = draw_with(&mut of_processor, packet);
            let differing = differing(&made, &uploaded);
            let lit = uploaded.pixels().filter(|pixel| pixel.0[..3] != [0; 3]).count();
            assert!(
                lit > 1000 && differing * 100 <= lit,
                "{strategy}, {place}: {differing} of {lit}"
            );
        }
    }
}

#[test]
fn depth_images_are_not_used_where_points_differ() {
    let frame = of_images(Filters::NONE);
    let images = |frame: &PreparedFrame, style: &Style| {
        let packets = packets_of_images(frame, style);
        images_of(&packets[0]).map(|images| images.one_color)
    };
    assert_eq!(images(&frame, &style_of_images()), Some(None));
    let uniform = prepare(
        0,
        Arc::clone(&frame.frame),
        0.0,
        &Scene::needs(&style()),
        &PrepareCounters::default(),
    );
    assert!(images(&uniform, &style()).is_some_and(|color| color.is_some()));
    let by_height = style().with(|style| style.colors.source = ColorSource::Height(HeightAxis::Axis(1, false)));
    let painted = prepare(
        0,
        Arc::clone(&frame.frame),
        0.0,
        &Scene::needs(&by_height),
        &PrepareCounters::default(),
    );
    assert_eq!(images(&painted, &by_height), None, "in other colours");
    let (sample, _) = frame.frame.sample(1000).unwrap();
    assert!(sample.made_from().is_none(), "some of the points");
    let clipped = style_of_images().with(|style| {
        let around = ClipShape::around(&frame.frame.bounds(), DVec3::ZERO);
        style.of_sequence.clip = Some(Clip::to(around));
    });
    assert_eq!(images(&frame, &clipped), None, "cut");
}

#[test]
fn the_number_of_visible_points_is_read_back() {
    let frame = of_images(Filters::USUAL);
    let packets = packets_of_images(&frame, &style_of_images());
    let mut renderer = making(context());
    assert_eq!(renderer.stats().screen, None);
    for packet in &packets {
        renderer.prepare(packet).unwrap();
        renderer.render().unwrap();
        renderer.wait_gpu_ms();
        let found = renderer.stats().screen.unwrap();
        let surfels = packet.content.gathered().unwrap();
        assert_eq!(found.points, frame.points.len());
        let off = found.visible.abs_diff(surfels.points.len());
        assert!(
            off * 200 <= surfels.points.len(),
            "{} and {}",
            found.visible,
            surfels.points.len()
        );
        // Adapters with timestamps report how long it took.
        if renderer.context().has_timestamps {
            assert!(found.cull_ms.is_some() && found.normals_ms.is_some());
        }
    }
    if renderer.context().has_timestamps {
        let passes = renderer.stats().image_passes;
        let passes: Vec<&str> = passes.iter().map(|time| time.pass).collect();
        assert_eq!(passes, ["near", "median", "bilateral", "flying", "reproject"]);
    }
    let points = style_of_images().with(|style| style.primitive = Primitive::Point);
    let packet = &packets_of_images(&frame, &points)[0];
    renderer.prepare(packet).unwrap();
    renderer.render().unwrap();
    assert_eq!(renderer.stats().screen, None, "of points nothing is culled");
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
fn software_adapters_use_cpu_surfels_unless_told_otherwise() {
    let frame = shape(Shape::Sphere);
    let mut scene = Scene::default();
    let packet = packet(&mut scene, &frame, &style(), 3.0);
    let context = context();
    if !context.is_software() {
        return;
    }
    let mut renderer = GpuRenderer::new(context).unwrap();
    let drawn = draw_with(&mut renderer, &packet);
    let visible = scene.screen_stats().unwrap().visible as u64;
    assert_eq!(renderer.stats().uploaded_bytes, 32 * visible);
    // These are the same records as in a separate packet.
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
fn picking_returns_a_visible_point() {
    let frame = shape(Shape::Sphere);
    let packet = packet(&mut Scene::default(), &frame, &style(), 3.0);
    let slot = pick(&packet, &frame, [160.5, 120.5], 0.0).unwrap();
    assert!(frame.points[slot].position[2] > 0.0);
}
