//! Analysis against brute force and against shapes whose surface is known.

use super::test_shapes::{self, Random, Sampled};
use super::*;
use crate::cloud::{Frame, Positions, RawCloud};
use glam::{DVec3, IVec3};
use proptest::prelude::*;

fn neighbours_by_brute_force(positions: &[Vec3], k: usize) -> Vec<Vec<u32>> {
    (0..positions.len())
        .map(|index| {
            let mut others: Vec<(f32, u32)> = (0..positions.len())
                .filter(|&other| other != index)
                .map(|other| {
                    let d = positions[other] - positions[index];
                    (d.x * d.x + d.y * d.y + d.z * d.z, other as u32)
                })
                .collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            others.truncate(k);
            others.into_iter().map(|(_, other)| other).collect()
        })
        .collect()
}

fn check_neighbours(positions: &[Vec3], k: usize) {
    let found = nearest_neighbours(positions, k);
    for (index, expected) in neighbours_by_brute_force(positions, k).iter().enumerate() {
        assert_eq!(found.of(index), expected, "point {index} of {}", positions.len());
    }
}

#[test]
fn neighbours_of_random_clouds() {
    let mut random = Random(1);
    for count in [0, 1, 2, 5, 13, 16, 17, 100, 2000] {
        let cloud: Vec<Vec3> = (0..count).map(|_| random.cube()).collect();
        for k in [0, 1, 8, 12, 16, 40] {
            check_neighbours(&cloud, k);
        }
    }
    check_neighbours(&test_shapes::torus(2000, 0.3, &mut random).positions, 12);
}

#[test]
fn neighbours_where_distances_tie() {
    let mut random = Random(2);
    let lattice: Vec<Vec3> = (0..12 * 12 * 12)
        .map(|i| Vec3::new((i % 12) as f32, (i / 12 % 12) as f32, (i / 144) as f32))
        .collect();
    // In shuffled order, so that index and position are unrelated.
    let mut shuffled = lattice.clone();
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, random.next_bits() as usize % (i + 1));
    }
    check_neighbours(&lattice, 12);
    check_neighbours(&shuffled, 12);
    let plane: Vec<Vec3> = shuffled.iter().map(|p| p.with_y(0.0)).collect();
    check_neighbours(&plane, 12);
    check_neighbours(&plane, 16);
    let line: Vec<Vec3> = shuffled.iter().map(|p| Vec3::new(p.x, 0.0, 0.0)).collect();
    check_neighbours(&line, 12);
    check_neighbours(&[Vec3::splat(3.0); 200], 12);
}

#[test]
fn neighbours_with_outliers_and_at_extreme_scales() {
    let mut random = Random(3);
    let cloud: Vec<Vec3> = (0..800).map(|_| random.cube()).collect();
    let outlier: Vec<Vec3> = cloud.iter().copied().chain([Vec3::splat(1e6)]).collect();
    check_neighbours(&outlier, 12);
    for scale in [1e-6f32, 1e9] {
        let scaled: Vec<Vec3> = cloud.iter().map(|&p| p * scale).collect();
        check_neighbours(&scaled, 12);
    }
    // Above the square root of f32::MAX plain squared distances are infinite; the result is the same as for the
    // unscaled cloud.
    let huge = 2f32.powi(120);
    let scaled: Vec<Vec3> = cloud.iter().map(|&p| p * huge).collect();
    assert_eq!(nearest_neighbours(&scaled, 12), nearest_neighbours(&cloud, 12));
}

