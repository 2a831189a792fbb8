//! Written data is read back: every bit of it, or within the requested precision.

use super::clouds::{clouds, decoded, decoder, file_of, open, surface, with_attributes};
use crate::cloud::{Frame, Positions, RawCloud, largest_normal_error};
use crate::progress::Progress;
use crate::reel::{Coding, NewFrame, Precision, ReelOptions, ReelWriter, StreamKind, encode_group};
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use std::path::Path;
use std::time::Duration;

/// All numbers of a point as bits.
fn bits_of(cloud: &RawCloud, point: usize) -> Vec<u64> {
    let mut bits: Vec<u64> = match &cloud.positions {
        Positions::F32(positions) => positions[point]
            .iter()
            .map(|along| u64::from(along.to_bits()))
            .collect(),
        Positions::F64(positions) => positions[point].iter().map(|along| along.to_bits()).collect(),
    };
    let attributes = &cloud.attributes;
    let mut add = |value: f32| bits.push(u64::from(value.to_bits()));
    attributes
        .normals
        .iter()
        .for_each(|normals| normals[point].into_iter().for_each(&mut add));
    attributes.radii.iter().for_each(|radii| add(radii[point]));
    if let Some(ellipses) = &attributes.ellipses {
        let ellipse = ellipses[point];
        ellipse
            .axis
            .to_array()
            .into_iter()
            .chain([ellipse.ratio])
            .for_each(&mut add);
    }
    attributes.scalars.iter().for_each(|field| add(field.values[point]));
    bits.extend(
        attributes
            .colors
            .iter()
            .map(|colors| u64::from(u32::from_le_bytes(colors[point]))),
    );
    bits
}

fn sorted_bits(cloud: &RawCloud) -> Vec<Vec<u64>> {
    let mut points: Vec<Vec<u64>> = (0..cloud.positions.len()).map(|point| bits_of(cloud, point)).collect();
    points.sort();
    points
}

fn names(cloud: &RawCloud) -> Vec<(String, u64)> {
    let offset = |name: &str| {
        let field = cloud.attributes.scalars.iter().find(|field| field.name == name);
        field.map_or(0, |field| field.offset.to_bits())
    };
    cloud
        .attributes
        .names()
        .map(|name| (name.to_owned(), offset(name)))
        .collect()
}

/// The precision of floats that are as large as a cloud's.
fn rounding(cloud: &RawCloud) -> f64 {
    let largest = (0..cloud.positions.len())
        .map(|point| cloud.positions.get(point).abs().max_element())
        .filter(|along| along.is_finite())
        .fold(0.0, f64::max);
    match cloud.positions {
        Positions::F32(_) => largest * 2f64.powi(-22),
        Positions::F64(_) => largest * 2f64.powi(-50),
    }
}

fn coding() -> impl Strategy<Value = Coding> {
    prop::sample::select(vec![Coding::Compact, Coding::Fast])
}

