//! Planes and radii of less than all points.

use super::test_shapes::{self, Random};
use super::*;
use crate::cloud::{Frame, Positions, RawCloud};
use glam::DVec3;

/// Points of a torus in Morton order.
fn torus(random: &mut Random) -> Vec<Vec3> {
    let torus = test_shapes::torus(30_000, 0.4, random);
    let positions = torus.positions.iter();
    let positions = positions.map(|p| p.as_dvec3().to_array()).collect();
    let frame = Frame::from_raw(
        RawCloud::from_positions(Positions::F64(positions)),
        DVec3::ZERO,
    );
    frame.unwrap().positions().to_vec()
}

#[test]
fn planes_asked_for_are_those_of_the_whole_and_no_others_are_estimated() {
    let positions = &torus(&mut Random(20));
    let sensor = Vec3::new(3.0, -1.0, 2.0);
    let whole = estimate_planes(positions, 16, PlaneFit::LeastSquares);
    let facing = estimate_surface(positions, Some(sensor)).normals;
    let lazy = LazySurface::new(positions, 16, None);
    let lazy_facing = LazySurface::new(positions, DEFAULT_NEIGHBOURS, Some(sensor));
    assert_eq!(lazy.estimated().planes, 0);
    // Three hundredths of the points, asked for from two threads and again.
    let some = 12_000..12_900;
    let (first, second) = rayon::join(|| lazy.planes(some.clone()), || lazy.planes(some.clone()));
    assert_eq!(first, second);
    assert!(first.normals == whole.normals[some.clone()]);
    assert!(lazy_facing.planes(some.clone()).normals == facing[some.clone()]);
    let estimated = lazy.estimated().planes;
    assert!((900..3_000).contains(&estimated), "{estimated} of 30,000");
    assert_eq!(lazy.planes(some).normals.len(), 900);
    assert_eq!(lazy.estimated().planes, estimated, "each block once");
    assert!(lazy.planes(0..30_000) == whole);
    assert_eq!(lazy.estimated().planes, 30_000);
    assert!(lazy.planes(0..0).normals.is_empty());
}

#[test]
fn planes_asked_for_of_any_cloud_are_those_of_the_whole() {
    let mut random = Random(21);
    let row: Vec<Vec3> = (0..700).map(|i| Vec3::X * i as f32).collect();
    let equal = vec![Vec3::ONE; 600];
    let cube: Vec<Vec3> = (0..1037).map(|_| random.cube()).collect();
    for cloud in [&[][..], &cube[..1], &cube[..3], &row, &equal, &cube] {
        let whole = estimate_planes(cloud, 12, PlaneFit::LeastSquares);
        let lazy = LazySurface::new(cloud, 12, None);
        // From the back, a third at a time.
        let third = cloud.len().div_ceil(3).max(1);
        for start in (0..cloud.len()).step_by(third).rev() {
            let points = start..cloud.len().min(start + third);
            let found = lazy.planes(points.clone());
            assert!(found.normals == whole.normals[points.clone()]);
            let without = whole.without_plane.iter().copied();
            assert!(
                found
                    .without_plane
                    .into_iter()
                    .eq(without.filter(|&p| points.contains(&(p as usize))))
            );
        }
        assert_eq!(lazy.estimated().planes, cloud.len());
    }
}

#[test]
fn radii_asked_for_are_those_of_the_whole_and_no_others_are_measured() {
    let positions = &torus(&mut Random(23));
    let whole = estimate_surface(positions, None).radii;
    let lazy = LazySurface::new(positions, DEFAULT_NEIGHBOURS, None);
    assert_eq!(lazy.estimated(), Estimated::default());
    assert!(lazy.radii(0..0).is_empty());
    assert_eq!(lazy.estimated(), Estimated::default());
    let some = 12_000..12_900;
    let (first, second) = rayon::join(|| lazy.radii(some.clone()), || lazy.radii(some.clone()));
    assert!(first == whole[some.clone()] && second == first);
    // With what is around them, and a fixed sample.
    let estimated = lazy.estimated();
    assert!((900..4_500).contains(&estimated.cells), "{estimated:?}");
    assert_eq!(estimated.planes, estimated.cells);
    assert!(estimated.sampled <= 8 * 512, "{estimated:?}");
    // Again, and their planes: nothing new.
    lazy.radii(some.clone());
    lazy.planes(some);
    assert_eq!(lazy.estimated(), estimated);
    // Planes alone measure no cells; radii where planes are known do.
    lazy.planes(25_000..25_200);
    assert_eq!(lazy.estimated().cells, estimated.cells);
    assert!(lazy.estimated().planes >= estimated.planes + 200);
    assert!(lazy.radii(25_000..25_200) == whole[25_000..25_200]);
    assert!(lazy.radii(0..30_000) == whole);
    let all = Estimated {
        planes: 30_000,
        cells: 30_000,
        ..estimated
    };
    assert_eq!(lazy.estimated(), all);
}

#[test]
fn radii_asked_for_of_any_cloud_in_any_order_are_those_of_the_whole() {
    let mut random = Random(24);
    let row: Vec<Vec3> = (0..700).map(|i| Vec3::X * i as f32).collect();
    let equal = vec![Vec3::ONE; 600];
    let cube: Vec<Vec3> = (0..1037).map(|_| random.cube()).collect();
    // Strays far apart, whose cells reach farther than either limit lets a disk.
    let mut strays = test_shapes::sphere(3000, &mut random).positions;
    strays.extend((0..20).map(|i| Vec3::new(1e3 * i as f32, 1e4, (i * i) as f32)));
    for cloud in [
        &[][..],
        &cube[..1],
        &cube[..3],
        &row,
        &equal,
        &cube,
        &strays,
    ] {
        let whole = estimate_surface(cloud, Some(Vec3::splat(9.0)));
        let lazy = LazySurface::new(cloud, DEFAULT_NEIGHBOURS, Some(Vec3::splat(9.0)));
        // Pieces of 37 points, every fifth and then the next ones, planes before or after radii.
        let starts: Vec<usize> = (0..cloud.len()).step_by(37).collect();
        for skipped in [3, 0, 4, 1, 2] {
            for &start in starts.iter().skip(skipped).step_by(5) {
                let points = start..cloud.len().min(start + 37);
                if start % 2 == 0 {
                    assert!(lazy.planes(points.clone()).normals == whole.normals[points.clone()]);
                }
                assert!(lazy.radii(points.clone()) == whole.radii[points.clone()]);
                assert!(lazy.planes(points.clone()).normals == whole.normals[points]);
            }
        }
        assert_eq!(lazy.estimated().cells, cloud.len());
    }
    // Or else this would not hold a limit of the cloud against that of the whole.
    let mut radii = estimate_surface(&strays, None).radii;
    radii.sort_unstable_by(f32::total_cmp);
    let (median, largest) = (radii[1500], radii[3019]);
    assert!(
        (25.0..40.0).contains(&(largest / median)),
        "{largest} for {median}"
    );
}