/// 60,000 points that a grid or an unbalanced tree would search in quadratic time, which no one would wait for.
#[test]
fn degenerate_clouds_are_not_quadratic() {
    let mut random = Random(4);
    let count = 60_000;
    let tiny: Vec<Vec3> = (0..count)
        .map(|_| random.cube() * 1e-3)
        .chain([Vec3::splat(1e6)])
        .collect();
    let equal = vec![Vec3::new(1.0, 2.0, 3.0); count];
    let two_places: Vec<Vec3> = (0..count).map(|i| Vec3::splat((i % 2) as f32)).collect();
    // Squared distances in the cluster underflow compared with the outlier: all equal to 0.
    let underflow: Vec<Vec3> = (0..count)
        .map(|_| random.cube() * 1e-30)
        .chain([Vec3::splat(1e30)])
        .collect();
    for cloud in [tiny, equal, two_places, underflow] {
        let surface = estimate_surface(&cloud, None);
        assert_defined(&surface, cloud.len());
    }
    let lists = nearest_neighbours(&vec![Vec3::ONE; count], 3);
    assert_eq!(lists.of(0), [1, 2, 3]);
    assert_eq!(lists.of(40_000), [0, 1, 2]);
}

proptest! {
    #[test]
    fn neighbours_of_any_cloud(points in prop::collection::vec(prop::array::uniform3(-6i8..6), 0..150),
        k in 0usize..20) {
        let positions: Vec<Vec3> = points.into_iter().map(|p| Vec3::from_array(p.map(f32::from))).collect();
        check_neighbours(&positions, k);
    }

    #[test]
    fn surfaces_of_any_cloud_are_defined(points in prop::collection::vec(prop::array::uniform3(-3i8..3), 0..60)) {
        let positions: Vec<Vec3> = points.into_iter().map(|p| Vec3::from_array(p.map(f32::from))).collect();
        assert_defined(&estimate_surface(&positions, None), positions.len());
        assert_defined(&estimate_surface(&positions, Some(Vec3::Z)), positions.len());
    }
}

fn assert_defined(surface: &Surface, count: usize) {
    assert_eq!((surface.normals.len(), surface.radii.len()), (count, count));
    assert!(surface.without_plane.is_sorted());
    assert!(surface.normals.iter().all(|normal| normal.is_normalized()));
    assert!(surface.radii.iter().all(|radius| radius.is_finite() && *radius > 0.0));
}

#[test]
fn few_and_degenerate_points_have_a_surface() {
    let mut random = Random(5);
    for count in 0..=8 {
        let cloud: Vec<Vec3> = (0..count).map(|_| random.cube()).collect();
        assert_defined(&estimate_surface(&cloud, None), count);
    }
    let one = estimate_surface(&[Vec3::splat(7.0)], None);
    assert_eq!((one.normals[0], one.radii[0]), (Vec3::Z, LONE_RADIUS));
    let equal = estimate_surface(&[Vec3::splat(7.0); 50], None);
    assert_eq!((equal.normals[9], equal.radii[9]), (Vec3::Z, LONE_RADIUS));

    let direction = Vec3::new(1.0, 2.0, -0.5).normalize();
    let line: Vec<Vec3> = (0..50).map(|i| direction * i as f32).collect();
    let surface = estimate_surface(&line, None);
    assert_defined(&surface, 50);
    for normal in &surface.normals {
        assert!(normal.dot(direction).abs() < 1e-3);
    }
    // Half the distance to a neighbour, plus the overlap: the line has no gap.
    assert!(surface.radii[5..45].iter().all(|radius| (0.5..0.7).contains(radius)));
}

/// A cell of points in a line is open between two parallel lines, in two directions of no width, wherever these are
/// among the directions that cells are measured along.
#[test]
fn lines_in_any_direction_have_small_disks() {
    for direction in [
        Vec3::new(0.25, -2.0, 0.5),
        Vec3::new(1.0, 0.1, 0.01),
        Vec3::new(0.1, 0.2, 0.9),
        Vec3::new(0.3, 0.7, 0.1),
        Vec3::ONE,
    ] {
        let line: Vec<Vec3> = (0..500).map(|i| direction * (i as f32 / 128.0)).collect();
        let spacing = direction.length() / 128.0;
        let surface = estimate_surface(&line, None);
        for (index, radius) in surface.radii.iter().enumerate() {
            let spacings = radius / spacing;
            assert!(
                (0.58..0.65).contains(&spacings),
                "a radius of {spacings} spacings at {index} along {direction}"
            );
        }
    }
}

