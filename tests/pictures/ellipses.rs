//! Surfels that are longer than wide: their coverage, their sources, and their cost.

use crate::common::{Surfel, camera_at, draw, draw_on_cpu, plain, surfels};
use glam::{DVec2, DVec3, Vec3};
use pointreel::cloud::{Ellipse, Frame, Positions, RawCloud, ShapeRecord, decode_ellipse, encode_ellipse};
use pointreel::levels::LevelsKind;
use pointreel::scene::{Camera, Content, Primitive, Scene, ScenePacket, Splatting, Style, UpAxis};
use pointreel::sequence::{PrepareCounters, PreparedFrame, Sequence, complete, prepare};
use std::sync::Arc;

const SIZE: [u32; 2] = [120, 120];

fn shapes_of(packet: &mut ScenePacket) -> &mut Vec<ShapeRecord> {
    let Content::Surfels(surfels) = &mut packet.content else {
        panic!("a packet of surfels");
    };
    Arc::make_mut(&mut surfels.shapes)
}

fn of_ellipses() -> Style {
    plain().with(|style| {
        style.primitive = Primitive::Ellipse;
        style.surfels.splatting = Splatting::TwoPass;
    })
}

fn of_disks() -> Style {
    of_ellipses().with(|style| style.primitive = Primitive::Surfel)
}

/// One surfel of radius 1 that faces the eye, 3 away.
fn facing(style: Style) -> ScenePacket {
    let surfel = Surfel {
        position: Vec3::ZERO,
        normal: Vec3::Z,
        radius: 1.0,
        color: [255; 3],
    };
    surfels(&[surfel], &camera_at(3.0), style, SIZE)
}

#[test]
fn an_ellipse_covers_the_area_of_its_semi_axes() {
    for (turn, ratio) in [(0.0f32, 0.5f32), (0.5, 0.25), (1.9, 0.7), (-0.6, 0.1)] {
        let mut packet = facing(of_ellipses());
        let axis = Vec3::new(turn.cos(), turn.sin(), 0.0);
        let ellipse = Ellipse { axis, ratio };
        let shape = &mut shapes_of(&mut packet)[0];
        shape.ellipse = encode_ellipse(shape.normal, ellipse);
        let px_per_unit = 0.5 * f64::from(SIZE[1]) * f64::from(packet.view.focal[1]) / 3.0;
        let half_axes_px = ellipse
            .half_axes_of_quadratic_mean(1.0)
            .map(|half| f64::from(half) * px_per_unit);
        for (image, by) in [(draw(&packet), "GPU"), (draw_on_cpu(&packet), "CPU")] {
            let mut covered = 0;
            for (x, y, pixel) in image.enumerate_pixels() {
                let [right, down] = [x, y].map(|px| f64::from(px) + 0.5 - 0.5 * f64::from(SIZE[0]));
                let at = DVec2::new(right, -down);
                let along = DVec2::from_angle(f64::from(turn));
                let place = DVec2::new(along.dot(at), along.perp_dot(at));
                let share = |slack_px: f64| (place / (DVec2::from_array(half_axes_px) + slack_px)).length();
                let is_drawn = pixel.0[..3] != [0; 3];
                covered += u32::from(is_drawn);
                // Within a pixel of the edge it may be either.
                assert!(
                    !is_drawn || share(1.0) <= 1.0,
                    "{by}: ({x}, {y}) of {turn}, {ratio} is outside"
                );
                assert!(
                    is_drawn || share(-1.0) >= 1.0,
                    "{by}: ({x}, {y}) of {turn}, {ratio} is inside"
                );
            }
            assert!(covered > 100, "{by}: {covered} pixels");
        }
    }
}

#[test]
fn an_ellipse_of_equal_axes_is_the_disk() {
    let disk = facing(of_disks());
    let mut circle = facing(of_ellipses());
    shapes_of(&mut circle)[0].ellipse = 0;
    for (disk, circle) in [(draw(&disk), draw(&circle)), (draw_on_cpu(&disk), draw_on_cpu(&circle))] {
        let max = disk
            .as_raw()
            .iter()
            .zip(circle.as_raw())
            .map(|(a, b)| a.abs_diff(*b))
            .max();
        assert!(max <= Some(1), "{max:?}");
    }
}

