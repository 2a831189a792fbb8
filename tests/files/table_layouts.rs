//! Layouts of tables and arrays that are easily mistaken for others: read correctly, or refused by name.

use pointreel::assumption::{Evidence, Subject};
use pointreel::cloud::RawCloud;
use pointreel::io::{self, IoError, ReadOptions};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

fn read(name: &str, bytes: &[u8]) -> RawCloud {
    try_read(name, bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn try_read(name: &str, bytes: &[u8]) -> Result<RawCloud, IoError> {
    io::read_bytes(Path::new(name), bytes)
}

#[track_caller]
fn refused(name: &str, bytes: &[u8], expected: &str) {
    let error = try_read(name, bytes).unwrap_err().to_string();
    assert!(error.contains(expected), "{error}");
}

fn points(cloud: &RawCloud) -> Vec<[f64; 3]> {
    let positions = &cloud.positions;
    (0..positions.len())
        .map(|index| positions.get(index).to_array())
        .collect()
}

fn names(cloud: &RawCloud) -> Vec<&str> {
    let scalars = cloud.attributes.scalars.iter();
    scalars.map(|field| field.name.as_str()).collect()
}

/// Frames of a file: name and time.
fn frames(name: &str, bytes: &[u8]) -> Vec<(String, Option<Duration>)> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let entries = io::list(&path, &ReadOptions::default()).unwrap();
    entries.into_iter().map(|entry| (entry.name, entry.time)).collect()
}

/// Some number from 0 to 1.
fn noise(index: usize) -> f64 {
    ((index * 7919) % 1009) as f64 / 1009.0
}

#[test]
fn trajectories_are_not_clouds() {
    let mut stamped = String::new();
    let mut matrices = String::new();
    for index in 0..20 {
        let (x, sine, cosine) = (
            index as f64 * 0.1,
            (index as f64 * 0.1).sin(),
            (index as f64 * 0.1).cos(),
        );
        let _ = writeln!(stamped, "{} {x} 2 3 0 0 0.6 0.8", 1_305_031_449.7 + x);
        let _ = writeln!(matrices, "{cosine} {} 0 {x} {sine} {cosine} 0 2 0 0 1 3", -sine);
    }
    refused("a.txt", stamped.as_bytes(), "trajectory");
    refused("a.txt", matrices.as_bytes(), "--columns x=3,y=7,z=11");
    let named = format!("# timestamp tx ty tz qx qy qz qw\n{stamped}");
    let cloud = read("a.txt", named.as_bytes());
    assert_eq!(points(&cloud)[1], [0.1, 2.0, 3.0]);
    assert_eq!(names(&cloud), ["timestamp", "qx", "qy", "qz", "qw"]);
    assert_eq!(cloud.attributes.colors, None);
}

#[test]
fn names_after_a_comment_mark_are_column_names() {
    let text = b"# range azimuth elevation power\n5 9 1 1\n6 3 4 1\n";
    refused("a.txt", text, "0 range, 1 azimuth, 2 elevation, 3 power");
    let colmap = b"# 3D point list\n#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n\
                   7 1.5 2 3 255 0 9 0.5 1 2 3 4\n9 4.5 5 6 255 0 9 0.25 1 2\n";
    let cloud = read("points3D.txt", colmap);
    assert_eq!(points(&cloud), [[1.5, 2.0, 3.0], [4.5, 5.0, 6.0]]);
    assert_eq!(cloud.attributes.colors.as_ref().unwrap()[0], [255, 0, 9, 255]);
    let cloud = read(
        "a.txt",
        b"% scale 0.01\n% xyziRGB\n1 2 3 9 65280 0 256\n4 5 6 8 0 0 0\n",
    );
    assert_eq!(
        (names(&cloud), cloud.attributes.colors.is_some()),
        (vec!["intensity"], true)
    );
}

#[test]
fn extended_xyz_names_its_columns() {
    let text = b"2\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=id:I:1:species:S:1:pos:R:3:forces:R:3 Time=0.5\n\
                 0 O 0.5 1.5 2.5 1 2 3\n1 H 3.5 4.5 5.5 1 2 3\n";
    let cloud = read("a.xyz", text);
    assert_eq!(points(&cloud), [[0.5, 1.5, 2.5], [3.5, 4.5, 5.5]]);
    let mut found = names(&cloud);
    found.sort_unstable();
    assert_eq!(found, ["element", "forces_x", "forces_y", "forces_z", "id"]);
    assert_eq!(cloud.attributes.colors, None);
    assert!(cloud.warnings.is_empty(), "{:?}", cloud.warnings);
    let two = [text.as_slice(), text].concat();
    assert_eq!(frames("a.xyz", &two).len(), 2);
    refused("a.xyz", b"1\nProperties=pos:R:3:q:R:1\n1 2 3\n", "names 4 columns");
    // Atomic numbers, and types as written by LAMMPS.
    for comment in ["", "Atoms. Timestep: 0"] {
        let text = format!("2\n{comment}\n8 0.5 1 2\n1 3.5 4 5\n");
        let cloud = read("a.xyz", text.as_bytes());
        assert_eq!(points(&cloud)[0], [0.5, 1.0, 2.0], "{comment:?}");
        assert_eq!(names(&cloud), ["element"]);
    }
}

#[test]
fn grids_without_a_header_are_not_tables() {
    let mut text = String::new();
    for row in 0..20 {
        let value = |column: usize| {
            format!(
                "{:.2}",
                10.0 * (0.3 * column as f64).sin() + 0.5 * noise(row * 31 + column)
            )
        };
        text += &(0..24).map(value).collect::<Vec<String>>().join(" ");
        text += "\n";
    }
    refused("a.txt", text.as_bytes(), "20 rows of 24 numbers");
    let grass = b"north: 20\nsouth: 0\neast: 30\nwest: 10\nrows: 2\ncols: 2\n1 2\n3 4\n";
    assert_eq!(points(&read("a.asc", grass))[0], [15.0, 15.0, 1.0]);
}

#[test]
fn numbers_and_line_endings_of_all_platforms_are_read() {
    let expected = [[1.5, -2.25, 3.0], [4.0, 5.5, 6.0]];
    let utf16: Vec<u8> = "1.5 -2.25 3\n4 5.5 6\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let texts: [(&str, &[u8]); 10] = [
        ("a.txt", b"1.5 -2.25 3\r4 5.5 6\r"),
        ("a.txt", &utf16),
        ("a.txt", b"1,500, -2,250, 3,000\n4,000, 5,500, 6,000\n"),
        ("a.txt", b"[1.5, -2.25, 3]\n[4, 5.5, 6]\n"),
        ("a.txt", b"{1.5, -2.25, 3},\n{4, 5.5, 6},\n"),
        ("a.dat", b"1.5D+00 -0.225D+01 3\n4 5.5 6\n"),
        (
            "a.dat",
            b"TITLE = \"t\"\nVARIABLES = \"X\", \"Y\", \"Z\"\nZONE I=2, F=POINT\n1.5 -2.25 3\n4 5.5 6\n",
        ),
        ("a.csv", b"name,x,y,z\n\"a\nb\",1.5,-2.25,3\n\"a\nb\",4,5.5,6\n"),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
            end_header\n1,5 -2,25 3\n4 5,5 6\n",
        ),
        (
            "a.pcd",
            b"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n\
            DATA ascii\n1,5 -2,25 3\n4 5,5 6\n",
        ),
    ];
    for (name, text) in texts {
        let shown = String::from_utf8_lossy(text).into_owned();
        assert_eq!(points(&read(name, text)), expected, "{shown:?}");
    }
    let north = read("a.neu", b"5400000.5 500000.25 300\n5400001.5 500000.25 300\n");
    assert_eq!(points(&north)[0], [500_000.25, 5_400_000.5, 300.0]);
    let missing = read(
        "a.csv",
        b"x,y,z,i\n#N/A,#N/A,#N/A,1\n1,2,3,4\n#N/A,#N/A,#N/A,2\n5,6,7,8\n",
    );
    assert_eq!(missing.positions.len(), 4);
    // A text that was not understood at all is not an empty cloud.
    refused("a.csv", b"x,y,z\nnothing here\nbut words\n", "no line has numbers");
}

