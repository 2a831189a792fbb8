//! Arrays of numpy written here, of every type, order and layout that the reader promises, and damaged ones.

use crate::data::shared;
use pointreel::cloud::RawCloud;
use pointreel::io;
use pointreel::progress::Progress;
use std::io::Write as _;
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

fn npy(version: u8, descr: &str, fortran: bool, shape: &str, payload: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}    \n");
    let mut file = b"\x93NUMPY".to_vec();
    file.extend([version, 0]);
    if version == 1 {
        file.extend((header.len() as u16).to_le_bytes());
    } else {
        file.extend((header.len() as u32).to_le_bytes());
    }
    file.extend(header.bytes());
    file.extend(payload);
    file
}

fn bytes_of(kind: &str, value: f64) -> Vec<u8> {
    let little = match &kind[1..] {
        "i1" => (value as i8).to_le_bytes().to_vec(),
        "u1" => (value as u8).to_le_bytes().to_vec(),
        "i2" => (value as i16).to_le_bytes().to_vec(),
        "u2" => (value as u16).to_le_bytes().to_vec(),
        "i4" => (value as i32).to_le_bytes().to_vec(),
        "u4" => (value as u32).to_le_bytes().to_vec(),
        "i8" => (value as i64).to_le_bytes().to_vec(),
        "u8" => (value as u64).to_le_bytes().to_vec(),
        "f4" => (value as f32).to_le_bytes().to_vec(),
        "f8" => value.to_le_bytes().to_vec(),
        // 1 to 6 in half precision.
        "f2" => [0x3c00u16, 0x4000, 0x4200, 0x4400, 0x4500, 0x4600][value as usize - 1]
            .to_le_bytes()
            .to_vec(),
        other => panic!("{other}"),
    };
    if kind.starts_with('>') {
        little.into_iter().rev().collect()
    } else {
        little
    }
}

