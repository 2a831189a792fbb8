//! Clouds with missing points of every kind, and clouds whose points only look missing.

use super::*;
use proptest::prelude::*;

/// A wavy ground of 50 × 40 points a metre apart.
fn ground(at: DVec3) -> Vec<DVec3> {
    let point = |index: u32| {
        let [x, y] = [index % 50, index / 50].map(f64::from);
        at + DVec3::new(x, y, 2.0 * (0.3 * x).sin())
    };
    (0..2000).map(point).collect()
}

fn found(points: &[DVec3]) -> MissingPoints {
    let positions = points.iter().map(glam::DVec3::to_array).collect();
    MissingPoints::find(&Positions::F64(positions), NoData::Auto, Known::default())
}

const UTM: DVec3 = DVec3::new(431_000.0, 4_581_000.0, 120.0);

#[test]
fn one_and_many_zeros_are_found_in_a_survey() {
    for count in [1, 20, 1500] {
        let mut points = ground(UTM);
        points.splice(7..7, vec![DVec3::ZERO; count]);
        let missing = found(&points);
        let expected: Vec<u32> = (7..7 + count as u32).collect();
        assert_eq!(missing.indices, expected);
        assert_eq!(missing.values[0].value, "0 0 0");
        assert_eq!(missing.values[0].count, count);
        assert!(missing.bounds.unwrap().0.x >= 431_000.0);
    }
}

#[test]
fn constants_are_found_per_coordinate() {
    for constant in [-9999.0, 65_535.0, -2_147_483.648, 1e30, -3.4e38, -32_768.0] {
        let mut points = ground(DVec3::ZERO);
        points[100].z = constant;
        points[200].z = constant;
        let missing = found(&points);
        assert_eq!(missing.indices, [100, 200], "{constant}");
        assert!(missing.values[0].value.starts_with("z = "), "{:?}", missing.values);
        assert_eq!(missing.values[0].count, 2);
    }
}

#[test]
fn absurdly_distant_points_are_missing_and_distant_ones_are_not() {
    for (x, is_missing) in [(1e9, true), (-3e6, true), (400.0, false)] {
        let mut points = ground(DVec3::ZERO);
        points[3].x = x;
        assert_eq!(!found(&points).is_empty(), is_missing, "{x}");
    }
}

#[test]
fn measurements_are_not_missing() {
    // A model at the origin with a vertex there; ground at z = 0; ground around the origin; one of another size.
    assert!(found(&ground(DVec3::ZERO)).is_empty());
    assert!(found(&ground(DVec3::new(-25.0, -20.0, 0.0))).is_empty());
    let flat: Vec<DVec3> = ground(DVec3::ZERO).iter().map(|point| point.with_z(0.0)).collect();
    assert!(found(&flat).is_empty());
    // Elevations around 999.
    let high: Vec<DVec3> = ground(DVec3::ZERO)
        .iter()
        .map(|point| point + DVec3::Z * 999.0)
        .collect();
    assert!(found(&high).is_empty());
    let line: Vec<DVec3> = (0..500).map(|index| DVec3::X * f64::from(index)).collect();
    assert!(found(&line).is_empty());
    assert!(found(&[DVec3::ZERO; 100]).is_empty());
    assert!(found(&[]).is_empty());
}

#[test]
fn zeros_in_a_void_are_missing_and_a_sweep_around_them_is_not() {
    // A scanner in a room that writes 0 0 0 where it got no return.
    let mut points: Vec<DVec3> = (0..4000)
        .map(|index| {
            let turn = f64::from(index) * 0.37;
            DVec3::new(5.0 * turn.cos(), 5.0 * turn.sin(), f64::from(index % 20) * 0.1 - 1.0)
        })
        .collect();
    points.extend([DVec3::ZERO; 50]);
    let missing = found(&points);
    assert_eq!(missing.indices.len(), 50);
    assert_eq!(missing.present_count, 4000);
}

