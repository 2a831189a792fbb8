//! Picks against all records, one by one, with formulas of their own; and cases with known answers.

use super::oracle::Oracle;
use super::*;
use crate::cloud::{Frame, Positions, RawCloud, ScalarField};
use crate::levels::{LevelsKey, LevelsKind, LevelsSet, Lod};
use crate::scene::{
    BackFaces, Camera, LevelStructure, PicturePlane, PointLight, PointShape, PointSizing, PointStyle, Primitive,
    Projection, Scene, Style, SurfelStyle, UpAxis,
};
use crate::sequence::{Needs, PrepareCounters, prepare};
use glam::DVec2;
use proptest::prelude::*;
use std::sync::Arc;

pub(super) const SIZE: [u32; 2] = [160, 120];

/// Far from zero, as the coordinates of a survey are.
const ECEF: DVec3 = DVec3::new(4_510_720.0, -3_911_168.0, 2_207_744.0);

fn needs() -> Needs {
    Needs {
        shapes: true,
        levels: Some(LevelsKey {
            kind: LevelsKind::LitCubes,
            stop: Style::default().levels.stop,
        }),
        ..Needs::default()
    }
}

pub(super) fn prepared(raw: RawCloud, origin: DVec3) -> PreparedFrame {
    let frame = Frame::from_raw(raw, origin).unwrap();
    prepare(7, Arc::new(frame), 0.0, &needs(), &PrepareCounters::default())
}

/// Points with normals and radii, at `origin`.
fn cloud(places: &[[f32; 3]], radius: f32, origin: DVec3) -> PreparedFrame {
    let positions = places
        .iter()
        .map(|&place| (origin + Vec3::from_array(place).as_dvec3()).to_array());
    let mut raw = RawCloud::from_positions(Positions::F64(positions.collect()));
    // Anywhere, and distinct.
    let normals = places.iter().enumerate().map(|(index, &[x, y, z])| {
        let turned = Vec3::new(y - 0.3, z + 0.2, x + 0.1 * (index % 7) as f32);
        turned.normalize_or(Vec3::Z).to_array()
    });
    raw.attributes.normals = Some(normals.collect());
    raw.attributes.radii = Some(
        (0..places.len())
            .map(|index| radius * (1.0 + (index % 3) as f32))
            .collect(),
    );
    let mut frame = prepared(raw, origin);
    // Thin ones and circles, in many directions.
    let mut shapes = frame.shapes.take().unwrap().to_vec();
    for (index, shape) in (0u32..).zip(&mut shapes) {
        shape.ellipse = ((index * 9973) << 16) | ((index % 4) * 16_000);
    }
    frame.shapes = Some(Arc::new(shapes));
    frame
}

pub(super) fn camera(distance: f64, azimuth_deg: f64, origin: DVec3) -> Camera {
    Camera {
        target_in_world: origin,
        distance,
        azimuth_deg,
        elevation_deg: 20.0,
        fov_deg: 60.0,
        up: UpAxis::Y,
        projection: Projection::Perspective,
        plane: PicturePlane::CENTERED,
    }
}