/// A frame of the demo, whose files have neither normals nor radii.
fn demo(style: &Style, counters: &PrepareCounters) -> PreparedFrame {
    let frame = Arc::new(Sequence::demo().frame(9).unwrap());
    prepare(9, frame, 0.0, &Scene::needs(style), counters)
}

#[test]
fn ellipses_are_estimated_once_and_disks_need_nothing_more() {
    let counters = PrepareCounters::default();
    let disks = of_disks();
    let of_disks = demo(&disks, &counters);
    assert!(!of_disks.has_ellipses && counters.ellipses_estimated() == 0);
    let of_ellipses = complete(&of_disks, &Scene::needs(&of_ellipses()), &counters);
    assert!(of_ellipses.has_ellipses && counters.ellipses_estimated() == 1);
    let again = complete(&of_ellipses, &Scene::needs(&disks), &counters);
    let (shapes, before) = (again.shapes.unwrap(), of_disks.shapes.unwrap());
    assert!(Arc::ptr_eq(&shapes, of_ellipses.shapes.as_ref().unwrap()));
    assert_eq!((counters.ellipses_estimated(), counters.surfaces_estimated()), (1, 1));
    let without_ellipse = |shape: &ShapeRecord| ShapeRecord { ellipse: 0, ..*shape };
    assert!(shapes.iter().map(without_ellipse).eq(before.iter().copied()));
    let thin = shapes.iter().filter(|shape| shape.ellipse != 0).count();
    assert!(2 * thin > shapes.len(), "{thin} of {} are no circles", shapes.len());
}

#[test]
fn ellipses_of_a_file_are_drawn_unchanged_and_disks_have_their_area() {
    let ellipse = Ellipse {
        axis: Vec3::Y,
        ratio: 0.25,
    };
    let mut raw = RawCloud::from_positions(Positions::F32(vec![[0.0; 3]]));
    raw.attributes.normals = Some(vec![[0.0, 0.0, 1.0]]);
    raw.attributes.radii = Some(vec![2.0]);
    raw.attributes.ellipses = Some(vec![ellipse]);
    let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap());
    let counters = PrepareCounters::default();
    let disks = Scene::needs(&of_disks());
    let ellipses = Scene::needs(&of_ellipses());
    let of_disks = prepare(0, frame, 0.0, &disks, &counters);
    let of_ellipses = complete(&of_disks, &ellipses, &counters);
    let again = complete(&of_ellipses, &disks, &counters);
    assert_eq!(counters.ellipses_estimated(), 0, "the file has them");
    let shape = |frame: &PreparedFrame| frame.shapes.as_ref().unwrap()[0];
    for frame in [&of_disks, &again] {
        assert_eq!((shape(frame).radius, shape(frame).ellipse), (2.0, 0));
    }
    let drawn = shape(&of_ellipses);
    let found = decode_ellipse(drawn.normal, drawn.ellipse);
    for (half_axis, expected) in found
        .half_axes_of_quadratic_mean(drawn.radius)
        .into_iter()
        .zip([4.0, 1.0])
    {
        assert!((half_axis - expected).abs() < 1e-3, "{half_axis} for {expected}");
    }
    assert!(found.axis.dot(Vec3::Y).abs() > 0.9999);
}

#[test]
fn levels_of_detail_of_ellipses_are_drawn_as_ellipses() {
    let style = of_ellipses().with(|style| style.levels.surfel_lod = true);
    assert_eq!(style.levels_kind(), Some(LevelsKind::Surfels));
    let frame = demo(&style, &PrepareCounters::default());
    let mut camera = Camera::framing(&frame.frame.bounds(), DVec3::ZERO, UpAxis::Y);
    camera.distance *= 4.0;
    let packet = Scene::default().packet(&frame, DVec3::ZERO, &camera, &style, SIZE);
    let shapes = packet.content.shapes().unwrap();
    assert!(
        shapes.len() < frame.points.len() / 2,
        "{} cells are drawn",
        shapes.len()
    );
    let thin = shapes.iter().filter(|shape| shape.ellipse != 0).count();
    assert!(2 * thin > shapes.len(), "{thin} of {} are no circles", shapes.len());
}
