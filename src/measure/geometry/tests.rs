//! Distances of clouds against constructed answers and against all pairs.

use super::*;
use proptest::prelude::*;

/// 20×20 points of a plane, one unit apart.
fn plane(shift: Vec3) -> Vec<Vec3> {
    (0..400)
        .map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0) + shift)
        .collect()
}

fn both(value: [f64; 2]) -> Distances {
    let way = OneWay {
        mean_squared: value[0],
        largest: value[1],
    };
    Distances {
        from_reference: way,
        from_test: way,
    }
}

#[test]
fn equal_clouds_have_no_error() {
    let cloud = plane(Vec3::ZERO);
    let error = GeometryError::of(&cloud, Some(&[Vec3::Z; 400]), &cloud).unwrap();
    assert_eq!(error.point_to_point, both([0.0, 0.0]));
    assert_eq!(error.point_to_plane, Some(both([0.0, 0.0])));
    assert_eq!(error.point_to_point.psnr_db(1.0), Some(f64::INFINITY));
}

#[test]
fn a_shifted_plane_has_the_error_of_its_shift() {
    let cloud = plane(Vec3::ZERO);
    for (shift, d1, d2) in [
        ([0.25, 0.0, 0.0], 0.0625, 0.0),
        ([0.0, 0.0, 0.5], 0.25, 0.25),
        ([0.25, 0.0, -0.5], 0.3125, 0.25),
    ] {
        // Normals of any length.
        let normals = [Vec3::Z * 3.0; 400];
        let moved = plane(Vec3::from_array(shift));
        let error = GeometryError::of(&cloud, Some(&normals), &moved).unwrap();
        assert_eq!(error.point_to_point, both([d1, d1.sqrt()]));
        assert_eq!(error.point_to_plane, Some(both([d2, d2.sqrt()])));
        // A grid of 19 steps: 3 · 19² over the error.
        let found = error.point_to_point.psnr_db(19.0).unwrap();
        let expected = 10.0 * (3.0 * 361.0 / d1).log10();
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }
}

#[test]
fn an_outlier_is_seen_from_the_test_and_a_hole_from_the_reference() {
    let cloud = plane(Vec3::ZERO);
    let mut test = cloud.clone();
    test.push(Vec3::new(4.0, 4.0, 10.0));
    let error = GeometryError::of(&cloud, None, &test).unwrap();
    assert_eq!(error.point_to_plane, None);
    let found = error.point_to_point;
    let expected = OneWay {
        mean_squared: 100.0 / 401.0,
        largest: 10.0,
    };
    assert_eq!(found.from_reference, both([0.0, 0.0]).from_reference);
    assert_eq!(found.from_test, expected);
    assert_eq!((found.mean_squared(), found.hausdorff()), (100.0 / 401.0, 10.0));

    let row: Vec<Vec3> = (0..10).map(|x| Vec3::X * x as f32).collect();
    let error = GeometryError::of(&row, None, &row[..7]).unwrap();
    // 1, 2 and 3 away from the last remaining point.
    assert_eq!(error.point_to_point.from_reference.mean_squared, 1.4);
    assert_eq!(error.point_to_point.from_reference.largest, 3.0);
    assert_eq!(error.point_to_point.from_test.largest, 0.0);
}

#[test]
fn test_normals_are_means_over_the_reference_points_nearest_to_them() {
    let reference = [Vec3::X, -Vec3::X];
    let error = GeometryError::of(&reference, Some(&[Vec3::X, Vec3::Y]), &[Vec3::ZERO]).unwrap();
    let found = error.point_to_plane.unwrap();
    // The mean of x and y has half the length along x; the nearest neighbour of the test point is the first of two
    // equally near ones.
    assert_eq!(found.from_reference.mean_squared, 0.25);
    assert_eq!(found.from_test.mean_squared, 1.0);
    // Without a normal the full distance counts.
    for none in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        let error = GeometryError::of(&reference, Some(&[none; 2]), &[Vec3::ZERO]).unwrap();
        assert_eq!(error.point_to_plane, Some(error.point_to_point));
    }
}

#[test]
fn incomparable_clouds_are_reported() {
    let one = [Vec3::ZERO];
    let odd = [Vec3::ZERO, Vec3::new(0.0, f32::NAN, 0.0)];
    let cases: [(&[Vec3], &[Vec3], &str); 4] = [
        (&[], &one, "the reference has no points"),
        (&one, &[], "the test has no points"),
        (&odd, &one, "point 1 of the reference is not finite"),
        (&one, &odd, "point 1 of the test is not finite"),
    ];
    for (reference, test, expected) in cases {
        let error = GeometryError::of(reference, None, test).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
    let error = GeometryError::of(&one, Some(&odd), &one).unwrap_err();
    assert_eq!(error.to_string(), "2 normals do not belong to 1 points");
}

#[test]
fn extreme_numbers_produce_no_nan() {
    for [a, b] in [[Vec3::MAX, Vec3::MIN], [Vec3::splat(f32::MIN_POSITIVE), Vec3::ZERO]] {
        let error = GeometryError::of(&[a], Some(&[Vec3::splat(1.0e-40)]), &[b]).unwrap();
        for found in [error.point_to_point, error.point_to_plane.unwrap()] {
            assert!(found.mean_squared() > 0.0 && found.mean_squared().is_finite());
            assert!(found.psnr_db(f64::MAX).unwrap().is_finite());
            assert!(found.psnr_db(f64::MIN_POSITIVE).unwrap().is_finite());
            for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                assert_eq!(found.psnr_db(wrong), None);
            }
        }
    }
}

