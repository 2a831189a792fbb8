//! Positions of the fields of each point format.

use super::*;
use laz::{LazVlrBuilder, ParLasZipCompressor};

/// Bytes of a point, and where its time, colours and near infrared are.
type FieldOffsets = (u16, Option<usize>, Option<usize>, Option<usize>);

const FORMATS: [FieldOffsets; 11] = [
    (20, None, None, None),
    (28, Some(20), None, None),
    (26, None, Some(20), None),
    (34, Some(20), Some(28), None),
    (57, Some(20), None, None),
    (63, Some(20), Some(28), None),
    (30, Some(22), None, None),
    (36, Some(22), Some(30), None),
    (38, Some(22), Some(30), Some(36)),
    (59, Some(22), None, None),
    (67, Some(22), Some(30), Some(36)),
];

/// Third return of five, class 9 with a flag where classes have five bits.
fn point(format: u8, red: u16, extra: &[u8]) -> Vec<u8> {
    let (bytes, time, colors, infrared) = FORMATS[usize::from(format)];
    let mut row = vec![0; usize::from(bytes)];
    let mut put = |at: usize, bytes: &[u8]| row[at..at + bytes.len()].copy_from_slice(bytes);
    for (axis, raw) in [-2i32, 4, 7].into_iter().enumerate() {
        put(4 * axis, &raw.to_le_bytes());
    }
    put(12, &40_000u16.to_le_bytes());
    if format >= 6 {
        put(14, &[3 | 5 << 4, 0, 209]);
    } else {
        put(14, &[3 | 5 << 3, 9 | 0x80]);
    }
    if let Some(at) = time {
        put(at, &1_234_567.125f64.to_le_bytes());
    }
    if let Some(at) = colors {
        for (channel, value) in [red, 0, 100].into_iter().enumerate() {
            put(at + 2 * channel, &value.to_le_bytes());
        }
    }
    if let Some(at) = infrared {
        put(at, &77u16.to_le_bytes());
    }
    row.extend(extra);
    row
}

#[test]
fn every_format_has_its_fields_at_the_standard_offsets() {
    for (format, (bytes, time, colors, infrared)) in FORMATS.into_iter().enumerate() {
        let format = format as u8;
        // Bytes after a point that nothing describes are skipped.
        for extra in [0, 3] {
            let mut file = header(format, bytes + extra, 2, 0, 375);
            for red in [65535, 0] {
                file.extend(point(format, red, &vec![0xee; usize::from(extra)]));
            }
            let cloud = read(&file);
            assert_eq!(
                cloud.positions,
                Positions::F64(vec![[99.0, 102.0, 103.5]; 2]),
                "{format}"
            );
            assert_eq!(numbers(&cloud, "intensity"), [40_000.0; 2], "{format}");
            let class = if format >= 6 { 209.0 } else { 9.0 };
            assert_eq!(numbers(&cloud, "classification"), [class; 2], "{format}");
            assert_eq!(numbers(&cloud, "return_number"), [3.0; 2], "{format}");
            assert_eq!(numbers(&cloud, "number_of_returns"), [5.0; 2], "{format}");
            let has = |name| cloud.attributes.names().any(|found| found == name);
            assert_eq!(has("gps_time"), time.is_some(), "{format}");
            assert_eq!(has("near_ir"), infrared.is_some(), "{format}");
            if has("gps_time") {
                assert_eq!(numbers(&cloud, "gps_time"), [1_234_567.125; 2], "{format}");
            }
            if has("near_ir") {
                assert_eq!(numbers(&cloud, "near_ir"), [77.0; 2], "{format}");
            }
            let expected = vec![[255, 0, 0, 255], [0, 0, 0, 255]];
            assert_eq!(cloud.attributes.colors, colors.map(|_| expected), "{format}");
        }
    }
}

