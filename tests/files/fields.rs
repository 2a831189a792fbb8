//! Fields of every format under their own names, splats of several programs, and headers that other programs write.

use crate::data::shared;
use pointreel::cloud::{RawCloud, ScalarField};
use pointreel::io;
use std::path::Path;

fn read(name: &str, bytes: &[u8]) -> RawCloud {
    io::read_bytes(Path::new(name), bytes).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A file of the set `meaning`, or none where that is not there.
fn meaning(name: &str) -> Option<RawCloud> {
    let path = shared(&format!("meaning/{name}"))?;
    Some(io::read(&path).unwrap_or_else(|error| panic!("{error}")))
}

fn field<'a>(cloud: &'a RawCloud, name: &str) -> &'a ScalarField {
    let mut fields = cloud.attributes.scalars.iter();
    let names: Vec<&str> = cloud
        .attributes
        .scalars
        .iter()
        .map(|field| field.name.as_str())
        .collect();
    fields
        .find(|field| field.name == name)
        .unwrap_or_else(|| panic!("no {name} in {names:?}"))
}

fn names(cloud: &RawCloud) -> Vec<&str> {
    cloud
        .attributes
        .scalars
        .iter()
        .map(|field| field.name.as_str())
        .collect()
}

/// Names that no list knows.
const NAMES: [&str; 7] = [
    "velocity",
    "doppler",
    "deviation",
    "density",
    "segment",
    "instance",
    "error",
];

fn ply(properties: &[&str], rows: &[&str]) -> Vec<u8> {
    let properties = properties
        .iter()
        .map(|line| format!("property {line}\n"))
        .collect::<Vec<_>>()
        .concat();
    let rows = rows.join("\n");
    let count = if rows.is_empty() { 0 } else { rows.lines().count() };
    format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{rows}\n").into_bytes()
}

#[test]
fn every_property_of_a_ply_is_a_scalar() {
    for name in NAMES.into_iter().chain(["C2C absolute distances", "h\u{f6}he (m)"]) {
        let own = format!("float {name}");
        let file = ply(
            &["float x", "float y", "float z", &own, "uchar extra"],
            &["1 2 3 -4.5 7", "4 5 6 2.5 8"],
        );
        let cloud = read("a.ply", &file);
        assert_eq!(names(&cloud), [name, "extra"]);
        assert_eq!(field(&cloud, name).values, [-4.5, 2.5]);
        assert_eq!(field(&cloud, "extra").values, [7.0, 8.0]);
    }
    // Known names come first, and nothing is lost even with dozens of fields.
    let many: Vec<String> = (0..80).map(|number| format!("float own_{number}")).collect();
    let many = many.iter().map(String::as_str);
    let properties: Vec<&str> = ["float x", "float y", "float z"]
        .into_iter()
        .chain(many)
        .chain(["float intensity"])
        .collect();
    let row: Vec<String> = (0..84).map(|number| number.to_string()).collect();
    let cloud = read("a.ply", &ply(&properties, &[&row.join(" ")]));
    assert_eq!(cloud.attributes.scalars.len(), 81);
    assert_eq!(names(&cloud)[..2], ["intensity", "own_0"]);
    assert_eq!(field(&cloud, "own_79").values, [82.0]);
}

#[test]
fn fields_of_the_shared_files_are_read() {
    if let (Some(ply), Some(npy)) = (meaning("SC_ply_velocity.ply"), meaning("SC_npy_struct.npy")) {
        assert_eq!(names(&ply), ["velocity"]);
        assert_eq!(field(&ply, "velocity").values.len(), 19_998);
        assert_eq!(field(&ply, "velocity").values, field(&npy, "velocity").values);
    }
    if let Some(cloud) = meaning("M12b_generic.drc") {
        assert_eq!(cloud.attributes.scalars.len(), 1);
        assert_eq!(cloud.attributes.scalars[0].values.len(), cloud.positions.len());
    }
    if let Some(cloud) = meaning("D15_nuscenes_radar.pcd") {
        assert_eq!(cloud.positions.len(), 125);
        for name in ["rcs", "vx", "vy", "vx_comp", "vy_comp", "dyn_prop", "id", "vy_rms"] {
            assert_eq!(field(&cloud, name).values.len(), 125);
        }
        assert_eq!(cloud.attributes.scalars.len(), 15);
    }
}

