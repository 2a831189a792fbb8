//! The examples of `docs/reel.md`: stored bytes are read unchanged, and written again as the same bytes.

use super::clouds::{decoded, file_of};
use super::parent_colors::chosen;
use crate::cloud::{Positions, RawCloud};
use crate::reel::parent_level::ParentValue;
use crate::reel::{Coding, Precision, ReelOptions};

const VECTORS: [(Coding, &[u8]); 2] = [
    (Coding::Compact, include_bytes!("vector.reel")),
    (Coding::Fast, include_bytes!("vector_fast.reel")),
];

/// As the fast coding was written before version 3.1.
const FAST_3_0: &[u8] = include_bytes!("vector_fast_3_0.reel");

/// Seven corners of a cube, and its centre.
fn cloud() -> RawCloud {
    let corner = |corner: u8| [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { 0.0 } else { 7.0 });
    let positions: Vec<[f32; 3]> = (0..7).map(corner).chain([[3.0, 4.0, 3.0]]).collect();
    let colors = (0..8u8).map(|point| [30 * point, 255 - 20 * point, 100 + point, 255]);
    let mut cloud = RawCloud::from_positions(Positions::F32(positions));
    cloud.attributes.colors = Some(colors.collect());
    cloud
}

fn options(coding: Coding) -> ReelOptions {
    ReelOptions {
        precision: Precision::Bits(3),
        coding,
        color_error: 0,
        ..ReelOptions::default()
    }
}

#[test]
fn the_example_files_are_read() {
    for (_, bytes) in VECTORS {
        is_read(bytes);
    }
    is_read(FAST_3_0);
}

fn is_read(bytes: &[u8]) {
    let frame = decoded(bytes, 0, usize::MAX).cloud;
    let Positions::F32(positions) = frame.positions else {
        panic!("other positions")
    };
    let colors = frame.attributes.colors.unwrap();
    let mut rows: Vec<[i32; 6]> = positions
        .iter()
        .zip(&colors)
        .map(|(&[x, y, z], &[red, green, blue, _])| {
            [
                x as i32,
                y as i32,
                z as i32,
                i32::from(red),
                i32::from(green),
                i32::from(blue),
            ]
        })
        .collect();
    rows.sort_unstable();
    let document = include_str!("../../../docs/reel.md");
    for [x, y, z, red, green, blue] in &rows {
        let row = format!("| {x} | {y} | {z} | {red} | {green} | {blue} |");
        assert!(document.contains(&row), "{row} is not in the document");
    }
    assert_eq!(rows.len(), 8);
}

/// The contents after the head, which names the version of the program.
fn group_of(bytes: &[u8]) -> Vec<u8> {
    let start = bytes.windows(8).position(|at| at == b"\xf1rlcGRUP").unwrap();
    let end = bytes.windows(8).position(|at| at == b"\xf1rlcINDX").unwrap();
    bytes[start..end].to_vec()
}

/// Bytes and CRC of the group of [`patches`]: colours of first children.
const OF_PATCHES: [(Coding, usize, u32); 2] = [
    (Coding::Compact, 16_210, 3_062_416_815),
    (Coding::Fast, 18_819, 214_070_945),
];

/// Voxels of a rough plane in patches of four colours: large enough for colours of first children, and whole numbers,
/// which are the same on every machine.
fn patches() -> RawCloud {
    const SIDE: u32 = 128;
    let places = (0..SIDE * SIDE).map(|index| [index % SIDE, index / SIDE]);
    let height = |[x, y]: [u32; 2]| (x * x + 3 * y * y) / 97 % 5;
    let position = |place: [u32; 2]| [place[0], place[1], height(place)].map(|axis| axis as f32);
    let color = |[x, y]: [u32; 2]| match (7 * (x / 11) + 3 * (y / 11) + x / 11 * (y / 11)) % 4 {
        0 => [250, 250, 250, 255],
        1 => [10, 20, 30, 255],
        2 => [200, 40, 90, 255],
        _ => [30, 160, 60, 255],
    };
    let mut cloud = RawCloud::from_positions(Positions::F32(places.clone().map(position).collect()));
    cloud.attributes.colors = Some(places.map(color).collect());
    cloud
}

#[test]
fn colors_of_first_children_keep_their_bytes() {
    let found = OF_PATCHES.map(|(coding, ..)| {
        let options = ReelOptions {
            precision: Precision::Bits(7),
            ..options(coding)
        };
        assert_eq!(chosen(&[patches()], &options), ParentValue::FirstChild);
        let bytes = group_of(&file_of(&[patches()], &options));
        (coding, bytes.len(), crc32fast::hash(&bytes))
    });
    assert_eq!(found, OF_PATCHES);
}

#[test]
fn the_example_files_are_reproduced_byte_for_byte() {
    for (coding, bytes) in VECTORS {
        assert_eq!(group_of(&file_of(&[cloud()], &options(coding))), group_of(bytes));
    }
}
