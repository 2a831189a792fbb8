//! Both codings keep the same.

use super::clouds::{clouds, decoded, decoder, file_of, open, surface};
use crate::cloud::{Positions, RawCloud};
use crate::progress::Progress;
use crate::reel::{Coding, NewFrame, Precision, ReelOptions, StreamKind, encode_group};
use proptest::prelude::*;

/// Options that are lossless as far as the coding decides, except for a precision.
fn options(precision: Precision) -> ReelOptions {
    ReelOptions {
        precision,
        color_error: 0,
        ..ReelOptions::default()
    }
}

fn fast(options: &ReelOptions) -> ReelOptions {
    ReelOptions {
        coding: Coding::Fast,
        ..options.clone()
    }
}

fn precision() -> impl Strategy<Value = Precision> {
    prop_oneof![
        Just(Precision::PointSpacing),
        Just(Precision::SamplingDensity),
        (1u8..12).prop_map(Precision::Bits),
        (-10i32..3).prop_map(|exponent| Precision::Length(2f64.powi(exponent))),
        Just(Precision::Lossless),
    ]
}

/// NaNs are alike if their bits are.
fn text(cloud: &RawCloud) -> String {
    format!("{cloud:?}")
}

proptest! {
    /// Every attribute of every cloud, on every level.
    #[test]
    fn fast_files_contain_the_same_as_compact_ones(cloud in clouds(), precision in precision(), bits in 0u8..3,
        scalar_bits in prop::sample::select(vec![0u8, 2, 8, 16])) {
        let options = ReelOptions { normal_bits: 13 + 2 * bits, scalar_bits, ..options(precision) };
        let compact = file_of(std::slice::from_ref(&cloud), &options);
        let fast = file_of(&[cloud], &fast(&options));
        let levels = open(&compact).unwrap().frame(0).unwrap().level_points.to_vec();
        for max in levels.into_iter().chain([usize::MAX]) {
            let (compact, fast) = (decoded(&compact, 0, max), decoded(&fast, 0, max));
            prop_assert_eq!(text(&compact.cloud), text(&fast.cloud));
            prop_assert_eq!((compact.levels, compact.is_whole), (fast.levels, fast.is_whole));
        }
    }
}

/// Enough points for sections of their own, states that take turns and several tables.
#[test]
fn large_frames_of_both_codings_match_on_every_level() {
    let cloud = surface(40_000, 0.3);
    for precision in [
        Precision::PointSpacing,
        Precision::SamplingDensity,
        Precision::Bits(9),
        Precision::Lossless,
    ] {
        let options = options(precision);
        let [mut compact, mut fast] =
            [&options, &fast(&options)].map(|options| decoder(&file_of(std::slice::from_ref(&cloud), options)));
        let levels = compact.file().frame(0).unwrap().level_points.to_vec();
        for max in levels {
            let [compact, fast] = [&mut compact, &mut fast].map(|decoder| {
                let mut frame = decoder.decode(0, max, &Progress::default()).unwrap();
                if !frame.is_whole {
                    // Those of the fast coding are means, those of the compact one may be colours of points.
                    frame.cloud.attributes.colors = None;
                }
                frame.cloud
            });
            assert!(compact == fast, "{precision:?}, {max} points");
        }
    }
}

/// Colours are off by no more than they may be, on both.
#[test]
fn colors_of_fast_files_are_within_their_bound() {
    let cloud = surface(10_000, 0.0);
    let voxels = options(Precision::Bits(8));
    let exact = decoded(&file_of(std::slice::from_ref(&cloud), &voxels), 0, usize::MAX).cloud;
    for color_error in [1, 2, 7, 100] {
        let options = ReelOptions {
            color_error,
            ..fast(&voxels)
        };
        let found = decoded(&file_of(std::slice::from_ref(&cloud), &options), 0, usize::MAX).cloud;
        let colors = |cloud: &RawCloud| cloud.attributes.colors.clone().unwrap();
        let (exact, found) = (colors(&exact), colors(&found));
        assert_eq!(exact.len(), found.len());
        let off = exact.iter().flatten().zip(found.iter().flatten());
        let max = off.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(
            max <= color_error && (max > 0 || color_error < 2),
            "{max} of {color_error}"
        );
    }
}

