//! Colours of nodes that have children: means, or those of first children.

use super::clouds::{decoded, file_of, open, patchwork, surface};
use crate::cloud::{Positions, RawCloud};
use crate::reel::encode::{NewFrame, encode_group};
use crate::reel::parent_level::ParentValue;
use crate::reel::{Coding, Precision, ReelOptions};
use std::collections::{HashMap, HashSet};

const COUNT: usize = 40_000;

/// Options of files of both codings, each with another kind of points.
fn kinds(color_error: u8) -> Vec<ReelOptions> {
    let voxels = ReelOptions {
        precision: Precision::Bits(9),
        ..ReelOptions::default()
    };
    let of_points = [
        ReelOptions::default(),
        ReelOptions::merged(),
        ReelOptions::lossless(),
        voxels,
    ];
    let of_coding = |coding| {
        of_points.clone().map(|options| ReelOptions {
            coding,
            color_error,
            ..options
        })
    };
    [Coding::Compact, Coding::Fast].map(of_coding).concat()
}

/// The choice for a group of these frames.
pub(super) fn chosen(clouds: &[RawCloud], options: &ReelOptions) -> ParentValue {
    let frame = |cloud| NewFrame {
        cloud,
        name: "frame",
        time: None,
    };
    let frames: Vec<NewFrame<'_>> = clouds.iter().map(frame).collect();
    let group = encode_group(&frames, options).unwrap();
    group.directory.schemas[0].color_of_parents
}

#[test]
fn edges_are_coded_by_first_children_and_slopes_by_means() {
    for options in kinds(2) {
        assert_eq!(
            chosen(&[patchwork(COUNT, 0.0)], &options),
            ParentValue::FirstChild,
            "{options:?}"
        );
        assert_eq!(
            chosen(&[surface(COUNT, 0.0)], &options),
            ParentValue::Mean,
            "{options:?}"
        );
    }
    // A few points are not worth coarse levels that look worse.
    assert_eq!(
        chosen(&[patchwork(400, 0.0)], &ReelOptions::default()),
        ParentValue::Mean
    );
}

#[test]
fn followed_points_that_change_their_colors_have_means() {
    let clouds = [0.0, 0.02].map(|time| patchwork(COUNT, time));
    let mut changed = clouds.clone();
    for color in changed[1].attributes.colors.iter_mut().flatten().step_by(3) {
        color[0] ^= 64;
    }
    for options in kinds(2) {
        assert_eq!(chosen(&clouds, &options), ParentValue::FirstChild, "{options:?}");
        // Frames that are never encoded relative to others have nothing to follow.
        let expected = if options.may_follow() {
            ParentValue::Mean
        } else {
            ParentValue::FirstChild
        };
        assert_eq!(chosen(&changed, &options), expected, "{options:?}");
    }
}

#[test]
fn colors_are_those_of_the_input() {
    let cloud = patchwork(COUNT, 0.0);
    let Positions::F32(positions) = &cloud.positions else {
        panic!("other positions")
    };
    let bits = |position: &[f32; 3]| position.map(f32::to_bits);
    let colors: HashMap<[u32; 3], [u8; 4]> = positions
        .iter()
        .map(bits)
        .zip(cloud.attributes.colors.iter().flatten().copied())
        .collect();
    for error in [0, 3] {
        for coding in [Coding::Compact, Coding::Fast] {
            let options = ReelOptions {
                coding,
                color_error: error,
                ..ReelOptions::lossless()
            };
            assert_eq!(chosen(std::slice::from_ref(&cloud), &options), ParentValue::FirstChild);
            let bytes = file_of(std::slice::from_ref(&cloud), &options);
            let read = decoded(&bytes, 0, usize::MAX).cloud;
            let Positions::F32(positions) = &read.positions else {
                panic!("other positions")
            };
            assert_eq!(positions.len(), COUNT);
            for (position, color) in positions.iter().zip(read.attributes.colors.iter().flatten()) {
                let given = colors[&bits(position)];
                let is_near = given.iter().zip(color).all(|(given, is)| given.abs_diff(*is) <= error);
                assert!(is_near, "{coding:?}, {error}: {given:?} became {color:?}");
            }
        }
    }
}

#[test]
fn coarse_levels_have_colors_of_points() {
    let cloud = patchwork(COUNT, 0.0);
    let plain: HashSet<[u8; 4]> = cloud.attributes.colors.iter().flatten().copied().collect();
    for error in [0, 2, 9] {
        // Merged points have means.
        for options in kinds(error) {
            if !options.keeps_points() {
                continue;
            }
            let bytes = file_of(std::slice::from_ref(&cloud), &options);
            let levels = open(&bytes).unwrap().frame(0).unwrap().level_points.to_vec();
            for max_points in levels {
                let found = decoded(&bytes, 0, max_points).cloud.attributes.colors.unwrap();
                let off = |color: &[u8; 4], other: &[u8; 4]| {
                    let channels = color.iter().zip(other);
                    channels.map(|(a, b)| a.abs_diff(*b)).max().unwrap()
                };
                let is_near = |color: &[u8; 4]| plain.iter().any(|other| off(color, other) <= error);
                assert!(found.iter().all(is_near), "{options:?}, {max_points} points");
            }
        }
    }
}

#[test]
fn colors_are_within_their_bound() {
    // In the order of the file, from frame to frame, so that the second is encoded relative to the first.
    let clouds = [0.0, 0.02].map(|time| patchwork(COUNT, time));
    for (exact, rounded) in kinds(0).into_iter().zip(kinds(3)) {
        let [exact, rounded] = [exact, rounded].map(|options| file_of(&clouds, &options));
        for frame in 0..2 {
            let levels = open(&exact).unwrap().frame(frame).unwrap().level_points.to_vec();
            for max_points in levels {
                let [exact, rounded] =
                    [&exact, &rounded].map(|bytes| decoded(bytes, frame, max_points).cloud.attributes.colors.unwrap());
                assert_eq!(exact.len(), rounded.len());
                let off = exact.iter().flatten().zip(rounded.iter().flatten());
                let max = off.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
                assert!(max <= 3, "frame {frame}, {max_points} points: {max}");
            }
        }
    }
}
