//! Meshes written here, with known vertices and faces, in every layout that the readers promise, and damaged ones.

use glam::Vec3;
use pointreel::cloud::RawCloud;
use pointreel::io::{self, ReadOptions};
use std::fmt::Write as _;
use std::num::NonZeroUsize;
use std::path::Path;

fn read(name: &str, bytes: &[u8]) -> RawCloud {
    io::read_bytes(Path::new(name), bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(name: &str, bytes: &[u8]) -> String {
    io::read_bytes(Path::new(name), bytes).unwrap_err().to_string()
}

fn positions(cloud: &RawCloud) -> Vec<[f64; 3]> {
    (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index).to_array())
        .collect()
}

const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 2.0, 0.5], [0.0, 2.0, 0.5]];
const FANNED: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// Files that are answered whatever is cut from or changed in them.
fn survives(name: &str, file: &[u8]) {
    for length in 0..file.len() {
        let _ = io::read_bytes(Path::new(name), &file[..length]);
    }
    for at in 0..file.len() {
        for change in [0x01, 0x80, 0xff] {
            let mut damaged = file.to_vec();
            damaged[at] ^= change;
            let _ = io::read_bytes(Path::new(name), &damaged);
        }
    }
}

/// The square as PLY; `faces` come first where `is_early`.
fn ply(encoding: &str, index: &str, is_early: bool) -> Vec<u8> {
    let vertex = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    let face = format!("element face 2\nproperty uchar flag\nproperty list uchar {index} vertex_index\n");
    let order = if is_early {
        format!("{face}{vertex}")
    } else {
        format!("{vertex}{face}")
    };
    let header = format!(
        "ply\r\nformat {encoding} 1.0\r\nobj_info a\r\ncomment b\r\n{}end_header\r\n",
        order.replace('\n', "\r\n")
    );
    let big = encoding == "binary_big_endian";
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    if encoding == "ascii" {
        for [x, y, z] in SQUARE {
            vertices.extend(format!("{x} {y} {z}\n").bytes());
        }
        faces.extend(b"9 4 0 1 2 3\n9 2 0 1\n");
    } else {
        for axis in SQUARE.iter().flatten() {
            let axis = *axis as f32;
            vertices.extend(if big { axis.to_be_bytes() } else { axis.to_le_bytes() });
        }
        for polygon in [&[0u8, 1, 2, 3][..], &[0, 1]] {
            faces.extend([9, polygon.len() as u8]);
            for &corner in polygon {
                let bytes: Vec<u8> = match index {
                    "char" | "uchar" => vec![corner],
                    "short" | "ushort" => u16::from(corner).to_le_bytes().to_vec(),
                    _ => u32::from(corner).to_le_bytes().to_vec(),
                };
                faces.extend(if big { bytes.into_iter().rev().collect() } else { bytes });
            }
        }
    }
    let payload = if is_early { [faces, vertices] } else { [vertices, faces] };
    [header.into_bytes(), payload.concat()].concat()
}

#[test]
fn ply_faces_of_every_index_type_and_encoding_are_read() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for index in ["char", "uchar", "short", "ushort", "int", "uint", "int32"] {
            for is_early in [false, true] {
                let cloud = read("a.ply", &ply(encoding, index, is_early));
                assert_eq!(positions(&cloud), SQUARE, "{encoding} {index} {is_early}");
                assert_eq!(cloud.faces, FANNED, "{encoding} {index} {is_early}");
            }
        }
        survives("a.ply", &ply(encoding, "int", false));
    }
}

/// The message for a file whose points are complete and whose faces are not.
fn warning_of_square(file: &[u8]) -> String {
    let cloud = read("a.ply", file);
    assert_eq!(positions(&cloud), SQUARE);
    assert!(cloud.faces.is_empty() || cloud.faces == FANNED, "{:?}", cloud.faces);
    let [warning] = cloud.warnings.as_slice() else {
        panic!("{:?}", cloud.warnings)
    };
    assert!(warning.starts_with("a.ply, "), "{warning}");
    assert!(warning.contains("are skipped"), "{warning}");
    warning.clone()
}