proptest! {
    #[test]
    fn lossless_is_bit_exact(clouds in prop::collection::vec(clouds(), 1..4), keep_order: bool, coding in coding()) {
        let options = ReelOptions { coding, keep_order, ..ReelOptions::lossless() };
        let bytes = file_of(&clouds, &options);
        for (index, cloud) in clouds.iter().enumerate() {
            let frame = decoded(&bytes, index, usize::MAX);
            prop_assert_eq!(names(&frame.cloud), names(cloud));
            if keep_order {
                for point in 0..cloud.positions.len() {
                    prop_assert_eq!(bits_of(&frame.cloud, point), bits_of(cloud, point));
                }
            }
            prop_assert_eq!(sorted_bits(&frame.cloud), sorted_bits(cloud));
        }
    }

    #[test]
    fn a_length_bounds_every_coordinate(cloud in clouds(), exponent in -12i32..4, coding in coding()) {
        let length = 2f64.powi(exponent);
        let options = ReelOptions {
            precision: Precision::Length(length),
            coding,
            keep_order: true,
            color_error: 3,
            ..ReelOptions::default()
        };
        let frame = decoded(&file_of(std::slice::from_ref(&cloud), &options), 0, usize::MAX);
        prop_assert_eq!(frame.cloud.positions.len(), cloud.positions.len());
        for point in 0..cloud.positions.len() {
            let (was, is) = (cloud.positions.get(point), frame.cloud.positions.get(point));
            for axis in 0..3 {
                let is_alike = was[axis].to_bits() == is[axis].to_bits() || (was[axis] - is[axis]).abs() <= length;
                prop_assert!(is_alike, "{} became {}, bound {}", was, is, length);
            }
        }
        check_attributes(&cloud, &frame.cloud, 3)?;
    }

    #[test]
    fn voxels_match_the_occupied_cells(points in prop::collection::vec(prop::array::uniform3(0u16..1024), 1..200),
        coding in coding()) {
        let mut cells = points.clone();
        cells.extend([[0; 3], [1023; 3]]);
        let positions = cells.iter().map(|cell| cell.map(f32::from)).collect();
        let cloud = RawCloud::from_positions(Positions::F32(positions));
        let options = ReelOptions { precision: Precision::Bits(10), coding, ..ReelOptions::default() };
        let frame = decoded(&file_of(&[cloud], &options), 0, usize::MAX);
        let Positions::F32(read) = frame.cloud.positions else { panic!("other positions") };
        let mut read: Vec<[u16; 3]> = read.iter().map(|point| point.map(|along| along as u16)).collect();
        read.sort_unstable();
        cells.sort_unstable();
        cells.dedup();
        prop_assert_eq!(read, cells);
    }

    /// For any cloud, each of its points is near a stored one, and nothing else is there.
    #[test]
    fn merged_points_represent_all_points(cloud in clouds()) {
        let frame = decoded(&file_of(std::slice::from_ref(&cloud), &ReelOptions::merged()), 0, usize::MAX);
        let edge = frame.cell_edge * 2.0 + rounding(&cloud);
        let all = |cloud: &RawCloud| (0..cloud.positions.len()).map(|p| cloud.positions.get(p)).collect::<Vec<DVec3>>();
        let (was, is) = (all(&cloud), all(&frame.cloud));
        let near = |a: DVec3, b: DVec3| (a - b).abs().max_element() <= edge;
        for &point in was.iter().filter(|point| point.is_finite()) {
            prop_assert!(is.iter().any(|&other| near(point, other)), "{point} of {is:?}");
        }
        for &point in &is {
            prop_assert!(was.iter().any(|&other| near(point, other)));
        }
    }
}

/// Attributes in steps, of points that stand in the same order.
pub(super) fn check_attributes(was: &RawCloud, is: &RawCloud, color_error: i32) -> Result<(), TestCaseError> {
    let (was, is) = (&was.attributes, &is.attributes);
    if let (Some(was), Some(is)) = (&was.colors, &is.colors) {
        for (was, is) in was.iter().zip(is) {
            for channel in 0..4 {
                let allowed = if channel == 3 { 0 } else { color_error };
                let off = (i32::from(was[channel]) - i32::from(is[channel])).abs();
                prop_assert!(off <= allowed, "{was:?} became {is:?}");
            }
        }
    }
    if let (Some(was), Some(is)) = (&was.normals, &is.normals) {
        for (was, is) in was.iter().zip(is) {
            match Vec3::from_array(*was).try_normalize() {
                None => prop_assert_eq!(*is, [0.0; 3]),
                Some(was) => {
                    let chord = (was - Vec3::from_array(*is)).length();
                    prop_assert!(2.0 * (0.5 * chord).asin() <= largest_normal_error(13));
                }
            }
        }
    }
    if let (Some(was), Some(is)) = (&was.radii, &is.radii) {
        for (was, is) in was.iter().zip(is) {
            // Radii of a hundred times the cell may become zero, which is not drawn.
            let is_like = (was - is).abs() <= 0.023 * was || *is != 0.0 || *was == 0.0;
            prop_assert!(is_like, "{was} became {is}");
        }
    }
    for (was, is) in was.scalars.iter().zip(&is.scalars) {
        prop_assert_eq!((&was.name, was.offset), (&is.name, is.offset));
        let finite = was.values.iter().copied().filter(|value| value.is_finite());
        let (min, max) = finite.fold((f32::MAX, f32::MIN), |(min, max), value| {
            (min.min(value), max.max(value))
        });
        let step = (max - min) / 254.0;
        for (&was, &is) in was.values.iter().zip(&is.values) {
            prop_assert_eq!(was.is_nan(), is.is_nan());
            prop_assert!(
                was.is_nan() || (was - is).abs() <= 0.51 * step + 1e-4,
                "{} became {}",
                was,
                is
            );
        }
    }
    Ok(())
}