#[test]
fn the_user_can_define_the_no_data_value() {
    let positions = ground(DVec3::ZERO).iter().map(glam::DVec3::to_array).collect();
    let positions = Positions::F64(positions);
    let find = |rule| MissingPoints::find(&positions, rule, Known::default());
    assert_eq!(find(NoData::Value(0.0)).indices, [0]);
    assert_eq!(find(NoData::Value(7.0)).indices.len(), 40 + 50 - 1);
    assert!(find(NoData::None).is_empty());
    for (text, rule) in [
        ("auto", NoData::Auto),
        ("none", NoData::None),
        ("-9999", NoData::Value(-9999.0)),
        ("-1,-1,-1", NoData::Place([-1.0; 3])),
    ] {
        assert_eq!(text.parse(), Ok(rule));
        assert_eq!(rule.to_string(), text);
    }
    assert_eq!("0, 0 0".parse(), Ok(NoData::Place([0.0; 3])));
    assert!("1,2".parse::<NoData>().is_err());
    assert!("nan".parse::<NoData>().is_err() && "zero".parse::<NoData>().is_err());
}

/// A ball on a table of 4 × 4 m, as a scanner in the centre of a room sees it: 2000 points.
fn table(at: DVec3) -> Vec<DVec3> {
    let point = |index: u32| {
        let turn = f64::from(index) * 2.399_963;
        if index.is_multiple_of(2) {
            let height = f64::from(index) / 1000.0 - 1.0;
            let across = (1.0 - height * height).max(0.0).sqrt();
            at + DVec3::new(across * turn.cos(), across * turn.sin(), 1.0 + height)
        } else {
            let across = 2.0 * (f64::from(index) / 2000.0).sqrt();
            at + DVec3::new(across * turn.cos(), across * turn.sin(), 0.001 * turn.sin())
        }
    };
    (0..2000).map(point).collect()
}

/// Replaces every `step`-th point by the result of `other`.
fn replaced(points: &[DVec3], step: usize, other: impl Fn(usize, DVec3) -> DVec3) -> (Vec<DVec3>, Vec<u32>) {
    let with_other = |(index, &point): (usize, &DVec3)| {
        if index.is_multiple_of(step) {
            other(index, point)
        } else {
            point
        }
    };
    let indices = (0..points.len()).step_by(step).map(|index| index as u32).collect();
    (points.iter().enumerate().map(with_other).collect(), indices)
}

#[test]
fn many_points_at_one_place_are_missing_whatever_the_number() {
    for at in [DVec3::ZERO, UTM, DVec3::new(10.0, 0.0, 0.0)] {
        for value in [-1.0, 1.0, 100.0, -1000.0, 999.99, 32.767] {
            let (points, indices) = replaced(&table(at), 20, |_, _| DVec3::splat(value));
            let missing = found(&points);
            assert_eq!(missing.indices, indices, "{value} at {at}");
            assert!(missing.in_words().starts_with(&format!("{} points", indices.len())));
        }
    }
    let (points, _) = replaced(&table(DVec3::ZERO), 20, |_, _| DVec3::splat(100.0));
    assert_eq!(found(&points).values[0].value, "100 100 100");
    // Most of the points, near the rest, in a void.
    let (points, indices) = replaced(&table(DVec3::new(0.0, 0.0, 3.0)), 1, |index, point| {
        if index % 3 == 0 { point } else { DVec3::NEG_ONE }
    });
    assert_eq!(found(&points).indices.len(), indices.len() - 667);
}

#[test]
fn repeated_real_points_are_retained() {
    // Two objects far apart; a far object; positions that all have copies; the tip of a needle of triangles.
    let (points, _) = replaced(&table(DVec3::ZERO), 2, |_, point| point + DVec3::X * 50.0);
    assert!(found(&points).is_empty());
    let (points, _) = replaced(&table(DVec3::ZERO), 20, |_, point| point + DVec3::X * 200.0);
    assert!(found(&points).is_empty());
    let copied: Vec<DVec3> = table(UTM).into_iter().flat_map(|point| [point; 30]).collect();
    assert!(found(&copied).is_empty());
    let tip = |index: usize, point: DVec3| {
        if index.is_multiple_of(3) {
            DVec3::Z * 100.0
        } else {
            point
        }
    };
    let (points, _) = replaced(&table(DVec3::ZERO), 1, tip);
    let positions = Positions::F64(points.iter().map(DVec3::to_array).collect());
    let known = Known {
        has_faces: true,
        ..Known::default()
    };
    assert!(MissingPoints::find(&positions, NoData::Auto, known).is_empty());
}

