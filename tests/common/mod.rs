//! Code shared by image tests: one software device, and packets made from a few records.
#![allow(dead_code, reason = "every test binary uses another part")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use glam::{DVec3, Vec3};
use image::{Rgba, RgbaImage};
use pointreel::cloud::{Frame, PointRecord, Positions, RawCloud, ShapeRecord, VoxelRecord, oct_encode};
use pointreel::math::Aabb;
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::gpu::{Context, ContextOptions, GpuRenderer};
use pointreel::render::{RenderStats, Renderer};
use pointreel::scene::{
    Background, Camera, Content, Lighting, PacketParams, PicturePlane, Primitive, Projection, Scene, ScenePacket,
    Settings, Splatting, Style, Surfels, UpAxis, Voxels,
};
use pointreel::sequence::{PrepareCounters, PreparedFrame, prepare};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard};

static CONTEXT: LazyLock<Arc<Context>> = LazyLock::new(|| open(&software()));

/// Options of every test: the software rasteriser, so that images come from one renderer.
pub(crate) fn software() -> ContextOptions {
    ContextOptions {
        prefer_software: true,
        ..ContextOptions::default()
    }
}

/// Opens a device or reports what to install.
pub(crate) fn open(options: &ContextOptions) -> Arc<Context> {
    Context::headless(options).unwrap_or_else(|error| panic!("{error}"))
}

/// The device that the tests of one binary share.
pub(crate) fn context() -> Arc<Context> {
    Arc::clone(&CONTEXT)
}

static RENDERER: LazyLock<Mutex<GpuRenderer>> = LazyLock::new(|| Mutex::new(GpuRenderer::new(context()).unwrap()));

/// The renderer that the tests of one binary share; tests that read counters make their own.
pub(crate) fn renderer() -> MutexGuard<'static, GpuRenderer> {
    RENDERER.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Draws a packet with the shared renderer.
pub(crate) fn draw(packet: &ScenePacket) -> RgbaImage {
    draw_with(&mut renderer(), packet)
}

/// Draws a packet.
pub(crate) fn draw_with(renderer: &mut GpuRenderer, packet: &ScenePacket) -> RgbaImage {
    renderer.prepare(packet).unwrap();
    renderer.render().unwrap();
    renderer.read_image().unwrap()
}

/// Draws a packet on the CPU.
pub(crate) fn draw_on_cpu(packet: &ScenePacket) -> RgbaImage {
    let mut renderer = CpuRenderer::new();
    renderer.prepare(packet).unwrap();
    renderer.render().unwrap();
    renderer.read_image().unwrap()
}

/// Settings whose colours can be predicted: no light, black background. Splats cover the gaps between them.
pub(crate) fn plain() -> Style {
    Style::default().with(|style| {
        style.surfels.splatting = Splatting::TwoPassEnlarged;
        style.light.lighting = Lighting::Unlit;
        style.backdrop.background = Background::solid([0, 0, 0]);
    })
}

/// A camera on +Z at `distance`, looking at the origin, 90 degrees high and wide on a square viewport.
pub(crate) fn camera_at(distance: f64) -> Camera {
    Camera {
        target_in_world: DVec3::ZERO,
        distance,
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        fov_deg: 90.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    }
}

/// A surfel of the tests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surfel {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) radius: f32,
    pub(crate) color: [u8; 3],
}

/// A packet of surfels, or by the settings of points, or of ellipses: thin ones and circles, in many directions.
pub(crate) fn surfels(surfels: &[Surfel], camera: &Camera, style: Style, viewport_px: [u32; 2]) -> ScenePacket {
    let positions: Vec<Vec3> = surfels.iter().map(|surfel| surfel.position).collect();
    let points = surfels.iter().map(|surfel| PointRecord {
        position: surfel.position.to_array(),
        color: [surfel.color[0], surfel.color[1], surfel.color[2], 255],
    });
    let points = Arc::new(points.collect());
    let are_ellipses = style.primitive == Primitive::Ellipse;
    let shapes = (0u32..).zip(surfels).map(|(index, surfel)| ShapeRecord {
        normal: oct_encode(surfel.normal),
        radius: surfel.radius,
        ellipse: u32::from(are_ellipses) * ((index.wrapping_mul(9973) << 16) | ((index % 4) * 16_000)),
        scalar: 0.0,
    });
    ScenePacket {
        viewport_px,
        view: camera.transform(DVec3::ZERO, viewport_px),
        content: if style.primitive == Primitive::Point && !style.has_points_with_shapes() {
            Content::Points(points)
        } else {
            let shapes = Arc::new(shapes.collect());
            Content::Surfels(Surfels { points, shapes })
        },
        style: style.painted(),
        ground: None,
        posed_images: None,
        params: PacketParams::default(),
        bounds: Aabb::from_points(&positions),
    }
}