#[test]
fn ply_points_are_read_whatever_is_wrong_with_the_faces() {
    let ascii = String::from_utf8(ply("ascii", "int", false)).unwrap();
    for (found, replaced, expected) in [
        ("4 0 1 2 3", "4 0 1 2 4", "face 0: it names vertex 4"),
        ("4 0 1 2 3", "4 0 1 2 -1", "face 0: it names vertex -1"),
        ("2 0 1", "2 0 0.5", "face 1: it names vertex 0.5"),
        ("2 0 1", "2 0 nan", "face 1: it names vertex NaN"),
        ("2 0 1", "-2 0 1", "line 18: a list cannot have -2 items"),
        ("2 0 1", "1.5 0 1", "a list cannot have 1.5 items"),
        ("2 0 1", "2 0", "face 1: the file ends before property"),
        ("2 0 1", "9999999999 0 1", "face 1: the file ends before property"),
        ("2 0 1", "two 0 1", "of face 1 is `two`, expected a number"),
        ("element face 2", "element face 3", "face 2: the file ends"),
        (
            "element face 2",
            "element face 1000000000000",
            "its header claims 1000000000000",
        ),
    ] {
        assert!(ascii.contains(found), "{found}");
        let warning = warning_of_square(ascii.replacen(found, replaced, 1).as_bytes());
        assert!(warning.contains(expected), "{replaced}: {warning}");
    }

    for encoding in ["binary_little_endian", "binary_big_endian"] {
        let file = ply(encoding, "int", false);
        // The last face has ten bytes: flag, length, two vertices.
        for length in file.len() - 10..file.len() {
            let warning = warning_of_square(&file[..length]);
            assert!(warning.contains(", face 1: "), "{length}: {warning}");
        }
        let mut long = file.clone();
        let at = file.len() - 9;
        assert_eq!(long[at], 2);
        long[at] = 200;
        let warning = warning_of_square(&long);
        assert!(warning.contains("face 1: a list of 200 items goes beyond"), "{warning}");
        let header_end = file.len() - 4 * 12 - 18 - 10;
        let header = String::from_utf8(file[..header_end].to_vec()).unwrap();
        let claim = header.replace("element face 2", "element face 4000000000000");
        let claim = [claim.as_bytes(), &file[header_end..]].concat();
        let warning = warning_of_square(&claim);
        assert!(warning.contains("its header claims 4000000000000"), "{warning}");
    }
}

#[test]
fn broken_ply_faces_before_the_points_only_lose_unreachable_points() {
    // An index is wrong: the points are where the header says.
    let mut file = ply("binary_little_endian", "int", true);
    let vertices = file.len() - 4 * 12;
    file[vertices - 4] = 99;
    assert!(warning_of_square(&file).contains("face 1: it names vertex 99"));
    // A length is wrong: the start of the points is unknown.
    let mut file = ply("binary_little_endian", "int", true);
    file[vertices - 9] = 255;
    let message = refused("a.ply", &file);
    assert!(message.contains("face 1: a list of 255 items"), "{message}");
}

#[test]
fn ply_points_are_read_whatever_is_wrong_between_them_and_the_faces() {
    let file = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                element edge 1\nproperty int a\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
                1 2 3\noops\n3 0 0 0\n";
    let cloud = read("a.ply", file.as_bytes());
    assert_eq!(positions(&cloud), [[1.0, 2.0, 3.0]]);
    assert_eq!(cloud.warnings.len(), 1);
    assert!(
        cloud.warnings[0].contains("of edge 0 is `oops`"),
        "{}",
        cloud.warnings[0]
    );
}

#[test]
fn ply_strips_with_an_invalid_vertex_are_skipped() {
    let file = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n7 0 1 2 -1 0 1 3\n";
    let cloud = read("a.ply", file.as_bytes());
    assert_eq!((cloud.positions.len(), cloud.faces.len()), (3, 0));
    assert!(cloud.warnings[0].contains("tristrips 0: it names vertex 3"));
}

#[test]
fn ply_strips_restart_and_keep_their_winding() {
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    let vertices = "0 0 0\n1 0 0\n1 2 0\n0 2 0\n";
    let cloud = read("a.ply", format!("{header}{vertices}9 0 1 3 2 -1 0 1 1 2\n").as_bytes());
    assert_eq!(cloud.faces, [[0, 1, 3], [3, 1, 2]]);
    let cloud = read("a.ply", format!("{header}{vertices}7 0 1 2 -1 2 3 0\n").as_bytes());
    assert_eq!(cloud.faces, [[0, 1, 2], [2, 3, 0]]);
}