#[test]
fn a_minority_of_local_coordinates_does_not_move_a_survey() {
    for step in [20, 4, 3] {
        let (points, indices) = replaced(&table(UTM), step, |_, point| point - UTM);
        let missing = found(&points);
        assert_eq!(missing.indices, indices, "one in {step}");
        assert!(missing.bounds.unwrap().0.x > 430_000.0);
    }
    let (points, indices) = replaced(&table(UTM), 10, |_, point| DVec3::Z * point.z);
    let missing = found(&points);
    assert_eq!(
        (&missing.indices, missing.values[0].value.as_str()),
        (&indices, "x = y = 0")
    );
    // Two halves: it is unknown which one is wrong.
    let (points, _) = replaced(&table(UTM), 2, |_, point| point - UTM);
    assert!(found(&points).is_empty());
}

#[test]
fn heights_of_zero_far_below_the_rest_are_missing() {
    let (points, indices) = replaced(&table(UTM), 7, |_, point| point.with_z(0.0));
    let missing = found(&points);
    assert_eq!(
        (&missing.indices, missing.values[0].value.as_str()),
        (&indices, "z = 0")
    );
    let positions = Positions::F64(points.iter().map(DVec3::to_array).collect());
    let said = MissingPoints::find(&positions, NoData::Value(0.0), Known::default());
    assert_eq!(said.indices, indices);
    // A floor below objects that hang above it.
    let floor = |_: usize, point: DVec3| DVec3::new(point.x * 5.0, point.y * 5.0, 0.0);
    let (points, _) = replaced(&table(DVec3::Z * 9.0), 3, floor);
    assert!(found(&points).is_empty());
}

#[test]
fn equal_distances_in_all_directions_are_the_maximum_range() {
    for range in [65.535, 1000.0, 12.3 * 7.0] {
        let far = |index: usize, _: DVec3| {
            let turn = index as f64 * 2.399_963;
            let height = index as f64 / 1000.0 - 1.0;
            let across = (1.0 - height * height).sqrt();
            let at = DVec3::new(across * turn.cos(), across * turn.sin(), height) * range;
            at.as_vec3().as_dvec3()
        };
        let (points, indices) = replaced(&table(DVec3::ZERO), 4, far);
        let missing = found(&points);
        assert_eq!(missing.indices.len(), indices.len(), "{range}");
        let total: usize = missing.values.iter().map(|value| value.count).sum();
        assert_eq!(total, indices.len());
    }
}

#[test]
fn limits_of_integer_types_are_named() {
    let limits = [0, 1, 2].map(|axis| [i32::MIN, i32::MAX].map(|integer| f64::from(integer) * 0.001 + UTM[axis]));
    let (points, indices) = replaced(&table(UTM), 100, |_, _| {
        DVec3::new(limits[0][0], limits[1][0], limits[2][0])
    });
    let positions = Positions::F64(points.iter().map(DVec3::to_array).collect());
    let known = Known {
        limits: Some(limits),
        has_faces: false,
    };
    let missing = MissingPoints::find(&positions, NoData::Auto, known);
    assert_eq!(missing.indices, indices);
    assert_eq!(missing.values[0].value, "x = y = z = the smallest 32-bit integer");
    let few = MissingPoints::find(&positions, NoData::Place(points[0].to_array()), known);
    assert_eq!(few.indices, indices);
    let mut found_in = FoundIn {
        point_count: 2000,
        whole_count: Some(4000),
        is_only_frame: false,
    };
    let why = |found_in| missing.assumption(NoData::Auto, found_in).unwrap().why;
    assert!(
        why(found_in).starts_with("about 40 points in a frame at most, away"),
        "{}",
        why(found_in)
    );
    found_in.whole_count = None;
    found_in.is_only_frame = true;
    assert!(why(found_in).starts_with("20 points away"), "{}", why(found_in));
}

proptest! {
    /// The bounds are the same as without the missing points, and only these are holes.
    #[test]
    fn bounds_exclude_missing_points(
        x in -1e6f64..1e6, y in -1e7f64..1e7, count in 1usize..200, place in 0usize..2000,
    ) {
        let at = DVec3::new(x, y, 50.0);
        prop_assume!(at.truncate().length() > 200.0);
        let clean = ground(at);
        let expected = found(&clean);
        let mut points = clean.clone();
        points.splice(place..place, vec![DVec3::ZERO; count]);
        let missing = found(&points);
        prop_assert_eq!(missing.bounds, expected.bounds);
        prop_assert_eq!(missing.indices.len(), count);
        let mut positions = Positions::F64(points.iter().map(glam::DVec3::to_array).collect());
        make_holes(&mut positions, &missing.indices);
        prop_assert_eq!(positions.finite_bounds().1, expected.bounds);
    }
}
