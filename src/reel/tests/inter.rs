//! Frames encoded relative to the one before: within the same bounds, at any place of a sequence, and only where it
//! saves.

use super::clouds::{clouds, decoded, decoder, file_of, open, surface};
use super::round_trip::check_attributes;
use crate::cloud::{Positions, RawCloud};
use crate::progress::Progress;
use crate::reel::{Coding, Precision, ReelOptions, StreamKind};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

fn group_of(keyframes: u32) -> ReelOptions {
    ReelOptions {
        keyframes,
        ..ReelOptions::merged()
    }
}

/// The frames of a file that are encoded relative to the one before.
fn inter_frames(bytes: &[u8]) -> Vec<bool> {
    let file = open(bytes).unwrap();
    let frames = (0..file.frame_count()).map(|index| file.frame(index).unwrap());
    frames
        .map(|frame| frame.bytes_by_stream[StreamKind::Motion as usize] > 0)
        .collect()
}

/// The cloud, turned and moved, its attributes as they were.
fn turned(cloud: &RawCloud, turn: DQuat, step: DVec3) -> RawCloud {
    let place = |index: usize| turn * cloud.positions.get(index) + step;
    let places = (0..cloud.positions.len()).map(place);
    let mut turned = cloud.clone();
    turned.positions = match cloud.positions {
        Positions::F32(_) => Positions::F32(places.map(|place| place.as_vec3().to_array()).collect()),
        Positions::F64(_) => Positions::F64(places.map(|place| place.to_array()).collect()),
    };
    turned
}

fn distances(one: &RawCloud, other: &RawCloud) -> Vec<f64> {
    assert_eq!(one.positions.len(), other.positions.len());
    let distance = |index: usize| one.positions.get(index).distance(other.positions.get(index));
    (0..one.positions.len()).map(distance).collect()
}

#[test]
fn a_rotating_body_is_coded_by_its_rotation() {
    let body = surface(20_000, 0.0);
    let turn = |frame: u32| DQuat::from_rotation_z(0.02 * f64::from(frame));
    let bodies: Vec<RawCloud> = (0..8)
        .map(|frame| turned(&body, turn(frame), DVec3::X * 0.01 * f64::from(frame)))
        .collect();
    let bytes = file_of(&bodies, &group_of(8));
    assert_eq!(inter_frames(&bytes), [false, true, true, true, true, true, true, true]);
    let file = open(&bytes).unwrap();
    let bytes_of = |frame: usize| file.frame(frame).unwrap().bytes_by_stream.iter().sum::<u64>();
    // The appearance is encoded once; the motion is smooth.
    assert!(
        (1..8).all(|frame| 20 * bytes_of(frame) < bytes_of(0)),
        "{:?}",
        (0..8).map(bytes_of).collect::<Vec<_>>()
    );
    let mut decoder = decoder(&bytes);
    let mut frame = |index| decoder.decode(index, usize::MAX, &Progress::default()).unwrap();
    let first = frame(0);
    for index in 1..8 {
        let found = frame(index);
        let expected = turned(&first.cloud, turn(index as u32), DVec3::X * 0.01 * index as f64);
        // Half a cell along each axis; and the mean of the points of a cell rotates about a different centre than its
        // node.
        let max = distances(&expected, &found.cloud).into_iter().fold(0.0, f64::max);
        assert!(max <= 1.2 * found.cell_edge, "{index}: {max} of {}", found.cell_edge);
        assert_eq!(found.cloud.attributes.colors, first.cloud.attributes.colors);
    }
}

