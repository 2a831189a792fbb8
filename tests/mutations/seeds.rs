//! What mutations begin with: the project's fixtures, files made of them in other formats, and small files of folders
//! that are named.

use crate::cases::Case;
use crate::kinds::{KINDS, extension_of};
use draco_core::mesh_encoder::MeshEncoder;
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, PointAttribute, PointCloudEncoder, PointIndex,
};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Larger files make slow seeds; what is in them is in small ones too.
const MOST_BYTES: u64 = 64 << 10;

/// Seeds of one kind from one folder that is named.
const MOST_OF_KIND: usize = 40;

/// The files of each format of photographs in `fuzz/seeds/photos`, as in the fuzz target of that name.
const PHOTOS: [&[&str]; 11] = [
    &["cameras.bin", "images.bin", "points3D.bin"],
    &["cameras.txt", "images.txt", "points3D.txt"],
    &["bundle.out", "list.txt"],
    &["a.nvm"],
    &["sfm.json"],
    &["a_par.txt"],
    &["transforms.json"],
    &["a.png.geometric.bin"],
    &["poses_bounds.npy"],
    &["a_cam.txt"],
    &["calib.txt"],
];

/// A picture of 8 × 6 pixels, grey.
const PICTURE: &[u8] = b"P5\n8 6\n255\n................................................";

const SESSION: &str = r#"{"pointreel_session":1,"files":["a.xyz","b.xyz"],"reading":{"no_data":"auto"},"frame":1,
"view":null,"range":{"in":0,"out":1},"markers":[{"frame":1,"name":"turn"}],
"labels":[{"text":"knee","frame":0,"point":1,"of":4,"from":0,"to":1},{"text":"the door","at":[1,2.5,-3]}],
"measurements":[{"gauge":"distance","points":[{"frame":0,"point":0,"of":4,"at":[0,0,0]},
{"frame":0,"point":1,"of":4,"at":[3,4,0]}]}],
"camera_path":{"pointreel_path":1,"ease":true,"up":"y","keyframes":[
{"time_s":0,"frame":0,"target":[0,0,0],"distance":3,"azimuth_deg":0,"elevation_deg":20,"fov_deg":45},
{"time_s":2,"frame":1,"target":[0,1,0],"distance":4,"azimuth_deg":90,"elevation_deg":10,"fov_deg":45}]},
"compare":{"files":["b.xyz"],"offset":1,"line":0.5},
"settings":{"primitive":"voxel","point_size":3,"exposure":1.5}}"#;

const ROWS: &str = "0 0 0 10 20 30\n1 0 0 40 50 60\n0 1 0 70 80 90\n0 0 1 200 210 220\n1 1 1 0 0 0\n";

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Writes `case` into `folder` as `cases::kept_in` reads it.
pub(crate) fn keep(case: &Case, folder: &Path) -> PathBuf {
    let place = folder.join(&case.set).join(&case.name);
    for (name, bytes) in &case.files {
        let path = if case.files.len() == 1 {
            place.clone()
        } else {
            place.join(name)
        };
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    place
}

fn one(set: &str, name: &str, bytes: impl Into<Vec<u8>>) -> Case {
    several(set, name, vec![(name, bytes.into())])
}

fn several(set: &str, name: &str, files: Vec<(&str, Vec<u8>)>) -> Case {
    Case {
        set: set.to_owned(),
        name: name.to_owned(),
        files: files
            .into_iter()
            .map(|(name, bytes)| (name.to_owned(), bytes))
            .collect(),
    }
}

/// Writes all seeds into `folder`; `named` are folders of further ones.
pub(crate) fn gather(folder: &Path, named: &[PathBuf]) {
    for case in own() {
        keep(&case, folder);
    }
    for name in ["tests/data", "src/reel/tests"] {
        gather_files(&project().join(name), folder, usize::MAX);
    }
    gather_converted(folder);
    for named in named {
        gather_files(named, folder, MOST_OF_KIND);
    }
    copy_all(&project().join("fuzz/seeds/mutations"), folder);
}

/// Adds what was found before: what is next to it is likely to be wrong too.
pub(crate) fn gather_corpus(folder: &Path) {
    copy_all(&project().join("tests/data/hostile"), folder);
}

fn copy_all(from: &Path, to: &Path) {
    let Ok(entries) = fs::read_dir(from) else { return };
    for entry in entries {
        let path = entry.unwrap().path();
        let to = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_all(&path, &to);
        } else {
            fs::create_dir_all(to.parent().unwrap()).unwrap();
            fs::copy(&path, &to).unwrap();
        }
    }
}

