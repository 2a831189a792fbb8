//! Packed Gaussian splats, written here by their published descriptions: positions, colours and ellipses are known.

use glam::Vec3;
use pointreel::cloud::{AxisConvention, RawCloud};
use pointreel::io::{self, Part, ReadOptions};
use std::io::Write as _;
use std::path::Path;

/// The half of a root of 2.
const HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;

fn read(name: &str, bytes: &[u8]) -> RawCloud {
    io::read_bytes(Path::new(name), bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(name: &str, bytes: &[u8]) -> String {
    io::read_bytes(Path::new(name), bytes).unwrap_err().to_string()
}

fn places(cloud: &RawCloud) -> Vec<Vec3> {
    let places = (0..cloud.positions.len()).map(|index| cloud.positions.get(index).as_vec3());
    places.collect()
}

fn near(found: Vec3, expected: Vec3, within: f32) {
    assert!((found - expected).length() < within, "{found} for {expected}");
}

/// Directions may have either sign.
fn along(found: Vec3, expected: Vec3) {
    assert!(found.dot(expected).abs() > 0.999, "{found} for {expected}");
}

/// The splat `index` is an ellipse of these half axes along these directions.
fn is_ellipse(cloud: &RawCloud, index: usize, (longer, shorter): (f32, f32), (axis, normal): (Vec3, Vec3)) {
    let ellipse = cloud.attributes.ellipses.as_ref().unwrap()[index];
    let radius = cloud.attributes.radii.as_ref().unwrap()[index];
    let [found_longer, found_shorter] = ellipse.half_axes(radius);
    let off = |found: f32, expected: f32| (found / expected - 1.0).abs() > 0.01;
    assert!(
        !off(found_longer, longer) && !off(found_shorter, shorter),
        "{found_longer} {found_shorter}"
    );
    along(ellipse.axis, axis);
    along(
        Vec3::from_array(cloud.attributes.normals.as_ref().unwrap()[index]),
        normal,
    );
}

/// No truncation and no damage of a file does anything but fail, or give other points.
fn survives_damage(name: &str, file: &[u8]) {
    for length in 0..file.len() {
        let _ = io::read_bytes(Path::new(name), &file[..length]);
        let mut damaged = file.to_vec();
        for change in [0x01, 0x80, 0xff] {
            damaged[length] ^= change;
            let _ = io::read_bytes(Path::new(name), &damaged);
        }
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap()
}

/// Two splats: one of half axes e, 1 and e⁻² along x, y and z, and the same half a turn about the axis between y and z,
/// which takes x to −x, y to z and z to y.
fn spz(version: u32, count: u32) -> Vec<u8> {
    let mut file = spz_header(version, count);
    file.extend(spz_arrays(version).concat());
    file
}

fn spz_header(version: u32, count: u32) -> Vec<u8> {
    let mut file = b"NGSP".to_vec();
    file.extend(version.to_le_bytes());
    file.extend(count.to_le_bytes());
    // No spherical harmonics except the constant one; coordinates in 4096ths.
    file.extend([0, 12, 0, 0]);
    file
}

/// Positions, opacities, colours, sizes, rotations.
fn spz_arrays(version: u32) -> [Vec<u8>; 5] {
    let coordinates = [1.0f32, -2.5, 0.25, -100.0, 0.0, 7.5];
    let positions = if version == 1 {
        coordinates.map(half).concat()
    } else {
        let fixed = coordinates.map(|coordinate| (coordinate * 4096.0) as i32);
        let bytes = fixed.iter().flat_map(|fixed| fixed.to_le_bytes()[..3].to_vec());
        bytes.collect()
    };
    let sizes = [1.0f32, 0.0, -2.0].map(|log| ((log + 10.0) * 16.0) as u8);
    let rotations = if version < 3 {
        let part = |value: f32| (value * 127.5 + 127.5).round() as u8;
        vec![128, 128, 128, part(0.0), part(HALF), part(HALF)]
    } else {
        // The real part, the last, is the largest; then y, with the others x, z and w.
        [3u32 << 30, (1u32 << 30) | (511 << 10)].map(u32::to_le_bytes).concat()
    };
    [
        positions,
        vec![255, 64],
        vec![128, 255, 0, 153, 128, 128],
        [sizes, sizes].concat(),
        rotations,
    ]
}

/// The same two splats as version 4 stores them, with harmonics and an unknown record of a vendor.
fn spz_of_streams() -> Vec<u8> {
    let harmonics = vec![128; 2 * 9];
    let streams = [&spz_arrays(4)[..], &[harmonics]].concat();
    let vendor = [&0xadbe_0002u32.to_le_bytes()[..], &4u32.to_le_bytes(), &[1, 2, 3, 4]].concat();
    let mut file = spz_header(4, 2);
    // First-degree harmonics, and the flag for extensions; then the number of streams.
    (file[12], file[14], file[15]) = (1, 2, 6);
    file.extend((32 + vendor.len() as u32).to_le_bytes());
    file.extend([0; 12]);
    file.extend(&vendor);
    let packed: Vec<Vec<u8>> = streams
        .iter()
        .map(|stream| zstd::encode_all(&stream[..], 3).unwrap())
        .collect();
    for (stream, packed) in streams.iter().zip(&packed) {
        file.extend((packed.len() as u64).to_le_bytes());
        file.extend((stream.len() as u64).to_le_bytes());
    }
    file.extend(packed.concat());
    file
}

#[test]
fn spz_of_every_version_is_read() {
    for version in 1..=4 {
        let file = match version {
            4 => spz_of_streams(),
            _ => gzip(&spz(version, 2)),
        };
        let cloud = read("scene.spz", &file);
        let places = places(&cloud);
        near(places[0], Vec3::new(1.0, -2.5, 0.25), 1e-6);
        near(places[1], Vec3::new(-100.0, 0.0, 7.5), 1e-6);
        // 153 is 0.6: a tenth above the centre over 0.15, times the constant term of 0.2821.
        assert_eq!(
            cloud.attributes.colors.as_ref().unwrap(),
            &[[128, 255, 0, 255], [175, 128, 128, 64]]
        );
        let e = std::f32::consts::E;
        is_ellipse(&cloud, 0, (e, 1.0), (Vec3::X, Vec3::Z));
        is_ellipse(&cloud, 1, (e, 1.0), (Vec3::X, Vec3::Y));
        assert_eq!(cloud.convention, Some(AxisConvention::YUp));
        survives_damage("scene.spz", &spz(version, 2));
        survives_damage("scene.spz", &file);
    }
    // Signs of components: a quarter turn about −z takes x to −y.
    let mut file = spz(3, 2);
    let at = file.len() - 4;
    let word = (3u32 << 30) | (1 << 9) | 511;
    file[at..].copy_from_slice(&word.to_le_bytes());
    let cloud = read("scene.spz", &gzip(&file));
    is_ellipse(&cloud, 1, (std::f32::consts::E, 1.0), (Vec3::Y, Vec3::Z));
}

#[test]
fn spz_declaring_too_much_is_rejected() {
    assert!(refused("a.spz", &gzip(&spz(3, 3))).contains("of 3 splats are claimed"));
    assert!(refused("a.spz", &gzip(&spz(3, u32::MAX))).contains("claimed"));
    assert!(refused("a.spz", &gzip(&spz(4, 2))).contains("packed as a whole and says that it is of version 4"));
    assert!(refused("a.spz", &gzip(&spz(0, 2))).contains("expected 1 to 3"));
    assert!(refused("a.spz", &gzip(b"NGSP")).contains("truncated"));
    assert!(refused("a.spz", &gzip(&[0; 64])).contains("NGSP"));
    let bomb = gzip(&vec![0; 1 << 20]);
    let mut options = ReadOptions::default();
    options.max_memory_bytes = 1 << 16;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.spz");
    std::fs::write(&path, bomb).unwrap();
    let error = io::read_part(&path, &Part::Whole, &options).unwrap_err().to_string();
    assert!(error.contains("--max-memory"), "{error}");
}

#[test]
fn spz_streams_with_an_invalid_table_are_rejected() {
    let file = spz_of_streams();
    let table = 32 + 12;
    let with = |at: usize, bytes: &[u8]| {
        let mut wrong = file.clone();
        wrong[at..at + bytes.len()].copy_from_slice(bytes);
        refused("a.spz", &wrong)
    };
    assert!(with(4, &[5]).contains("version 5 is not read, expected 1 to 4"));
    // More splats than there are bytes for, and more than fit into memory.
    assert!(with(8, &[3]).contains("the positions of 3 splats are 18 bytes, expected 27"));
    assert!(
        with(8, &[255; 4]).contains("splats are 18 bytes, expected") || with(8, &[255; 4]).contains("--max-memory")
    );
    assert!(with(15, &[4]).contains("4 streams"));
    assert!(with(16, &[31]).contains("from byte 31 on"));
    assert!(with(16, &[255; 4]).contains("truncated"));
    assert!(with(table, &[255; 8]).contains("within the positions"));
    let one_less = (file[table] - 1).to_le_bytes();
    let said = with(table, &one_less);
    assert!(
        said.contains("the positions: ") || said.contains("the opacities: "),
        "{said}"
    );
    assert!(refused("a.spz", &file[..31]).contains("truncated"));
    // An empty file has no streams.
    let mut empty = file[..32].to_vec();
    (empty[8], empty[15]) = (0, 0);
    assert_eq!(read("a.spz", &empty).positions.len(), 0);
}

#[test]
fn trained_splats_have_y_down_unless_stated_otherwise() {
    let cloud = read("a.splat", &[0; 32]);
    assert_eq!(cloud.convention, Some(AxisConvention::UsuallyYDown));
}

#[test]
fn bare_splat_records_are_read() {
    let mut file = Vec::new();
    let mut record = |place: [f32; 3], sizes: [f32; 3], color: [u8; 4], rotation: [f32; 4]| {
        for number in place.into_iter().chain(sizes) {
            file.extend(number.to_le_bytes());
        }
        file.extend(color);
        file.extend(rotation.map(|part| (part * 128.0 + 128.0).clamp(0.0, 255.0) as u8));
    };
    record([1.0, 2.0, 3.0], [0.5, 2.0, 0.1], [1, 2, 3, 200], [1.0, 0.0, 0.0, 0.0]);
    // Half a turn about the axis between y and z.
    record([4.0, 5.0, 6.0], [3.0, 0.1, 1.0], [9, 8, 7, 255], [0.0, 0.0, HALF, HALF]);
    let cloud = read("bonsai.splat", &file);
    assert_eq!(places(&cloud), [Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)]);
    assert_eq!(
        cloud.attributes.colors.as_ref().unwrap(),
        &[[1, 2, 3, 200], [9, 8, 7, 255]]
    );
    is_ellipse(&cloud, 0, (2.0, 0.5), (Vec3::Y, Vec3::Z));
    is_ellipse(&cloud, 1, (3.0, 1.0), (Vec3::X, Vec3::Z));
    assert!(refused("a.splat", &file[..63]).contains("multiple of 32 bytes"));
    survives_damage("a.splat", &file);
}

/// Packed splats; the last one is the first of another chunk.
fn packed(count: usize, has_colors: bool, word: impl Fn(usize) -> [u32; 4]) -> Vec<u8> {
    let mut names: Vec<String> = Vec::new();
    for (kind, axes) in [("", "xyz"), ("scale_", "xyz"), ("", "rgb")] {
        for end in ["min", "max"] {
            names.extend(axes.chars().map(|axis| format!("{end}_{kind}{axis}")));
        }
    }
    names.truncate(if has_colors { 18 } else { 12 });
    let chunks = count.div_ceil(256);
    let mut file = format!("ply\nformat binary_little_endian 1.0\nelement chunk {chunks}\n").into_bytes();
    for name in &names {
        file.extend(format!("property float {name}\n").bytes());
    }
    file.extend(format!("element vertex {count}\n").bytes());
    for name in ["position", "rotation", "scale", "color"] {
        file.extend(format!("property uint packed_{name}\n").bytes());
    }
    file.extend(b"end_header\n");
    for chunk in 0..chunks {
        let from = 10.0 * chunk as f32;
        let places = [from, -1.0, 0.0, from + 4.0, 1.0, 8.0];
        let scales = [-2.0, -2.0, -2.0, 1.0, 1.0, 1.0];
        let colors = [0.0, 0.0, 0.5, 0.5, 1.0, 0.5];
        let ends = [places, scales, colors].concat();
        for number in &ends[..names.len()] {
            file.extend(number.to_le_bytes());
        }
    }
    for word in (0..count).flat_map(word) {
        file.extend(word.to_le_bytes());
    }
    file
}

#[test]
fn splats_of_compressed_ply_are_read() {
    let identity = (512 << 20) | (512 << 10) | 512;
    let first = [
        // x at its end, y at the centre, z at its start.
        (2047 << 21) | (512 << 11),
        identity,
        // e, e⁻² and 1.
        (2047 << 21) | 0x555,
        0xff80_4020,
    ];
    // The real part is 0; the largest of the others is the second of x, y and z.
    let turned = (2u32 << 30) | (512 << 20) | (512 << 10) | 1023;
    let last = [0, turned, (2047 << 21) | 0x555, 0x00ff_0001];
    for has_colors in [false, true] {
        let file = packed(257, has_colors, |splat| if splat == 256 { last } else { first });
        let cloud = read("a.compressed.ply", &file);
        assert_eq!(cloud.positions.len(), 257);
        let places = places(&cloud);
        near(places[0], Vec3::new(4.0, 0.001, 0.0), 1e-3);
        near(places[256], Vec3::new(10.0, -1.0, 0.0), 1e-6);
        let colors = cloud.attributes.colors.as_ref().unwrap();
        if has_colors {
            assert_eq!((colors[0], colors[256]), ([128, 128, 128, 32], [0, 255, 128, 1]));
        } else {
            assert_eq!((colors[0], colors[256]), ([255, 128, 64, 32], [0, 255, 0, 1]));
        }
        let e = std::f32::consts::E;
        is_ellipse(&cloud, 0, (e, 1.0), (Vec3::X, Vec3::Y));
        // Half a turn about the axis between y and z takes y to z.
        is_ellipse(&cloud, 256, (e, 1.0), (Vec3::X, Vec3::Z));
    }
    let file = packed(2, true, |_| first);
    let wrong = String::from_utf8_lossy(&file[..400]).replace("element chunk 1", "element chunk 0");
    assert!(refused("a.ply", &[wrong.as_bytes(), &file[400..]].concat()).contains("chunks"));
    assert!(refused("a.ply", &file[..file.len() - 1]).contains("truncated"));
    survives_damage("a.ply", &file);
}

/// Single precision to half, for numbers that have few digits.
fn half(value: f32) -> [u8; 2] {
    let bits = value.to_bits();
    let (sign, exponent, fraction) = (bits >> 31, (bits >> 23 & 255) as i32 - 127, bits >> 13 & 0x3ff);
    let half = if value == 0.0 {
        sign << 15
    } else {
        sign << 15 | ((exponent + 15) as u32) << 10 | fraction
    };
    (half as u16).to_le_bytes()
}

fn array(shape: &str, values: &[f32]) -> Vec<u8> {
    let header = format!("{{'descr': '<f2', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut file = b"\x93NUMPY\x01\0".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.bytes());
    file.extend(values.iter().flat_map(|&value| half(value)));
    file
}

fn archive(members: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in members {
        archive
            .start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default())
            .unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn half_precision_numpy_splats_are_read() {
    let means = [1.0, -2.5, 0.25, 4.0, 5.0, 6.0];
    let quats = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 2.0];
    let logs = [1.0, 0.0, -2.0, 1.0, 0.0, -2.0];
    let e = std::f32::consts::E;
    for (points, rotations) in [
        ("means3D", "unnorm_rotations"),
        ("points", "quats"),
        ("means", "rotations"),
    ] {
        let file = archive(&[
            (points, array("(2, 3)", &means)),
            (rotations, array("(2, 4)", &quats)),
            ("scales", array("(2, 3)", &logs)),
            ("rgb_colors", array("(2, 3)", &[1.0, 0.5, 0.0, 0.0, 1.0, 1.0])),
            ("opacities", array("(2, 1)", &[1.0, 0.5])),
        ]);
        let cloud = read("params.npz", &file);
        assert_eq!(
            places(&cloud),
            [Vec3::new(1.0, -2.5, 0.25), Vec3::new(4.0, 5.0, 6.0)],
            "{points}"
        );
        assert_eq!(
            cloud.attributes.colors.as_ref().unwrap(),
            &[[255, 128, 0, 255], [0, 255, 255, 128]]
        );
        is_ellipse(&cloud, 0, (e, 1.0), (Vec3::X, Vec3::Z));
        is_ellipse(&cloud, 1, (e, 1.0), (Vec3::X, Vec3::Y));
    }
    // Lengths instead of logarithms, harmonics with a layer of one, logits.
    let file = archive(&[
        ("means3d", array("(1, 2, 3)", &means)),
        ("quats", array("(2, 4)", &quats)),
        ("scales", array("(2, 3)", &[4.0, 2.0, 0.5, 4.0, 2.0, 0.5])),
        ("sh0", array("(2, 1, 3)", &[0.0, 2.0, -2.0, 0.0, 0.0, 0.0])),
        ("logit_opacities", array("(2,)", &[0.0, 20.0])),
    ]);
    let cloud = read("params.npz", &file);
    is_ellipse(&cloud, 0, (4.0, 2.0), (Vec3::X, Vec3::Z));
    assert_eq!(
        cloud.attributes.colors.as_ref().unwrap(),
        &[[128, 255, 0, 128], [128, 128, 128, 255]]
    );
    // Balls have no orientation.
    let file = archive(&[
        ("means3d", array("(2, 3)", &means)),
        ("log_scales", array("(2, 1)", &[0.0, 1.0])),
        ("unnorm_rotations", array("(2, 4)", &quats)),
    ]);
    let cloud = read("params.npz", &file);
    assert!((cloud.attributes.radii.as_ref().unwrap()[1] - e).abs() < 1e-6);
    assert!(cloud.attributes.ellipses.is_none() && cloud.attributes.normals.is_none());
}

#[test]
fn unsupported_data_is_reported_without_a_command() {
    let error = refused("a.jpg", b"\xff\xd8");
    assert!(
        error.contains("a.jpg is an image: a single image has no depth") && !error.contains("--help"),
        "{error}"
    );
    let error = refused("a.unknown", b"\x01\x02");
    assert!(!error.contains("--help"), "a window has no command line: {error}");
    for name in ["PLY", "SPZ", "SPLAT", "NPZ"] {
        assert!(error.contains(name), "{error}");
    }
}