proptest! {
    /// Colours of any cloud, on every level that can be drawn.
    #[test]
    fn colors_of_any_fast_file_are_within_their_bound(cloud in clouds(), precision in precision(), error in 1u8..40) {
        let exact = fast(&options(precision));
        let rounded = ReelOptions { color_error: error, ..exact.clone() };
        let [exact, rounded] = [exact, rounded].map(|options| file_of(std::slice::from_ref(&cloud), &options));
        let levels = open(&exact).unwrap().frame(0).unwrap().level_points.to_vec();
        for max in levels.into_iter().chain([usize::MAX]) {
            let [exact, rounded] = [&exact, &rounded].map(|bytes| decoded(bytes, 0, max).cloud);
            prop_assert_eq!(exact.positions.len(), rounded.positions.len());
            let [exact, rounded] = [exact, rounded].map(|cloud| cloud.attributes.colors.unwrap_or_default());
            let off = exact.iter().flatten().zip(rounded.iter().flatten());
            prop_assert!(off.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0) <= error);
        }
    }
}

/// A solid of one colour takes hardly a bit, and is not a bomb.
#[test]
fn uniform_clouds_are_small_and_round_trip() {
    let cells = (0..64u32 * 64 * 64).map(|cell| [cell & 63, cell >> 6 & 63, cell >> 12].map(|along| along as f32));
    let mut cloud = RawCloud::from_positions(Positions::F32(cells.collect()));
    cloud.attributes.colors = Some(vec![[9, 8, 7, 255]; cloud.positions.len()]);
    let bytes = file_of(&[cloud], &fast(&options(Precision::Bits(6))));
    assert!(bytes.len() < 2000, "{}", bytes.len());
    let frame = decoded(&bytes, 0, usize::MAX);
    assert_eq!(frame.cloud.positions.len(), 64 * 64 * 64);
    assert!(
        frame
            .cloud
            .attributes
            .colors
            .unwrap()
            .iter()
            .all(|color| *color == [9, 8, 7, 255])
    );
}

/// Any number of threads makes the same bytes.
#[test]
fn fast_files_do_not_depend_on_thread_count() {
    let clouds: Vec<RawCloud> = (0..3).map(|frame| surface(20_000, 0.05 * frame as f32)).collect();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| file_of(&clouds, &fast(&ReelOptions::default())))
    };
    assert_eq!(with(1), with(4));
}

/// Each frame states its coding: groups of both are in one file.
#[test]
fn one_file_may_mix_both_codings() {
    let clouds = [surface(900, 0.0), surface(1600, 0.1)];
    let options = options(Precision::SamplingDensity);
    let mut writer =
        crate::reel::ReelWriter::new(Vec::new(), std::path::Path::new(super::clouds::PATH), options.clone()).unwrap();
    for (cloud, options) in clouds.iter().zip([&options, &fast(&options)]) {
        let frame = NewFrame {
            cloud,
            name: "frame",
            time: None,
        };
        writer.write_encoded(&encode_group(&[frame], options).unwrap()).unwrap();
    }
    let bytes = writer.finish().unwrap();
    let alone = |index: usize| decoded(&file_of(&clouds[index..=index], &options), 0, usize::MAX).cloud;
    assert!((0..2).all(|index| decoded(&bytes, index, usize::MAX).cloud == alone(index)));
}

/// Bits per point of a kind of stream.
fn bits_of(cloud: &RawCloud, options: &ReelOptions, kind: StreamKind) -> f64 {
    let file = open(&file_of(std::slice::from_ref(cloud), options)).unwrap();
    let frame = file.frame(0).unwrap();
    let place = StreamKind::ALL.iter().position(|other| *other == kind).unwrap();
    8.0 * frame.bytes_by_stream[place] as f64 / frame.points as f64
}

/// Between those around it every value of a plane slope is known; rounding remains.
#[test]
fn slopes_take_few_bits() {
    let mut cloud = surface(40_000, 0.0);
    let color = |point: usize| {
        let [x, y, z] = (cloud.positions.get(point) * 25.0).to_array();
        [128.0 + x, 128.0 + y + z, 128.0 - x, 255.0].map(|channel| channel as u8)
    };
    cloud.attributes.colors = Some((0..cloud.positions.len()).map(color).collect());
    let near = bits_of(&cloud, &ReelOptions::merged(), StreamKind::Color);
    assert!(near < 1.0, "{near}");
}

/// A node without siblings has its parent's values.
#[test]
fn nodes_without_siblings_take_no_bits() {
    // A point far from all others is alone in its cell on every level but the first.
    let corner = |corner: u32| [0, 1, 2].map(|axis| 1000.0 * (corner >> axis & 1) as f32);
    let mut cloud = RawCloud::from_positions(Positions::F32((0..8).map(corner).collect()));
    cloud.attributes.colors = Some((0..8).map(|point| [30 * point, 7, 90 - point, 255]).collect());
    let bits = |levels: u8| bits_of(&cloud, &options(Precision::Bits(levels)), StreamKind::Color);
    assert!(bits(4) > 0.0);
    assert_eq!(bits(4), bits(21));
}