/// Files below `from` whose extensions are those of kinds.
fn gather_files(from: &Path, folder: &Path, most_of_kind: usize) {
    let mut counts = std::collections::BTreeMap::new();
    let mut folders = vec![from.to_owned()];
    while let Some(next) = folders.pop() {
        let Ok(entries) = fs::read_dir(&next) else { continue };
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let extension = extension_of(&name);
            let kind = KINDS.iter().find(|kind| kind.extension == extension);
            if path.is_dir() {
                // The corpus is no fixture: it has seeds of its own (`gather_corpus`).
                folders.extend((!path.ends_with("hostile")).then_some(path));
            } else if let Some(kind) = kind
                && extension != "json"
                && path.metadata().unwrap().len() <= MOST_BYTES
            {
                let count: &mut usize = counts.entry(kind.extension).or_default();
                *count += 1;
                if *count <= most_of_kind {
                    let name = format!("{count}-{name}");
                    keep(&one(kind.set, &name, fs::read(&path).unwrap()), folder);
                }
            }
        }
    }
}

/// What is written here by hand, or made of fixtures.
fn own() -> Vec<Case> {
    let hex: String = fs::read_to_string(project().join("src/wire/test_vector.txt")).unwrap();
    let hex: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
    let digits = hex.chunks_exact(2).map(|pair| std::str::from_utf8(pair).unwrap());
    let stream: Vec<u8> = digits.map(|digits| u8::from_str_radix(digits, 16).unwrap()).collect();
    let cube = fs::read(project().join("tests/data/cube_little_endian.ply")).unwrap();
    let preferences = serde_json::to_vec(&pointreel::app::Preferences::default()).unwrap();
    let session: serde_json::Value = serde_json::from_str(SESSION).unwrap();
    let path = session["camera_path"].to_string();
    let presets = r#"{"presets":[{"name":"mine","settings":{"primitive":"surfel"}}]}"#;
    let tgz = packed(&tar_of(&cube));
    let mut cases = vec![
        one("streams", "vector.pointreel-stream", stream),
        several(
            "sessions",
            "all",
            vec![
                ("all.pointreel", SESSION.into()),
                ("a.xyz", ROWS.into()),
                ("b.xyz", ROWS.into()),
            ],
        ),
        one("settings", "settings.json", preferences),
        one("settings", "path.json", path),
        one("settings", "presets.json", presets),
        one("settings", "recent.json", r#"{"recent":[["/a/b.ply"],["/c","/d"]]}"#),
        one("archives", "cubes.zip", zip_of(&cube)),
        one("archives", "cubes.tar", tar_of(&cube)),
        one("archives", "cubes.tgz", tgz),
        one("archives", "cube.ply.gz", packed(&cube)),
        one(
            "meshes",
            "cube.obj",
            "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf -1 -2 -3\n",
        ),
        one(
            "meshes",
            "cube.off",
            "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 1 2 3\n",
        ),
        one(
            "arrays",
            "scan.bin",
            [0.5f32, 1.0, 2.0, 0.25].map(f32::to_le_bytes).concat().repeat(30),
        ),
    ];
    cases.extend([true, false].map(|has_faces| one("draco", &format!("{has_faces}.drc"), draco(has_faces))));
    cases.push(one("splats", "few.splat", splats()));
    cases.extend(photos());
    for name in ["known", "unknown"] {
        let bytes = fs::read(project().join("fuzz/seeds/matroska").join(name)).unwrap();
        cases.push(one("depth", &format!("{name}.mkv"), bytes));
    }
    cases.push(depth_folder());
    cases
}

/// A strip of triangles with colours, or its points alone.
fn draco(has_faces: bool) -> Vec<u8> {
    const POINTS: usize = 9;
    let positions = (0..POINTS).flat_map(|point| [point as f32, (point % 2) as f32, 0.5].map(f32::to_le_bytes));
    let positions = positions.flatten().collect::<Vec<u8>>();
    let colors = (0..POINTS)
        .flat_map(|point| [20 * point as u8, 200, 90])
        .collect::<Vec<u8>>();
    let mut mesh = draco_core::Mesh::new();
    mesh.set_num_points(POINTS);
    for (kind, data_type, bytes) in [
        (GeometryAttributeType::Position, DataType::Float32, positions),
        (GeometryAttributeType::Color, DataType::Uint8, colors),
    ] {
        let mut attribute = PointAttribute::new();
        attribute.init(kind, 3, data_type, false, POINTS);
        attribute.buffer_mut().data_mut().copy_from_slice(&bytes);
        mesh.add_attribute(attribute);
    }
    for first in 0..POINTS as u32 - 2 {
        mesh.add_face([first, first + 1, first + 2].map(PointIndex));
    }
    let (options, mut written) = (EncoderOptions::new(), EncoderBuffer::new());
    if has_faces {
        let mut encoder = MeshEncoder::new();
        encoder.set_mesh(mesh);
        encoder.encode(&options, &mut written).unwrap();
    } else {
        let mut encoder = PointCloudEncoder::new();
        encoder.set_point_cloud(mesh.into_point_cloud());
        encoder.encode(&options, &mut written).unwrap();
    }
    written.data().to_vec()
}

/// Places, half axes, colours and turns of 32 bytes each.
fn splats() -> Vec<u8> {
    let splat = |index: u8| {
        let floats = [f32::from(index), 0.5, -1.0, 0.1, 0.2, 0.01]
            .map(f32::to_le_bytes)
            .concat();
        [floats, vec![index, 100, 200, 255, 255, 128, 128, 128]].concat()
    };
    (0..20).flat_map(splat).collect()
}

fn photos() -> Vec<Case> {
    let entries = fs::read_dir(project().join("fuzz/seeds/photos")).unwrap();
    let cases = entries.map(|entry| {
        let path = entry.unwrap().path();
        let bytes = fs::read(&path).unwrap();
        let (choice, bytes) = bytes.split_first().unwrap();
        let names = PHOTOS[usize::from(*choice) % PHOTOS.len()];
        let text = String::from_utf8_lossy(bytes);
        // Bytes that are no text come alone, or parted in the same way.
        let parts: Vec<Vec<u8>> = match std::str::from_utf8(bytes) {
            Ok(_) => text.split("\n%%\n").map(|part| part.as_bytes().to_vec()).collect(),
            Err(_) => parted(bytes),
        };
        let mut files: Vec<(&str, Vec<u8>)> = names.iter().copied().zip(parts).collect();
        files.push(("a.pgm", PICTURE.to_vec()));
        several("photos", path.file_name().unwrap().to_str().unwrap(), files)
    });
    cases.collect()
}

fn parted(mut bytes: &[u8]) -> Vec<Vec<u8>> {
    const PART: &[u8] = b"\n%%\n";
    let mut parts = Vec::new();
    while let Some(place) = bytes.windows(PART.len()).position(|window| window == PART) {
        parts.push(bytes[..place].to_vec());
        bytes = &bytes[place + PART.len()..];
    }
    parts.push(bytes.to_vec());
    parts
}

/// Two depth images with colours, their cameras and poses, as the data sets of TUM have them.
fn depth_folder() -> Case {
    let depth = image::ImageBuffer::from_fn(16, 12, |x, y| image::Luma([(5000 + 50 * x + 20 * y) as u16]));
    let color = image::RgbImage::from_fn(16, 12, |x, y| image::Rgb([(10 * x) as u8, (20 * y) as u8, 90]));
    let (mut of_depth, mut of_color) = (std::io::Cursor::new(Vec::new()), std::io::Cursor::new(Vec::new()));
    depth.write_to(&mut of_depth, image::ImageFormat::Png).unwrap();
    color.write_to(&mut of_color, image::ImageFormat::Png).unwrap();
    let (depth, color) = (of_depth.into_inner(), of_color.into_inner());
    let times = ["1305031102.1", "1305031102.2"];
    let list = |folder: &str| -> Vec<u8> {
        let rows = times.map(|time| format!("{time} {folder}/{time}.png\n"));
        format!("# {folder}\n{}", rows.concat()).into_bytes()
    };
    let poses = times.map(|time| format!("{time} 0 0.1 0 0 0 0 1\n")).concat();
    several(
        "depth",
        "tum",
        vec![
            ("depth.txt", list("depth")),
            ("rgb.txt", list("rgb")),
            ("groundtruth.txt", poses.into_bytes()),
            ("depth/1305031102.1.png", depth.clone()),
            ("depth/1305031102.2.png", depth),
            ("rgb/1305031102.1.png", color.clone()),
            ("rgb/1305031102.2.png", color),
        ],
    )
}

fn zip_of(cube: &[u8]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for name in ["cube_0.ply", "cube_1.ply"] {
        archive
            .start_file(name, zip::write::SimpleFileOptions::default())
            .unwrap();
        archive.write_all(cube).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn tar_of(cube: &[u8]) -> Vec<u8> {
    let mut archive = tar::Builder::new(Vec::new());
    for name in ["cube_0.ply", "cube_1.ply"] {
        let mut header = tar::Header::new_ustar();
        header.set_size(cube.len() as u64);
        header.set_mode(0o644);
        archive.append_data(&mut header, name, cube).unwrap();
    }
    archive.into_inner().unwrap()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packing = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packing.write_all(bytes).unwrap();
    packing.finish().unwrap()
}

/// A small cloud with everything, moved from frame to frame, in the formats that are written.
fn gather_converted(folder: &Path) {
    let scratch = tempfile::tempdir().unwrap();
    let frames = scratch.path().join("frames");
    fs::create_dir_all(&frames).unwrap();
    for frame in 0..3 {
        let rows = (0..300).map(|point| {
            let (turn, height) = (point as f32 * 0.37, point as f32 / 150.0);
            let (x, y) = (turn.cos() + 0.02 * frame as f32, turn.sin());
            format!(
                "{x},{height},{y},{x},0,{y},{},{},90,{}\n",
                point % 256,
                200 - point % 100,
                point % 7
            )
        });
        let text = format!("x,y,z,nx,ny,nz,red,green,blue,intensity\n{}", rows.collect::<String>());
        fs::write(frames.join(format!("f_{frame}.csv")), text).unwrap();
    }
    let convert = |output: &Path, options: &[&str]| {
        let line = ["pointreel", "convert"].into_iter().chain(options.iter().copied());
        let line = line.map(std::ffi::OsString::from);
        let _ = pointreel::cli::run(line.chain([frames.as_os_str().to_owned(), output.as_os_str().to_owned()]));
    };
    let reel = folder.join("reel");
    fs::create_dir_all(&reel).unwrap();
    for (name, options) in [
        ("usual.reel", &[][..]),
        ("merged.reel", &["--merge"]),
        ("lossless.reel", &["--precision", "lossless"]),
        ("fast.reel", &["--coding", "fast"]),
        ("fast_merged.reel", &["--coding", "fast", "--merge"]),
    ] {
        convert(&reel.join(name), options);
    }
    for format in ["ply", "ply-ascii", "pcd", "las", "laz", "npy"] {
        let output = scratch.path().join(format);
        convert(&output, &["--frames", "0..0", "--format", format]);
        gather_files(&output, folder, 1);
    }
}