#[test]
fn pcd_headers_of_other_programs_are_read() {
    if let Some(cloud) = meaning("D01_count_zero.pcd") {
        assert_eq!(cloud.positions.len(), 6000);
        for name in ["intensity", "t", "reflectivity", "ring", "noise", "range"] {
            assert_eq!(field(&cloud, name).values.len(), 6000);
        }
    }
    if let Some(path) = shared("meaning/D05_size_shorter_than_fields.pcd") {
        let error = io::read(&path).unwrap_err().to_string();
        assert!(error.contains("line 4") && error.contains("SIZE"), "{error}");
    }
    let file =
        |fields: &str, rest: &str| format!("VERSION .7\n{fields}\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n{rest}").into_bytes();
    // A field with several values, in text.
    let several = "FIELDS x y z hist\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 3";
    let cloud = read("a.pcd", &file(several, "DATA ascii\n1 2 3 4 5 6\n7 8 9 10 11 12\n"));
    assert_eq!(names(&cloud), ["hist_0", "hist_1", "hist_2"]);
    assert_eq!(field(&cloud, "hist_2").values, [6.0, 12.0]);
    // Fields with zero values take no bytes, unless the file has one value for each.
    let none = "FIELDS x y z a b\nSIZE 1 1 1 1 1\nTYPE U U U U U\nCOUNT 1 1 1 0 1";
    let cloud = read(
        "a.pcd",
        &file(none, "DATA binary\n\u{1}\u{2}\u{3}\u{4}\u{5}\u{6}\u{7}\u{8}"),
    );
    assert_eq!(names(&cloud), ["b"]);
    assert_eq!(field(&cloud, "b").values, [4.0, 8.0]);
    let cloud = read("a.pcd", &file(none, "DATA ascii\n1 2 3 4 5\n6 7 8 9 10\n"));
    assert_eq!(field(&cloud, "a").values, [4.0, 9.0]);
    // Unknown header lines are skipped with a warning.
    let own = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nUNITS m";
    let cloud = read("a.pcd", &file(own, "DATA ascii\n1 2 3\n4 5 6\n"));
    assert!(
        cloud.warnings[0].contains("line 5") && cloud.warnings[0].contains("UNITS"),
        "{:?}",
        cloud.warnings
    );
}

#[test]
fn a_duplicate_property_is_reported() {
    if let Some(cloud) = meaning("P20_same_property_twice.ply") {
        assert_eq!(cloud.positions.len(), 500);
        assert_eq!(names(&cloud), ["quality", "quality_2"]);
        assert!(cloud.warnings[0].contains("`quality`"), "{:?}", cloud.warnings);
    }
    for (twice, retained) in [("x", 1.0), ("y", 2.0), ("z", 3.0)] {
        let own = format!("float {twice}");
        let cloud = read("a.ply", &ply(&["float x", "float y", "float z", &own], &["1 2 3 9"]));
        assert_eq!(cloud.positions.get(0).to_array(), [1.0, 2.0, 3.0], "{retained}");
        assert_eq!(field(&cloud, &format!("{twice}_2")).values, [9.0]);
        assert!(
            cloud.warnings[0].contains(&format!("`{twice}`")),
            "{:?}",
            cloud.warnings
        );
    }
}

/// Properties of splats without colours.
const SPLAT: [&str; 11] = [
    "float x",
    "float y",
    "float z",
    "float opacity",
    "float scale_0",
    "float scale_1",
    "float scale_2",
    "float rot_0",
    "float rot_1",
    "float rot_2",
    "float rot_3",
];

fn splats(more: &[&str], rows: &[&str]) -> RawCloud {
    let properties: Vec<&str> = SPLAT.iter().chain(more).copied().collect();
    read("a.ply", &ply(&properties, rows))
}

#[test]
fn splats_of_several_programs_are_read() {
    // 8-bit colours; other types stay fields.
    let rgb = ["uchar red", "uchar green", "uchar blue", "float uncertainty"];
    let cloud = splats(&rgb, &["1 2 3 0 -1 -2 -3 1 0 0 0 255 128 0 0.5"]);
    assert_eq!(cloud.attributes.colors, Some(vec![[255, 128, 0, 128]]));
    assert!((cloud.attributes.radii.as_ref().unwrap()[0] - (-1.5f32).exp()).abs() < 1e-6);
    assert_eq!(names(&cloud), ["uncertainty"]);
    assert!(cloud.warnings.is_empty(), "{:?}", cloud.warnings);
    // Spherical harmonics: whatever is converted to colours is not a field.
    let harmonics = [
        "float f_dc_0",
        "float f_dc_1",
        "float f_dc_2",
        "float f_rest_0",
        "float f_rest_1",
    ];
    let cloud = splats(&harmonics, &["1 2 3 0 -1 -2 -3 1 0 0 0 0 0 0 5 5"]);
    assert_eq!(cloud.attributes.colors, Some(vec![[128, 128, 128, 128]]));
    assert!(names(&cloud).is_empty());
    if let Some(cloud) = meaning("P12_splat_with_rgb_nerfstudio.ply") {
        assert!(cloud.attributes.ellipses.is_some() && names(&cloud).is_empty());
        assert!(cloud.attributes.colors.iter().flatten().all(|color| color[3] == 250));
    }
}

