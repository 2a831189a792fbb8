//! Byte codes that the GPU traverses and decodes: the same images by all strategies, as from the CPU's decoding, and
//! close to the CPU's masks.
//!
//! Images are saved in the folder that `POINTREEL_KEEP_PICTURES` names, if it names one.

use crate::common::{self, camera_at, colored_sphere, cost, plain};
use glam::DVec3;
use image::RgbaImage;
use pointreel::levels::Lod;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::gpu::{Context, ContextOptions, GpuRenderer};
use pointreel::scene::{
    Antialiasing, BackFaces, Footprint, Lighting, NormalBits, OffsetBits, Scene, ScenePacket, Strategy, Style,
};
use pointreel::sequence::PreparedFrame;
use std::path::Path;
use std::sync::Arc;

const SIZE: [u32; 2] = [160, 120];
const POINTS: u32 = 20_000;

fn style(footprint: Footprint, lod_px: f32) -> Style {
    plain().drawn_by(false).with(|style| {
        style.codes.footprint = footprint;
        style.light.lighting = Lighting::PerSurfel;
        style.levels.lod = Lod::ThresholdPx(lod_px);
    })
}

fn packet(frame: &PreparedFrame, style: &Style, distance: f64) -> ScenePacket {
    let packet = Scene::default().packet(frame, DVec3::ZERO, &camera_at(distance), style, SIZE);
    assert!(packet.content.coded().is_some());
    packet
}

/// A renderer that does not leave decoding to the CPU, though its adapter is one.
fn decoding(context: Arc<Context>) -> GpuRenderer {
    let mut renderer = GpuRenderer::new(context).unwrap();
    renderer.set_makes_surfels(true);
    renderer
}

fn drawn(renderer: &mut dyn Renderer, packet: &ScenePacket) -> RgbaImage {
    renderer.prepare(packet).unwrap();
    renderer.render().unwrap();
    renderer.read_image().unwrap()
}

fn keep(picture: &RgbaImage, name: &str) {
    if let Some(folder) = std::env::var_os("POINTREEL_KEEP_PICTURES") {
        picture.save(Path::new(&folder).join(format!("{name}.png"))).unwrap();
    }
}

fn psnr(a: &RgbaImage, b: &RgbaImage) -> f64 {
    psnr_db(mean_squared_error(a, b).unwrap())
}

/// Packet with the records that the CPU decodes.
fn decoded(packet: &ScenePacket) -> ScenePacket {
    packet.with_surfels_of(packet.content.coded().unwrap())
}

#[test]
fn strategies_draw_the_nodes_that_the_cpu_decodes() {
    let frame = colored_sphere(POINTS, &style(Footprint::Masks, 0.0));
    for (lod_px, distance) in [(0.0, 2.0), (3.0, 2.0), (2.0, 1.1), (1.0, 9.0)] {
        let mut first: Option<RgbaImage> = None;
        for &strategy in Strategy::ALL {
            let style = style(Footprint::Masks, lod_px).with(|style| style.drawing.strategy = strategy);
            let packet = packet(&frame, &style, distance);
            // With chunks that are shorter than the drawn nodes, too.
            let options = ContextOptions {
                prefer_software: true,
                max_chunk_records: Some(1000),
            };
            for context in [common::context(), Context::headless(&options).unwrap()] {
                let mut renderer = decoding(context);
                let image = drawn(&mut renderer, &packet);
                let name = format!("{lod_px} px from {distance} by {strategy}");
                keep(&image, &format!("coded {name}"));
                // A node at its threshold except for rounding is drawn or divided.
                let db = psnr(&image, &drawn(&mut renderer, &decoded(&packet)));
                assert!(db > 50.0, "{name}: {db:.1} dB");
                let first = first.get_or_insert_with(|| image.clone());
                assert_eq!(first.as_raw(), image.as_raw(), "{name}");
            }
        }
        let lit = first
            .iter()
            .flat_map(RgbaImage::pixels)
            .filter(|pixel| pixel.0[..3] != [0; 3]);
        assert!(lit.count() > 100, "{lod_px} px from {distance}");
    }
}

