//! Files that the limit allows, by their length, and whose numbers take more in memory than in the file.

use super::heads::{las, npy, pcd, ply, tar_header, text_line, zip};
use super::{Case, MIB};

/// Length of a file of text, and its limit: text is slow without optimisation.
const TEXT_BYTES: u64 = 24 * MIB;
const TEXT_LIMIT_BYTES: u64 = 26 * MIB;

/// Length of another file, and its limit.
const BYTES: u64 = 120 * MIB;
const LIMIT_BYTES: u64 = 128 * MIB;

pub(super) fn cases() -> Vec<Case> {
    [text(), rows(), archives(), messages()].into_iter().flatten().collect()
}

fn of_text(name: &'static str, file: &'static str, head: &str, line: &str) -> Case {
    let bytes = [head.as_bytes(), &text_line(line, TEXT_BYTES)].concat();
    Case::whole(name, file, bytes).with_limit(TEXT_LIMIT_BYTES)
}

fn text() -> Vec<Case> {
    let lines = |line: &str| TEXT_BYTES / line.len() as u64;
    let points = lines("0 0 0\n");
    let poses = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    let cells = TEXT_BYTES / 2 / 4000;
    vec![
        of_text("text", "a.xyz", "", "0 0 0\n"),
        of_text("text of many columns", "a.csv", "", "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"),
        of_text("text of empty lines", "a.xyz", "0 0 0\n", "\n"),
        of_text("text of lone numbers", "a.xyz", "0 0 0\n0 0 0\n", "1\n"),
        of_text("text of words", "a.csv", "x,y,z,w\n", "0,0,0,a\n"),
        of_text("text of frames", "a.csv", "frame,x,y,z\n", "0,0,0,0\n1,1,1,1\n"),
        of_text("text of a line", "a.xyz", "0 0 0\n0 0 0\n", "1 "),
        of_text(
            "PLY, text",
            "a.ply",
            &String::from_utf8(ply("ascii", points, "")).unwrap(),
            "0 0 0\n",
        ),
        of_text(
            "PCD, text",
            "a.pcd",
            &String::from_utf8(pcd(points, "ascii")).unwrap(),
            "0 0 0\n",
        ),
        of_text(
            "PTX",
            "a.ptx",
            &format!("1\n{}\n{poses}", lines("0 0 0 0\n") - 1),
            "0 0 0 0\n",
        ),
        of_text("OBJ of vertices", "a.obj", "", "v 0 0 0\n"),
        of_text("OBJ of texture coordinates", "a.obj", "v 0 0 0\n", "vt 0\n"),
        of_text("OBJ of faces", "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\n", "f 1 2 3\n"),
        of_text("OBJ of one polygon", "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf", " 1 2 3"),
        of_text(
            "OBJ of materials",
            "a.obj",
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n",
            "usemtl a\nusemtl b\n",
        ),
        of_text(
            "OFF",
            "a.off",
            &format!("OFF\n{} 0 0\n", lines("0 0 0\n") - 1),
            "0 0 0\n",
        ),
        of_text(
            "OFF of faces",
            "a.off",
            &format!("OFF\n3 {} 0\n0 0 0\n1 0 0\n0 1 0\n", lines("3 0 1 2\n")),
            "3 0 1 2\n",
        ),
        of_text(
            "OFF of one polygon",
            "a.off",
            &format!("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n{}", 3 * lines("0 1 2 ")),
            " 0 1 2",
        ),
        of_text(
            "STL, text",
            "a.stl",
            "solid a\n",
            "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
        ),
        of_text(
            "ESRI grid",
            "a.asc",
            &format!("ncols 4000\nnrows {cells}\nxllcorner 0\nyllcorner 0\ncellsize 1\n"),
            "0 ",
        ),
        of_text(
            "Surfer grid",
            "a.grd",
            &format!("DSAA\n4000 {cells}\n0 1\n0 1\n0 1\n"),
            "0 ",
        ),
        of_text(
            "glTF",
            "a.gltf",
            "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{}",
            ",{}",
        ),
    ]
}

fn of_zeros(name: &'static str, file: &'static str, head: Vec<u8>) -> Case {
    Case::whole(name, file, head).with_length(BYTES).with_limit(LIMIT_BYTES)
}

fn rows() -> Vec<Case> {
    let count = |bytes: u64| (BYTES - 1024) / bytes;
    let bytes_of_shorts = "property uchar a\nproperty uchar b\nproperty uchar c\nproperty uchar d\n";
    let faces = format!("element face {}\nproperty list uchar uchar vertex_indices\n", count(4));
    let stl = [vec![0; 80], (count(50) as u32).to_le_bytes().to_vec()].concat();
    vec![
        // Frames are made from the read data, and take more memory: `convert` writes the read data itself.
        of_zeros("PLY", "a.ply", ply("binary_little_endian", count(12), "")).with_commands(&["convert"]),
        of_zeros(
            "PLY of bytes",
            "a.ply",
            ply("binary_little_endian", count(16), bytes_of_shorts),
        ),
        of_zeros("PLY of faces", "a.ply", ply("binary_little_endian", 3, &faces)),
        of_zeros(
            "PLY of empty lists",
            "a.ply",
            ply("binary_little_endian", count(13), "property list uchar int l\n"),
        ),
        of_zeros("PCD", "a.pcd", pcd(count(12), "binary")).with_commands(&["convert"]),
        of_zeros("LAS", "a.las", las(count(20), false, &[])),
        of_zeros("NPY", "a.npy", npy("'<f4'", &format!("{}, 3", count(12)))),
        of_zeros("NPY of bytes", "a.npy", npy("'|u1'", &format!("{}, 3", count(3)))),
        of_zeros("NPY of wide rows", "a.npy", npy("'|u1'", &format!("{}, 12", count(12)))),
        of_zeros("NPY of frames", "a.npy", npy("'<f4'", &format!("2, {}, 3", count(24)))),
        of_zeros("STL", "a.stl", stl),
        of_zeros("SPLAT", "a.splat", Vec::new()),
        of_zeros("bin of floats", "a.bin", Vec::new()),
    ]
}

fn archives() -> Vec<Case> {
    let piece = vec![0; 1 << 20];
    let array = npy("'|u1'", &format!("{}, 3", 39 * MIB / 3));
    let limited = |case: Case| case.with_limit(64 * MIB);
    let tar = tar_header("a.npy", BYTES - 1024);
    vec![
        limited(Case::whole(
            "NPZ",
            "a.npz",
            zip("points.npy", &[(&array, 1), (&piece, 40)]),
        )),
        limited(Case::whole("ZIP", "a.zip", zip("a.npy", &[(&array, 1), (&piece, 40)]))),
        of_zeros(
            "TAR",
            "a.tar",
            [tar, npy("'|u1'", &format!("{}, 3", BYTES / 3 - 1024))].concat(),
        ),
        limited(Case::whole(
            "TAR, packed",
            "a.tgz",
            super::heads::gzip(&[(&tar_header("a.npy", 40 * MIB), 1), (&array, 1), (&piece, 41)]),
        )),
    ]
}

fn messages() -> Vec<Case> {
    vec![super::bombs::cloud_message("MCAP of bytes", BYTES).with_limit(LIMIT_BYTES)]
}
