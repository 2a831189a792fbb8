//! Every point by default: as many come out as went in, each within an eighth of the spacing around it.

use super::clouds::{decoded, file_of, open, surface};
use crate::cloud::{Positions, RawCloud};
use crate::reel::{Coding, ReelOptions, StreamKind};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

/// Neighbourhoods that a spacing may be the median of.
const NEIGHBOURHOODS: [usize; 3] = [5, 8, 12];

/// The median distance to the nearest other position among the points around each point; infinity without another
/// position. Computed by comparing all with all.
fn spacings(positions: &[DVec3], around: usize) -> Vec<f64> {
    let mut distinct = positions.to_vec();
    distinct.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
    distinct.dedup();
    let others = |from: DVec3| {
        let mut others: Vec<(f64, usize)> = (0..distinct.len())
            .map(|place| (distinct[place].distance(from), place))
            .collect();
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        others
    };
    let nearest: Vec<f64> = distinct
        .iter()
        .map(|&position| others(position).get(1).map_or(f64::INFINITY, |other| other.0))
        .collect();
    let spacing = |&position: &DVec3| {
        let mut lengths: Vec<f64> = others(position)
            .iter()
            .take(around + 1)
            .map(|&(_, place)| nearest[place])
            .collect();
        lengths.sort_by(f64::total_cmp);
        lengths[lengths.len() / 2]
    };
    positions.iter().map(spacing).collect()
}

fn positions(cloud: &RawCloud) -> Vec<DVec3> {
    (0..cloud.positions.len())
        .map(|point| cloud.positions.get(point))
        .collect()
}

/// Positions of the points of `frames` in a file, in the order in which they were written.
fn retained(frames: &[RawCloud], coding: Coding) -> (Vec<Vec<DVec3>>, Vec<u8>) {
    let options = ReelOptions {
        keep_order: true,
        coding,
        ..ReelOptions::default()
    };
    let bytes = file_of(frames, &options);
    let frames = (0..frames.len()).map(|index| positions(&decoded(&bytes, index, usize::MAX).cloud));
    (frames.collect(), bytes)
}

fn check(clouds: &[RawCloud], coding: Coding) -> Result<(), TestCaseError> {
    let (retained, _) = retained(clouds, coding);
    for (cloud, retained) in clouds.iter().zip(retained) {
        let was = positions(cloud);
        prop_assert_eq!(was.len(), retained.len());
        let spacings = NEIGHBOURHOODS.map(|around| spacings(&was, around));
        for (point, (&was, &is)) in was.iter().zip(&retained).enumerate() {
            let spacing = spacings.iter().map(|of| of[point]).fold(0.0, f64::max);
            let error = was.distance(is);
            prop_assert!(
                error <= spacing / 8.0,
                "point {}: {} became {}, {} of {}",
                point,
                was,
                is,
                error,
                spacing
            );
        }
    }
    Ok(())
}

/// Numbers between 0 and 1.
fn unit() -> impl Strategy<Value = f64> {
    (0u32..1 << 24).prop_map(|number| f64::from(number) / f64::from(1 << 24))
}

fn unit_cube() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(unit()).prop_map(DVec3::from_array)
}

/// Positions of every kind: even, in clusters, many at one place, dense here and sparse there, on a grid, on a line.
fn any_positions() -> impl Strategy<Value = Vec<DVec3>> {
    let points = || prop::collection::vec(unit_cube(), 1..160);
    prop_oneof![
        points(),
        (prop::collection::vec((unit_cube(), -4i32..1), 1..5), points()).prop_map(|(clusters, points)| {
            let in_cluster = |(index, point): (usize, DVec3)| {
                let (center, exponent) = clusters[index % clusters.len()];
                100.0 * center + point * 10f64.powi(exponent)
            };
            points.into_iter().enumerate().map(in_cluster).collect()
        }),
        (prop::collection::vec(unit_cube(), 1..40), 1usize..9).prop_map(|(points, times)| {
            let count = points.len() * times;
            points.into_iter().cycle().take(count).collect()
        }),
        // The same number at every distance as at ten times that distance.
        points().prop_map(|points| {
            let far = |point: DVec3| (point - 0.5).normalize_or(DVec3::X) * 10f64.powf(-6.0 * point.x);
            points.into_iter().map(far).collect()
        }),
        points().prop_map(|points| points.iter().map(|point| (point * 6.0).floor()).collect()),
        points().prop_map(|points| points.iter().map(|point| DVec3::new(point.x, 2.0, -1.0)).collect()),
    ]
}