#[test]
fn empty_and_single_point_frames_round_trip() {
    let empty = RawCloud::from_positions(Positions::F64(Vec::new()));
    let one = with_attributes(Positions::F32(vec![[1.0, 2.0, 3.0]]), 255);
    let clouds = [empty, one];
    let fast = ReelOptions {
        coding: Coding::Fast,
        ..ReelOptions::default()
    };
    for options in [
        ReelOptions::default(),
        ReelOptions::merged(),
        ReelOptions::lossless(),
        fast,
    ] {
        let bytes = file_of(&clouds, &options);
        assert_eq!(decoded(&bytes, 0, usize::MAX).cloud.positions, clouds[0].positions);
        let frame = decoded(&bytes, 1, usize::MAX);
        assert_eq!(frame.cloud.positions.len(), 1);
        assert!(
            (frame.cloud.positions.get(0) - DVec3::new(1.0, 2.0, 3.0))
                .abs()
                .max_element()
                <= frame.cell_edge
        );
    }
}

#[test]
fn every_level_is_a_coarser_frame() {
    let cloud = surface(10_000, 0.0);
    for options in [ReelOptions::default(), ReelOptions::merged(), ReelOptions::lossless()] {
        let bytes = file_of(std::slice::from_ref(&cloud), &options);
        let mut decoder = decoder(&bytes);
        let levels = decoder.file().frame(0).unwrap().level_points.to_vec();
        assert!(levels.len() > 5, "{levels:?}");
        for (level, &points) in levels.iter().enumerate() {
            let frame = decoder.decode(0, points, &Progress::default()).unwrap();
            assert_eq!(frame.cloud.positions.len(), points);
            assert_eq!(frame.is_whole, level + 1 == levels.len());
            if points > 1 {
                let coarser = decoder.decode(0, points - 1, &Progress::default()).unwrap();
                assert_eq!(coarser.cloud.positions.len(), levels[level - 1]);
            }
            let attributes = &frame.cloud.attributes;
            assert_eq!(attributes.other_length(points), None);
            assert!(attributes.colors.is_some() && attributes.normals.is_some());
            // Every point of the cloud is in a cell, and coarse disks cover it.
            let reach = frame.cell_edge;
            for point in (0..cloud.positions.len()).step_by(97) {
                let point = cloud.positions.get(point);
                let is_near = |other: usize| (frame.cloud.positions.get(other) - point).length() < 1.8 * reach;
                assert!((0..points).any(is_near), "level {level}");
            }
            Frame::from_raw(frame.cloud, DVec3::ZERO).unwrap();
        }
    }
}

/// Colours of a coarse level are means of the level below it, but for rounding.
#[test]
fn colors_of_a_level_are_means_of_the_level_below() {
    let cloud = surface(10_000, 0.0);
    for options in [ReelOptions::default(), ReelOptions::merged(), ReelOptions::lossless()] {
        let options = ReelOptions {
            color_error: 0,
            ..options
        };
        let bytes = file_of(std::slice::from_ref(&cloud), &options);
        let [root, below] = [1, 8].map(|max_points| decoded(&bytes, 0, max_points));
        assert_eq!((root.levels, below.levels), (1, 2));
        let root = root.cloud.attributes.colors.unwrap()[0];
        let below = below.cloud.attributes.colors.unwrap();
        for channel in 0..3 {
            let sum: f64 = below.iter().map(|color| f64::from(color[channel])).sum();
            let error = f64::from(root[channel]) - sum / below.len() as f64;
            assert!(error.abs() <= 0.5, "{root:?} for {below:?}");
        }
    }
}

/// So they are about those of the points, where no cell of few counts as much as others: the cube of merged points is
/// divided evenly, and the cube of individually stored points is as large as their precision requires.
#[test]
fn coarse_colors_are_means() {
    let cloud = surface(10_000, 0.0);
    let options = ReelOptions {
        color_error: 0,
        ..ReelOptions::merged()
    };
    let bytes = file_of(std::slice::from_ref(&cloud), &options);
    let root = decoded(&bytes, 0, 1);
    let mean = |channel: usize| {
        let colors = cloud.attributes.colors.as_ref().unwrap();
        colors.iter().map(|color| f64::from(color[channel])).sum::<f64>() / colors.len() as f64
    };
    for channel in 0..3 {
        let found = f64::from(root.cloud.attributes.colors.as_ref().unwrap()[0][channel]);
        assert!((found - mean(channel)).abs() < 25.0, "{found} for {}", mean(channel));
    }
}