/// Angles in degrees between found and true normals, sign included: mean and largest.
pub(super) fn angles(found: &[Vec3], truth: &[Vec3]) -> (f32, f32) {
    let angles: Vec<f32> = found
        .iter()
        .zip(truth)
        .map(|(a, b)| a.angle_between(*b).to_degrees())
        .collect();
    (
        angles.iter().sum::<f32>() / angles.len() as f32,
        angles.iter().copied().fold(0.0, f32::max),
    )
}

fn assert_outwards(shape: &Sampled, mean_degrees: f32, max_degrees: f32) {
    let surface = estimate_surface(&shape.positions, None);
    let (mean, max) = angles(&surface.normals, &shape.normals);
    assert!(
        mean < mean_degrees && max < max_degrees,
        "mean {mean}, largest {max} degrees"
    );
}

#[test]
fn normals_of_closed_shapes_point_outward() {
    let mut random = Random(6);
    let sphere = test_shapes::sphere(10_000, &mut random);
    let torus = test_shapes::torus(20_000, 0.4, &mut random);
    assert_outwards(&sphere, 1.2, 8.0);
    assert_outwards(&torus, 2.0, 20.0);
    let far = sphere
        .clone()
        .and(test_shapes::sphere(3_000, &mut random).moved(Vec3::new(5.0, 1.0, 0.0)));
    assert_outwards(&far, 1.5, 15.0);
    // A sphere within a sphere: two components, each oriented outwards.
    let mut inner = test_shapes::sphere(3_000, &mut random);
    inner.positions.iter_mut().for_each(|position| *position *= 0.5);
    assert_outwards(&sphere.and(inner), 1.5, 15.0);
}

#[test]
fn orientation_crosses_sharp_edges_and_keeps_thin_sheets_apart() {
    let mut random = Random(7);
    for half_edges in [Vec3::ONE, Vec3::new(1.0, 1.0, 0.03), Vec3::new(1.0, 0.2, 0.05)] {
        let shape = test_shapes::cuboid(30_000, half_edges, &mut random);
        let surface = estimate_surface(&shape.positions, None);
        let wrong = surface
            .normals
            .iter()
            .zip(&shape.normals)
            .filter(|(found, truth)| found.dot(**truth) < -0.1)
            .count();
        assert!(wrong < 30, "{wrong} of 30,000 face inwards of {half_edges}");
    }
}

/// A bumpy dish: at its rim the surface slopes either way, so that its extreme points say nothing, but its convex side
/// is below.
#[test]
fn samples_of_an_open_surface_turn_the_same_side_out() {
    for seed in 20..30 {
        let mut random = Random(seed);
        let mut positions = Vec::new();
        while positions.len() < 8000 {
            let Vec3 { x, y, .. } = 10.0 * random.cube();
            if x.hypot(y) < 10.0 {
                positions.push(Vec3::new(
                    x,
                    y,
                    0.02 * (x * x + y * y) + 0.2 * (3.0 * x).sin() * (3.0 * y).sin(),
                ));
            }
        }
        let surface = estimate_surface(&positions, None);
        let below = surface.normals.iter().filter(|normal| normal.z < 0.0).count();
        assert!(
            below * 100 > positions.len() * 95,
            "seed {seed}: {below} of 8,000 point down"
        );
    }
}

#[test]
fn noise_does_not_flip_patches() {
    let mut random = Random(8);
    let mut sphere = test_shapes::sphere(20_000, &mut random);
    for position in &mut sphere.positions {
        *position *= 1.0 + 0.005 * (random.unit() - 0.5);
    }
    let surface = estimate_surface(&sphere.positions, None);
    let wrong = surface
        .normals
        .iter()
        .zip(&sphere.normals)
        .filter(|(found, truth)| found.dot(**truth) < 0.0)
        .count();
    assert_eq!(wrong, 0);
}

