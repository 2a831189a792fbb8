//! A property: everything in a cloud is in the file written from it, or a line reports its loss.

use glam::Vec3;
use pointreel::cloud::{Ellipse, ImageGrid, Positions, RawCloud, ScalarField};
use pointreel::io::{self, Loss, Losses, WriteFormat};
use proptest::prelude::*;
use std::io::Cursor;
use std::path::PathBuf;

prop_compose! {
    /// 12 points with some of all that there can be.
    fn clouds()(
        is_wide in any::<bool>(),
        place in prop_oneof![Just(0.0), Just(5_334_567.125), -1e3f64..1e3],
        [colors, alpha, normals, radii] in any::<[bool; 4]>(),
        [ellipses, faces, hole, grid] in any::<[bool; 4]>(),
        sensor in any::<bool>(),
        scalars in prop::collection::btree_set(prop::sample::select(SCALARS.to_vec()), 0..4),
    ) -> RawCloud {
        let at = |index: usize| [index as f64 * 0.25 + place, (index % 4) as f64, -1.5];
        let mut places: Vec<[f64; 3]> = (0..COUNT).map(at).collect();
        if hole {
            places[5] = [f64::NAN; 3];
        }
        let narrow = || places.iter().map(|place| place.map(|value| value as f32)).collect();
        let mut cloud = RawCloud::from_positions(if is_wide {
            Positions::F64(places.clone())
        } else {
            Positions::F32(narrow())
        });
        let attributes = &mut cloud.attributes;
        let alpha = if alpha { 100 } else { 255 };
        attributes.colors = colors.then(|| (0..COUNT as u8).map(|point| [20 * point, 200, 77, alpha]).collect());
        attributes.normals = normals.then(|| vec![[0.6, 0.0, 0.8]; COUNT]);
        attributes.radii = radii.then(|| vec![0.125; COUNT]);
        let ellipse = Ellipse { axis: Vec3::X, ratio: 0.5 };
        attributes.ellipses = ellipses.then(|| vec![ellipse; COUNT]);
        let field = |name: &str| ScalarField::new(name, (0..COUNT).map(|point| point as f32).collect());
        attributes.scalars = scalars.into_iter().map(field).collect();
        cloud.faces = if faces { vec![[0, 1, 2], [2, 3, 4]] } else { Vec::new() };
        cloud.grid = if grid { ImageGrid::of(4, 3, COUNT) } else { None };
        cloud.sensor = sensor.then_some(glam::DVec3::new(1.0, 2.0, 3.0));
        cloud
    }
}

const COUNT: usize = 12;

/// Names that readers know, and one with a sign that most formats cannot hold.
const SCALARS: [&str; 6] = [
    "intensity",
    "classification",
    "gps_time",
    "ring",
    "curvature",
    "scalar_a b",
];

fn read_back(format: WriteFormat, cloud: &RawCloud) -> RawCloud {
    let mut file = Cursor::new(Vec::new());
    io::write(&mut file, format, cloud).unwrap();
    let name = PathBuf::from(format!("a.{}", format.extension()));
    io::read_bytes(&name, &file.into_inner()).unwrap_or_else(|error| panic!("{format}: {error}"))
}

fn loses(losses: &Losses, loss: &Loss) -> bool {
    losses.kinds().any(|kind| kind == loss)
}

fn loses_field(losses: &Losses, names: &[&str]) -> bool {
    let is_of = |kind: &Loss| match kind {
        Loss::Field(name) => names.contains(&name.trim_matches('`')),
        _ => false,
    };
    losses.kinds().any(is_of)
}

/// The name that a scalar has in the file.
fn written_name(losses: &Losses, name: &str) -> String {
    let renamed = losses.kinds().find_map(|kind| match kind {
        Loss::Name(from, to) if from == name => Some(to.clone()),
        _ => None,
    });
    renamed.unwrap_or_else(|| name.to_owned())
}

fn has_alpha(cloud: &RawCloud) -> bool {
    cloud.attributes.colors.iter().flatten().any(|color| color[3] != 255)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn exactly_the_content_missing_from_the_file_is_reported(cloud in clouds()) {
        for format in WriteFormat::all() {
            let losses = format.losses(&cloud);
            let read = read_back(format, &cloud);
            let (there, read_of) = (&cloud.attributes, &read.attributes);
            let holes = usize::from(loses(&losses, &Loss::Holes));
            prop_assert_eq!(read.positions.len(), COUNT - holes, "{}: points", format);
            prop_assert_eq!(read_of.colors.is_some(), there.colors.is_some(), "{}: colours", format);
            let loses_alpha = loses_field(&losses, &["the alpha of colours", "alpha"]);
            for (what, is_there, is_read, is_said) in [
                ("normals", there.normals.is_some(), read_of.normals.is_some(), loses_field(&losses, &["normals"])),
                ("alpha", has_alpha(&cloud), has_alpha(&read), loses_alpha),
                ("radii", there.radii.is_some(), read_of.radii.is_some(), loses_field(&losses, &["radii", "radius"])),
                ("ellipses", there.ellipses.is_some(), read_of.ellipses.is_some(), loses_field(&losses, &["ellipses"])),
                ("faces", !cloud.faces.is_empty(), !read.faces.is_empty(), loses(&losses, &Loss::Faces)),
                ("rows", cloud.grid.is_some(), read.grid.is_some(), loses(&losses, &Loss::Rows)),
                ("sensor", cloud.sensor.is_some(), read.sensor.is_some(), loses(&losses, &Loss::Sensor)),
            ] {
                prop_assert_eq!(is_there && !is_read, is_said, "{}: {} {:?}", format, what, losses);
            }
            for field in &there.scalars {
                let name = written_name(&losses, &field.name);
                let is_read = read_of.scalars.iter().any(|read| {
                    let bare = |name: &str| name.strip_prefix("scalar_").unwrap_or(name).to_owned();
                    bare(&read.name) == bare(&name)
                });
                // A NumPy table has no names: its only scalar is read as the intensity.
                let is_unnamed = format.to_string() == "npy" && read_of.scalars.len() == 1;
                let is_said = loses_field(&losses, &[&name, &field.name]);
                prop_assert!(is_read || is_unnamed || is_said, "{}: {} {:?}", format, field.name, losses);
                prop_assert!(!is_said || !is_read || is_unnamed, "{}: {} is written {:?}", format, field.name, losses);
            }
            let lines = losses.lines(&format.to_string(), 1).join("\n");
            for kind in losses.kinds() {
                if let Loss::Field(name) = kind {
                    prop_assert!(lines.contains(name.as_str()), "{} is not in {}", name, lines);
                }
            }
            prop_assert_eq!(lines.is_empty(), losses.is_empty());
        }
    }
}