#[test]
fn ply_gaussian_splats_are_disks() {
    let names = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 f_rest_0 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    // Half a turn about the axis between y and z takes the flat axis z to y.
    let half = 0.5f32.sqrt();
    let rows = [
        [
            1.0,
            2.0,
            3.0,
            0.0,
            0.0,
            0.0,
            0.0,
            10.0,
            -10.0,
            7.0,
            0.0,
            2f32.ln(),
            8f32.ln(),
            0.1f32.ln(),
            1.0,
            0.0,
            0.0,
            0.0,
        ],
        [
            4.0,
            5.0,
            6.0,
            0.0,
            0.0,
            0.0,
            0.5,
            0.0,
            0.0,
            7.0,
            100.0,
            1.0,
            1.0,
            0.0,
            0.0,
            0.0,
            2.0 * half,
            2.0 * half,
        ],
    ];
    for is_text in [false, true] {
        let encoding = if is_text { "ascii" } else { "binary_little_endian" };
        let mut file = format!("ply\nformat {encoding} 1.0\nelement vertex 2\n").into_bytes();
        for name in names.split(' ') {
            file.extend(format!("property float {name}\n").bytes());
        }
        file.extend(b"end_header\n");
        for value in rows.iter().flatten() {
            if is_text {
                file.extend(format!("{value} ").bytes());
            } else {
                file.extend(value.to_le_bytes());
            }
        }
        let cloud = read("a.ply", &file);
        // 0.5 + 0.2821 / 2 is 0.641 of 255.
        assert_eq!(
            cloud.attributes.colors.unwrap(),
            [[128, 255, 0, 128], [163, 128, 128, 255]]
        );
        let radii = cloud.attributes.radii.unwrap();
        assert!(
            (radii[0] - 4.0).abs() < 1e-5 && (radii[1] - 1f32.exp()).abs() < 1e-5,
            "{radii:?}"
        );
        let ellipses = cloud.attributes.ellipses.unwrap();
        assert_eq!(ellipses[0].axis, Vec3::Y, "the longest of the first");
        let [longer, shorter] = ellipses[0].half_axes(radii[0]);
        assert!(
            (longer - 8.0).abs() < 1e-5 && (shorter - 2.0).abs() < 1e-5,
            "{longer} {shorter}"
        );
        assert_eq!(ellipses[1].ratio, 1.0);
        let normals = cloud.attributes.normals.unwrap();
        assert_eq!(normals[0], [0.0, 0.0, 1.0]);
        assert!((normals[1][1] - 1.0).abs() < 1e-5, "{normals:?}");
    }
}

#[test]
fn voxelised_sequences_are_read_unchanged() {
    let file = "ply\nformat ascii 1.0\ncomment Version 2, Copyright 2017, 8i Labs, Inc.\ncomment frame_to_world_scale \
        0.181985\ncomment frame_to_world_translation -39.1528 3.75652 -46.6228\ncomment width 1023\nelement vertex \
        2\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty \
        uchar blue\nend_header\n171 63 255 132 107 98\n172 1023 0 1 0 1\n";
    let cloud = read("longdress_vox10_1051.ply", file.as_bytes());
    assert_eq!(positions(&cloud), [[171.0, 63.0, 255.0], [172.0, 1023.0, 0.0]]);
    assert_eq!(cloud.attributes.colors.unwrap(), [[132, 107, 98, 255], [1, 0, 1, 255]]);
}

