//! Labels of points that move, and their occlusion.

use super::*;
use crate::cloud::{Frame, Positions, RawCloud};
use crate::math::Aabb;
use crate::scene::{PointSizing, Primitive, Projection, Scene, Style, UpAxis};
use crate::sequence::{Needs, PrepareCounters, prepare};
use glam::Vec3;
use proptest::prelude::*;
use std::sync::Arc;

const FAR: DVec3 = DVec3::new(1e6, -2e6, 3e5);

fn frame(index: usize, places: &[[f32; 3]], origin: DVec3) -> PreparedFrame {
    let positions = places.iter().map(|&place| {
        let [x, y, z] = place.map(f64::from);
        (origin + DVec3::new(x, y, z)).to_array()
    });
    let raw = RawCloud::from_positions(Positions::F64(positions.collect()));
    let frame = Arc::new(Frame::from_raw(raw, origin).unwrap());
    prepare(index, frame, 0.0, &Needs::default(), &PrepareCounters::default())
}

fn label(point: Option<(u32, Option<usize>)>, place: Option<DVec3>) -> Label {
    Label {
        text: "knee".to_owned(),
        frame: 0,
        point: point.map(|(index_in_file, points_in_file)| FollowedPoint {
            index_in_file,
            points_in_file,
        }),
        place,
        frames: PlayRange::default(),
    }
}

#[test]
fn a_label_follows_its_point_where_indices_are_stable_and_is_fixed_elsewhere() {
    let put = FAR + DVec3::new(1.0, 0.0, 0.0);
    let knee = label(Some((1, Some(3))), Some(put));
    let first = frame(0, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], FAR);
    assert_eq!(knee.place_in(&first, FAR), Some(put));
    // In a different order of positions, with a hole in the file.
    let moved = frame(1, &[[f32::NAN; 3], [-5.0, 2.0, 0.0], [9.0, 0.0, 0.0]], FAR);
    assert_eq!(knee.place_in(&moved, FAR), Some(FAR + DVec3::new(-5.0, 2.0, 0.0)));
    // Fewer points: it is unknown which one it is. The same if it is a hole itself.
    let fewer = frame(2, &[[3.0; 3], [4.0; 3]], FAR);
    let hole = frame(3, &[[0.0; 3], [f32::INFINITY; 3], [9.0, 0.0, 0.0]], FAR);
    for other in [&fewer, &hole] {
        assert_eq!(knee.place_in(other, FAR), Some(put));
    }
    // Hand-written: a point index in any file that has it, and nothing in others; or only a position.
    let by_index = label(Some((1, None)), None);
    assert_eq!(by_index.place_in(&fewer, FAR), Some(FAR + DVec3::splat(4.0)));
    assert_eq!(by_index.place_in(&hole, FAR), None);
    assert_eq!(label(None, Some(put)).place_in(&moved, FAR), Some(put));
}

proptest! {
    /// Compared with the order of the file: whatever the order in memory, the label is at its point.
    #[test]
    fn every_point_of_every_frame_is_found(
        places in prop::collection::vec(prop::array::uniform3(-9f32..9.0), 1..40), index in 0usize..40,
    ) {
        let index = index % places.len();
        let frame = frame(0, &places, DVec3::ZERO);
        let knee = label(Some((index as u32, Some(places.len()))), None);
        let [x, y, z] = places[index].map(f64::from);
        prop_assert_eq!(knee.place_in(&frame, DVec3::ZERO), Some(DVec3::new(x, y, z)));
    }
}

#[test]
fn a_label_is_only_shown_in_its_frames() {
    let mut knee = label(None, Some(DVec3::ZERO));
    knee.frames = PlayRange::default().beginning_at(2).ending_at(4);
    let shown: Vec<usize> = (0..8)
        .filter(|&index| {
            knee.place_in(&frame(index, &[[0.0; 3]], DVec3::ZERO), DVec3::ZERO)
                .is_some()
        })
        .collect();
    assert_eq!(shown, [2, 3, 4]);
}

#[test]
fn label_texts_are_one_line() {
    assert_eq!(Label::as_text("  left\nknee\t "), "left knee");
    assert_eq!(Label::as_text(&"é".repeat(500)).chars().count(), MAX_LABEL_CHARS);
}

/// A wall of points, and one far behind it, next to one that is seen past the wall.
#[test]
fn labels_behind_a_wall_are_hidden_and_those_on_or_next_to_it_are_not() {
    let mut places = Vec::new();
    for x in -10i8..=10 {
        for y in -10i8..=10 {
            places.push([f32::from(x) * 0.1, f32::from(y) * 0.1, 0.0]);
        }
    }
    let wall = places.len() as u32;
    places.extend([[0.0, 0.0, -2.0], [2.5, 0.0, -2.0], [0.0, 0.0, 2.0]]);
    let frame = frame(0, &places, FAR);
    let bounds = Aabb {
        min: Vec3::splat(-2.0),
        max: Vec3::splat(2.0),
    };
    for projection in [Projection::Perspective, Projection::Orthographic] {
        // From +z, where the last point is in front of the wall.
        let camera = Camera {
            azimuth_deg: 0.0,
            elevation_deg: 0.0,
            projection,
            ..Camera::framing(&bounds, FAR, UpAxis::Y)
        };
        assert!(camera.eye_in_world().z > FAR.z);
        let style = Style::default().with(|style| {
            style.primitive = Primitive::Point;
            style.points.sizing = PointSizing::Pixels;
            style.points.size_px = 30.0;
        });
        let size = [640, 480];
        let packet = Scene::default().packet(&frame, FAR, &camera, &style, size);
        // The centre of the wall is behind the last point; a point at its edge is not.
        let labels = [wall, wall + 1, wall + 2, 0].map(|index| label(Some((index, None)), None));
        let on_picture = labels_on_picture(&labels, &frame, FAR, &camera, &packet, size);
        let hidden: Vec<bool> = on_picture.iter().map(|label| label.is_hidden).collect();
        assert_eq!(hidden, [true, false, false, false], "{projection:?}");
        for (label, on_picture) in labels.iter().zip(&on_picture) {
            let place = label.place_in(&frame, FAR).unwrap();
            assert_eq!(on_picture.px, camera.to_px(place, size).unwrap());
        }
        // An image drawn at a smaller size has the same labels.
        let small = Scene::default().packet(&frame, FAR, &camera, &style, [320, 240]);
        let of_small = labels_on_picture(&labels, &frame, FAR, &camera, &small, size);
        assert_eq!(
            of_small.iter().map(|label| label.px).collect::<Vec<_>>(),
            on_picture.iter().map(|label| label.px).collect::<Vec<_>>()
        );
    }
}
