//! Text as found in practice, PTX scans and bare records, with known answers.

use pointreel::cloud::RawCloud;
use pointreel::io::{self, ColumnMap, IoError, Part, ReadOptions, read_part};
use std::path::Path;

fn read(name: &str, bytes: &[u8]) -> Result<RawCloud, IoError> {
    io::read_bytes(Path::new(name), bytes)
}

fn points(cloud: &RawCloud) -> Vec<[f64; 3]> {
    (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index).to_array())
        .collect()
}

#[test]
fn separators_commas_and_names_of_all_kinds_are_read() {
    for text in [
        "1.5 2.5 3.5\n",
        "1.5\t2.5\t3.5\r\n",
        "1.5,2.5,3.5\n",
        "1.5, 2.5, 3.5\n",
        "1.5;2.5;3.5",
        "1,5;2,5;3,5\n",
        "1,5 2,5 3,5\n",
        "1,5\t2,5\t3,5\n",
        "X;Y;Z\n1,5;2,5;3,5\n",
        "\"Z\",\"Y\",\"X\"\n3.5,2.5,1.5\n",
        "//X Y Z\n1.5 2.5 3.5\n",
        "Y [m],X [m],Z [m]\n2.5,1.5,3.5\n",
        "Points:0,Points:1,Points:2\n1.5,2.5,3.5\n",
        "1\n1.5 2.5 3.5\n",
        "\u{feff}x,y,z\n1.5,2.5,3.5,\n",
        "1.5 2.5 3.5\n,,,\n\n# end\n",
        "Northing,Easting,Height\n2.5,1.5,3.5\n",
    ] {
        let cloud = read("a.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(points(&cloud), [[1.5, 2.5, 3.5]], "{text:?}");
    }
    let cloud = read(
        "a.txt",
        b"//X Y Z R G B Intensity\n1 2 3 10 20 30 0.5\n4 5 6 40 50 255 0.25\n",
    )
    .unwrap();
    assert_eq!(
        cloud.attributes.colors,
        Some(vec![[10, 20, 30, 255], [40, 50, 255, 255]])
    );
    assert_eq!(cloud.attributes.scalars[0].values, [0.5, 0.25]);
    let cloud = read("a.csv", b"x,y,z\n1,,3\n").unwrap();
    assert!(cloud.positions.get(0).y.is_nan());
}

const SCAN: &str = "2\n1\n10 20 30\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";

#[test]
fn scans_are_placed_by_their_poses() {
    let text = format!("{SCAN}1 2 3 0.25 255 0 1\n0 0 0 0.5 1 1 1\n");
    for name in ["a.ptx", "a.txt", "a.pts"] {
        let cloud = read(name, text.as_bytes()).unwrap();
        // x goes to y, y to -x.
        assert_eq!(points(&cloud), [[8.0, 21.0, 33.0], [10.0, 20.0, 30.0]], "{name}");
        assert_eq!(cloud.attributes.colors, Some(vec![[255, 0, 1, 255], [1, 1, 1, 255]]));
        assert_eq!(cloud.attributes.scalars[0].values, [0.25, 0.5]);
        assert_eq!(cloud.sensor.unwrap().to_array(), [10.0, 20.0, 30.0]);
    }
    assert_eq!(read("a.ptx", text.as_bytes()).unwrap().grid, None, "a line is no image");
    let two = format!("{text}{SCAN}1 2 3 0.25\r\n\r\n1 2 4 0.25");
    let cloud = read("a.ptx", two.as_bytes()).unwrap();
    assert_eq!(points(&cloud)[2..], [[8.0, 21.0, 33.0], [8.0, 21.0, 34.0]]);
    assert_eq!((cloud.attributes.colors, cloud.sensor), (None, None));
}

#[test]
fn the_columns_of_a_scan_become_image_rows() {
    let header = SCAN.replacen("2\n1\n", "2\n3\n", 1);
    let text = format!("{header}{}", "1 2 3 0.25\n".repeat(6));
    let grid = read("a.ptx", text.as_bytes()).unwrap().grid.unwrap();
    assert_eq!((grid.width(), grid.height()), (3, 2));
    let two = read("a.ptx", text.repeat(2).as_bytes()).unwrap();
    assert_eq!((two.positions.len(), two.grid), (12, None), "two scans are no image");
}

#[test]
fn invalid_scans_are_rejected_with_their_line() {
    for (text, expected) in [
        (format!("{SCAN}1 2 3 4\n"), "the scan before it has 2 points"),
        (format!("{SCAN}1 2 3 4\n1 2 x 4\n"), "line 12: found `x`"),
        (
            format!("{SCAN}1.25 2.5 3 4\n1\n"),
            "line 12: found a line of one number",
        ),
        (SCAN.replace("2\n1\n10", "2\n1e300\n10"), "truncated"),
        (SCAN.replace("2\n1\n10", "2\n-1\n10"), "line 2: found -1"),
        (SCAN.replace("0 1 0 0\n", "0 1 0\n"), "line 7: found 3 numbers"),
    ] {
        let error = read("a.ptx", text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let text = format!("{SCAN}1 2 3 4\n5 6 7 8\n");
    for length in 0..text.len() {
        let _ = read("a.ptx", &text.as_bytes()[..length]);
        let mut damaged = text.clone().into_bytes();
        damaged[length] ^= 0x11;
        let _ = read("a.ptx", &damaged);
    }
}

fn records(rows: &[&[f32]]) -> Vec<u8> {
    rows.concat().into_iter().flat_map(f32::to_le_bytes).collect()
}

#[test]
fn bare_records_are_recognised_by_size_and_values() {
    let kitti = records(&[&[1.0, -2.0, 3.0, 0.5], &[4.0, 5.0, -6.0, 0.25]]);
    let cloud = read("000001.bin", &kitti).unwrap();
    assert_eq!(points(&cloud), [[1.0, -2.0, 3.0], [4.0, 5.0, -6.0]]);
    assert_eq!(cloud.attributes.scalars[0].values, [0.5, 0.25]);
    // Four records of five are twenty numbers, like five of four.
    let rows: Vec<[f32; 5]> = (0..4).map(|i| [10.5 + i as f32, -7.25, -1.5, 30.0, i as f32]).collect();
    let rows: Vec<&[f32]> = rows.iter().map(<[f32; 5]>::as_slice).collect();
    for name in ["a.pcd.bin", "a.bin"] {
        let cloud = read(name, &records(&rows)).unwrap();
        assert_eq!(cloud.positions.len(), 4, "{name}");
        assert_eq!(cloud.attributes.scalars[1].values, [0.0, 1.0, 2.0, 3.0], "{name}");
    }
    assert_eq!(
        read("a.bin", &records(&[&[1.0, 2.0, -3.0]])).unwrap().positions.len(),
        1
    );
}

/// A street: 12,000 points of ground and walls, which is a multiple of all widths.
fn street(is_shuffled: bool) -> Vec<[f32; 6]> {
    let mut state = 9u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut rows: Vec<[f32; 6]> = (0..12_000)
        .map(|i| {
            let turn = i as f32 * 0.01;
            let range = 4.0 + 30.0 * (i % 64) as f32 / 64.0;
            let (x, y) = (range * turn.cos(), range * turn.sin());
            [
                x,
                y,
                -1.7 + 0.02 * random(),
                0.01 + random().powi(3),
                (i % 64) as f32,
                0.1 * random(),
            ]
        })
        .collect();
    if is_shuffled {
        for last in (1..rows.len()).rev() {
            rows.swap(last, (random() * last as f32) as usize);
        }
    }
    rows
}

#[test]
fn statistics_determine_the_numbers_per_point() {
    for is_shuffled in [false, true] {
        for width in 3..=6 {
            let rows = street(is_shuffled);
            let rows: Vec<&[f32]> = rows.iter().map(|row| &row[..width]).collect();
            let cloud = read("scan.bin", &records(&rows)).unwrap();
            let assumption = cloud.assumptions[0].to_string();
            assert_eq!(cloud.positions.len(), rows.len(), "{width}: {assumption}");
            assert!(
                assumption.starts_with(&format!("columns: {width} values per point: x y z")),
                "{assumption}"
            );
        }
    }
}

#[test]
fn a_few_coordinates_that_are_nearly_zero_change_nothing() {
    let mut rows = street(false);
    let mut read_with_tiny = |tiny: std::ops::Range<usize>| {
        for row in &mut rows[tiny] {
            row[1] = 1.08e-15;
        }
        let rows: Vec<&[f32]> = rows.iter().map(|row| &row[..4]).collect();
        read("scan.bin", &records(&rows))
    };
    let cloud = read_with_tiny(5..12).unwrap();
    assert_eq!(cloud.positions.len(), 12_000, "{:?}", cloud.assumptions);
    assert!(
        cloud.assumptions[0].value.starts_with("4 values per point"),
        "{:?}",
        cloud.assumptions
    );
    // Integers that are read as floats are all tiny.
    assert!(read_with_tiny(0..12_000).is_err());
}

#[test]
fn the_user_can_set_the_numbers_per_point() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scan.bin");
    let rows: Vec<[f32; 6]> = street(false);
    let rows: Vec<&[f32]> = rows.iter().map(|row| &row[..4]).collect();
    std::fs::write(&file, records(&rows)).unwrap();
    let options = ReadOptions::default().with_columns(Some(ColumnMap::of_width(3)));
    let cloud = read_part(&file, &Part::Whole, &options).unwrap();
    assert_eq!(cloud.positions.len(), 16_000);
    assert_eq!(cloud.assumptions[0].value, "3 values per point: x y z");
}

#[test]
fn other_data_is_not_read_as_bare_records() {
    let mut state = 1u32;
    let noise: Vec<u8> = (0..4800)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    for bytes in [
        noise.as_slice(),
        &noise[..4799],
        &[1; 4800],
        b"text, not records, of 48 bytes as all can be so ",
    ] {
        assert!(read("a.bin", bytes).is_err());
    }
    let error = read("a.bin", &[0; 17]).unwrap_err().to_string();
    assert!(error.contains("17 bytes") && error.contains("truncated"), "{error}");
    let far = records(&[&[1.0, 2.0, 3.0, 0.5], &[1.0, f32::NAN, 3.0, 0.5]]);
    assert!(read("a.bin", &far).is_err());
}