#[test]
fn point_times_are_not_frames() {
    let mut text = String::from("X,Y,Z,GpsTime\n");
    let mut rounded = String::from("x,y,z,time\n");
    for index in 0..2000 {
        let [x, y, z] = [0, 1, 2].map(|axis| noise(index * 3 + axis));
        let time = (index as f64 / 99.7).round() / 1000.0;
        let _ = writeln!(text, "{x},{y},{z},{}", 245_370.0 + time);
        let _ = writeln!(rounded, "{x},{y},{z},{time}");
    }
    for text in [text, rounded] {
        assert_eq!(frames("a.csv", text.as_bytes()).len(), 1);
        let cloud = read("a.csv", text.as_bytes());
        let frames = cloud
            .assumptions
            .iter()
            .find(|found| found.subject == Subject::Frames)
            .unwrap();
        assert_eq!(frames.value, "one");
    }
}

#[test]
fn columns_before_the_coordinates_are_not_coordinates() {
    let mut index = String::new();
    let mut grid = String::new();
    for row in 0..30 {
        let [x, y, z] = [0, 1, 2].map(|axis| noise(row * 3 + axis) + 0.0001);
        let _ = writeln!(index, "{row} {x} {y} {z}");
        let _ = writeln!(grid, "0 {row} {x} {y} {z} 255 {row} 9");
    }
    for (text, scalars) in [(&index, vec![]), (&grid, vec!["row", "column"])] {
        let cloud = read("a.xyz", text.as_bytes());
        assert!(points(&cloud)[29][0] < 1.1, "{:?}", cloud.assumptions);
        assert_eq!(names(&cloud), scalars);
        let columns = cloud
            .assumptions
            .iter()
            .find(|found| found.subject == Subject::Columns)
            .unwrap();
        assert_eq!(columns.evidence, Evidence::Statistics);
    }
    assert_eq!(
        read("a.xyz", grid.as_bytes()).attributes.colors.unwrap()[7],
        [255, 7, 9, 255]
    );
}