pub(super) fn packet_of(frame: &PreparedFrame, origin: DVec3, camera: &Camera, style: &Style) -> ScenePacket {
    Scene::default().packet(frame, origin, camera, style, SIZE)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn the_picked_record_matches_brute_force(
        places in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 0..700),
        distance in 0.2f64..4.0,
        azimuth_deg in -180f64..180.0,
        px in (0..SIZE[0], 0..SIZE[1]),
        size_px in 1f32..9.0,
        shape in prop::sample::select(PointShape::ALL),
        light in prop::sample::select(PointLight::ALL),
        sizing in prop::sample::select(PointSizing::ALL),
        scale in 0.1f32..8.0,
        is_far: bool,
        culled: bool,
    ) {
        let origin = if is_far { ECEF } else { DVec3::ZERO };
        let frame = cloud(&places, 0.06, origin);
        let camera = camera(distance, azimuth_deg, origin);
        let place_px = [f64::from(px.0) + 0.3, f64::from(px.1) + 0.9];
        let back_faces = if culled { BackFaces::Culled } else { BackFaces::Drawn };
        for &primitive in Primitive::ALL {
            let style = Style {
                primitive,
                surfels: SurfelStyle { back_faces, ..SurfelStyle::default() },
                points: PointStyle { sizing, size_px, scale, shape, light },
                ..Style::default()
            };
            let packet = packet_of(&frame, origin, &camera, &style);
            let oracle = Oracle { packet: &packet, px: DVec2::new(f64::from(px.0) + 0.5, f64::from(px.1) + 0.5) };
            let found = pick(&packet, &frame, place_px, 0.0);
            match primitive {
                // Without faces.
                Primitive::Point | Primitive::Mesh => prop_assert_eq!(found, oracle.point()),
                Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite => {
                    prop_assert_eq!(found, oracle.surfel());
                }
                Primitive::Voxel => {
                    let Some(record) = oracle.voxel() else {
                        prop_assert_eq!(found, None);
                        continue;
                    };
                    let voxels = packet.content.voxels().unwrap();
                    let cell = Cubes::new(voxels).cell(record);
                    let holds = |slot: usize| cell.contains(Vec3::from_array(frame.points[slot].position).as_dvec3());
                    // No point is inside a gap between cells.
                    let is_gap = !(0..frame.points.len()).any(holds);
                    prop_assert!(found.is_some_and(|slot| is_gap || holds(slot)));
                }
            }
        }
    }

    #[test]
    fn next_to_drawn_points_the_nearest_in_the_image_is_picked(
        places in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 1..60),
        px in (0..SIZE[0], 0..SIZE[1]),
        radius_px in 0f64..40.0,
    ) {
        let frame = cloud(&places, 0.0, DVec3::ZERO);
        let camera = camera(3.0, 10.0, DVec3::ZERO);
        let style = Style { primitive: Primitive::Point, ..Style::default() };
        let packet = packet_of(&frame, DVec3::ZERO, &camera, &style);
        let center = DVec2::new(f64::from(px.0) + 0.5, f64::from(px.1) + 0.5);
        let found = pick(&packet, &frame, center.to_array(), radius_px);
        let apart = |slot: usize| {
            let place = Vec3::from_array(frame.points[slot].position).as_dvec3();
            (camera.to_px(place, SIZE).unwrap() - center).length()
        };
        let nearest = (0..frame.points.len()).map(apart).reduce(f64::min).unwrap();
        match found {
            // Within half a pixel, the size of the square, all are equally near.
            Some(slot) => prop_assert!(apart(slot) <= nearest.max(0.5f64.sqrt()) + 0.5, "{} {}", apart(slot), nearest),
            None => prop_assert!(nearest > radius_px + 0.499),
        }
        if nearest < radius_px {
            prop_assert!(found.is_some());
        }
    }
}

#[test]
fn empty_space_picks_nothing() {
    let origin = DVec3::ZERO;
    let camera = camera(3.0, 0.0, origin);
    for &primitive in Primitive::ALL {
        let style = Style::default().with(|style| {
            style.primitive = primitive;
            style.surfels.back_faces = BackFaces::Drawn;
        });
        let empty = cloud(&[], 0.1, origin);
        let packet = packet_of(&empty, origin, &camera, &style);
        assert_eq!(pick(&packet, &empty, [80.0, 60.0], 1e9), None);
        // Twice as far behind the eye as the target is in front of it.
        let eye = camera.eye_in_world();
        let behind = cloud(&[(eye * 3.0).as_vec3().to_array()], 0.1, origin);
        let packet = packet_of(&behind, origin, &camera, &style);
        assert_eq!(pick(&packet, &behind, [80.0, 60.0], 20.0), None, "{primitive}");
        // A frame that was not prepared for the primitive draws nothing of it.
        let mut bare = cloud(&[[0.0; 3]], 0.1, origin);
        bare.shapes = None;
        bare.levels = LevelsSet::default();
        let packet = packet_of(&bare, origin, &camera, &style);
        let expected = style.draws_points().then_some(0);
        assert_eq!(pick(&packet, &bare, [80.0, 60.0], 5.0), expected);
        // Positions outside any image.
        for place_px in [[f64::NAN; 2], [f64::INFINITY; 2], [-1e300, 1e300]] {
            assert_eq!(pick(&packet, &bare, place_px, 5.0), None);
        }
    }
}

