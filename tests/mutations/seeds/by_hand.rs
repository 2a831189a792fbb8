//! Seeds that are written here: text by hand, recordings of a few images, and the files of `written.rs`.

use super::project;
use super::written::{draco, e57, packed, splats, spz, tar_of, zip_of};
use crate::cases::Case;
use std::fs;

/// The files of each format of posed images in `fuzz/seeds/photos`, as in the fuzz target of that name.
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

/// An image of 8 × 6 pixels, grey.
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

/// Files written here by hand, or made of fixtures.
pub(super) fn by_hand() -> Vec<Case> {
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
    cases.extend([2, 3].map(|version| one("splats", &format!("version_{version}.spz"), packed(&spz(version)))));
    cases.push(one("e57", "scans.e57", e57()));
    cases.extend(photos());
    for name in ["known", "unknown"] {
        let bytes = fs::read(project().join("fuzz/seeds/matroska").join(name)).unwrap();
        cases.push(one("depth", &format!("{name}.mkv"), bytes));
    }
    cases.push(depth_folder());
    cases
}

fn photos() -> Vec<Case> {
    let entries = fs::read_dir(project().join("fuzz/seeds/photos")).unwrap();
    let cases = entries.map(|entry| {
        let path = entry.unwrap().path();
        let bytes = fs::read(&path).unwrap();
        let (choice, bytes) = bytes.split_first().unwrap();
        let names = PHOTOS[usize::from(*choice) % PHOTOS.len()];
        let text = String::from_utf8_lossy(bytes);
        // Binary data comes alone, or separated likewise.
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

pub(super) fn one(set: &str, name: &str, bytes: impl Into<Vec<u8>>) -> Case {
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