#[test]
fn rounded_coordinates_and_values_are_reported() {
    let las: WriteFormat = "las".parse().unwrap();
    let mut cloud = RawCloud::from_positions(Positions::F64(vec![[0.123_456_789_123, 0.0, 0.0], [5e6, 1.0, 1.0]]));
    cloud.attributes.scalars = vec![ScalarField::new("classification", vec![1.5, 300.0])];
    let lines = las.losses(&cloud).lines("las", 1).join("\n");
    assert!(
        lines.contains("rounds coordinates") && lines.contains("classification"),
        "{lines}"
    );
    let exact = RawCloud::from_positions(Positions::F64(vec![[0.125, 0.0, 0.001], [5e3, 1.0, 1.0]]));
    assert!(las.losses(&exact).is_empty());
}

#[test]
fn losses_of_many_frames_take_one_line_per_kind() {
    let mut all = Losses::default();
    for frame in 0..10 {
        let mut losses = Losses::default();
        losses.add(Loss::Faces, 100.0);
        losses.add(Loss::Precision, f64::from(frame));
        if frame < 3 {
            losses.add(Loss::Field("normals".to_owned()), 0.0);
        }
        all.merge(losses);
    }
    let lines = all.lines("las", 10);
    assert_eq!(
        lines,
        [
            "las cannot hold normals: not written (3 of 10 frames)",
            "las cannot hold faces: 1000 are not written, only their points",
            "las rounds coordinates here, by up to 9.000e0",
        ]
    );
}

/// The data of `file` that is lost although `format` could hold it, as one text.
fn dropped(name: &str, file: &str, format: &str) -> String {
    let cloud = io::read_bytes(&PathBuf::from(name), file.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    let format: WriteFormat = format.parse().unwrap_or_else(|error| panic!("{error}"));
    format.losses(&cloud).lines(&format.to_string(), 1).join("\n")
}

#[test]
fn unread_content_is_reported_when_it_is_lost() {
    let ply = |properties: &str, rows: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
             {properties}end_header\n{rows}\n"
        )
    };
    let colors = |kind: &str| format!("property {kind} red\nproperty {kind} green\nproperty {kind} blue\n");
    let rounded = "more than 8 bits";
    for (kind, values, is_lost) in [
        ("ushort", "0 1000 65535", true),
        ("ushort", "0 257 65535", false),
        ("float", "0 0.3 1", true),
        ("float", "0 0.2 1", false),
        ("uchar", "0 1 255", false),
    ] {
        let said = dropped("a.ply", &ply(&colors(kind), &format!("1 2 3 {values}")), "ply");
        assert_eq!(said.contains(rounded), is_lost, "{kind} {values}: {said}");
    }
    let said = dropped("a.ply", &ply("property list uchar int near\n", "1 2 3 2 0 0"), "pcd");
    assert!(said.contains("lists of points are not read: `near`"), "{said}");
    let faces = "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\n";
    let said = dropped("a.ply", &ply(faces, "1 2 3\n3 0 0 0 9"), "ply");
    assert!(said.contains("properties of faces are not read: `red`"), "{said}");
    let pcd = |viewpoint: &str, id: &str| {
        format!(
            "FIELDS x y z id\nSIZE 4 4 4 8\nTYPE F F F U\nWIDTH 1\nHEIGHT 1\nVIEWPOINT {viewpoint}\nPOINTS 1\n\
             DATA ascii\n1 2 3 {id}\n"
        )
    };
    let said = dropped("a.pcd", &pcd("0 0 0 0.7 0 0.7 0", "7"), "ply");
    assert!(said.contains("the rotation of VIEWPOINT (0.7 0 0.7 0)"), "{said}");
    let said = dropped("a.pcd", &pcd("0 0 0 1 0 0 0", "9007199254740995"), "ply");
    assert!(said.contains("`id` are beyond 2^53"), "{said}");
    assert_eq!(dropped("a.pcd", &pcd("0 0 0 1 0 0 0", "9007199254740"), "ply"), "");
}