/// A packet of voxels.
pub(crate) fn voxels(
    records: Vec<VoxelRecord>,
    cube_edge: f32,
    camera: &Camera,
    style: Style,
    viewport_px: [u32; 2],
) -> ScenePacket {
    let centers: Vec<Vec3> = records.iter().map(|record| Vec3::from_array(record.center)).collect();
    ScenePacket {
        viewport_px,
        view: camera.transform(DVec3::ZERO, viewport_px),
        style: style.painted(),
        content: Content::Voxels(Voxels {
            records: Arc::new(records),
            normals: None,
            cube_edge,
        }),
        ground: None,
        posed_images: None,
        params: PacketParams::default(),
        bounds: Aabb::from_points(&centers),
    }
}

/// Records whose normals point away from the origin, some of them inwards.
pub(crate) fn shapes_towards(places: impl Iterator<Item = [f32; 3]>) -> Vec<ShapeRecord> {
    places
        .zip([1.0f32, 1.0, -1.0].into_iter().cycle())
        .map(|(place, side)| ShapeRecord {
            normal: oct_encode(side * Vec3::from_array(place).normalize_or(Vec3::Z)),
            radius: 0.0,
            ellipse: 0,
            scalar: 0.0,
        })
        .collect()
}

/// `count` surfels on a sphere around the origin (golden spiral), coloured by where they are.
pub(crate) fn sphere(count: u32, sphere_radius: f32) -> Vec<Surfel> {
    let golden_angle = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    (0..count)
        .map(|i| {
            let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
            let (sin, cos) = (golden_angle * i as f32).sin_cos();
            let ring = (1.0 - y * y).sqrt();
            let normal = Vec3::new(ring * cos, y, ring * sin);
            let color = (normal * 127.5 + 127.5).to_array().map(|channel| channel as u8);
            Surfel {
                position: normal * sphere_radius,
                normal,
                // The spiral gives each surfel an area of 4π/count.
                radius: sphere_radius * 1.3 * (4.0 / count as f32).sqrt(),
                color,
            }
        })
        .collect()
}

/// Number of pixels that are not `background`.
pub(crate) fn covered(image: &RgbaImage, background: [u8; 3]) -> usize {
    image.pixels().filter(|pixel| pixel.0[..3] != background).count()
}

/// Number of pixels of exactly this colour.
pub(crate) fn count_color(image: &RgbaImage, color: [u8; 3]) -> usize {
    image.pixels().filter(|pixel| pixel.0[..3] == color).count()
}

/// Reports where two images differ: number of pixels and the largest difference of a channel.
pub(crate) fn difference(a: &RgbaImage, b: &RgbaImage) -> (usize, u8) {
    assert_eq!(a.dimensions(), b.dimensions());
    a.pixels()
        .zip(b.pixels())
        .fold((0, 0), |(count, max), (Rgba(a), Rgba(b))| {
            let most = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
            (count + usize::from(most > 0), max.max(most))
        })
}

/// A closed sphere of radius 1 with colours that change along it.
pub(crate) fn colored_sphere(count: u32, style: &Style) -> PreparedFrame {
    let surfels = sphere(count, 1.0);
    let positions = surfels.iter().map(|surfel| surfel.position.to_array());
    let mut raw = RawCloud::from_positions(Positions::F32(positions.collect()));
    let color = |normal: Vec3| {
        let [red, green, blue] = (normal * 100.0 + 128.0).to_array().map(|value| value as u8);
        [red, green, blue, 255]
    };
    raw.attributes.colors = Some(surfels.iter().map(|surfel| color(surfel.normal)).collect());
    raw.attributes.normals = Some(surfels.iter().map(|surfel| surfel.normal.to_array()).collect());
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Scene::needs(style);
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

/// Draws and returns the statistics of it.
pub(crate) fn cost(renderer: &mut GpuRenderer, packet: &ScenePacket) -> RenderStats {
    let before = renderer.stats();
    renderer.prepare(packet).unwrap();
    renderer.render().unwrap();
    let after = renderer.stats();
    RenderStats {
        frames: after.frames - before.frames,
        passes: after.passes - before.passes,
        uploads: after.uploads - before.uploads,
        uploaded_bytes: after.uploaded_bytes - before.uploaded_bytes,
        ..after
    }
}

/// The meaning of sRGB: light from 0 to 1.
pub(crate) fn to_linear(channel: f64) -> f64 {
    if channel <= 0.04045 {
        channel / 12.92
    } else {
        ((channel + 0.055) / 1.055).powf(2.4)
    }
}

/// The inverse of [`to_linear`].
pub(crate) fn to_display(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        light * 12.92
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

/// Lights `style` as `lighting`, by the rig of settings where none is chosen: an environment lights alone.
pub(crate) fn set_lighting(style: &mut Style, lighting: Lighting) {
    let settings = Settings::default().with(|settings| settings.light.lighting = lighting.into());
    style.light.lighting = lighting;
    style.light.rig = settings.decided().light.rig;
}