#[test]
fn tables_of_every_type_and_order_are_read() {
    for kind in [
        "|i1", "|u1", "<i2", ">i2", "<u2", ">u2", "<i4", ">i4", "<u4", ">u4", "<i8", ">i8", "<u8", ">u8", "<f2", ">f2",
        "<f4", ">f4", "<f8", ">f8",
    ] {
        for fortran in [false, true] {
            let order: [u8; 6] = if fortran {
                [1, 4, 2, 5, 3, 6]
            } else {
                [1, 2, 3, 4, 5, 6]
            };
            let payload: Vec<u8> = order
                .into_iter()
                .flat_map(|value| bytes_of(kind, f64::from(value)))
                .collect();
            for version in [1, 2, 3] {
                let file = npy(version, &format!("'{kind}'"), fortran, "(2, 3)", &payload);
                assert_eq!(
                    positions(&read("a.npy", &file)),
                    [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
                    "{kind} {fortran}"
                );
            }
        }
    }
}

#[test]
fn columns_are_interpreted_as_in_text() {
    let table = |row: &[f64]| {
        let payload: Vec<u8> = row.iter().flat_map(|&value| bytes_of("<f8", value)).collect();
        read(
            "a.npy",
            &npy(1, "'<f8'", false, &format!("(1, {})", row.len()), &payload),
        )
    };
    assert_eq!(table(&[1.0, 2.0, 3.0, 0.5]).attributes.scalars[0].values, [0.5]);
    assert_eq!(
        table(&[1.0, 2.0, 3.0, 255.0, 0.0, 1.0]).attributes.colors.unwrap(),
        [[255, 0, 1, 255]]
    );
    assert_eq!(
        table(&[1.0, 2.0, 3.0, 0.6, 0.0, -0.8]).attributes.normals.unwrap(),
        [[0.6, 0.0, -0.8]]
    );
    let both = table(&[1.0, 2.0, 3.0, 0.25, 1.0, 0.5, 0.0, 0.0, 1.0]);
    assert_eq!(
        (both.attributes.colors.unwrap(), both.attributes.normals.unwrap()),
        (vec![[64, 255, 128, 255]], vec![[0.0, 0.0, 1.0]])
    );
}

#[test]
fn records_are_read_by_field_name() {
    let mut payload = Vec::new();
    for row in 0u8..2 {
        for axis in 0..3 {
            payload.extend(f32::from(row * 3 + axis).to_le_bytes());
        }
        payload.extend([row, 7, 9]);
        payload.extend(b"name");
        payload.extend((f64::from(row) / 2.0).to_be_bytes());
    }
    let descr = "[('xyz', '<f4', (3,)), ('rgb', '|u1', (3,)), ('name', '|S4'), (('a title', 'intensity'), '>f8')]";
    let cloud = read("a.npy", &npy(1, descr, false, "(2,)", &payload));
    assert_eq!(positions(&cloud), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
    assert_eq!(cloud.attributes.colors.unwrap(), [[0, 7, 9, 255], [1, 7, 9, 255]]);
    assert_eq!(
        (
            cloud.attributes.scalars[0].name.as_str(),
            cloud.attributes.scalars[0].values.as_slice()
        ),
        ("intensity", &[0.0, 0.5][..])
    );
    let flat = "[('z', '<f4'), ('', '|V4'), ('y', '<f4'), ('x', '<i4'), ('red', '|u1'), ('green', '|u1'), ('blue', \
        '|u1')]";
    let row: Vec<u8> = [
        &3f32.to_le_bytes()[..],
        &[0; 4],
        &2f32.to_le_bytes(),
        &1i32.to_le_bytes(),
        &[4, 5, 6],
    ]
    .concat();
    let cloud = read("a.npy", &npy(1, flat, false, "(1,)", &row));
    assert_eq!(
        (positions(&cloud), cloud.attributes.colors.unwrap()),
        (vec![[1.0, 2.0, 3.0]], vec![[4, 5, 6, 255]])
    );
}

fn npz(members: &[(&str, Vec<u8>)], method: zip::CompressionMethod) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in members {
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        archive.start_file(format!("{name}.npy"), options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn floats(shape: &str, values: &[f32]) -> Vec<u8> {
    let payload: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    npy(1, "'<f4'", false, shape, &payload)
}

#[test]
fn archives_join_their_arrays() {
    for method in [zip::CompressionMethod::Stored, zip::CompressionMethod::Deflated] {
        for (points, colors) in [
            ("xyz", "rgb"),
            ("points", "colors"),
            ("positions", "colours"),
            ("vertices", "color"),
            ("coords", "rgb"),
        ] {
            let file = npz(
                &[
                    (colors, npy(1, "'|u1'", false, "(2, 3)", &[1, 2, 3, 4, 5, 6])),
                    ("normals", floats("(2, 3)", &[0.0, 0.0, 1.0, 1.0, 0.0, 0.0])),
                    ("intensity", floats("(2,)", &[0.25, 0.5])),
                    (points, floats("(2, 3)", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
                    ("K", floats("(3, 3)", &[0.0; 9])),
                ],
                method,
            );
            let cloud = read("a.npz", &file);
            assert_eq!(positions(&cloud), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{points}");
            assert_eq!(cloud.attributes.colors.unwrap(), [[1, 2, 3, 255], [4, 5, 6, 255]]);
            assert_eq!(cloud.attributes.normals.unwrap(), [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
            assert_eq!(cloud.attributes.scalars[0].values, [0.25, 0.5]);
        }
        let only = npz(&[("arr_0", floats("(1, 4)", &[1.0, 2.0, 3.0, 4.0]))], method);
        assert_eq!(positions(&read("a.npz", &only)), [[1.0, 2.0, 3.0]]);
        let axes = npz(
            &[
                ("x", floats("(1,)", &[1.0])),
                ("y", floats("(1,)", &[2.0])),
                ("z", floats("(1,)", &[3.0])),
            ],
            method,
        );
        assert_eq!(positions(&read("a.npz", &axes)), [[1.0, 2.0, 3.0]]);
        for length in 0..only.len() {
            let _ = io::read_bytes(Path::new("a.npz"), &only[..length]);
            let mut damaged = only.clone();
            damaged[length] ^= 0x41;
            let _ = io::read_bytes(Path::new("a.npz"), &damaged);
        }
    }
    let short = npz(
        &[
            ("xyz", floats("(1, 3)", &[0.0; 3])),
            ("rgb", floats("(2, 3)", &[0.0; 6])),
        ],
        zip::CompressionMethod::Stored,
    );
    assert!(refused("a.npz", &short).contains("array `rgb` has 2 entries, but there are 1 points"));
    let none = npz(
        &[("a", floats("(1,)", &[0.0])), ("b", floats("(1,)", &[0.0]))],
        zip::CompressionMethod::Stored,
    );
    assert!(refused("a.npz", &none).contains("found `a` ("));
}

/// The numbers 100 t + 10 n + c of `layers` of 3 points, in the order of C or of Fortran.
fn layered(layers: usize, fortran: bool) -> Vec<u8> {
    let number = |t: usize, n: usize, c: usize| (100 * t + 10 * n + c) as f32;
    let mut values = Vec::new();
    if fortran {
        for (c, n) in (0..3).flat_map(|c| (0..3).map(move |n| (c, n))) {
            values.extend((0..layers).map(|t| number(t, n, c)));
        }
    } else {
        for (t, n) in (0..layers).flat_map(|t| (0..3).map(move |n| (t, n))) {
            values.extend((0..3).map(|c| number(t, n, c)));
        }
    }
    let payload: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    npy(1, "'<f4'", fortran, &format!("({layers}, 3, 3)"), &payload)
}

#[test]
fn an_array_with_layers_is_a_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.npz");
    let options = io::ReadOptions::default();
    let expected = |t: usize| -> Vec<[f64; 3]> {
        let point = |n: usize| [0, 1, 2].map(|c| (100 * t + 10 * n + c) as f64);
        (0..3).map(point).collect()
    };
    for fortran in [false, true] {
        let colors: Vec<u8> = (0..18).collect();
        let file = npz(
            &[
                ("points", layered(2, fortran)),
                ("colors", npy(1, "'|u1'", false, "(2, 3, 3)", &colors)),
                (
                    "normals",
                    floats("(3, 3)", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]),
                ),
                ("intensity", floats("(2, 3)", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
                ("betas", floats("(10,)", &[0.0; 10])),
            ],
            zip::CompressionMethod::Deflated,
        );
        std::fs::write(&path, &file).unwrap();
        let entries = io::list(&path, &options).unwrap();
        assert_eq!(entries.len(), 2);
        let shared = io::SharedFile::default();
        for (t, entry) in entries.iter().enumerate() {
            assert_eq!(
                (&entry.name, &entry.part),
                (&format!("frame {}", t + 1), &io::Part::Layer(t))
            );
            let cloud = io::read_part(&path, &entry.part, &options).unwrap();
            assert_eq!(positions(&cloud), expected(t), "{fortran}");
            let first = 9 * t as u8;
            assert_eq!(
                cloud.attributes.colors.as_ref().unwrap()[0],
                [first, first + 1, first + 2, 255]
            );
            // Arrays without a frame axis apply to all frames.
            assert_eq!(cloud.attributes.normals.as_ref().unwrap()[2], [1.0, 0.0, 0.0]);
            let intensity = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]][t];
            assert_eq!(cloud.attributes.scalars[0].values, intensity);
            assert_eq!(cloud.assumptions[0].value, "2 frames of 3 points");
            let same = shared.read_part(&path, &entry.part, &options, &Progress::default());
            assert_eq!(same.unwrap(), cloud);
        }
        assert_eq!(
            positions(&read("walk.npz", &file)),
            expected(0),
            "the first where one is asked for"
        );
        let beyond = io::read_part(&path, &io::Part::Layer(2), &options).unwrap_err();
        assert!(
            beyond.to_string().contains("layer 2 does not exist, only 2"),
            "{beyond}"
        );
    }
}

/// The frames in the file at `path`, as a sequence has them.
fn frames(path: &Path) -> Vec<Vec<[f64; 3]>> {
    let options = io::ReadOptions::default();
    let shared = io::SharedFile::default();
    let entries = io::list(path, &options).unwrap();
    let read = |entry: &io::Entry| {
        let cloud = io::read_part(path, &entry.part, &options).unwrap();
        let same = shared.read_part(path, &entry.part, &options, &Progress::default());
        assert_eq!(same.unwrap().positions, cloud.positions);
        positions(&cloud)
    };
    entries.iter().map(read).collect()
}

#[test]
fn a_bare_array_with_layers_is_a_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.npy");
    for fortran in [false, true] {
        for layers in [2, 5] {
            std::fs::write(&path, layered(layers, fortran)).unwrap();
            let found = frames(&path);
            assert_eq!(found.len(), layers);
            assert_eq!(found[1][2], [120.0, 121.0, 122.0]);
        }
        std::fs::write(&path, layered(1, fortran)).unwrap();
        assert_eq!(frames(&path).len(), 1);
    }
    std::fs::write(&path, floats("(4, 3)", &[1.0; 12])).unwrap();
    assert_eq!(frames(&path).len(), 1);
    if let Some(path) = shared("meaning/N05_T_N_3.npy") {
        let found = frames(&path);
        assert!(found.len() > 1 && found[0] != found[1]);
        assert!(found.iter().all(|frame| frame.len() == found[0].len()));
    }
}

#[test]
fn numbered_arrays_of_an_archive_are_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.npz");
    let frame = |count: usize| floats(&format!("({count}, 3)"), &vec![count as f32; 3 * count]);
    for name in ["arr_", "frame", "t"] {
        let names: Vec<String> = [10, 2, 0, 1].iter().map(|number| format!("{name}{number}")).collect();
        let members: Vec<(&str, Vec<u8>)> = names.iter().map(String::as_str).zip([5, 3, 1, 2].map(frame)).collect();
        std::fs::write(&path, npz(&members, zip::CompressionMethod::Deflated)).unwrap();
        let counts: Vec<usize> = frames(&path).iter().map(Vec::len).collect();
        assert_eq!(counts, [1, 2, 3, 5], "{name}");
    }
    // A table and its colours are not two frames.
    let colors = npy(1, "'|u1'", false, "(2, 3)", &[1; 6]);
    let members = [("arr_0", frame(2)), ("arr_1", colors)];
    std::fs::write(&path, npz(&members, zip::CompressionMethod::Stored)).unwrap();
    assert_eq!(io::list(&path, &io::ReadOptions::default()).unwrap().len(), 1);
}

#[test]
fn an_array_of_images_of_points_is_a_sequence_of_organised_clouds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.npz");
    let options = io::ReadOptions::default();
    // Two images of two lines of four pixels, the third pixel of each line a hole.
    let values: Vec<f32> = (0..48)
        .map(|index| if index / 3 % 4 == 2 { f32::NAN } else { index as f32 })
        .collect();
    let confidence: Vec<f32> = (0..16).map(|pixel| pixel as f32).collect();
    let colors: Vec<u8> = (0..48).collect();
    let write = |frames: usize, values: &[f32], confidence: &[f32], colors: &[u8]| {
        let file = npz(
            &[
                ("intensity", floats(&format!("({frames}, 2, 4)"), confidence)),
                ("world_points", floats(&format!("({frames}, 2, 4, 3)"), values)),
                (
                    "colors",
                    npy(1, "'|u1'", false, &format!("({frames}, 2, 4, 3)"), colors),
                ),
            ],
            zip::CompressionMethod::Deflated,
        );
        std::fs::write(&path, file).unwrap();
        io::list(&path, &options).unwrap()
    };
    let entries = write(2, &values, &confidence, &colors);
    assert_eq!(entries.len(), 2);
    for (frame, entry) in entries.iter().enumerate() {
        let cloud = io::read_part(&path, &entry.part, &options).unwrap();
        let grid = cloud.grid.unwrap();
        assert_eq!((grid.width(), grid.height()), (4, 2));
        let first = 24.0 * frame as f64;
        assert_eq!(positions(&cloud)[5], [first + 15.0, first + 16.0, first + 17.0]);
        assert!(positions(&cloud)[2][0].is_nan() && positions(&cloud)[6][0].is_nan());
        assert_eq!(cloud.attributes.scalars[0].values[7], 8.0 * frame as f32 + 7.0);
        assert_eq!(cloud.attributes.colors.as_ref().unwrap()[1][0], 24 * frame as u8 + 3);
        assert_eq!(cloud.assumptions, []);
    }
    let one = write(1, &values[..24], &confidence[..8], &colors[..24]);
    assert_eq!(one.len(), 1);
    let cloud = io::read_part(&path, &one[0].part, &options).unwrap();
    assert_eq!((positions(&cloud).len(), cloud.grid.is_some()), (8, true));
}

#[test]
fn layers_only_declared_are_not_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let options = io::ReadOptions::default();
    let frames = |shape: &str, bytes: usize| {
        let array = npy(1, "'<f4'", false, shape, &vec![0; bytes]);
        std::fs::write(&path, npz(&[("xyz", array)], zip::CompressionMethod::Stored)).unwrap();
        io::list(&path, &options).unwrap().len()
    };
    assert_eq!(frames("(4, 2, 3)", 96), 4);
    assert_eq!(frames("(1, 8, 3)", 96), 1);
    assert_eq!(
        frames("(900000, 1000, 3)", 96),
        1,
        "more than a file of this size can hold"
    );
    assert_eq!(frames("(4611686018427387904, 4, 3)", 96), 1);
    assert_eq!(frames("(4611686018427387904, 0, 3)", 0), 1, "layers of nothing");
    assert_eq!(frames("(2, 3, 2)", 48), 1);
    let error = io::read_part(&path, &io::Part::Whole, &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("2 × 3 × 2"), "{error}");
    // Whatever is wrong with a file, it is one frame that reports it.
    for damaged in [&b"PK\x03\x04"[..], b"", b"no archive"] {
        std::fs::write(&path, damaged).unwrap();
        assert_eq!(io::list(&path, &options).map_or(1, |entries| entries.len()), 1);
    }
    let whole = npz(&[("xyz", layered(3, false))], zip::CompressionMethod::Deflated);
    for length in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[length] ^= 0x41;
        std::fs::write(&path, &damaged).unwrap();
        for entry in io::list(&path, &options).unwrap_or_default().iter().take(4) {
            let _ = io::read_part(&path, &entry.part, &options);
        }
    }
}

#[test]
fn arrays_that_are_not_tables_are_rejected_with_advice() {
    let message = |shape: &str, values: usize| refused("a.npy", &floats(shape, &vec![0.0; values]));
    assert!(
        message("(2, 2, 3)", 12).contains("2 × 2 × 3") && message("(2, 2, 3)", 12).contains("save each of its frames")
    );
    assert!(message("(3, 100)", 300).contains("transposed"));
    assert!(message("(6,)", 6).contains("expected two dimensions"));
    assert!(message("(2, 2)", 4).contains("3 to 64 numbers"));
    assert!(message("(2, 3)", 5).contains("truncated"));
    assert!(message("(4611686018427387904, 4)", 5).contains("truncated"));
    let objects = refused("a.npy", &npy(1, "'|O'", false, "(1, 3)", &[0; 64]));
    assert!(
        objects.contains("pickled Python objects") && objects.contains("save the arrays with numpy.savez"),
        "{objects}"
    );
    let complex = refused("a.npy", &npy(1, "'<c8'", false, "(1, 3)", &[0; 64]));
    assert!(complex.contains("non-numeric"), "{complex}");
    for descr in [
        "[('x', '<f4', (2, 99999999999999999999))]",
        "((((",
        "[(",
        "'<f'",
        "'\u{e9}4'",
    ] {
        let file = npy(1, descr, false, "(1, 3)", &[0; 64]);
        assert!(
            refused("a.npy", &file).contains("the header is not understood"),
            "{descr}"
        );
    }
    let deep = npy(2, &"(".repeat(1 << 20), false, "(1, 3)", &[]);
    assert!(refused("a.npy", &deep).contains("the header is not understood"));
    let file = floats("(2, 3)", &[1.0; 6]);
    for length in 0..file.len() {
        assert!(io::read_bytes(Path::new("a.npy"), &file[..length]).is_err());
        for change in [0x01, 0x10, 0x80] {
            let mut damaged = file.clone();
            damaged[length] ^= change;
            let _ = io::read_bytes(Path::new("a.npy"), &damaged);
        }
    }
}