#[test]
fn moving_splats_are_shown_at_one_time() {
    let moving = [
        "float trbf_center",
        "float trbf_scale",
        "float motion_0",
        "float motion_1",
        "float motion_2",
        "float motion_3",
        "float motion_4",
        "float motion_5",
        "float motion_6",
        "float motion_7",
        "float motion_8",
        "float omega_0",
        "float omega_1",
        "float omega_2",
        "float omega_3",
        "float f_dc_0",
        "float f_dc_1",
        "float f_dc_2",
    ];
    let shape = "100 -1 -2 -3 1 0 0 0";
    // The median of the centres is 0.5.
    let rows = [
        format!("1 0 0 {shape} 0.5 0 9 9 9 9 9 9 9 9 9 0 0 0 0 1 0.5 0"),
        format!("1 0 0 {shape} 0.25 0 4 0 0 16 0 0 64 0 0 0 0 0 0 0.2 0.2 0.2"),
        format!("1 0 0 {shape} 0.75 0 4 8 0 0 0 0 0 0 0 0 0 0 0 0.2 0.2 0.2"),
    ];
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let cloud = splats(&moving, &rows);
    let places: Vec<[f64; 3]> = (0..3).map(|index| cloud.positions.get(index).to_array()).collect();
    assert_eq!(places, [[1.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, -2.0, 0.0]]);
    let colors = cloud.attributes.colors.as_ref().unwrap();
    assert_eq!(colors[0], [255, 128, 0, 255]);
    // exp(-0.25²) for an opaque one.
    assert_eq!(colors[1], [51, 51, 51, 240]);
    assert!(
        cloud.warnings[0].contains("moving splats") && cloud.warnings[0].contains("t = 0.5"),
        "{:?}",
        cloud.warnings
    );
    if let Some(cloud) = meaning("P15_spacetime_gaussians.ply") {
        assert!(cloud.warnings[0].contains("time is not read"), "{:?}", cloud.warnings);
        let brightest = cloud.attributes.colors.iter().flatten().map(|color| color[0]).max();
        assert_eq!(brightest, Some(255));
    }
}

#[test]
fn undrawable_splats_are_counted() {
    let colors = ["float f_dc_0", "float f_dc_1", "float f_dc_2"];
    for (row, expected) in [
        (
            "1 2 3 0 nan -1 -1 1 0 0 0 0 0 0",
            "1 of 2 splats have no usable scale or rotation",
        ),
        (
            "1 2 3 0 -1 inf -1 1 0 0 0 0 0 0",
            "1 of 2 splats have no usable scale or rotation",
        ),
        (
            "1 2 3 0 -1 -1 -1 0 0 0 0 0 0 0",
            "1 of 2 splats have no usable scale or rotation",
        ),
        (
            "1 2 3 0 -1 -1 -1 nan 0 0 0 0 0 0",
            "1 of 2 splats have no usable scale or rotation",
        ),
        (
            "1 2 3 inf -1 -1 -1 1 0 0 0 0 0 0",
            "1 of 2 splats have an opacity that is not finite",
        ),
    ] {
        let cloud = splats(&colors, &[row, "4 5 6 0 -1 -1 -1 1 0 0 0 0 0 0"]);
        assert!(cloud.warnings[0].contains(expected), "{row}: {:?}", cloud.warnings);
    }
    if let Some(cloud) = meaning("P14c_splat_nan_zero_quaternion.ply") {
        assert!(
            cloud.warnings[0].contains("6000 of 6000 splats"),
            "{:?}",
            cloud.warnings
        );
    }
}

#[test]
fn every_written_format_preserves_fields_by_name() {
    let mut cloud = read("a.xyz", b"1 2 3\n4 5 6\n7 8 9\n");
    let own = NAMES.into_iter().enumerate();
    cloud.attributes.scalars = own
        .map(|(place, name)| ScalarField::new(name, vec![place as f32 - 0.5, f32::MAX, -1e-20]))
        .collect();
    for format in io::WriteFormat::all() {
        let mut file = std::io::Cursor::new(Vec::new());
        io::write(&mut file, format, &cloud).unwrap();
        let back = read(&format!("a.{}", format.extension()), file.get_ref());
        for name in NAMES {
            assert_eq!(field(&back, name).values, field(&cloud, name).values, "{format} {name}");
        }
        assert!(format.losses(&cloud).is_empty(), "{format}");
    }
}

/// Splats with properties of these names behind `x y z`, zeros but for those that are given.
fn named_splat(names: &str, values: &[(&str, f32)]) -> RawCloud {
    let all: Vec<&str> = "x y z".split(' ').chain(names.split(' ')).collect();
    let properties: Vec<String> = all.iter().map(|name| format!("float {name}")).collect();
    let properties: Vec<&str> = properties.iter().map(String::as_str).collect();
    let value = |name: &&str| {
        values
            .iter()
            .find(|(known, _)| known == name)
            .map_or(0.0, |(_, value)| *value)
    };
    let row: Vec<String> = all.iter().map(|name| value(name).to_string()).collect();
    read("a.ply", &ply(&properties, &[&row.join(" "), &row.join(" ")]))
}