#[test]
fn frames_are_the_same_in_any_order_and_on_every_level() {
    let clouds: Vec<RawCloud> = (0..5).map(|frame| surface(6000, 0.05 * frame as f32)).collect();
    for options in [
        group_of(5),
        ReelOptions {
            coding: Coding::Fast,
            ..group_of(5)
        },
        ReelOptions {
            precision: Precision::Length(1e-3),
            keep_order: true,
            ..group_of(5)
        },
        ReelOptions {
            precision: Precision::PointSpacing,
            ..group_of(5)
        },
    ] {
        let bytes = file_of(&clouds, &options);
        assert_eq!(inter_frames(&bytes), [false, true, true, true, true]);
        let mut in_order = decoder(&bytes);
        let levels = in_order.file().frame(3).unwrap().level_points.to_vec();
        for max in levels.into_iter().chain([usize::MAX]) {
            for index in [0, 1, 2, 3, 4, 2, 2, 0] {
                let one = in_order.decode(index, max, &Progress::default()).unwrap();
                assert_eq!(one, decoded(&bytes, index, max), "frame {index}, {max} points");
                assert!(one.cloud.positions.len() <= max);
            }
        }
    }
}

#[test]
fn coarse_levels_move_as_the_points_do() {
    let motion = |frame: f64| (DQuat::from_rotation_z(0.03 * frame), DVec3::Y * 0.03 * frame);
    let body = surface(9000, 0.0);
    let bodies = (0..4).map(|frame| {
        let (turn, step) = motion(f64::from(frame));
        turned(&body, turn, step)
    });
    let bytes = file_of(&bodies.collect::<Vec<_>>(), &group_of(4));
    let levels = open(&bytes).unwrap().frame(0).unwrap().level_points.to_vec();
    let cell = decoded(&bytes, 0, usize::MAX).cell_edge;
    for &max in &levels[2..] {
        let [first, last] = [0, 3].map(|index| decoded(&bytes, index, max));
        let (turn, step) = motion(3.0);
        let inter = turned(&first.cloud, turn, step);
        let max_off = distances(&inter, &last.cloud).into_iter().fold(0.0, f64::max);
        // The mean of the points of a node rotates about a different centre than the node.
        let allowed = cell + 0.1 * first.cell_edge;
        assert!(max_off <= allowed, "{max} points: {max_off} of {allowed}");
        assert_eq!(first.cloud.attributes.radii, last.cloud.attributes.radii);
    }
}

#[test]
fn unrelated_points_are_coded_as_intra_frames() {
    let one = surface(5000, 0.0);
    let mut shuffled = surface(5000, 0.05);
    let count = shuffled.positions.len() as u32;
    let places: Vec<u32> = (0..count)
        .map(|place| (u64::from(place) * 2_654_435_761 % u64::from(count)) as u32)
        .collect();
    shuffled.keep(&places);
    let mut fewer = one.clone();
    fewer.keep(&(0..count - 1).collect::<Vec<_>>());
    let mut bare = one.clone();
    bare.attributes.colors = None;
    for other in [shuffled, fewer, bare] {
        let clouds = [one.clone(), other, surface(5000, 0.1)];
        let bytes = file_of(&clouds, &group_of(3));
        assert_eq!(inter_frames(&bytes)[1..2], [false]);
        let alone: usize = clouds
            .iter()
            .map(|cloud| file_of(std::slice::from_ref(cloud), &group_of(1)).len())
            .sum();
        assert!(bytes.len() * 100 <= alone * 101);
    }
    // Voxels stay in their grid, and lossless is lossless.
    for precision in [Precision::Bits(7), Precision::Lossless] {
        let options = ReelOptions {
            precision,
            ..group_of(2)
        };
        assert_eq!(
            inter_frames(&file_of(&[one.clone(), surface(5000, 0.01)], &options)),
            [false, false]
        );
    }
}

