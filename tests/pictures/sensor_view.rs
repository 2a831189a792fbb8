//! A frame of a depth camera, drawn from where the camera was: the result is its image, pixel by pixel.

use crate::common;
use glam::{DVec2, DVec3};
use image::RgbaImage;
use pointreel::cloud::Frame;
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::rgbd::{Camera, DepthImage, Distortion, RayTable, Rig, Sensor, cloud};
use pointreel::scene::{
    Background, FirstLook, Lighting, PicturePlane, Primitive, Scene, ScenePacket, Style, UpAxis, pick,
};
use pointreel::sequence::{ColorSource, Coloring, Needs, PrepareCounters, PreparedFrame, prepare};
use std::sync::Arc;

const SIZE: [u32; 2] = [160, 120];
/// Colour of pixels without a point.
const BACKGROUND: [u8; 3] = [0; 3];

/// Depths that jump from pixel to pixel, and holes, so that an image shifted by a pixel differs.
fn depths() -> Vec<f32> {
    let depth = |index: u32| match index.wrapping_mul(2_654_435_761) >> 16 {
        hash if hash.is_multiple_of(7) => 0.0,
        hash => 0.5 + 3.5 * (hash as f32 / 65_536.0),
    };
    (0..SIZE[0] * SIZE[1]).map(depth).collect()
}

/// Another one for each pixel, brighter than the background.
fn color(index: usize) -> [u8; 3] {
    let [low, high, ..] = (index as u32).to_le_bytes();
    [low, high, 200]
}

/// Far from a camera of the window: its pixels are not square, and its axis is far from the centre.
fn sensor() -> Sensor {
    let camera = Camera::new(
        SIZE,
        DVec2::new(131.25, 140.5),
        DVec2::new(91.3, 47.8),
        Distortion::None,
    );
    Sensor {
        rig: Arc::new(Rig {
            depth: camera.unwrap(),
            color: None,
        }),
        world_from_camera: None,
    }
}

fn style() -> Style {
    Style::default().with(|style| {
        style.primitive = Primitive::Point;
        style.points.size_px = 1.0;
        style.colors = Coloring::of(ColorSource::File);
        style.light.lighting = Lighting::Unlit;
        style.backdrop.background = Background::solid(BACKGROUND);
    })
}

struct Drawn {
    frame: PreparedFrame,
    packet: ScenePacket,
}

/// The frame as seen by its sensor where `up` is up.
fn drawn(up: UpAxis) -> Drawn {
    let (sensor, style) = (sensor(), style());
    let depth = DepthImage::new(SIZE, depths()).unwrap();
    let rays = RayTable::of(&sensor.rig.depth);
    let colors = (0..depths().len()).map(color).map(|[r, g, b]| [r, g, b, 255]).collect();
    let raw = cloud(&depth, &rays, Some(colors));
    let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap());
    let look = FirstLook::of(&[&frame], DVec3::ZERO).with_up(up);
    let camera = look.camera_of_sensor(&sensor, DVec3::ZERO);
    assert_ne!(camera.plane, PicturePlane::CENTERED);
    let needs = Needs {
        colors: Coloring::of(ColorSource::File),
        ..Scene::needs(&style)
    };
    let frame = prepare(0, frame, 0.0, &needs, &PrepareCounters::default());
    let packet = Scene::default().packet(&frame, DVec3::ZERO, &camera, &style, SIZE);
    Drawn { frame, packet }
}

fn on_cpu(packet: &ScenePacket) -> RgbaImage {
    let mut renderer = CpuRenderer::new();
    renderer.prepare(packet).unwrap();
    renderer.render().unwrap();
    renderer.read_image().unwrap()
}

#[test]
fn the_sensor_view_reproduces_each_pixel_of_the_image() {
    // The second is upside down, the third lies on its side.
    for up in [UpAxis::NegY, UpAxis::Y, UpAxis::X] {
        let Drawn { packet, .. } = drawn(up);
        for (renderer, picture) in [("cpu", on_cpu(&packet)), ("gpu", common::draw(&packet))] {
            for (index, (depth, pixel)) in depths().into_iter().zip(picture.pixels()).enumerate() {
                let expected = if depth > 0.0 { color(index) } else { BACKGROUND };
                assert_eq!(pixel.0[..3], expected, "pixel {index}, {renderer}, {up:?} is up");
            }
        }
    }
}

#[test]
fn a_pick_has_the_depth_of_its_pixel() {
    let Drawn { frame, packet } = drawn(UpAxis::NegY);
    for (index, depth) in depths().into_iter().enumerate().step_by(37) {
        let place = [index % SIZE[0] as usize, index / SIZE[0] as usize].map(|at| at as f64 + 0.5);
        let found = pick(&packet, &frame, place, 0.4).map(|slot| frame.frame.positions()[slot].z);
        assert_eq!(found, (depth > 0.0).then_some(depth), "pixel {index}");
    }
}

#[test]
fn a_wider_view_shows_the_image_in_its_center() {
    let Drawn { frame, packet } = drawn(UpAxis::NegY);
    let camera = FirstLook::of(&[&frame.frame], DVec3::ZERO).camera_of_sensor(&sensor(), DVec3::ZERO);
    let wide = [SIZE[0] + 80, SIZE[1]];
    let wider = Scene::default().packet(&frame, DVec3::ZERO, &camera, &style(), wide);
    let (own, wider) = (on_cpu(&packet), on_cpu(&wider));
    for (x, y, pixel) in own.enumerate_pixels() {
        assert_eq!(wider.get_pixel(x + 40, y), pixel, "{x} {y}");
    }
}