#[test]
fn normals_face_the_sensor() {
    let mut random = Random(9);
    let sensor = Vec3::new(0.5, -4.0, 2.0);
    let sphere = test_shapes::sphere(5_000, &mut random);
    let surface = estimate_surface(&sphere.positions, Some(sensor));
    for (normal, position) in surface.normals.iter().zip(&sphere.positions) {
        assert!(normal.dot(sensor - position) >= 0.0);
    }
}

#[test]
fn planes_are_exact_far_from_the_origin() {
    let mut random = Random(10);
    let normal = Vec3::new(0.0, 0.6, 0.8);
    for offset in [0.0, 1e3, 1e5, 131_072.0 - 32.0] {
        // On multiples of 2⁻⁶, which f32 holds exactly up to 2¹⁷.
        let positions: Vec<Vec3> = (0..5000)
            .map(|_| {
                let (a, b) = ((random.unit() * 1000.0).round(), (random.unit() * 200.0).round());
                Vec3::new(a, b * 4.0, b * -3.0) / 64.0 + Vec3::splat(offset)
            })
            .collect();
        let surface = estimate_surface(&positions, None);
        for found in &surface.normals {
            assert!(found.dot(normal) > 0.999_999, "{found} at {offset}");
        }
    }
}

/// Sheets of rolling hills a thousandth high, at 10⁶ units from the origin: in the file's f64, which frames are made
/// of, the hills survive, and their normals are as good as at the origin.
#[test]
fn details_survive_a_shift_of_the_file() {
    let mut random = Random(16);
    let places: Vec<DVec3> = (0..4000)
        .map(|_| {
            let (x, y) = (f64::from(random.unit()), f64::from(random.unit()));
            DVec3::new(x, y, 1e-3 * (20.0 * x).sin())
        })
        .collect();
    let normals_at = |shift: f64| {
        let shifted = places.iter().map(|&place| (place + shift).to_array());
        let raw = RawCloud::from_positions(Positions::F64(shifted.collect()));
        let origin = if shift == 0.0 { DVec3::ZERO } else { DVec3::splat(shift) };
        let frame = Frame::from_raw(raw, origin).unwrap();
        let normals = estimate_surface(frame.positions(), Some(Vec3::Z * 10.0)).normals;
        let mut by_file = vec![Vec3::ZERO; normals.len()];
        for (&index, normal) in frame.file_index().iter().zip(normals) {
            by_file[index as usize] = normal;
        }
        by_file
    };
    let (near, far) = (normals_at(0.0), normals_at(1e6));
    // A position in f64 at 10⁶ is rounded by 10⁻¹⁰, an f32 offset of 1 by 10⁻⁷, compared with the mean spacing of
    // 0.016.
    let (_, largest) = angles(&near, &far);
    assert!(largest < 0.05, "{largest} degrees");
    let truth: Vec<Vec3> = places
        .iter()
        .map(|place| Vec3::new(-0.02 * (20.0 * place.x).cos() as f32, 0.0, 1.0).normalize())
        .collect();
    let (mean, _) = angles(&far, &truth);
    assert!(mean < 0.1, "{mean} degrees, where the hills slope by one");
}

/// Points (of small whole coordinates) that lie on a line or in one place with their neighbours, by exact arithmetic.
fn without_plane_by_brute_force(points: &[[i8; 3]], k: usize) -> Vec<u32> {
    let positions: Vec<Vec3> = points.iter().map(|p| Vec3::from(p.map(f32::from))).collect();
    let lists = neighbours_by_brute_force(&positions, k);
    let is_line = |(index, list): &(usize, &Vec<u32>)| {
        let offsets = || {
            list.iter().map(|&other| {
                let other = points[other as usize];
                IVec3::from(std::array::from_fn::<i32, 3, _>(|axis| {
                    i32::from(other[axis]) - i32::from(points[*index][axis])
                }))
            })
        };
        offsets().all(|a| offsets().all(|b| a.cross(b) == IVec3::ZERO))
    };
    let lines = lists.iter().enumerate().filter(is_line);
    lines.map(|(index, _)| index as u32).collect()
}