#[test]
fn obj_is_read_in_the_layouts_of_many_programs() {
    let corners = "v 0 0 0.5\nv 1 0 0.5\nv 1 2 0.5 \nv 0 2 0.5\n";
    for faces in [
        "f 1 2 3 4\n",
        "f 1/7/1 2/8/1 3//1 4\n",
        "f -4 -3 -2 -1\n",
        "f 1 2 \\\n 3 4 # c\r\n",
        "f 1 2 3\nl 1 2\nf 1 3 4",
    ] {
        let file = format!("# c\nmtllib missing.mtl\no a\nvn 0 0 2\n{corners}usemtl m\ns off\n{faces}");
        let cloud = read("a.obj", file.as_bytes());
        assert_eq!(positions(&cloud), SQUARE, "{faces}");
        assert_eq!(cloud.faces, FANNED, "{faces}");
        if faces.contains("//") {
            assert_eq!(cloud.attributes.normals.unwrap()[..3], [[0.0, 0.0, 2.0]; 3]);
        }
        survives("a.obj", file.as_bytes());
    }
    let cloud = read("a.obj", b"v 4000000.125 2 3 0 0.5 1\nv 1 2 3 1 1 1\n");
    assert_eq!(positions(&cloud)[0], [4_000_000.125, 2.0, 3.0]);
    assert_eq!(cloud.attributes.colors.unwrap(), [[0, 128, 255, 255], [255; 4]]);
    let cloud = read("a.obj", b"v 1 2 3 4 5 6\nvn 0 1 0\n");
    assert_eq!(
        (cloud.attributes.colors.unwrap()[0], cloud.attributes.normals.unwrap()),
        ([4, 5, 6, 255], vec![[0.0, 1.0, 0.0]])
    );
    let cloud = read("a.obj", b"v 1 2 3\nf 1 1 2\nf 1 1 1\nf 1 1 1\nf 1 1 1\n");
    assert_eq!(cloud.faces.len(), 3);
    assert!(
        cloud.warnings[0].contains("line 2: the face names vertex `2`"),
        "{:?}",
        cloud.warnings
    );
    assert!(refused("a.obj", b"v 1 2\n").contains("line 1: the vertex has 2 numbers"));
    assert!(refused("a.obj", b"vt 1 2\n").contains("missing vertices"));
    assert!(read("a.obj", b"v 1 2 3\nf -2 1 1\n").warnings[0].contains("line 2"));
}

#[test]
fn off_is_read_in_the_layouts_of_many_programs() {
    for (header, tail) in [
        ("OFF\n4 1 0\n", ""),
        ("OFF 4 1 0\n", ""),
        ("# c\n\nOFF # d\n# e\n 4 1 0 # f\n", ""),
        ("4 1 0\n", ""),
        ("COFF\n4 1 4\n", " 255 0 1 255"),
        ("OFF\n4 1 4\n", " 255 0 1"),
        ("NOFF\n4 1 0\n", " 0 0 1"),
        ("CNOFF\n4 1 0\n", " 0 0 1 1.0 0.0 0.00392 1"),
        ("STOFF\n4 1 0\n", " 0.5 0.25"),
    ] {
        let mut file = header.to_owned();
        for [x, y, z] in SQUARE {
            writeln!(file, "{x} {y} {z}{tail}").unwrap();
        }
        file += "4 0 1 2 3 0.9 0.1 0.2\n";
        let cloud = read("a.off", file.as_bytes());
        assert_eq!(positions(&cloud), SQUARE, "{header}");
        assert_eq!(cloud.faces, FANNED, "{header}");
        let is_colored = tail.contains("255") || tail.contains("1.0");
        assert_eq!(
            cloud.attributes.colors,
            is_colored.then_some(vec![[255, 0, 1, 255]; 4]),
            "{header}"
        );
        assert_eq!(
            cloud.attributes.normals,
            header.contains('N').then_some(vec![[0.0, 0.0, 1.0]; 4]),
            "{header}"
        );
        survives("a.off", file.as_bytes());
    }
    let cloud = read("a.off", b"OFF\n1 1 0\n0 0 0\n3 0 0 1\n");
    assert!(cloud.faces.is_empty() && cloud.warnings[0].contains("face 0: it names vertex 1"));
    assert!(refused("a.off", b"OFF\n4000000000 1 0\n0 0 0\n").contains("vertex 1: the file ends here"));
    assert!(refused("a.off", b"OFF BINARY\n").contains("binary OFF"));
}

fn stl(header: &[u8], extra: &[u8]) -> Vec<u8> {
    let mut file = header.to_vec();
    file.resize(80, b' ');
    file.extend(2u32.to_le_bytes());
    for face in FANNED {
        file.extend([0; 12]);
        for axis in face.iter().flat_map(|&corner| SQUARE[corner as usize]) {
            file.extend((axis as f32).to_le_bytes());
        }
        // Red, in the VisCAM encoding.
        file.extend(0xfc00u16.to_le_bytes());
    }
    file.extend(extra);
    file
}

