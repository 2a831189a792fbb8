//! Round trips of written files.

use super::*;
use proptest::prelude::*;

fn scale(file: &[u8]) -> f64 {
    f64::from_le_bytes(take(file, 131))
}

#[test]
fn everything_written_is_read_back() {
    // More than one chunk when compressed.
    let cloud = sample(120_000);
    for compressed in [false, true] {
        let file = written(&cloud, compressed);
        let back = read(&file);
        assert_eq!(back.attributes.colors, cloud.attributes.colors);
        for name in ["classification", "gps_time"] {
            assert_eq!(numbers(&back, name), numbers(&cloud, name), "{name}");
        }
        let full = |number: &f64| number.min(65535.0);
        let expected: Vec<f64> = numbers(&cloud, "intensity").iter().map(full).collect();
        assert_eq!(numbers(&back, "intensity"), expected);
        assert_eq!(numbers(&back, "return_number"), vec![1.0; 120_000]);
        let (Positions::F64(found), Positions::F64(expected)) = (&back.positions, &cloud.positions) else {
            panic!("not of double precision");
        };
        for (found, expected) in found.iter().zip(expected) {
            for axis in 0..3 {
                assert!((found[axis] - expected[axis]).abs() < 1e-9 * 120_000.0);
            }
        }
        assert_eq!(file.len() < 36 * 120_000 / 2, compressed, "{}", file.len());
    }
}

#[test]
fn the_scale_is_the_coarsest_that_loses_nothing() {
    for (positions, expected) in [
        // Millimetres of a map projection.
        (
            Positions::F64(vec![[470_692.441, 0.0, 0.0], [470_000.12, 0.0, 0.0]]),
            1e-3,
        ),
        (Positions::F64(vec![[4_602_888.125_47, 0.0, 0.0]]), 1e-5),
        // Not a decimal fraction: the finest step that fits, or the last bit of single precision.
        (Positions::F64(vec![[-1.0 / 3.0, 0.0, 0.0], [1000.0, 0.0, 0.0]]), 1e-6),
        (Positions::F32(vec![[1.0 / 3.0, 0.0, 0.0], [0.1, 0.0, 0.0]]), 1e-8),
        // Too far apart for millimetres.
        (Positions::F64(vec![[-6e9, 0.0, 0.0], [6e9, 0.0, 0.0]]), 10.0),
        (Positions::F64(Vec::new()), 1e-3),
    ] {
        let file = written(&RawCloud::from_positions(positions.clone()), false);
        assert_eq!(scale(&file), expected, "{positions:?}");
        let back = read(&file);
        for index in 0..positions.len() {
            let error = (back.positions.get(index) - positions.get(index)).abs();
            assert!(error.max_element() <= expected / 2.0 + 1e-9, "{positions:?}");
        }
    }
}

#[test]
fn intensities_from_0_to_1_become_16_bits() {
    for (values, expected) in [
        (vec![0.0, 0.5, 1.0], [0.0, 32768.0, 65535.0]),
        (vec![0.0, 1.0, 1.0], [0.0, 1.0, 1.0]),
        (vec![-3.0, f32::NAN, 1e9], [0.0, 0.0, 65535.0]),
    ] {
        let mut cloud = RawCloud::from_positions(Positions::F32(vec![[0.0; 3]; 3]));
        cloud.attributes.scalars.push(ScalarField::new("Intensity", values));
        assert_eq!(numbers(&read(&written(&cloud, true)), "intensity"), expected);
    }
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -1e3..1e3f64,
        4 => (-5_000_000i64..5_000_000).prop_map(|millimetres| millimetres as f64 / 1000.0),
        2 => 4.0e6..4.1e6f64,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn finite_points_round_trip_within_the_resolution(
        points in prop::collection::vec([coordinate(), coordinate(), coordinate()], 0..40),
        compressed: bool,
        single: bool,
    ) {
        let narrow = |point: &[f64; 3]| point.map(|value| value as f32);
        let positions = if single {
            Positions::F32(points.iter().map(narrow).collect())
        } else {
            Positions::F64(points)
        };
        let back = read(&written(&RawCloud::from_positions(positions.clone()), compressed));
        let finite: Vec<_> = (0..positions.len())
            .map(|index| positions.get(index))
            .filter(|position| position.is_finite())
            .collect();
        prop_assert_eq!(back.positions.len(), finite.len());
        // All of them are within a cube of 5000 km: millimetres in the worst case.
        for (index, expected) in finite.into_iter().enumerate() {
            let error = (back.positions.get(index) - expected).abs().max_element();
            prop_assert!(error <= 0.5e-3 + 1e-9, "{} at {}", error, expected);
        }
    }
}
