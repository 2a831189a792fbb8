//! Packets of clipped frames against packets of frames that never had the rest.

use super::*;
use crate::cloud::{Frame, Positions, RawCloud};
use crate::scene::pick;
use crate::scene::{
    BackFaces, Camera, CodeStyle, DrawingStyle, Footprint, LevelStyle, Primitive, RendererChoice, Scene, Style, UpAxis,
};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, complete, prepare};
use proptest::prelude::*;
use std::sync::Arc;

const SIZE: [u32; 2] = [96, 64];

/// Far from zero, as the coordinates of a survey are.
const ECEF: DVec3 = DVec3::new(4_510_720.0, -3_911_168.0, 2_207_744.0);

fn frame(places: &[Vec3], origin: DVec3) -> PreparedFrame {
    let positions = places.iter().map(|place| (origin + place.as_dvec3()).to_array());
    let mut raw = RawCloud::from_positions(Positions::F64(positions.collect()));
    let normal = |place: &Vec3| (*place + 0.01).normalize_or(Vec3::Z).to_array();
    raw.attributes.normals = Some(places.iter().map(normal).collect());
    raw.attributes.radii = Some(vec![0.05; places.len()]);
    let frame = Arc::new(Frame::from_raw(raw, origin).unwrap());
    let needs = Needs {
        shapes: true,
        ..Needs::default()
    };
    prepare(0, frame, 0.0, &needs, &PrepareCounters::default())
}

fn camera(origin: DVec3) -> Camera {
    let bounds = Aabb {
        min: Vec3::NEG_ONE,
        max: Vec3::ONE,
    };
    Camera::framing(&bounds, origin, UpAxis::Y)
}

/// Everything that draws: points, surfels of all points, of a cut and of byte codes, voxels.
fn styles() -> Vec<Style> {
    let mut styles: Vec<Style> = Primitive::ALL
        .iter()
        .map(|&primitive| {
            Style::default().with(|style| {
                style.primitive = primitive;
                style.surfels.back_faces = BackFaces::Drawn;
            })
        })
        .collect();
    styles.push(Style {
        levels: LevelStyle {
            surfel_lod: true,
            ..(styles[0]).levels
        },
        ..styles[0]
    });
    styles.push(Style {
        codes: CodeStyle {
            footprint: Footprint::Masks,
            ..(styles[0]).codes
        },
        drawing: DrawingStyle {
            renderer: RendererChoice::Cpu,
            ..(styles[0]).drawing
        },
        ..styles[0]
    });
    styles
}

fn shape() -> impl Strategy<Value = ClipShape> {
    let place = || prop::array::uniform3(-1.2f64..1.2).prop_map(DVec3::from_array);
    prop_oneof![
        (place(), place()).prop_map(|(a, b)| ClipShape::Box {
            min: a.min(b),
            max: a.max(b)
        }),
        (place(), -1.0f64..1.0).prop_map(|(normal, offset)| ClipShape::Plane { normal, offset }),
    ]
}