const DC: &str = "f_dc_0 f_dc_1 f_dc_2";
const SHAPE: &str = "scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";

#[test]
fn splats_missing_one_group_of_properties_are_read_with_a_warning() {
    for (names, expected) in [
        (format!("{DC} {SHAPE}"), "no `opacity`"),
        (format!("{DC} opacity scale_0 scale_1 scale_2"), "no rotation"),
        (format!("{DC} opacity scale_0 rot_0 rot_1 rot_2 rot_3"), "one scale"),
    ] {
        let cloud = named_splat(&names, &[("rot_0", 1.0), ("scale_0", -1.0), ("opacity", 9.0)]);
        let grey = Some(vec![[128, 128, 128, 255]; 2]);
        assert_eq!(cloud.attributes.colors, grey, "{names}");
        assert!(cloud.attributes.radii.is_some(), "{names}");
        assert!(cloud.warnings[0].contains(expected), "{:?}", cloud.warnings);
    }
    // Points with a field of one of these names are not splats.
    let cloud = named_splat("opacity scale_0", &[]);
    assert!(cloud.attributes.radii.is_none() && cloud.warnings.is_empty());
}

#[test]
fn splats_of_other_methods_are_reported() {
    let splat = format!("{DC} opacity {SHAPE}");
    for (more, expected) in [
        ("t scale_t rot_r_0", "`scale_t`"),
        ("time duration velocity_0 velocity_1 velocity_2", "`velocity_0`"),
        ("vx vy vz t_start t_end", "`t_start`"),
        ("time", "the property `time` says"),
    ] {
        let cloud = named_splat(&format!("{splat} {more}"), &[("rot_0", 1.0), ("opacity", 9.0)]);
        let warning = cloud.warnings.join("\n");
        assert!(
            warning.contains(expected) && warning.contains("time is not read"),
            "{more}: {warning}"
        );
    }
    // A rotor of eight numbers is not a quaternion.
    let cloud = named_splat(&format!("{splat} rot_4 rot_5 rot_6 rot_7 scale_3 t"), &[("rot_0", 1.0)]);
    assert!(cloud.attributes.ellipses.is_none() && cloud.attributes.radii.is_some());
    assert!(cloud.warnings[0].contains("`rot_7`"), "{:?}", cloud.warnings);
    // Anchors of a network are only positions.
    let cloud = named_splat(&format!("f_offset_0 f_anchor_feat_0 opacity {SHAPE}"), &[]);
    assert_eq!(cloud.point_names(), ["position"]);
    assert!(cloud.warnings[0].contains("Scaffold-GS"), "{:?}", cloud.warnings);
}

#[test]
fn out_of_range_colors_and_opacities_of_splats_are_counted() {
    let splat = format!("{DC} opacity {SHAPE}");
    let cloud = named_splat(&splat, &[("rot_0", 1.0), ("opacity", 9.0), ("f_dc_1", f32::NAN)]);
    assert_eq!(cloud.attributes.colors, Some(vec![[128, 128, 128, 255]; 2]));
    assert!(cloud.warnings[0].contains("2 of 2 splats have a colour that is not a number"));
    let cloud = named_splat(&splat, &[("rot_0", 1.0), ("opacity", -9.0)]);
    assert!(
        cloud.warnings[0].contains("2 of 2 splats are transparent"),
        "{:?}",
        cloud.warnings
    );
}

#[test]
fn renamed_fields_are_reported() {
    let properties = [
        "float x",
        "float y",
        "float z",
        "float scalar_Intensity",
        "float intensity",
    ];
    let cloud = read("a.ply", &ply(&properties, &["1 2 3 4 5"]));
    assert_eq!(names(&cloud), ["scalar_Intensity", "intensity_2"]);
    assert!(cloud.warnings[0].contains("`intensity`") && cloud.warnings[0].contains("`intensity_2`"));
}

#[test]
fn files_without_points_are_rejected_stating_their_contents() {
    let file = "ply\nformat ascii 1.0\nelement vertices 1\nproperty float x\nproperty float y\nend_header\n1 2\n";
    let error = io::read_bytes(Path::new("a.ply"), file.as_bytes())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("missing element `vertex`") && error.contains("`vertices` of 1 rows (x y)"),
        "{error}"
    );
    let file = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nelement vertex 0\nend_header\n";
    let error = io::read_bytes(Path::new("a.ply"), file.as_bytes())
        .unwrap_err()
        .to_string();
    assert!(error.contains("`vertex`"), "{error}");
}