#[test]
fn the_frontmost_is_picked_and_the_last_of_equals() {
    let origin = DVec3::ZERO;
    let camera = Camera {
        elevation_deg: 0.0,
        ..camera(3.0, 0.0, origin)
    };
    let style = Style {
        primitive: Primitive::Point,
        ..Style::default()
    };
    let line = [[0.0, 0.0, -1.0], [0.0, 0.0, 0.5], [0.0, 0.0, 0.0]];
    let frame = cloud(&line, 0.1, origin);
    let packet = packet_of(&frame, origin, &camera, &style);
    let slot = pick(&packet, &frame, [79.9, 59.9], 0.0).unwrap();
    assert_eq!(Pick::of(&frame, origin, slot).unwrap().index_in_file, 1);

    let mut raw = RawCloud::from_positions(Positions::F32(vec![[0.1; 3]; 200]));
    raw.attributes.normals = Some(vec![[0.0, 0.0, 1.0]; 200]);
    raw.attributes.radii = Some(vec![0.1; 200]);
    let same = prepared(raw, origin);
    for &primitive in Primitive::ALL {
        let style = style.with(|style| {
            style.primitive = primitive;
            style.surfels.back_faces = BackFaces::Drawn;
        });
        let packet = packet_of(&same, origin, &camera, &style);
        let px = camera.to_px(DVec3::splat(0.1), SIZE).unwrap();
        let slot = pick(&packet, &same, px.to_array(), 0.0).unwrap();
        assert_eq!(slot, 199, "{primitive}");
    }
}

#[test]
fn back_faces_are_picked_only_where_they_are_drawn() {
    let origin = DVec3::ZERO;
    let camera = camera(3.0, 0.0, origin);
    for (toward, back_faces, expected) in [
        (1.0, BackFaces::Culled, Some(0)),
        (-1.0, BackFaces::Culled, None),
        (-1.0, BackFaces::Drawn, Some(0)),
        (-1.0, BackFaces::Darker, Some(0)),
    ] {
        let mut raw = RawCloud::from_positions(Positions::F32(vec![[0.0; 3]]));
        raw.attributes.normals = Some(vec![[0.0, 0.0, toward]]);
        raw.attributes.radii = Some(vec![0.5]);
        let frame = prepared(raw, origin);
        let style = Style::default().with(|style| style.surfels.back_faces = back_faces);
        let packet = packet_of(&frame, origin, &camera, &style);
        assert_eq!(pick(&packet, &frame, [80.0, 60.0], 3.0), expected);
    }
}

#[test]
fn a_lone_point_is_picked_from_next_to_it() {
    let origin = ECEF;
    let frame = cloud(&[[0.0; 3]], 1e-6, origin);
    let camera = camera(2.0, 77.0, origin);
    for &primitive in Primitive::ALL {
        let style = Style::default().with(|style| {
            style.primitive = primitive;
            style.surfels.back_faces = BackFaces::Drawn;
        });
        let packet = packet_of(&frame, origin, &camera, &style);
        assert_eq!(pick(&packet, &frame, [84.0, 57.0], 6.0), Some(0), "{primitive}");
        // The cell of a single point may have any size.
        if primitive != Primitive::Voxel {
            assert_eq!(pick(&packet, &frame, [84.0, 57.0], 3.0), None, "{primitive}");
        }
    }
}

