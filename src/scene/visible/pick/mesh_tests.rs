//! Picks of triangles against a look at every one, with formulas of their own; and cases with known answers.

use super::oracle::Oracle;
use super::tests::{SIZE, camera, packet_of, prepared};
use super::*;
use crate::cloud::{Mesh, Positions, RawCloud};
use crate::scene::{Camera, Clip, ClipShape, PointShape, PointStyle, Primitive, Style};
use crate::sequence::PreparedMesh;
use glam::DVec2;
use proptest::prelude::*;

/// A frame whose points are the vertices of a mesh.
fn mesh(positions: &[[f32; 3]], faces: &[[u32; 3]]) -> PreparedFrame {
    let mut raw = RawCloud::from_positions(Positions::F32(positions.to_vec()));
    raw.faces = faces.to_vec();
    let mesh = Mesh::from_raw(raw.clone(), DVec3::ZERO).unwrap();
    let mut frame = prepared(raw, DVec3::ZERO);
    frame.mesh = Some(PreparedMesh::new(Arc::new(mesh), frame.paint()));
    frame
}

fn style(points: PointStyle) -> Style {
    Style {
        primitive: Primitive::Mesh,
        points,
        ..Style::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn the_picked_triangle_matches_brute_force(
        positions in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 3..120),
        faces in prop::collection::vec(prop::array::uniform3(0u32..120), 1..90),
        distance in 0.2f64..4.0,
        azimuth_deg in -180f64..180.0,
        px in (0..SIZE[0], 0..SIZE[1]),
        size_px in 1f32..9.0,
        is_round: bool,
    ) {
        let faces: Vec<[u32; 3]> =
            faces.into_iter().map(|face| face.map(|corner| corner % positions.len() as u32)).collect();
        let frame = mesh(&positions, &faces);
        let shape = if is_round { PointShape::Disk } else { PointShape::Square };
        let camera = camera(distance, azimuth_deg, DVec3::ZERO);
        let points = PointStyle { size_px, shape, ..PointStyle::default() };
        let packet = packet_of(&frame, DVec3::ZERO, &camera, &style(points));
        let place_px = [f64::from(px.0) + 0.3, f64::from(px.1) + 0.9];
        let oracle = Oracle { packet: &packet, px: DVec2::new(f64::from(px.0) + 0.5, f64::from(px.1) + 0.5) };
        let Some(records) = packet.content.mesh() else {
            // None of the faces has three distinct corners.
            prop_assert!(frame.mesh.unwrap().mesh().triangles().is_empty());
            return Ok(());
        };
        let triangles = Triangles::new(records, &packet);
        let found = Ray::new(&packet, place_px).choose(&triangles, 0.0);
        let expected = oracle.triangle();
        prop_assert_eq!(found.is_some(), expected.is_some());
        if let (Some(seen), Some((record, place))) = (found, expected) {
            // Of two triangles with the same corners rounding decides which is nearer.
            let corners = |record: usize| {
                let mut corners = records.triangles[record].corners;
                corners.sort_unstable();
                corners
            };
            prop_assert_eq!(corners(seen.record), corners(record));
            prop_assert!(seen.place.distance(place) < 1e-6);
            let slot = pick(&packet, &frame, place_px, 0.0).unwrap();
            let apart = |slot: usize| Vec3::from_array(frame.points[slot].position).as_dvec3().distance(place);
            let nearest = (0..frame.points.len()).map(apart).fold(f64::INFINITY, f64::min);
            prop_assert!(apart(slot) <= nearest + 1e-6);
        }
    }
}

/// A large triangle across the view, and a vertex that belongs to none, right of it.
fn wedge() -> PreparedFrame {
    let positions = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.2, 0.9, 0.0]];
    mesh(&positions, &[[0, 1, 2]])
}

#[test]
fn picking_next_to_a_triangle_measures_to_its_edges_not_its_circumcircle() {
    let frame = wedge();
    let camera = Camera {
        elevation_deg: 0.0,
        ..camera(3.0, 0.0, DVec3::ZERO)
    };
    let packet = packet_of(&frame, DVec3::ZERO, &camera, &style(PointStyle::default()));
    let slot_of = |index: u32| frame.frame.file_index().iter().position(|&at| at == index);
    let px_of = |place: DVec3| camera.to_px(place, SIZE).unwrap();
    let at = |place: DVec2, radius_px: f64| pick(&packet, &frame, place.to_array(), radius_px);
    assert_eq!(at(px_of(DVec3::new(-0.8, -0.9, 0.0)), 0.0), slot_of(0));
    assert_eq!(at(px_of(DVec3::new(-0.9, 0.7, 0.0)), 0.0), slot_of(2));
    assert_eq!(at(px_of(DVec3::new(1.2, 0.9, 0.0)), 0.0), slot_of(3));
    // Three and a half pixels from the longest side, well within the circle around the corners.
    let beside = px_of(DVec3::ZERO) + DVec2::new(2.5, -2.5);
    assert_eq!(at(beside, 2.5), None);
    assert!(at(beside, 5.0).is_some());
    // Behind the eye and on the background there is no hit.
    assert_eq!(at(DVec2::new(2.0, 2.0), 5.0), None);
}

#[test]
fn triangles_are_clipped_as_a_whole_by_their_centroids() {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [-2.0, 3.0, 0.0],
    ];
    let frame = mesh(&positions, &[[0, 1, 2], [0, 2, 3]]);
    let clip = Clip::to(ClipShape::Plane {
        normal: DVec3::X,
        offset: 0.1,
    });
    let mut style = style(PointStyle::default());
    let whole = packet_of(&frame, DVec3::ZERO, &camera(4.0, 0.0, DVec3::ZERO), &style);
    style.of_sequence.clip = Some(clip);
    let clipped = packet_of(&frame, DVec3::ZERO, &camera(4.0, 0.0, DVec3::ZERO), &style);
    let [whole, clipped] = [&whole, &clipped].map(|packet| packet.content.mesh().unwrap());
    assert_eq!(whole.triangles.len(), 3);
    assert!(Arc::ptr_eq(&whole.vertices, &clipped.vertices));
    assert_eq!(clipped.triangles.len(), 1);
    assert!((clipped.center(0) - Vec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0)).length() < 1e-6);
}