/// Compressed files equal the uncompressed ones, including waveform data (formats 4, 5, 9 and 10).
#[test]
fn every_format_is_unpacked() {
    const COUNT: usize = 300;
    for (format, (bytes, ..)) in FORMATS.into_iter().enumerate() {
        let format = format as u8;
        for extra in [0, 3] {
            let mut rows = Vec::new();
            for index in 0..COUNT {
                let mut row = point(format, 65535 - index as u16, &[7; 3][..usize::from(extra)]);
                row[..4].copy_from_slice(&((index * index) as i32).to_le_bytes());
                row[12] = index as u8;
                // A waveform packet is the last field of the format: the description index, the offset, the length, and
                // four floats.
                if [4, 5, 9, 10].contains(&format) {
                    let mut packet = vec![1 + (index % 3) as u8];
                    packet.extend((60 + 256 * index as u64).to_le_bytes());
                    packet.extend(256u32.to_le_bytes());
                    for float in [index as f32, 0.5, -0.25, 2.0] {
                        packet.extend(float.to_le_bytes());
                    }
                    row[usize::from(bytes) - 29..usize::from(bytes)].copy_from_slice(&packet);
                }
                rows.extend(row);
            }
            let mut plain = header(format, bytes + extra, COUNT as u64, 0, 375);
            plain.extend(&rows);

            let compression = LazVlrBuilder::default().with_point_format(format, extra).unwrap();
            let compression = compression.with_fixed_chunk_size(100).build();
            let mut described = Vec::new();
            compression.write_to(&mut described).unwrap();
            let described = record(b"laszip encoded", 22204, &described);
            let start = 375 + described.len();
            let mut packed = header(format | 0x80, bytes + extra, COUNT as u64, 1, start);
            packed.extend(described);
            let mut packed = Cursor::new(packed);
            packed.set_position(start as u64);
            let mut packer = ParLasZipCompressor::new(&mut packed, compression).unwrap();
            packer.compress_many(&rows).unwrap();
            packer.done().unwrap();
            assert_eq!(read(packed.get_ref()), read(&plain), "{format} {extra}");
        }
    }
}

#[test]
fn unfilled_fields_are_omitted() {
    for (format, names) in [
        (3, vec!["position", "color", "intensity"]),
        (6, vec!["position", "intensity"]),
    ] {
        let bytes = FORMATS[usize::from(format)].0;
        let mut file = header(format, bytes, 2, 0, 375);
        file.extend(vec![0; 2 * usize::from(bytes)]);
        assert_eq!(read(&file).point_names(), names, "{format}");
        // One point with a class.
        let class = file.len() - usize::from(bytes) + if format >= 6 { 16 } else { 15 };
        file[class] = 2;
        assert_eq!(numbers(&read(&file), "classification"), [0.0, 2.0], "{format}");
    }
}

#[test]
fn eight_bit_colors_in_sixteen_bits_are_detected_by_the_brightest() {
    for (red, expected) in [(255u16, [255, 0, 100, 255]), (256, [1, 0, 0, 255])] {
        let mut file = header(2, 26, 1, 0, 375);
        file.extend(point(2, red, &[]));
        assert_eq!(read(&file).attributes.colors, Some(vec![expected]), "{red}");
    }
}

#[test]
fn either_point_count_of_version_1_4_is_used() {
    let mut file = header(0, 20, 0, 0, 375);
    file.extend(point(0, 0, &[]));
    // Neither count is set: the file was never finished, and its points are read with a warning.
    let unfinished = read(&file);
    assert_eq!((unfinished.positions.len(), unfinished.warnings.len()), (1, 1));
    file[107..111].copy_from_slice(&1u32.to_le_bytes());
    assert_eq!(read(&file).positions.len(), 1);
    // Before 1.4 there is only one count, whatever bytes are in the place of the other.
    file[COUNT_AT..COUNT_AT + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    file[25] = 2;
    assert_eq!(read(&file).positions.len(), 1);
}

#[test]
fn plain_numeric_extra_bytes_become_scalars() {
    let describe = |kind: u8, options: u8, name: &str| {
        let mut description = vec![0; 192];
        description[2..4].copy_from_slice(&[kind, options]);
        description[4..4 + name.len()].copy_from_slice(name.as_bytes());
        description[40..48].copy_from_slice(&9u64.to_le_bytes());
        description[112..120].copy_from_slice(&0.5f64.to_le_bytes());
        description[136..144].copy_from_slice(&10f64.to_le_bytes());
        description
    };
    let described = [
        describe(3, 1 | 8 | 16, "Height"),
        // Two undefined bytes, three u8, and then a signed number.
        describe(0, 2, "raw"),
        describe(21, 0, "triple"),
        describe(4, 0, "Intensity"),
        // It does not fit.
        describe(10, 0, "outside"),
    ]
    .concat();
    let described = record(b"LASF_Spec", 4, &described);
    let start = 375 + described.len();
    let mut file = header(0, 29, 3, 1, start);
    file.extend(described);
    for height in [4u16, 9, 65535] {
        let extra = [
            height.to_le_bytes().as_slice(),
            &[1, 2, 3, 4, 5],
            &(-3i16).to_le_bytes(),
        ]
        .concat();
        file.extend(point(0, 0, &extra));
    }
    let cloud = read(&file);
    let height = numbers(&cloud, "Height");
    assert_eq!((height[0], height[2]), (12.0, 65535.0 * 0.5 + 10.0));
    assert!(height[1].is_nan(), "9 stands for no height");
    assert_eq!(numbers(&cloud, "Intensity extra 5"), [-3.0; 3]);
    assert_eq!(numbers(&cloud, "triple_2").len(), 3);
    assert_eq!(cloud.attributes.scalars.len(), 4 + 6);
}