proptest! {
    // Few distinct coordinates, so that many points coincide or are collinear.
    #[test]
    fn points_without_a_plane_are_reported(
        points in prop::collection::vec(prop::array::uniform3(-2i8..3), 0..60),
        flattened in 0usize..4,
        k in 0usize..7,
    ) {
        let points: Vec<[i8; 3]> = points
            .into_iter()
            .map(|point| std::array::from_fn(|axis| if axis < flattened { 1 } else { point[axis] }))
            .collect();
        let positions: Vec<Vec3> = points.iter().map(|p| Vec3::from(p.map(f32::from))).collect();
        let planes = estimate_planes(&positions, k, PlaneFit::default());
        prop_assert!(planes.normals.iter().all(|normal| normal.is_normalized()));
        prop_assert_eq!(planes.without_plane, without_plane_by_brute_force(&points, k));
    }
}

#[test]
fn lines_and_coincident_points_have_no_plane() {
    let mut random = Random(17);
    let all = |count: u32| (0..count).collect::<Vec<u32>>();
    let without = |cloud: &[Vec3]| estimate_surface(cloud, None).without_plane;
    for count in 0..=8 {
        let cloud: Vec<Vec3> = (0..count).map(|_| random.cube()).collect();
        let expected = if count < 3 { all(count) } else { Vec::new() };
        assert_eq!(without(&cloud), expected);
    }
    assert_eq!(without(&[Vec3::new(0.1, -7.0, 3e8); 50]), all(50));
    // Rounding moves the points off these lines, and more so the farther they are from the origin.
    for shift in [0.0, 1.0, 1e3, 1e6] {
        for _ in 0..20 {
            let (start, direction) = (random.cube() + shift, random.cube());
            let line: Vec<Vec3> = (0..50).map(|i| start + direction * i as f32).collect();
            assert_eq!(without(&line), all(50), "from {start} along {direction}");
        }
    }
    // A lattice next to a line: only the line is reported, and the lattice has its normal down to the last bits.
    let lattice = (0..400).map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0));
    let line = (0..50).map(|i| Vec3::new(1000.0, 0.0, 3.0 * i as f32));
    let both: Vec<Vec3> = lattice.chain(line).collect();
    let surface = estimate_surface(&both, None);
    assert!(surface.without_plane.iter().copied().eq(400..450));
    for normal in &surface.normals[..400] {
        assert!(normal.abs_diff_eq(Vec3::Z, 1e-6));
    }
    // Copies of three positions count as three points.
    for copies in [13, 5] {
        let places = [Vec3::ZERO, Vec3::X, Vec3::new(0.2, 0.7, 0.0)];
        let cloud: Vec<Vec3> = places.iter().flat_map(|&place| vec![place; copies]).collect();
        assert_eq!(without(&cloud), [0u32; 0]);
    }
}

/// Share of rays from `origins` against `directions` that miss every disk within `reach` of where they start.
fn uncovered(shape: &Sampled, radii: &[f32], probes: &Sampled) -> f32 {
    let reach = radii.iter().copied().fold(0.0, f32::max) * 2.0;
    let is_hole = |probe: Vec3, direction: Vec3| {
        !shape
            .positions
            .iter()
            .zip(&shape.normals)
            .zip(radii)
            .any(|((&center, &normal), &radius)| {
                let offset = center - probe;
                if offset.length_squared() > reach * reach {
                    return false;
                }
                let slope = normal.dot(direction);
                let hit = direction * (normal.dot(offset) / slope);
                slope.abs() > 0.2 && (hit - offset).length_squared() <= radius * radius
            })
    };
    let holes = probes
        .positions
        .iter()
        .zip(&probes.normals)
        .filter(|&(&probe, &direction)| is_hole(probe, direction))
        .count();
    holes as f32 / probes.positions.len() as f32
}