#[test]
fn colors_are_found_in_the_notation_of_many_programs() {
    for text in [
        "x,y,z,color\n1,2,3,#ff0009\n4,5,6,#000000\n",
        "x,y,z,rgb\n1,2,3,0xFF0009\n4,5,6,0x000000\n",
        "x,y,z,colR,colG,colB\n1,2,3,255,0,9\n4,5,6,0,0,0\n",
        "x,y,z,Rouge,Vert,Bleu\n1,2,3,255,0,9\n4,5,6,0,0,0\n",
        "1 2 3 65535 0 2313\n4 5 6 0 0 0\n",
    ] {
        let cloud = read("a.csv", text.as_bytes());
        assert_eq!(cloud.attributes.colors.unwrap()[0], [255, 0, 9, 255], "{text}");
    }
}

#[test]
fn rows_of_markers_are_frames() {
    let text = "time,x0,y0,z0,x1,y1,z1,x2,y2,z2\n0,1,2,3,4,5,6,7,8,9\n0.5,1.5,2,3,4,5,6,7,8,9\n";
    let found = frames("a.csv", text.as_bytes());
    assert_eq!(found[1], ("frame 2".to_owned(), Some(Duration::from_millis(500))));
    assert_eq!(
        points(&read("a.csv", text.as_bytes())),
        [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]
    );
    let titled = "Frame 0\n1 2 3\n4 5 6\n1 5 3\nFrame 1\n1 2 4\n4 5 6\n1 5 3\nFrame 2\n1 2 5\n4 5 6\n1 5 3\n";
    let found = frames("a.txt", titled.as_bytes());
    assert_eq!((found.len(), found[0].0.as_str()), (3, "frame 1 (Frame 0)"));
    let timed = titled.replace("Frame ", "# t = ");
    assert_eq!(frames("a.txt", timed.as_bytes())[2].1, Some(Duration::from_secs(2)));
}

#[test]
fn one_bad_row_only_loses_one_point() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  end_header\n";
    let pcd =
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA ascii\n";
    for (name, header) in [("a.ply", header), ("a.pcd", pcd)] {
        let cloud = read(name, format!("{header}1 2 3\noops here now\n7 8 9\n").as_bytes());
        let found = points(&cloud);
        assert!(found[1][0].is_nan() && found[2] == [7.0, 8.0, 9.0], "{found:?}");
        assert!(cloud.warnings[0].contains("missing"), "{:?}", cloud.warnings);
        // If there is one line more than points, it is not a point.
        let cloud = read(name, format!("{header}1 2 3\noops\n4 5 6\n7 8 9\n").as_bytes());
        assert_eq!(points(&cloud)[1], [4.0, 5.0, 6.0]);
        assert!(cloud.warnings[0].contains("skipped"), "{:?}", cloud.warnings);
        assert!(try_read(name, format!("{header}1 2 3\noops\n7 8 9\n1 2\n3\n4\n5\n").as_bytes()).is_err());
    }
}

#[test]
fn binary_ply_may_have_long_numbers_and_more_bytes() {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                      property float z\nproperty int64 id\nend_header\n"
        .to_vec();
    for value in [1.0f32, 2.0, 3.0] {
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend(77i64.to_le_bytes());
    let cloud = read("a.ply", &bytes);
    assert_eq!((points(&cloud)[0], names(&cloud)), ([1.0, 2.0, 3.0], vec!["id"]));
    assert!(cloud.warnings.is_empty());
    bytes.extend([0; 12]);
    let cloud = read("a.ply", &bytes);
    assert!(cloud.warnings[0].contains("12 bytes behind"), "{:?}", cloud.warnings);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    std::fs::write(&path, &bytes).unwrap();
    assert!(io::read(&path).unwrap().warnings[0].contains("12 bytes behind"));
}

#[test]
fn bare_records_may_be_doubles() {
    let mut bytes = Vec::new();
    for index in 0..4000 {
        let angle = index as f64 * 0.01;
        for value in [20.0 * angle.cos(), 20.0 * angle.sin(), 0.01 * index as f64 - 3.0] {
            bytes.extend(value.to_le_bytes());
        }
    }
    let cloud = read("a.bin", &bytes);
    assert_eq!(cloud.positions.len(), 4000);
    assert!((points(&cloud)[0][0] - 20.0).abs() < 1e-9);
    assert!(
        cloud.assumptions[0].value.starts_with("3 doubles per point"),
        "{:?}",
        cloud.assumptions
    );
    refused("a.bin", &[0; 480], "all bytes are zero");
}
