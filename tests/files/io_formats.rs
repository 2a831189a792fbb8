//! Files written here, with known values, in every encoding, scalar type and layout that the readers promise.

use pointreel::cloud::{ImageGrid, Positions, RawCloud};
use pointreel::io::{self, Format};
use std::path::Path;

fn read(name: &str, bytes: &[u8]) -> RawCloud {
    io::read_bytes(Path::new(name), bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn positions(cloud: &RawCloud) -> Vec<[f64; 3]> {
    (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index).to_array())
        .collect()
}

const POINTS: [[f64; 3]; 2] = [[1.0, -2.0, 3.0], [4.0, 5.0, -6.0]];

/// A number of a PLY or PCD type as bytes.
fn bytes_of(scalar: &str, value: f64, big_endian: bool) -> Vec<u8> {
    let little = match scalar {
        "char" | "int8" => (value as i8).to_le_bytes().to_vec(),
        "uchar" | "uint8" => (value as u8).to_le_bytes().to_vec(),
        "short" | "int16" => (value as i16).to_le_bytes().to_vec(),
        "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
        "int" | "int32" => (value as i32).to_le_bytes().to_vec(),
        "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
        "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
        "double" | "float64" => value.to_le_bytes().to_vec(),
        other => panic!("no type {other}"),
    };
    if big_endian {
        little.into_iter().rev().collect()
    } else {
        little
    }
}

/// A PLY whose vertices are `rows`, in all three encodings.
fn plys(properties: &[(&str, &str)], rows: &[Vec<f64>]) -> [(&'static str, Vec<u8>); 3] {
    ["ascii", "binary_little_endian", "binary_big_endian"].map(|encoding| {
        let mut file = format!("ply\nformat {encoding} 1.0\nelement vertex {}\n", rows.len()).into_bytes();
        for (scalar, name) in properties {
            file.extend(format!("property {scalar} {name}\n").bytes());
        }
        file.extend(b"end_header\n");
        for row in rows {
            for ((scalar, _), value) in properties.iter().zip(row) {
                match encoding {
                    "ascii" => file.extend(format!("{value} ").bytes()),
                    _ => file.extend(bytes_of(scalar, *value, encoding == "binary_big_endian")),
                }
            }
            if encoding == "ascii" {
                file.push(b'\n');
            }
        }
        (encoding, file)
    })
}

#[test]
fn ply_coordinates_of_every_type_and_encoding_are_read() {
    let signed = [
        "char", "int8", "short", "int16", "int", "int32", "float", "float32", "double", "float64",
    ];
    for scalar in signed {
        let rows = POINTS.map(|point| point.to_vec());
        for (encoding, file) in plys(&[(scalar, "x"), (scalar, "y"), (scalar, "z")], &rows) {
            assert_eq!(positions(&read("a.ply", &file)), POINTS, "{scalar}, {encoding}");
        }
    }
    for scalar in ["uchar", "uint8", "ushort", "uint16", "uint", "uint32"] {
        let rows = [vec![1.0, 2.0, 200.0]];
        for (encoding, file) in plys(&[(scalar, "x"), (scalar, "y"), (scalar, "z")], &rows) {
            assert_eq!(
                positions(&read("a.ply", &file)),
                [[1.0, 2.0, 200.0]],
                "{scalar}, {encoding}"
            );
        }
    }
}

#[test]
fn ply_doubles_keep_their_digits() {
    let point = [4_320_978.612_345, -1e-9, 1e7 + 0.001];
    for (encoding, file) in plys(&[("double", "x"), ("double", "y"), ("double", "z")], &[point.to_vec()]) {
        let cloud = read("a.ply", &file);
        assert!(matches!(cloud.positions, Positions::F64(_)));
        assert_eq!(positions(&cloud), [point], "{encoding}");
    }
}

#[test]
fn ply_attributes_are_read_in_any_order() {
    let properties = [
        ("uchar", "blue"),
        ("float", "nz"),
        ("double", "z"),
        ("uchar", "red"),
        ("float", "x"),
        ("short", "unknown"),
        ("float", "y"),
        ("float", "nx"),
        ("uchar", "green"),
        ("float", "ny"),
        ("float", "radius"),
        ("uchar", "alpha"),
        ("float", "scalar_Intensity"),
    ];
    let row = vec![3.0, 1.0, 30.0, 1.0, 10.0, -7.0, 20.0, 0.0, 2.0, 0.5, 0.25, 128.0, 9.0];
    for (encoding, file) in plys(&properties, &[row]) {
        let cloud = read("a.ply", &file);
        assert_eq!(positions(&cloud), [[10.0, 20.0, 30.0]], "{encoding}");
        assert_eq!(cloud.attributes.colors, Some(vec![[1, 2, 3, 128]]), "{encoding}");
        assert_eq!(cloud.attributes.normals, Some(vec![[0.0, 0.5, 1.0]]), "{encoding}");
        assert_eq!(cloud.attributes.radii, Some(vec![0.25]), "{encoding}");
        assert_eq!(cloud.attributes.scalars[0].values, [9.0], "{encoding}");
    }
}

#[test]
fn ply_colors_of_every_depth_are_read() {
    let cases: [(&str, [f64; 3], [u8; 4]); 4] = [
        ("uchar", [255.0, 128.0, 0.0], [255, 128, 0, 255]),
        ("float", [1.0, 0.5, 0.0], [255, 128, 0, 255]),
        ("float", [255.0, 128.0, 0.0], [255, 128, 0, 255]),
        ("ushort", [65535.0, 32896.0, 0.0], [255, 128, 0, 255]),
    ];
    for (scalar, color, expected) in cases {
        let properties = [
            ("float", "x"),
            ("float", "y"),
            ("float", "z"),
            (scalar, "red"),
            (scalar, "green"),
            (scalar, "blue"),
        ];
        let row: Vec<f64> = [0.0; 3].into_iter().chain(color).collect();
        for (encoding, file) in plys(&properties, std::slice::from_ref(&row)) {
            assert_eq!(
                read("a.ply", &file).attributes.colors,
                Some(vec![expected]),
                "{scalar} {color:?}, {encoding}"
            );
        }
    }
}

#[test]
fn ply_lists_and_other_elements_are_skipped() {
    let header = |encoding| {
        format!(
            "ply\r\nformat {encoding} 1.0\r\ncomment a b c\r\nobj_info made by a test\r\n\
             element camera 1\r\nproperty list uchar int ids\r\nproperty float f\r\n\
             element vertex 2\r\nproperty float x\r\nproperty list uchar short neighbours\r\nproperty float y\r\n\
             property float z\r\nelement face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n"
        )
    };
    let ascii = header("ascii") + "3 7 8 9 0.5\r\n1 0 -2 3\r\n4 2 11 12 5 -6\r\n3 0 1 0\r\n";
    assert_eq!(positions(&read("a.ply", ascii.as_bytes())), POINTS);
    for big_endian in [false, true] {
        let put = |scalar, value| bytes_of(scalar, value, big_endian);
        let mut file = header(if big_endian {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        })
        .into_bytes();
        for (scalar, value) in [("uchar", 3.0), ("int", 7.0), ("int", 8.0), ("int", 9.0), ("float", 0.5)] {
            file.extend(put(scalar, value));
        }
        let rows: [&[f64]; 2] = [&[], &[11.0, 12.0]];
        for (point, list) in POINTS.iter().zip(rows) {
            file.extend(put("float", point[0]));
            file.extend(put("uchar", list.len() as f64));
            for &item in list {
                file.extend(put("short", item));
            }
            file.extend(put("float", point[1]));
            file.extend(put("float", point[2]));
        }
        file.extend(put("uchar", 0.0));
        assert_eq!(positions(&read("a.ply", &file)), POINTS, "big endian: {big_endian}");
    }
}

#[test]
fn ply_is_recognised_by_its_magic_whatever_its_name() {
    let (_, file) = &plys(
        &[("float", "x"), ("float", "y"), ("float", "z")],
        &[vec![1.0, 2.0, 3.0]],
    )[1];
    for name in ["a.txt", "a.pcd", "a", "a.xyz.bak"] {
        assert_eq!(
            Format::detect(Path::new(name), file),
            Format::of_extension(Path::new("a.ply"))
        );
        assert_eq!(positions(&read(name, file)), [[1.0, 2.0, 3.0]], "{name}");
    }
}

fn pcd_header(fields: &str, sizes: &str, types: &str, counts: &str, points: usize, data: &str) -> Vec<u8> {
    format!(
        "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS {fields}\nSIZE {sizes}\nTYPE {types}\n\
         COUNT {counts}\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    )
    .into_bytes()
}

#[test]
fn pcd_is_read_in_all_encodings() {
    let header = |data| {
        pcd_header(
            "x y z rgb _ normal_x normal_y normal_z",
            "4 4 4 4 1 4 4 4",
            "F F F U U F F F",
            "1 1 1 1 3 1 1 1",
            2,
            data,
        )
    };
    let rgb = [0x00ff_8000_u32, 0x0001_0203];
    let normals = [[0.0f32, 0.0, 1.0], [1.0, 0.0, 0.0]];

    let mut ascii = header("ascii");
    let mut rows = header("binary");
    let mut columns: Vec<Vec<u8>> = vec![Vec::new(); 8];
    for i in 0..2 {
        let [x, y, z] = POINTS[i];
        let [nx, ny, nz] = normals[i];
        ascii.extend(format!("{x} {y} {z} {} 0 0 0 {nx} {ny} {nz}\n", rgb[i]).bytes());
        let fields: Vec<Vec<u8>> = vec![
            (x as f32).to_le_bytes().to_vec(),
            (y as f32).to_le_bytes().to_vec(),
            (z as f32).to_le_bytes().to_vec(),
            rgb[i].to_le_bytes().to_vec(),
            vec![0; 3],
            nx.to_le_bytes().to_vec(),
            ny.to_le_bytes().to_vec(),
            nz.to_le_bytes().to_vec(),
        ];
        for (column, field) in columns.iter_mut().zip(&fields) {
            column.extend(field);
            rows.extend(field);
        }
    }
    let block = columns.concat();
    let packed = crate::rgbd::lzf(&block);
    let mut compressed = header("binary_compressed");
    compressed.extend((packed.len() as u32).to_le_bytes());
    compressed.extend((block.len() as u32).to_le_bytes());
    compressed.extend(&packed);

    for (encoding, file) in [("ascii", ascii), ("binary", rows), ("binary_compressed", compressed)] {
        let cloud = read("a.pcd", &file);
        assert_eq!(positions(&cloud), POINTS, "{encoding}");
        assert_eq!(
            cloud.attributes.colors,
            Some(vec![[255, 128, 0, 255], [1, 2, 3, 255]]),
            "{encoding}"
        );
        assert_eq!(cloud.attributes.normals, Some(normals.to_vec()), "{encoding}");
        assert_eq!(cloud.sensor, None, "{encoding}: the default viewpoint says nothing");
    }
}

#[test]
fn pcd_colors_are_read_from_the_bits_of_a_float() {
    let bits = f32::from_bits(0x00ff_8000);
    let mut file = pcd_header("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 1, "ascii");
    file.extend(format!("1 2 3 {bits:e}\n").bytes());
    assert_eq!(read("a.pcd", &file).attributes.colors, Some(vec![[255, 128, 0, 255]]));
}

#[test]
fn pcd_viewpoints_give_the_sensor_position() {
    let organised = b"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\n\
        VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n0 0 1\nnan nan nan\n0 1 1\n1 1 1\n";
    let cloud = read("a.pcd", organised);
    assert_eq!(cloud.sensor, Some(glam::DVec3::ZERO));
    assert_eq!(cloud.positions.len(), 4);
    assert_eq!(cloud.positions.finite_bounds().0, 3);
    assert_eq!(cloud.grid, ImageGrid::of(2, 2, 4));
    let moved = String::from_utf8_lossy(organised)
        .replace("HEIGHT 2", "HEIGHT 1")
        .replace("VIEWPOINT 0 0 0", "VIEWPOINT 1 2 3");
    let moved = read("a.pcd", moved.as_bytes());
    assert_eq!(moved.sensor, Some(glam::DVec3::new(1.0, 2.0, 3.0)));
    assert_eq!(moved.grid, None);
}

#[test]
fn text_is_read_in_the_layouts_of_many_programs() {
    let at = |text: &str| read("a.xyz", text.as_bytes());
    for text in [
        "1 -2 3\n4 5 -6\n",
        "1,-2,3\r\n4,5,-6",
        "# x y z\n1;-2;3\n4;5;-6\n",
        "x,y,z\n1\t-2\t3\n\n4 5 -6\n",
        "2\n1 -2 3\n4 5 -6\n",
    ] {
        assert_eq!(positions(&at(text)), POINTS, "{text:?}");
    }
    assert_eq!(
        at("1 2 3 255 128 0\n1 2 3 0 0 9\n").attributes.colors,
        Some(vec![[255, 128, 0, 255], [0, 0, 9, 255]])
    );
    assert_eq!(
        at("1 2 3 1.0 0.5 0.25\n").attributes.colors,
        Some(vec![[255, 128, 64, 255]])
    );
    assert_eq!(
        at("1 2 3 0.0 0.6 0.8\n4 5 6 -1 0 0\n").attributes.normals,
        Some(vec![[0.0, 0.6, 0.8], [-1.0, 0.0, 0.0]])
    );
    assert_eq!(at("1 2 3 0.7\n").attributes.scalars[0].values, [0.7]);
    let pts = at("1\n1 2 3 -17 255 128 0\n");
    assert_eq!(
        (pts.attributes.scalars[0].values.clone(), pts.attributes.colors),
        (vec![-17.0], Some(vec![[255, 128, 0, 255]]))
    );
    let named = at("red green blue z y x\n255 128 0 3 2 1\n");
    assert_eq!(
        (positions(&named), named.attributes.colors),
        (vec![[1.0, 2.0, 3.0]], Some(vec![[255, 128, 0, 255]]))
    );
    assert_eq!(positions(&at("4320978.612345 0 0\n"))[0][0], 4_320_978.612_345);
}

#[test]
fn clouds_of_no_and_of_one_point_are_read() {
    let xyz = [("float", "x"), ("float", "y"), ("float", "z")];
    for (encoding, file) in plys(&xyz, &[]) {
        assert_eq!(read("a.ply", &file).positions.len(), 0, "{encoding}");
    }
    for (encoding, file) in plys(&xyz, &[vec![1.0, 2.0, 3.0]]) {
        assert_eq!(read("a.ply", &file).positions.len(), 1, "{encoding}");
    }
    for data in ["ascii", "binary", "binary_compressed"] {
        let file = pcd_header("x y z", "4 4 4", "F F F", "1 1 1", 0, data);
        assert_eq!(read("a.pcd", &file).positions.len(), 0, "{data}");
    }
    assert_eq!(read("a.xyz", b"x y z\n").positions.len(), 0);
}

#[test]
fn files_of_every_format_contain_the_same_cube() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let signs = || (0..8).map(|corner| [0, 1, 2].map(|axis| f32::from((corner >> axis & 1) as u8)));
    let corners: Vec<[f64; 3]> = signs()
        .map(|sign| sign.map(|positive| f64::from(positive) - 0.5))
        .collect();
    let colors: Vec<[u8; 4]> = signs()
        .map(|sign| sign.map(|positive| (255.0 * positive) as u8))
        .map(|[red, green, blue]| [red, green, blue, 255])
        .collect();
    let normals: Vec<[f32; 3]> = signs()
        .map(|sign| sign.map(|positive| (2.0 * positive - 1.0) * 0.577_350_26))
        .collect();
    let intensities: Vec<f32> = (0..8u8).map(|corner| 10.0 * f32::from(corner)).collect();

    let mut read = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name == "README.md" || path.is_dir() {
            continue;
        }
        let cloud = io::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(positions(&cloud), corners, "{name}");
        assert_eq!(cloud.attributes.colors.as_ref(), Some(&colors), "{name}");
        let has_normals = name != "cube.pts";
        assert_eq!(
            cloud.attributes.normals.as_ref(),
            has_normals.then_some(&normals),
            "{name}"
        );
        let has_intensities = name != "cube.xyz";
        assert_eq!(
            cloud.attributes.scalars.first().map(|field| &field.values),
            has_intensities.then_some(&intensities),
            "{name}"
        );
        read += 1;
    }
    assert_eq!(read, 9);
}

#[test]
fn cloudcompare_names_and_white_space_in_headers_do_no_harm() {
    let file = "ply\r\nformat ascii 1.0\r\n\r\n  element vertex 1\r\nproperty float x\r\n\
                property float scalar_C2C_distances_(mm)\r\nproperty float y\r\nproperty float z\r\n end_header\r\n\
                1 99 2 3\r\n";
    assert_eq!(positions(&read("a.ply", file.as_bytes())), [[1.0, 2.0, 3.0]]);
}

#[test]
fn dark_channels_are_scaled_like_bright_ones() {
    let properties = [
        ("float", "x"),
        ("float", "y"),
        ("float", "z"),
        ("float", "red"),
        ("float", "green"),
        ("float", "blue"),
    ];
    let rows = [
        vec![1.0, 2.0, 3.0, 1.0, 0.0, 200.0],
        vec![1.0, 2.0, 3.0, 0.0, 1.0, 100.0],
    ];
    let expected = Some(vec![[1, 0, 200, 255], [0, 1, 100, 255]]);
    for (encoding, file) in plys(&properties, &rows) {
        assert_eq!(read("a.ply", &file).attributes.colors, expected, "{encoding}");
    }
    let text = "1 2 3 1 0 200\n1 2 3 0 1 100\n";
    assert_eq!(read("a.xyz", text.as_bytes()).attributes.colors, expected);
}