proptest! {
    #[test]
    fn clipped_packets_match_testing_every_record(
        places in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 0..300),
        shape in shape(),
        keeps_outside: bool,
        is_far: bool,
    ) {
        let origin = if is_far { ECEF } else { DVec3::ZERO };
        let places: Vec<Vec3> = places.into_iter().map(Vec3::from_array).collect();
        let frame = frame(&places, origin);
        let in_world = shape.relative_to(-origin);
        let clip = Clip { keeps_outside, ..Clip::to(in_world) };
        // An independent oracle, in world coordinates.
        let is_drawn = |place: [f32; 3]| {
            let place = origin + Vec3::from_array(place).as_dvec3();
            let is_inside = match in_world {
                ClipShape::Box { min, max } => (0..3).all(|axis| min[axis] <= place[axis] && place[axis] <= max[axis]),
                ClipShape::Plane { normal, offset } => {
                    normal.x * place.x + normal.y * place.y + normal.z * place.z >= offset
                }
            };
            is_inside != keeps_outside
        };
        for way in styles() {
            let frame = complete(&frame, &Scene::needs(&way), &PrepareCounters::default());
            let packet = |clip| {
                let style = way.with(|style| style.of_sequence.clip = clip);
                Scene::default().packet(&frame, origin, &camera(origin), &style, SIZE)
            };
            let (all, clipped) = (packet(None), packet(Some(clip)));
            prop_assert!(clipped.content.coded().is_none());
            if let (Some(all), Some(clipped)) = (all.content.voxels(), clipped.content.voxels()) {
                let retained: Vec<_> = all.records.iter().copied().filter(|cell| is_drawn(cell.center)).collect();
                prop_assert_eq!(&retained, &*clipped.records);
                continue;
            }
            // With a clip, content of a byte code is drawn from all points.
            let points = all.content.points().unwrap_or(&frame.points);
            let retained: Vec<usize> = (0..points.len()).filter(|&slot| is_drawn(points[slot].position)).collect();
            let points: Vec<_> = retained.iter().map(|&slot| points[slot]).collect();
            prop_assert_eq!(&points, &**clipped.content.points().unwrap());
            prop_assert_eq!(clipped.content.shapes().is_some(), way.draws_surfels());
            if let Some(clipped) = clipped.content.shapes() {
                let shapes = all.content.shapes().or(frame.shapes.as_ref()).unwrap();
                let shapes: Vec<_> = retained.iter().map(|&slot| shapes[slot]).collect();
                prop_assert_eq!(&shapes, &**clipped);
            }
        }
    }

    #[test]
    fn clipped_points_are_not_picked(
        places in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 1..200),
        shape in shape(),
        px in (0..SIZE[0], 0..SIZE[1]),
        is_far: bool,
    ) {
        let origin = if is_far { ECEF } else { DVec3::ZERO };
        let places: Vec<Vec3> = places.into_iter().map(Vec3::from_array).collect();
        let frame = frame(&places, origin);
        let clip = Clip::to(shape.relative_to(-origin));
        for way in styles() {
            let style = way.with(|style| style.of_sequence.clip = Some(clip));
            let packet = Scene::default().packet(&frame, origin, &camera(origin), &style, SIZE);
            let at = [px.0, px.1].map(|edge| f64::from(edge) + 0.5);
            let Some(slot) = pick(&packet, &frame, at, 20.0) else { continue };
            let place = Vec3::from_array(frame.points[slot].position).as_dvec3();
            prop_assert!(clip.keeps(origin + place), "{} {:?}", way.primitive, way.codes.footprint);
            // For points, it is the one that is drawn there: unchanged by others.
            if way.primitive == Primitive::Point {
                let alone: Vec<Vec3> =
                    places.iter().copied().filter(|place| clip.keeps(origin + place.as_dvec3())).collect();
                let alone = self::frame(&alone, origin);
                let packet = Scene::default().packet(&alone, origin, &camera(origin), &way, SIZE);
                let other = pick(&packet, &alone, at, 20.0).unwrap();
                let other = Vec3::from_array(alone.points[other].position).as_dvec3();
                prop_assert_eq!(other, place);
            }
        }
    }
}

#[test]
fn an_unchanged_clip_reuses_its_allocation() {
    let places: Vec<Vec3> = (0..100).map(|index| Vec3::splat(index as f32 / 50.0 - 1.0)).collect();
    let frame = frame(&places, DVec3::ZERO);
    let mut scene = Scene::default();
    let mut packet = |min: f64, is_on: bool| {
        let shape = ClipShape::Box {
            min: DVec3::splat(min),
            max: DVec3::ONE,
        };
        let clip = Clip {
            is_on,
            ..Clip::to(shape)
        };
        let style = Style::default().with(|style| style.of_sequence.clip = Some(clip));
        scene.packet(&frame, DVec3::ZERO, &camera(DVec3::ZERO), &style, SIZE)
    };
    let [first, again] = [packet(0.0, true), packet(0.0, true)];
    assert_eq!(first.content.record_count(), 50);
    assert_eq!(first, again);
    assert_ne!(first, packet(0.5, true));
    for whole in [packet(-1.0, true), packet(0.0, false)] {
        assert!(Arc::ptr_eq(whole.content.points().unwrap(), &frame.points));
    }
}

#[test]
fn planes_pass_through_three_points_unless_these_are_collinear() {
    let places = [DVec3::X, DVec3::Y, DVec3::Z].map(|place| ECEF + place);
    let Some(ClipShape::Plane { normal, offset }) = ClipShape::through(places) else {
        panic!("a plane was expected");
    };
    for place in places {
        assert!((normal.dot(place) - offset).abs() < 1e-8);
    }
    let line = [0.0, 1.0, 3.0].map(|share| ECEF + share * DVec3::new(1.0, 2.0, -0.5));
    assert_eq!(ClipShape::through(line), None);
    assert_eq!(ClipShape::through([ECEF; 3]), None);
}