#[test]
fn offsets_move_points_onto_the_surface() {
    let cloud = surface(40_000, 0.0);
    let error = |offset_bits: u8| {
        let options = ReelOptions {
            offset_bits,
            ..ReelOptions::merged()
        };
        let frame = decoded(&file_of(std::slice::from_ref(&cloud), &options), 0, usize::MAX);
        let height = |point: DVec3| point.z - 0.2 * (6.0 * point.x).sin() * (4.0 * point.y).cos();
        let count = frame.cloud.positions.len();
        let squares = (0..count)
            .map(|point| height(frame.cloud.positions.get(point)).powi(2))
            .sum::<f64>();
        (squares / count as f64).sqrt() / frame.cell_edge
    };
    let (without, with) = (error(0), error(3));
    assert!(with < 0.45 * without, "{with} beside {without}");
}

#[test]
fn frames_are_listed_with_their_contents() {
    let clouds = [surface(900, 0.0), surface(1600, 0.1)];
    let options = ReelOptions {
        fps: Some(24.0),
        ..ReelOptions::default()
    };
    let mut writer = ReelWriter::new(Vec::new(), Path::new("a"), options.clone()).unwrap();
    let frame = |index: usize| NewFrame {
        cloud: &clouds[index],
        name: ["first", "zweites ä"][index],
        time: Some(Duration::from_millis(40 * index as u64)),
    };
    writer.write_group(&[frame(0)]).unwrap();
    writer
        .write_encoded(&encode_group(&[frame(1)], &options).unwrap())
        .unwrap();
    assert_eq!(writer.frame_count(), 2);
    let file = open(&writer.finish().unwrap()).unwrap();
    assert_eq!((file.frame_count(), file.fps()), (2, Some(24.0)));
    let second = file.frame(1).unwrap();
    assert_eq!(
        (second.name, second.time, second.group),
        ("zweites ä", Some(Duration::from_millis(40)), 1..2)
    );
    assert_eq!(second.points_written, 1600);
    assert!(second.bytes_by_stream.iter().sum::<u64>() > 0);
    assert_eq!(file.frame(2), None);
    assert!(file.damage().is_empty());
}

/// Any number of threads makes the same bytes.
#[test]
fn files_do_not_depend_on_thread_count() {
    let clouds: Vec<RawCloud> = (0..3).map(|frame| surface(20_000, 0.05 * frame as f32)).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| file_of(&clouds, &ReelOptions::default()))
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn frames_can_be_read_in_any_order() {
    let clouds: Vec<RawCloud> = (0..5).map(|frame| surface(3000, 0.05 * frame as f32)).collect();
    let bytes = file_of(&clouds, &ReelOptions::default());
    let in_order: Vec<_> = (0..5).map(|index| decoded(&bytes, index, usize::MAX)).collect();
    let mut decoder = decoder(&bytes);
    for (index, max) in [
        (4, usize::MAX),
        (0, 300),
        (1, usize::MAX),
        (2, 300),
        (3, usize::MAX),
        (2, usize::MAX),
    ] {
        let frame = decoder.decode(index, max, &Progress::default()).unwrap();
        if max == usize::MAX {
            assert_eq!(frame, in_order[index]);
        } else {
            assert_eq!(frame, decoded(&bytes, index, max));
        }
    }
}

/// Coordinates that were a text once take the bits of their digits, and come back to the last bit; so do the
/// coordinates of a few points that have more digits.
#[test]
fn coordinates_in_thousandths_take_fewer_bits() {
    let exact = surface(20_000, 0.0);
    let mut rounded = exact.clone();
    if let Positions::F32(positions) = &mut rounded.positions {
        for along in positions.iter_mut().flatten() {
            *along = ((f64::from(*along) * 1000.0).round() / 1000.0) as f32;
        }
        positions[5] = [0.123_456_7; 3];
        positions[6] = [-0.0, 0.5, 0.25];
    }
    for coding in [Coding::Compact, Coding::Fast] {
        let options = ReelOptions {
            keep_order: true,
            coding,
            ..ReelOptions::lossless()
        };
        let [bytes, of_floats] = [&rounded, &exact].map(|cloud| file_of(std::slice::from_ref(cloud), &options));
        let position =
            |bytes: &[u8]| open(bytes).unwrap().frame(0).unwrap().bytes_by_stream[StreamKind::Position as usize];
        assert!(
            3 * position(&bytes) < position(&of_floats),
            "{} {}",
            position(&bytes),
            position(&of_floats)
        );
        assert!(decoded(&bytes, 0, usize::MAX).cloud == rounded, "{coding:?}");
    }
}