#[test]
fn stl_vertices_are_merged_in_both_encodings() {
    for (header, extra) in [
        (&b"made by"[..], &b""[..]),
        (b"solid but binary", b""),
        (b"made by", b"\n\n"),
    ] {
        let cloud = read("a.stl", &stl(header, extra));
        assert_eq!(positions(&cloud), SQUARE);
        assert_eq!(cloud.faces, FANNED);
        assert_eq!(cloud.attributes.colors.unwrap(), [[255, 0, 0, 255]; 4]);
    }
    let mut text = "solid a vertex\n".to_owned();
    for face in FANNED {
        text += "facet normal 0 0 1\n outer loop\n";
        for corner in face {
            let [x, y, z] = SQUARE[corner as usize];
            writeln!(text, "  vertex {x} {y:e} {z}").unwrap();
        }
        text += " endloop\nendfacet\n";
    }
    text += "endsolid a\n";
    for file in [text.clone(), text.to_uppercase(), text.replace('\n', "\r\n")] {
        let cloud = read("a.stl", file.as_bytes());
        assert_eq!((positions(&cloud), cloud.faces), (SQUARE.to_vec(), FANNED.to_vec()));
    }
    survives("a.stl", text.as_bytes());
    survives("a.stl", &stl(b"made by", b""));
    let binary = stl(b"made by", b"");
    assert!(refused("a.stl", &binary[..binary.len() - 1]).contains("triangle 1: the file ends here, but it counts 2"));
    assert!(refused("a.stl", b"solid\nfacet\nvertex 1 2 x").contains("line 3: found `x`"));
}

#[test]
fn meshes_are_sampled_on_request() {
    let file = ply("ascii", "int", false);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    std::fs::write(&path, file).unwrap();
    let options = ReadOptions::default().with_sample_count(NonZeroUsize::new(1000));
    let cloud = io::read_part(&path, &io::Part::Whole, &options).unwrap();
    assert_eq!((cloud.positions.len(), cloud.faces.len()), (1000, 0));
    assert!(
        positions(&cloud)
            .iter()
            .all(|&[x, y, z]| (0.0..=1.0).contains(&x) && (0.0..=2.0).contains(&y) && z == 0.5)
    );
    let error = io::read_part(&path, &io::Part::Whole, &options.with_max_memory(1000)).unwrap_err();
    assert!(error.to_string().contains("--max-memory"), "{error}");
    // Clouds without faces keep their points.
    std::fs::write(
        &path,
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float \
        z\nend_header\n1 2 3\n",
    )
    .unwrap();
    assert_eq!(
        io::read_part(&path, &io::Part::Whole, &options)
            .unwrap()
            .positions
            .len(),
        1
    );
}

/// A strip of triangles in a row: nine of them; the fifth names a vertex that does not exist.
fn row_of_triangles(head: &str, places: std::ops::Range<usize>) -> String {
    let vertices: Vec<String> = (0..10).map(|index| format!("{index} {} 0\n", index % 2)).collect();
    let corner = |index: usize| if index == 6 { 66 } else { index + 2 };
    let faces: Vec<String> = places
        .map(|index| format!("3 {index} {} {}\n", index + 1, corner(index)))
        .collect();
    format!("{head}{}{}", vertices.concat(), faces.concat())
}

#[test]
fn one_broken_face_does_not_affect_others() {
    const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 10\nproperty float x\nproperty float y\n\
                       property float z\nelement face 7\nproperty list uchar int vertex_indices\nend_header\n";
    for (name, head) in [("a.ply", PLY), ("a.off", "OFF\n10 7 0\n"), ("b.off", "OFF10 7 0\n")] {
        let cloud = read(name, row_of_triangles(head, 0..7).as_bytes());
        assert_eq!((cloud.positions.len(), cloud.faces.len()), (10, 6), "{name}");
        let [warning] = cloud.warnings.as_slice() else {
            panic!("{name}: {:?}", cloud.warnings)
        };
        assert!(
            warning.contains("face 6: it names vertex 66") && warning.contains("1 of 7 faces are skipped"),
            "{warning}"
        );
        // The file ends among the faces.
        let cloud = read(name, row_of_triangles(head, 0..4).as_bytes());
        assert_eq!(cloud.faces.len(), 4, "{name}");
        assert!(
            cloud.warnings[0].contains("face 4: the file ends"),
            "{:?}",
            cloud.warnings
        );
        assert!(
            cloud.warnings[0].contains("from there on are skipped"),
            "{:?}",
            cloud.warnings
        );
    }
}