#[test]
fn results_do_not_depend_on_thread_count() {
    let wave = |i: u32, by: f32| {
        let [x, y] = [(i % 150) as f32 * 0.07, (i / 150) as f32 * 0.09];
        Vec3::new(x + by, y, (x * 1.3).sin() + by * y)
    };
    let [reference, test]: [Vec<Vec3>; 2] = [0.0, 0.013].map(|by| (0..20_000).map(|i| wave(i, by)).collect());
    let normals = vec![Vec3::new(0.2, 0.1, 0.9); reference.len()];
    let compare = || GeometryError::of(&reference, Some(&normals), &test).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    assert_eq!(pool.unwrap().install(compare), compare());
}

/// For each of `from` the index of the nearest of `to`, the first of equal ones, by asking all.
fn all_pairs(from: &[Vec3], to: &[Vec3]) -> Vec<usize> {
    let nearest = |&place: &Vec3| {
        let distance = |index: usize| place.as_dvec3().distance_squared(to[index].as_dvec3());
        (0..to.len()).fold(
            0,
            |best, index| {
                if distance(index) < distance(best) { index } else { best }
            },
        )
    };
    from.iter().map(nearest).collect()
}

/// Mean square and largest of `lengths`.
fn summary(lengths: &[f64]) -> [f64; 2] {
    let squares: f64 = lengths.iter().map(|length| length * length).sum();
    [
        squares / lengths.len() as f64,
        lengths.iter().copied().fold(0.0, f64::max),
    ]
}

proptest! {
    #[test]
    fn random_clouds_match_brute_force(
        reference in prop::collection::vec(prop::array::uniform6(-9i8..9), 1..60),
        test in prop::collection::vec(prop::array::uniform3(-9i8..9), 1..60),
    ) {
        let vector = |at: &[i8]| Vec3::new(f32::from(at[0]), f32::from(at[1]), f32::from(at[2]));
        let normals: Vec<Vec3> = reference.iter().map(|at| vector(&at[3..])).collect();
        let reference: Vec<Vec3> = reference.iter().map(|at| vector(at)).collect();
        let test: Vec<Vec3> = test.iter().map(|at| vector(at)).collect();
        let error = GeometryError::of(&reference, Some(&normals), &test).unwrap();

        let to_test = all_pairs(&reference, &test);
        let to_reference = all_pairs(&test, &reference);
        let unit = |index: usize| {
            let normal = normals[index].as_dvec3();
            (normal.length() > 0.0).then(|| normal / normal.length())
        };
        let normal_of_test = |index: usize| {
            let mapped = (0..reference.len()).filter(|&from| to_test[from] == index);
            let given: Vec<DVec3> = mapped.filter_map(unit).collect();
            match given.len() {
                0 => unit(to_reference[index]),
                count => Some(given.iter().sum::<DVec3>() / count as f64),
            }
        };
        let way = |a: Vec3, b: Vec3| a.as_dvec3() - b.as_dvec3();
        let along = |way: DVec3, normal: Option<DVec3>| {
            normal.map_or(way.length(), |normal| way.dot(normal).abs())
        };
        let [mut d1, mut d2] = [[const { Vec::new() }; 2], [const { Vec::new() }; 2]];
        for (index, &point) in reference.iter().enumerate() {
            let way = way(point, test[to_test[index]]);
            d1[0].push(way.length());
            d2[0].push(along(way, normal_of_test(to_test[index])));
        }
        for (index, &point) in test.iter().enumerate() {
            let way = way(point, reference[to_reference[index]]);
            d1[1].push(way.length());
            d2[1].push(along(way, unit(to_reference[index])));
        }
        for (found, expected) in [(error.point_to_point, d1), (error.point_to_plane.unwrap(), d2)] {
            for (found, expected) in [found.from_reference, found.from_test].into_iter().zip(expected) {
                let expected = summary(&expected);
                for (found, expected) in [found.mean_squared, found.largest].into_iter().zip(expected) {
                    prop_assert!((found - expected).abs() <= 1e-12 * (1.0 + expected), "{found} for {expected}");
                }
            }
        }
    }
}