fn any_cloud() -> impl Strategy<Value = RawCloud> {
    let place = prop_oneof![Just(DVec3::ZERO), unit_cube().prop_map(|point| (point - 0.5) * 1e6)];
    (any_positions(), any::<bool>(), place).prop_map(|(points, is_double, place)| {
        let points = points.into_iter().map(|point| point + place);
        RawCloud::from_positions(if is_double {
            Positions::F64(points.map(|point| point.to_array()).collect())
        } else {
            Positions::F32(points.map(|point| point.as_vec3().to_array()).collect())
        })
    })
}

proptest! {
    #[test]
    fn every_point_stays_in_place(cloud in any_cloud(), is_fast: bool) {
        check(&[cloud], if is_fast { Coding::Fast } else { Coding::Compact })?;
    }

    /// Frames encoded relative to the one before as well.
    #[test]
    fn every_point_stays_in_place_in_every_frame(cloud in any_cloud(), step in unit_cube(), angle in -0.1f64..0.1) {
        let (_, bounds) = cloud.positions.finite_bounds();
        let extent = bounds.map_or(1.0, |(min, max)| (max - min).max_element());
        let mut clouds = vec![cloud];
        for _ in 0..3 {
            let last = &clouds[clouds.len() - 1];
            let center = last.positions.get(0);
            let turn = DQuat::from_rotation_y(angle);
            let step = step * extent * 0.01;
            let inter = positions(last).into_iter().map(|point| center + turn * (point - center) + step);
            clouds.push(RawCloud::from_positions(match last.positions {
                Positions::F32(_) => Positions::F32(inter.map(|point| point.as_vec3().to_array()).collect()),
                Positions::F64(_) => Positions::F64(inter.map(|point| point.to_array()).collect()),
            }));
        }
        check(&clouds, Coding::Compact)?;
    }
}

#[test]
fn holes_and_duplicates_are_retained() {
    let mut places = vec![[1.0, 2.0, 3.0]; 700];
    places.extend([[f32::NAN; 3]; 5]);
    places.extend((0..100).map(|place| [place as f32, 0.0, 0.0]));
    let cloud = RawCloud::from_positions(Positions::F32(places));
    let file = file_of(std::slice::from_ref(&cloud), &ReelOptions::default());
    let frame = decoded(&file, 0, usize::MAX).cloud;
    assert_eq!(frame.positions.len(), 805);
    let near = |point: usize| frame.positions.get(point).distance(DVec3::new(1.0, 2.0, 3.0)) < 0.125;
    assert_eq!((0..805).filter(|&point| near(point)).count(), 700);
    assert_eq!((0..805).filter(|&point| frame.positions.get(point).is_nan()).count(), 5);
}

/// A dense part does not make a sparse one dear: each has the bits that its spacing needs.
#[test]
fn uneven_clouds_take_the_bits_of_each_part() {
    let bits = |scales: [f32; 2]| {
        let cloud = surface(4000, 0.0);
        let Positions::F32(of_surface) = &cloud.positions else {
            panic!("other positions")
        };
        let scaled = |(index, place): (usize, &[f32; 3])| place.map(|along| along * scales[index / 2000]);
        let halves: Vec<[f32; 3]> = of_surface.iter().take(4000).enumerate().map(scaled).collect();
        let file = file_of(
            &[RawCloud::from_positions(Positions::F32(halves))],
            &ReelOptions::default(),
        );
        let file = open(&file).unwrap();
        let frame = file.frame(0).unwrap();
        let of = |kind: StreamKind| frame.bytes_by_stream[kind as usize];
        8.0 * (of(StreamKind::Geometry) + of(StreamKind::Position)) as f64 / frame.points as f64
    };
    let (even, uneven) = (bits([1.0, 1.0]), bits([1.0, 100.0]));
    // In a cube a hundred times as large the dense half takes 3 log2(100) = 20 bits more per point, which are 10 on
    // average over all points. The sparse half would take the same number more if it had the bits of the dense one.
    assert!(uneven < even + 10.5, "{uneven} bits per point, {even} where it is even");
}
