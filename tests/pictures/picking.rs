//! Picks against the image: the picked record is the drawn one.

use crate::common;
use crate::common::draw_on_cpu;
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::{Frame, Positions, RawCloud};
use pointreel::levels::Lod;
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::scene::{
    Background, Camera, Content, Footprint, LevelStyle, Lighting, PicturePlane, PointShape, PointStyle, Primitive,
    Projection, RendererChoice, Scene, ScenePacket, Style, SurfelStyle, UpAxis, pick,
};
use pointreel::sequence::{ColorSource, Coloring, Needs, PrepareCounters, PreparedFrame, Sequence, Shape, prepare};
use std::collections::HashMap;
use std::sync::Arc;

const SIZE: [u32; 2] = [320, 240];

/// Step between tested pixels in rows and columns.
const STRIDE: u32 = 3;

/// This many points of a torus, each in a colour that no other has.
fn torus(count: usize, style: &Style) -> PreparedFrame {
    let shape = Sequence::of(Shape::Torus.frame(count)).frame(0).unwrap();
    let positions: Vec<[f32; 3]> = shape.positions().iter().map(Vec3::to_array).collect();
    let mut raw = RawCloud::from_positions(Positions::F32(positions));
    raw.attributes.normals = Some(shape.normals().unwrap().iter().map(Vec3::to_array).collect());
    raw.attributes.colors = Some((0..count).map(|index| color_of(index).with_alpha()).collect());
    let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
    let needs = Needs {
        colors: Coloring::of(ColorSource::File),
        ..Scene::needs(style)
    };
    prepare(0, Arc::new(frame), 0.0, &needs, &PrepareCounters::default())
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Color([u8; 3]);

impl Color {
    fn with_alpha(self) -> [u8; 4] {
        let [red, green, blue] = self.0;
        [red, green, blue, 255]
    }
}

/// Different for every number, and neighbours far apart, so that a blend is hardly ever another one's.
fn color_of(number: usize) -> Color {
    let mixed = (number as u32 + 1).wrapping_mul(0x9e_37_79) & 0xff_ff_ff;
    let [blue, green, red, _] = mixed.to_le_bytes();
    Color([red, green, blue])
}

fn style(primitive: Primitive) -> Style {
    Style::default().with(|style| {
        style.primitive = primitive;
        style.colors = Coloring::of(ColorSource::File);
        style.light.lighting = Lighting::Unlit;
        // Numbers are stored plus one, so that 0 is the background.
        style.backdrop.background = Background::solid([0; 3]);
    })
}

fn camera(projection: Projection) -> Camera {
    Camera {
        target_in_world: DVec3::new(0.1, 0.0, 0.0),
        distance: 3.2,
        azimuth_deg: 25.0,
        elevation_deg: 35.0,
        fov_deg: 50.0,
        up: UpAxis::Z,
        projection,
        plane: PicturePlane::CENTERED,
    }
}

fn packet_of(frame: &PreparedFrame, style: &Style) -> ScenePacket {
    let camera = camera(Projection::Perspective);
    Scene::default().packet(frame, DVec3::ZERO, &camera, style, SIZE)
}

/// Compares pixels all over the image, each that shows one record alone, or nothing, with the pick there: the fraction
/// that agrees, and how many pixels showed a record.
fn agreement(
    image: &RgbaImage,
    numbers: &HashMap<Color, usize>,
    picked: impl Fn([f64; 2]) -> Option<usize>,
    is_same: impl Fn(usize, usize) -> bool,
) -> (f64, usize) {
    let (mut same, mut compared, mut shown) = (0usize, 0usize, 0usize);
    let looked_at = |&(x, y, _): &(u32, u32, &image::Rgba<u8>)| x % STRIDE + y % STRIDE == 0;
    for (x, y, pixel) in image.enumerate_pixels().filter(looked_at) {
        let [red, green, blue, _] = pixel.0;
        let found = picked([f64::from(x) + 0.5, f64::from(y) + 0.5]);
        let agrees = if [red, green, blue] == [0; 3] {
            found.is_none()
        } else if let Some(&number) = numbers.get(&Color([red, green, blue])) {
            shown += 1;
            found.is_some_and(|found| is_same(found, number))
        } else {
            continue;
        };
        compared += 1;
        same += usize::from(agrees);
    }
    (same as f64 / compared as f64, shown)
}

fn slots(frame: &PreparedFrame) -> HashMap<Color, usize> {
    let colors = frame.points.iter().enumerate();
    let slots = colors.map(|(slot, point)| {
        let [red, green, blue, _] = point.color;
        (Color([red, green, blue]), slot)
    });
    slots.collect()
}

#[test]
fn points_are_picked_as_both_renderers_draw_them() {
    let (square, disk) = (PointShape::Square, PointShape::Disk);
    for (size_px, shape, min_shown) in [(1.0, square, 1_000), (4.5, square, 2_000), (4.5, disk, 2_000)] {
        let style = Style {
            points: PointStyle {
                size_px,
                shape,
                ..PointStyle::default()
            },
            ..style(Primitive::Point)
        };
        let frame = torus(30_000, &style);
        let packet = packet_of(&frame, &style);
        let numbers = slots(&frame);
        assert_eq!(numbers.len(), 30_000);
        // A GPU rounds positions to a 256th of a pixel.
        let pictures = [(draw_on_cpu(&packet), 0.999), (common::draw(&packet), 0.995)];
        for (image, min_share) in pictures {
            let (share, shown) = agreement(
                &image,
                &numbers,
                |px| pick(&packet, &frame, px, 0.0),
                |found, slot| found == slot,
            );
            assert!(share > min_share, "{share} at {size_px} px, {shape}");
            assert!(shown > min_shown, "{shown} pixels at {size_px} px, {shape}");
        }
    }
}

#[test]
fn surfels_are_picked_where_only_one_is_visible() {
    // Small enough that many do not overlap others.
    let style = Style {
        surfels: SurfelStyle {
            splat_scale: 0.6,
            ..(style(Primitive::Surfel)).surfels
        },
        ..style(Primitive::Surfel)
    };
    let frame = torus(1_500, &style);
    let packet = packet_of(&frame, &style);
    let image = draw_on_cpu(&packet);
    let numbers = slots(&frame);
    let (share, shown) = agreement(
        &image,
        &numbers,
        |px| pick(&packet, &frame, px, 0.0),
        |found, slot| found == slot,
    );
    assert!(share > 0.99, "{share}");
    assert!(shown > 300, "{shown} pixels");
}

/// The distance of a point along the view.
fn depth_of(packet: &ScenePacket, frame: &PreparedFrame, slot: usize) -> f32 {
    -packet.view.to_view(Vec3::from_array(frame.points[slot].position)).z
}

#[test]
fn surfels_of_closed_surfaces_are_picked_at_the_depth_that_is_drawn() {
    for surfel_lod in [false, true] {
        let style = Style {
            levels: LevelStyle {
                surfel_lod,
                lod: Lod::ThresholdPx(4.0),
                ..(style(Primitive::Surfel)).levels
            },
            ..style(Primitive::Surfel)
        };
        let frame = torus(20_000, &style);
        let packet = packet_of(&frame, &style);
        let points = packet.content.points().unwrap();
        assert_eq!(Arc::ptr_eq(points, &frame.points), !surfel_lod);
        let mut renderer = CpuRenderer::new();
        renderer.prepare(&packet).unwrap();
        let depths = renderer.draw_depths().unwrap();
        let shapes = packet.content.shapes().unwrap();
        let radii = shapes.iter().map(|shape| shape.radius);
        let largest = radii.fold(0f32, f32::max);
        let (mut same, mut seen, mut looked_at) = (0, 0, 0);
        for (index, &depth) in depths.depth.iter().enumerate() {
            let (x, y) = (index as u32 % SIZE[0], index as u32 / SIZE[0]);
            if x % STRIDE + y % STRIDE > 0 {
                continue;
            }
            looked_at += 1;
            let picked = pick(&packet, &frame, [f64::from(x), f64::from(y)], 0.0);
            seen += usize::from(depth.is_finite());
            same += usize::from(match picked {
                Some(slot) => (depth_of(&packet, &frame, slot) - depth).abs() <= 2.0 * largest,
                None => depth.is_infinite(),
            });
        }
        assert!(seen > 1_500, "{seen} pixels");
        let share = same as f64 / f64::from(looked_at);
        assert!(share > 0.99, "{share}");
    }
}

#[test]
fn a_point_inside_the_visible_voxel_is_picked() {
    for lod_px in [0.0, 6.0] {
        let style = Style {
            levels: LevelStyle {
                lod: Lod::ThresholdPx(lod_px),
                ..(style(Primitive::Voxel)).levels
            },
            ..style(Primitive::Voxel)
        };
        let frame = torus(8_000, &style);
        let mut packet = packet_of(&frame, &style);
        let Content::Voxels(voxels) = &mut packet.content else {
            panic!("a packet of voxels");
        };
        let mut records = voxels.records.to_vec();
        for (number, record) in records.iter_mut().enumerate() {
            record.color = color_of(number).0;
        }
        voxels.records = Arc::new(records.clone());
        let edge = voxels.cube_edge;
        let numbers = (0..records.len()).map(|number| (color_of(number), number));
        let image = draw_on_cpu(&packet);
        let (share, shown) = agreement(
            &image,
            &numbers.collect(),
            |px| pick(&packet, &frame, px, 0.0),
            |slot, number| {
                let record = &records[number];
                let half = 0.5 * edge / (1u32 << record.level) as f32;
                let center = Vec3::from_array(record.center);
                let apart = |place: [f32; 3]| (Vec3::from_array(place) - center).abs().max_element();
                let is_gap = !frame.points.iter().any(|point| apart(point.position) <= half * 1.001);
                // A cell next to a gap has a point, and no nearer point is farther away than that one may be.
                let max = if is_gap { 5.0 * half } else { half };
                apart(frame.points[slot].position) <= max * 1.001
            },
        );
        assert!(share > 0.999, "{share} at {lod_px} px");
        assert!(shown > 800, "{shown} pixels");
    }
}

#[test]
fn parallel_rays_pick_what_they_draw() {
    let style = Style {
        points: PointStyle {
            size_px: 3.0,
            ..PointStyle::default()
        },
        ..style(Primitive::Point)
    };
    let frame = torus(30_000, &style);
    let camera = camera(Projection::Orthographic);
    let packet = Scene::default().packet(&frame, DVec3::ZERO, &camera, &style, SIZE);
    let (share, shown) = agreement(
        &draw_on_cpu(&packet),
        &slots(&frame),
        |px| pick(&packet, &frame, px, 0.0),
        |found, slot| found == slot,
    );
    // From that far away f32 has a precision of a few hundredths of a pixel.
    assert!(share > 0.97, "{share}");
    assert!(shown > 1_000, "{shown} pixels");
}

/// A pick on surfels drawn from byte codes is near the pick where the same surfels are drawn as disks.
#[test]
fn byte_codes_are_picked_where_their_surfels_are_drawn() {
    let disks = style(Primitive::Surfel);
    let mut codes = disks;
    codes.codes.footprint = Footprint::Masks;
    codes.drawing.renderer = RendererChoice::Cpu;
    let [of_disks, of_codes] = [disks, codes].map(|style| torus(20_000, &style));
    let [packet, coded] = [packet_of(&of_disks, &disks), packet_of(&of_codes, &codes)];
    assert!(coded.content.coded().is_some());
    let place = |frame: &PreparedFrame, slot: usize| frame.frame.positions()[slot];
    let (mut same, mut near, mut seen) = (0, 0, 0);
    for y in (0..SIZE[1]).step_by(7) {
        for x in (0..SIZE[0]).step_by(7) {
            let px = [f64::from(x), f64::from(y)];
            let found = pick(&packet, &of_disks, px, 0.0);
            let of_code = pick(&coded, &of_codes, px, 0.0);
            same += usize::from(found.is_some() == of_code.is_some());
            seen += 1;
            if let (Some(a), Some(b)) = (found, of_code) {
                near += usize::from(place(&of_disks, a).distance(place(&of_codes, b)) < 0.1);
            }
        }
    }
    assert!(same * 100 >= seen * 95, "{same} of {seen}");
    assert!(near > 200, "{near} of {seen}");
}