#[test]
fn disks_close_the_surface() {
    let mut random = Random(11);
    for (mut shape, probes) in [
        (
            test_shapes::sphere(4_000, &mut random),
            test_shapes::sphere(20_000, &mut random),
        ),
        (
            test_shapes::torus(8_000, 0.4, &mut random),
            test_shapes::torus(20_000, 0.4, &mut random),
        ),
    ] {
        let surface = estimate_surface(&shape.positions, None);
        shape.normals = surface.normals;
        let holes = uncovered(&shape, &surface.radii, &probes);
        assert!(holes <= 0.0005, "{holes} of the surface is open");
        let half: Vec<f32> = surface.radii.iter().map(|radius| radius * 0.5).collect();
        let without = uncovered(&shape, &half, &probes);
        assert!(without > 0.05, "half the radius would do: {without}");
    }
}

#[test]
fn outliers_do_not_grow_giant_disks() {
    let mut random = Random(12);
    let mut cloud = test_shapes::sphere(5_000, &mut random).positions;
    cloud.push(Vec3::splat(1e6));
    cloud.extend((0..5).map(|i| Vec3::new(30.0 + i as f32 * 5.0, 0.0, 0.0)));
    let surface = estimate_surface(&cloud, None);
    let largest = surface.radii.iter().copied().fold(0.0, f32::max);
    assert!(largest < 2.0, "{largest}");
}

#[test]
fn sparse_regions_keep_their_large_disks() {
    // Spacing grows sixtyfold along x, as in a LiDAR sweep.
    let mut positions = Vec::new();
    let mut x = 1.0f32;
    while x < 60.0 {
        let step = 0.02 * x;
        positions.extend((-10..=10).map(|row| Vec3::new(x, row as f32 * step, 0.0)));
        x += step;
    }
    let surface = estimate_surface(&positions, None);
    for (position, radius) in positions.iter().zip(&surface.radii) {
        let spacing = 0.02 * position.x;
        assert!((0.6..1.8).contains(&(radius / spacing)), "{radius} at {position}");
    }
}

#[test]
fn radii_alone_match_those_of_the_full_estimate() {
    let mut random = Random(13);
    let torus = test_shapes::torus(3_000, 0.4, &mut random);
    let surface = estimate_surface(&torus.positions, None);
    // Some are given with the opposite sign, which does not matter, and some have to be estimated.
    let some_missing: Vec<Vec3> = surface
        .normals
        .iter()
        .enumerate()
        .map(|(i, &normal)| match i % 3 {
            0 => Vec3::ZERO,
            1 => normal,
            _ => -normal,
        })
        .collect();
    for (a, b) in splat_radii(&torus.positions, &some_missing).iter().zip(&surface.radii) {
        assert!((a - b).abs() <= 1e-3 * b);
    }
}

#[test]
fn results_do_not_depend_on_thread_count() {
    let torus = test_shapes::torus(30_000, 0.4, &mut Random(14));
    let with_threads = |count| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .build()
            .unwrap()
            .install(|| {
                (
                    nearest_neighbours(&torus.positions, 12),
                    estimate_surface(&torus.positions, None),
                )
            })
    };
    let one = with_threads(1);
    assert!(with_threads(2) == one && with_threads(5) == one);
}

#[test]
fn progress_steps_add_up_and_cancelling_stops_after_the_first_stage() {
    let torus = test_shapes::torus(500, 0.4, &mut Random(8)).positions;
    for sensor in [None, Some(Vec3::Z)] {
        let progress = Progress::default();
        let surface = estimate_surface_observed(&torus, sensor, SurfaceOptions::default(), &progress);
        assert_eq!(progress.done(), surface_steps(500, sensor));
        assert_eq!(surface.normals, estimate_surface(&torus, sensor).normals);
        let cancelled = Progress::default();
        cancelled.cancel();
        estimate_surface_observed(&torus, sensor, SurfaceOptions::default(), &cancelled);
        assert_eq!(cancelled.done(), TREE_STEPS * 500, "the first stage alone");
    }
}