proptest! {
    /// Points, one by one, in every frame: within the length, colours and normals within their errors.
    #[test]
    fn bounds_hold_in_every_frame(
        cloud in clouds(),
        exponent in -9i32..-1,
        steps in prop::array::uniform4(prop::array::uniform3(-0.2f64..0.2)),
        angle in -0.3f64..0.3,
        change in 0u8..3,
    ) {
        let length = 2f64.powi(exponent);
        let options = ReelOptions {
            precision: Precision::Length(length),
            keep_order: true,
            color_error: 3,
            ..group_of(5)
        };
        let mut clouds = vec![cloud];
        for step in steps {
            let last = &clouds[clouds.len() - 1];
            let mut next = turned(last, DQuat::from_rotation_y(angle), DVec3::from_array(step));
            for color in next.attributes.colors.iter_mut().flatten() {
                color[0] = color[0].wrapping_add(change);
            }
            for normal in next.attributes.normals.iter_mut().flatten() {
                normal.rotate_right(usize::from(change));
            }
            clouds.push(next);
        }
        let bytes = file_of(&clouds, &options);
        for (index, cloud) in clouds.iter().enumerate() {
            let frame = decoded(&bytes, index, usize::MAX);
            prop_assert_eq!(frame.cloud.positions.len(), cloud.positions.len());
            for point in 0..cloud.positions.len() {
                let (was, is) = (cloud.positions.get(point), frame.cloud.positions.get(point));
                for axis in 0..3 {
                    let is_alike = was[axis].to_bits() == is[axis].to_bits() || (was[axis] - is[axis]).abs() <= length;
                    prop_assert!(is_alike, "frame {}: {} became {}, bound {}", index, was, is, length);
                }
            }
            check_attributes(cloud, &frame.cloud, 3)?;
        }
    }
}

/// The radius of a disk grows with the radii of the points it stands for; other numbers change likewise.
#[test]
fn changing_radii_and_scalars_round_trip() {
    let with = |frame: u32| {
        let mut cloud = surface(3000, 0.02 * frame as f32);
        let count = cloud.positions.len();
        cloud.attributes.radii = Some(vec![0.01 * (1.0 + frame as f32); count]);
        let heat = (0..count).map(|point| point as f32 / count as f32 + frame as f32);
        cloud.attributes.scalars = vec![crate::cloud::ScalarField::new("heat", heat.collect())];
        cloud
    };
    let clouds: Vec<RawCloud> = (0..3).map(with).collect();
    let bytes = file_of(&clouds, &group_of(3));
    assert_eq!(inter_frames(&bytes), [false, true, true]);
    let frames: Vec<RawCloud> = (0..3).map(|index| decoded(&bytes, index, usize::MAX).cloud).collect();
    let radius = |frame: usize| {
        frames[frame]
            .attributes
            .radii
            .as_ref()
            .unwrap()
            .iter()
            .copied()
            .fold(f32::MAX, f32::min)
    };
    assert!(
        (1.8..2.2).contains(&(radius(1) / radius(0))),
        "{} {}",
        radius(0),
        radius(1)
    );
    let heat = |frame: usize| &frames[frame].attributes.scalars[0].values;
    for frame in 1..3 {
        let off = heat(frame)
            .iter()
            .zip(heat(0))
            .map(|(now, first)| (now - first - frame as f32).abs());
        assert!(off.fold(0.0, f32::max) < 0.03);
    }
}

/// Normals that shake by less than the precision stay unchanged, and take no bit.
#[test]
fn normals_that_hardly_turn_cost_nothing() {
    let body = surface(10_000, 0.0);
    let shaken = |frame: u32| {
        let mut cloud = body.clone();
        for (point, normal) in (0u32..).zip(cloud.attributes.normals.iter_mut().flatten()) {
            let shake = ((point * 7 + frame * 3) % 5) as f32 * 0.0002;
            *normal = (glam::Vec3::from_array(*normal) + glam::Vec3::new(shake, -shake, 0.0))
                .normalize()
                .to_array();
        }
        cloud
    };
    let clouds: Vec<RawCloud> = (0..4).map(shaken).collect();
    let bytes = file_of(&clouds, &group_of(4));
    let file = open(&bytes).unwrap();
    let of_normals = |frame: usize| file.frame(frame).unwrap().bytes_by_stream[StreamKind::Normal as usize];
    assert!(
        (1..4).all(|frame| 20 * of_normals(frame) < of_normals(0)),
        "{:?}",
        (0..4).map(of_normals).collect::<Vec<_>>()
    );
}