#[test]
fn a_pick_has_all_file_values_of_the_point() {
    let mut raw = RawCloud::from_positions(Positions::F64(vec![
        [f64::NAN; 3],
        (ECEF + DVec3::new(0.25, 0.5, -0.125)).to_array(),
    ]));
    raw.attributes.colors = Some(vec![[0; 4], [1, 2, 3, 250]]);
    raw.attributes.normals = Some(vec![[1.0, 0.0, 0.0], [0.0, 0.0, -2.0]]);
    raw.attributes.scalars = vec![
        ScalarField::new("intensity", vec![9.0, 0.5]),
        ScalarField::from_f64("gps_time", &[1.3e9, 1.3e9 + 0.001]),
    ];
    let frame = prepared(raw, ECEF);
    let pick = Pick::of(&frame, ECEF, 0).unwrap();
    assert_eq!((pick.frame, pick.slot, pick.index_in_file), (7, 0, 1));
    assert_eq!(pick.position, ECEF + DVec3::new(0.25, 0.5, -0.125));
    assert_eq!(pick.precision, 2f64.powi(-25), "half a step of f32 from 0.5");
    assert_eq!(pick.color, Some([1, 2, 3, 250]));
    assert_eq!(pick.normal, Some(PickedNormal::File(Vec3::NEG_Z)));
    assert_eq!(pick.scalars[0], ("intensity".to_owned(), 0.5));
    let (name, time) = &pick.scalars[1];
    assert_eq!(name, "gps_time");
    // As precise as f64 is for such times.
    assert!((time - (1.3e9 + 0.001)).abs() < 5e-7, "{time}");
    assert_eq!(Pick::of(&frame, ECEF, 1), None);

    let bare = RawCloud::from_positions(Positions::F32(vec![[1.0, 2.0, 3.0]; 9]));
    let pick = Pick::of(&prepared(bare, DVec3::ZERO), DVec3::ZERO, 3).unwrap();
    assert!(matches!(pick.normal, Some(PickedNormal::Estimated(_))));
    assert_eq!((pick.color, pick.scalars.len()), (None, 0));
}

#[test]
fn every_level_structure_is_picked_where_it_is_drawn() {
    let places: Vec<[f32; 3]> = (0..4000)
        .map(|index| {
            let (x, y) = ((index % 63) as f32 / 31.5 - 1.0, (index / 63) as f32 / 31.5 - 1.0);
            [x, y, 0.2 * (x * y)]
        })
        .collect();
    let whole = cloud(&places, 0.02, DVec3::ZERO);
    let primitives = [Primitive::Surfel, Primitive::Point];
    for (&structure, primitive) in LevelStructure::ALL
        .iter()
        .flat_map(|structure| primitives.map(|primitive| (structure, primitive)))
    {
        let style = Style::default().with(|style| {
            style.primitive = primitive;
            style.points.sizing = PointSizing::Adaptive;
            style.levels.surfel_lod = true;
            style.levels.structure = structure;
            style.levels.lod = Lod::Budget(700);
        });
        let frame = prepare(
            7,
            Arc::clone(&whole.frame),
            0.0,
            &Scene::needs(&style),
            &PrepareCounters::default(),
        );
        let packet = packet_of(&frame, DVec3::ZERO, &camera(2.5, 30.0, DVec3::ZERO), &style);
        let Content::Surfels(drawn) = &packet.content else {
            panic!("{structure} draws what has radii")
        };
        assert!(
            (50..=700).contains(&drawn.points.len()),
            "{structure}: {}",
            drawn.points.len()
        );
        let mut picked = 0;
        for px in (0..SIZE[0] * SIZE[1]).step_by(37) {
            let place_px = [f64::from(px % SIZE[0]), f64::from(px / SIZE[0])];
            let Some(slot) = pick(&packet, &frame, place_px, 0.0) else {
                continue;
            };
            picked += 1;
            let position = Vec3::from_array(frame.points[slot].position);
            let is_near = drawn.points.iter().zip(drawn.shapes.iter()).any(|(point, shape)| {
                position.distance(Vec3::from_array(point.position)) <= 2.0 * style.surfels.splat_scale * shape.radius
            });
            assert!(is_near, "{structure}: {position}");
        }
        assert!(picked > 50, "{structure}: {picked}");
    }
}