#[test]
fn masks_and_pixels_are_close_to_those_of_the_cpu() {
    for (footprint, lod_px, min_db) in [
        // Masks end in another pixel along the outline, as on the CPU.
        (Footprint::Masks, 0.0, 26.0),
        (Footprint::Masks, 3.0, 26.0),
        (Footprint::Pixels, 0.0, 24.0),
    ] {
        for lighting in [Lighting::Unlit, Lighting::PerSurfel] {
            let of_gpu = style(footprint, lod_px).with(|style| style.light.lighting = lighting);
            let frame = colored_sphere(POINTS, &of_gpu);
            let packets = [of_gpu, of_gpu.drawn_by(true)].map(|style| packet(&frame, &style, 2.5));
            let mut gpu = decoding(common::context());
            let images = [
                drawn(&mut gpu, &packets[0]),
                drawn(&mut CpuRenderer::new(), &packets[1]),
            ];
            let name = format!("{footprint}, {lod_px} px, {lighting}");
            for (image, renderer) in images.iter().zip(["gpu", "cpu"]) {
                keep(image, &format!("coded {name} {renderer}"));
            }
            let db = psnr(&images[0], &images[1]);
            assert!(db > min_db, "{name}: {db:.1} dB");
        }
    }
}

/// Buffers and tables of one image are not taken for those of another.
#[test]
fn one_renderer_draws_one_code_after_the_other() {
    let mut renderer = decoding(common::context());
    let masks = style(Footprint::Masks, 0.0);
    let frames = [POINTS, 300, 5000].map(|points| colored_sphere(points, &masks));
    let with = |change: fn(&mut Style)| masks.with(change);
    let styles = [
        masks,
        with(|style| style.codes.normal_bits = NormalBits::Seventeen),
        with(|style| style.codes.offset_bits = OffsetBits::None),
        with(|style| style.levels.lod = Lod::ThresholdPx(9.0)),
        with(|style| style.surfels.back_faces = BackFaces::Drawn),
        with(|style| style.codes.footprint = Footprint::Pixels),
        with(|style| style.drawing.strategy = Strategy::Texture),
        with(|style| style.drawing.antialiasing = Antialiasing::Supersample),
    ];
    for (place, style) in styles.iter().enumerate() {
        for frame in &frames {
            let packet = packet(frame, style, 2.0);
            let image = drawn(&mut renderer, &packet);
            // A software adapter draws the nodes that the CPU decodes.
            let mut other = GpuRenderer::new(common::context()).unwrap();
            let db = psnr(&image, &drawn(&mut other, &packet));
            assert!(db > 50.0, "style {place}, {} points: {db:.1} dB", frame.points.len());
        }
    }
}

/// A ball with gaps between its pixels: its far side would show through them.
#[test]
fn pixels_that_face_away_are_not_drawn() {
    let of_gpu = style(Footprint::Pixels, 0.0).with(|style| {
        style.surfels.back_faces = BackFaces::Culled;
        style.light.lighting = Lighting::Unlit;
    });
    let frame = colored_sphere(2000, &of_gpu);
    let packets = [of_gpu, of_gpu.drawn_by(true)].map(|style| packet(&frame, &style, 2.0));
    let mut gpu = decoding(common::context());
    let images = [
        drawn(&mut gpu, &packets[0]),
        drawn(&mut CpuRenderer::new(), &packets[1]),
    ];
    let [of_gpu, of_cpu] = images.map(|image| image.pixels().filter(|pixel| pixel.0[..3] != [0; 3]).count());
    assert!(of_cpu > 300, "{of_cpu}");
    assert!(of_gpu.abs_diff(of_cpu) * 20 < of_cpu, "{of_gpu} and {of_cpu} pixels");
}

#[test]
fn a_moving_view_uploads_nothing() {
    let style = style(Footprint::Masks, 2.0);
    let frame = colored_sphere(POINTS, &style);
    let mut renderer = decoding(common::context());
    let first = cost(&mut renderer, &packet(&frame, &style, 3.0));
    let leaves = packet(&frame, &style, 3.0).content.record_count() as u64;
    assert!(first.uploaded_bytes > 8 * leaves, "{first:?}");
    assert!(first.uploaded_bytes < 32 * leaves, "less than records: {first:?}");
    for distance in [1.7, 6.0, 2.9] {
        let moved = cost(&mut renderer, &packet(&frame, &style, distance));
        assert_eq!((moved.frames, moved.uploads, moved.uploaded_bytes), (1, 0, 0));
        let still = cost(&mut renderer, &packet(&frame, &style, distance));
        assert_eq!((still.frames, still.passes), (0, 0));
    }
    // A software adapter draws the same nodes from records of the CPU.
    let by_compute = drawn(&mut renderer, &packet(&frame, &style, 3.0));
    let mut default = GpuRenderer::new(common::context()).unwrap();
    let uploaded = drawn(&mut default, &packet(&frame, &style, 3.0));
    assert!(psnr(&by_compute, &uploaded) > 50.0);
}
