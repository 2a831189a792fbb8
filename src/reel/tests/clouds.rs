//! Clouds of every kind, and files in memory.

use crate::cloud::{Ellipse, Positions, RawCloud, ScalarField};
use crate::progress::Progress;
use crate::reel::{DecodedFrame, NewFrame, ReelDecoder, ReelError, ReelFile, ReelOptions, ReelWriter};
use glam::Vec3;
use proptest::prelude::*;
use std::path::Path;
use std::sync::Arc;

pub(super) const PATH: &str = "scans/walk.reel";

/// Enough for any test.
pub(super) const MEMORY: u64 = 1 << 32;

/// A file of these clouds, in groups by the options.
pub(super) fn file_of(clouds: &[RawCloud], options: &ReelOptions) -> Vec<u8> {
    let mut writer = ReelWriter::new(Vec::new(), Path::new(PATH), options.clone()).unwrap();
    let names: Vec<String> = (0..clouds.len()).map(|index| format!("frame {index}")).collect();
    let frames: Vec<NewFrame<'_>> = clouds
        .iter()
        .zip(&names)
        .map(|(cloud, name)| NewFrame {
            cloud,
            name,
            time: None,
        })
        .collect();
    for group in frames.chunks(options.keyframes as usize) {
        writer.write_group(group).unwrap();
    }
    writer.finish().unwrap()
}

pub(super) fn open(bytes: &[u8]) -> Result<ReelFile, ReelError> {
    ReelFile::open(Arc::new(bytes.to_vec()), Path::new(PATH))
}

pub(super) fn decoder(bytes: &[u8]) -> ReelDecoder {
    ReelDecoder::new(Arc::new(open(bytes).unwrap()), MEMORY)
}

pub(super) fn decoded(bytes: &[u8], index: usize, max_points: usize) -> DecodedFrame {
    decoder(bytes).decode(index, max_points, &Progress::default()).unwrap()
}

/// Every possible attribute, from a few random numbers per point.
pub(super) fn with_attributes(positions: Positions, kinds: u8) -> RawCloud {
    let count = positions.len();
    let number = |point: usize, salt: u64| {
        let bits = (point as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15 ^ salt.wrapping_mul(0xbf58_476d));
        (bits >> 33) as u32
    };
    let unit = |point: usize, salt: u64| number(point, salt) as f32 / (1u64 << 31) as f32;
    let each = |make: &dyn Fn(usize) -> f32| (0..count).map(make).collect::<Vec<f32>>();
    let mut cloud = RawCloud::from_positions(positions);
    let attributes = &mut cloud.attributes;
    if kinds & 1 != 0 {
        let alpha = |point| if kinds & 16 != 0 { number(point, 3) as u8 } else { 255 };
        let color = |point| {
            [
                number(point, 0) as u8,
                number(point, 1) as u8,
                number(point, 2) as u8,
                alpha(point),
            ]
        };
        attributes.colors = Some((0..count).map(color).collect());
    }
    if kinds & 2 != 0 {
        let normal = |point: usize| match point % 7 {
            0 if kinds & 32 != 0 => [0.0; 3],
            1 if kinds & 32 != 0 => [f32::NAN, 1.0, 2.0],
            _ => Vec3::new(unit(point, 4) - 0.5, unit(point, 5) - 0.5, unit(point, 6) - 0.5)
                .normalize()
                .to_array(),
        };
        attributes.normals = Some((0..count).map(normal).collect());
    }
    if kinds & 4 != 0 {
        attributes.radii = Some(each(&|point| if point % 5 == 0 { 0.0 } else { unit(point, 7) }));
        let ellipse = |point| Ellipse {
            axis: Vec3::new(unit(point, 8), -unit(point, 9), 0.0),
            ratio: unit(point, 10),
        };
        attributes.ellipses = Some((0..count).map(ellipse).collect());
    }
    if kinds & 8 != 0 {
        let hole = |point: usize, value: f32| if point % 11 == 3 { f32::NAN } else { value };
        attributes.scalars = vec![
            ScalarField::new("intensity", each(&|point| hole(point, 1e3 * unit(point, 11) - 20.0))),
            ScalarField {
                offset: 1e9,
                ..ScalarField::new("class", each(&|point| (number(point, 12) % 9) as f32))
            },
        ];
    }
    cloud
}

/// Coordinates of every kind: near each other, far out, on a grid, equal, and none.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => -1f32..1.0,
        4 => (-8i32..8).prop_map(|whole| whole as f32),
        1 => any::<f32>(),
        1 => Just(f32::NAN),
        1 => Just(-0.0f32),
        1 => Just(f32::MAX),
        1 => Just(1e-42f32),
    ]
}

/// Clouds of up to 60 points.
pub(super) fn clouds() -> impl Strategy<Value = RawCloud> {
    let points = prop_oneof![
        prop::collection::vec(prop::array::uniform3(-1f32..1.0), 0..60),
        prop::collection::vec(prop::array::uniform3(coordinate()), 0..60),
        (prop::array::uniform3(coordinate()), 0usize..20).prop_map(|(point, count)| vec![point; count]),
    ];
    (points, any::<u8>(), any::<bool>(), -1e7f64..1e7).prop_map(|(points, kinds, is_double, place)| {
        let positions = if is_double {
            let inter = points.iter().map(|point| point.map(|along| f64::from(along) + place));
            Positions::F64(inter.collect())
        } else {
            Positions::F32(points)
        };
        with_attributes(positions, kinds)
    })
}

/// A bent surface of about `count` points, with everything.
pub(super) fn surface(count: usize, time: f32) -> RawCloud {
    let side = (count as f32).sqrt() as usize;
    let place = |index: usize| [index % side, index / side].map(|along| along as f32 / side as f32);
    let positions: Vec<[f32; 3]> = (0..side * side)
        .map(|index| {
            let [x, y] = place(index);
            [x + 0.1 * time, y, 0.2 * (6.0 * x + time).sin() * (4.0 * y).cos()]
        })
        .collect();
    let normals = positions.iter().map(|&[x, y, _]| {
        let x = x - 0.1 * time;
        let along_x = 1.2 * (6.0 * x + time).cos() * (4.0 * y).cos();
        let along_y = -0.8 * (6.0 * x + time).sin() * (4.0 * y).sin();
        Vec3::new(-along_x, -along_y, 1.0).normalize().to_array()
    });
    let normals = normals.collect();
    let colors = (0..positions.len()).map(|index| {
        let [x, y] = place(index);
        [
            (x * 255.0) as u8,
            (y * 255.0) as u8,
            (120.0 + 100.0 * (9.0 * x * y).sin()) as u8,
            255,
        ]
    });
    let colors = colors.collect();
    let mut cloud = RawCloud::from_positions(Positions::F32(positions));
    cloud.attributes.colors = Some(colors);
    cloud.attributes.normals = Some(normals);
    cloud
}

/// A bent surface in patches of four plain colours.
pub(super) fn patchwork(count: usize, time: f32) -> RawCloud {
    const PLAIN: [[u8; 4]; 4] = [
        [250, 250, 250, 255],
        [10, 20, 30, 255],
        [200, 40, 90, 255],
        [30, 160, 60, 255],
    ];
    let mut cloud = surface(count, time);
    let side = (count as f32).sqrt() as usize;
    let patch = |index: usize| [index % side, index / side].map(|along| 11 * along / side);
    let color = |index: usize| {
        let [x, y] = patch(index);
        PLAIN[(7 * x + 3 * y + x * y) % 4]
    };
    cloud.attributes.colors = Some((0..cloud.positions.len()).map(color).collect());
    cloud
}
