//! Written clouds are read back equal, as far as the format holds them.

use glam::DVec3;
use pointreel::assumption::{Evidence, Subject};
use pointreel::cloud::{AxisConvention, ColorDepth, ImageGrid, Positions, RawCloud, ScalarField};
use pointreel::io::{self, WriteFormat};
use proptest::prelude::*;
use std::io::Cursor;
use std::path::Path;

fn written(format: &str, cloud: &RawCloud) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let format: WriteFormat = format.parse().unwrap();
    io::write(&mut file, format, cloud).unwrap();
    file.into_inner()
}

fn read_back(format: &str, name: &str, cloud: &RawCloud) -> RawCloud {
    let file = written(format, cloud);
    io::read_bytes(Path::new(name), &file).unwrap_or_else(|error| panic!("{error}\n{}", String::from_utf8_lossy(&file)))
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<f32>().prop_filter("numbers", |number| !number.is_nan()),
        -100.0f32..100.0,
        Just(0.0)
    ]
}

fn vectors(count: usize) -> impl Strategy<Value = Vec<[f32; 3]>> {
    prop::collection::vec(prop::array::uniform3(number()), count)
}

prop_compose! {
    fn some_positions(count: usize)(is_wide in any::<bool>(), narrow in vectors(count),
        wide in prop::collection::vec(
            prop::array::uniform3(any::<f64>().prop_filter("numbers", |number| !number.is_nan())), count
        )) -> Positions {
        if is_wide { Positions::F64(wide) } else { Positions::F32(narrow) }
    }
}

prop_compose! {
    fn clouds()(count in 1usize..20)(
        positions in some_positions(count),
        colors in prop::option::of(prop_oneof![
            prop::collection::vec(any::<[u8; 4]>(), count),
            prop::collection::vec(any::<[u8; 3]>().prop_map(|[red, green, blue]| [red, green, blue, 255]), count),
            prop::collection::vec(prop::array::uniform4(0u8..2), count),
        ]),
        normals in prop::option::of(vectors(count)),
        radii in prop::option::of(prop::collection::vec(number(), count)),
        intensity in prop::option::of(prop::collection::vec(number(), count)),
        seconds in prop::option::of(prop::collection::vec(0.0..1e6f64, count)),
        faces in prop::collection::vec(prop::array::uniform3(0..count as u32), 0..5),
        sensor in prop::option::of(prop::array::uniform3(1.0..1e9f64)),
    ) -> RawCloud {
        let mut cloud = RawCloud::from_positions(positions);
        cloud.attributes.colors = colors;
        cloud.attributes.normals = normals;
        cloud.attributes.radii = radii;
        cloud.attributes.scalars.extend(intensity.map(|values| ScalarField::new("scalar_Intensity", values)));
        cloud.attributes.scalars.extend(seconds.map(|values| {
            let values: Vec<f64> = values.into_iter().map(|value| 1.3e9 + value).collect();
            ScalarField::from_f64("gps_time", &values)
        }));
        cloud.faces = faces;
        cloud.sensor = sensor.map(DVec3::from_array);
        cloud
    }
}

/// `read` as the precision of `original`, where a format does not define it.
fn as_precise(read: &Positions, original: &Positions) -> Positions {
    match (read, original) {
        (Positions::F64(read), Positions::F32(_)) => {
            Positions::F32(read.iter().map(|point| point.map(|axis| axis as f32)).collect())
        }
        _ => read.clone(),
    }
}

/// The range of colours in text, which has no types: those that are all 0 or 1 are written as fractions.
fn depth_in_text(colors: &[[u8; 4]]) -> ColorDepth {
    let is_dark = |[red, green, blue, _]: &[u8; 4]| [red, green, blue].into_iter().all(|&channel| channel <= 1);
    if colors.iter().all(is_dark) {
        ColorDepth::Unit
    } else {
        ColorDepth::Bits8
    }
}

proptest! {
    #[test]
    fn ply_stores_everything_but_the_sensor(cloud in clouds()) {
        let expected = RawCloud { sensor: None, ..cloud.clone() };
        prop_assert_eq!(&read_back("ply", "a.ply", &cloud), &expected);
        let mut text = read_back("ply-ascii", "a.ply", &cloud);
        text.positions = as_precise(&text.positions, &cloud.positions);
        prop_assert_eq!(&text, &expected);
    }

    #[test]
    fn pcd_stores_everything_but_faces(cloud in clouds()) {
        let mut expected = RawCloud {
            faces: Vec::new(),
            convention: Some(AxisConvention::UsuallyZUp),
            ..cloud.clone()
        };
        // Its readers treat an alpha of all zeros as no alpha.
        let colors = expected.attributes.colors.as_mut();
        if let Some(colors) = colors.filter(|colors| colors.iter().all(|color| color[3] == 0)) {
            for color in colors { color[3] = 255; }
        }
        prop_assert_eq!(read_back("pcd", "a.pcd", &cloud), expected);
    }

    #[test]
    fn text_stores_everything_but_faces_and_the_sensor(cloud in clouds()) {
        let expected = RawCloud {
            sensor: None,
            faces: Vec::new(),
            convention: Some(AxisConvention::UsuallyZUp),
            color_depth: cloud.attributes.colors.as_deref().map(depth_in_text),
            ..cloud.clone()
        };
        let mut text = read_back("xyz", "a.xyz", &cloud);
        // A column of times may be interpreted as frames: the note that each point has its own time is expected.
        let mut assumed = std::mem::take(&mut text.assumptions);
        // So is the note that names identify the columns.
        assumed.retain(|assumption| assumption.subject != Subject::Columns);
        let has_times = cloud.attributes.scalars.iter().any(|field| field.name == "gps_time");
        prop_assert_eq!(assumed.len(), usize::from(has_times && cloud.positions.len() > 1));
        for assumption in assumed {
            prop_assert_eq!(
                (assumption.subject, assumption.value.as_str(), assumption.evidence),
                (Subject::Frames, "one", Evidence::Convention)
            );
        }
        text.positions = as_precise(&text.positions, &cloud.positions);
        prop_assert_eq!(text, expected);
    }

    #[test]
    fn tables_store_positions_colors_unit_normals_and_fields(
        mut cloud in clouds(),
        normal in prop_oneof![
            (0.1f32..1.5).prop_map(|angle| [angle.cos(), -angle.sin(), 0.0]),
            Just([0.0, 0.0, 1.0]),
        ],
        whole in prop::option::of(0u8..=255),
    ) {
        let wide = cloud.attributes.scalars.iter().any(|field| field.offset != 0.0);
        if let Some(normals) = &mut cloud.attributes.normals {
            normals.fill(normal);
        }
        if let (Some(field), Some(whole), false) = (cloud.attributes.scalars.first_mut(), whole, wide) {
            field.values.fill(f32::from(whole));
        }
        let read = read_back("npy", "a.npy", &cloud);
        // A scalar with times makes all numbers double precision.
        prop_assert!(wide || matches!((&read.positions, &cloud.positions),
            (Positions::F64(_), _) | (Positions::F32(_), Positions::F32(_))));
        prop_assert_eq!(as_precise(&read.positions, &cloud.positions), cloud.positions);
        prop_assert_eq!(read.attributes.colors, cloud.attributes.colors);
        prop_assert_eq!(read.attributes.normals, cloud.attributes.normals);
        prop_assert_eq!(read.attributes.radii, cloud.attributes.radii);
        prop_assert_eq!(read.attributes.scalars, cloud.attributes.scalars);
    }
}

#[test]
fn files_have_the_layout_other_programs_expect() {
    let mut cloud = RawCloud::from_positions(Positions::F64(vec![[0.1, 1e-7, 4_000_000.125]]));
    cloud.attributes.colors = Some(vec![[1, 2, 255, 255]]);
    cloud.attributes.scalars = vec![ScalarField::new("a b,c", vec![0.1]), ScalarField::new("x", vec![1e20])];
    let text = |format| String::from_utf8(written(format, &cloud)).unwrap();
    assert_eq!(
        text("xyz"),
        "# x y z red green blue a_b_c scalar_x\n0.1 1e-7 4000000.125 1 2 255 0.10000000149011612 \
         1.0000000200408773e20\n"
    );
    assert_eq!(
        text("ply-ascii"),
        "ply\nformat ascii 1.0\ncomment written by pointreel\nelement vertex 1\nproperty double x\nproperty double \
         y\nproperty double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float \
         a_b_c\nproperty float scalar_x\nend_header\n0.1 1e-7 4000000.125 1 2 255 0.1 1e20\n"
    );
    let pcd = written("pcd", &cloud);
    let pcd = String::from_utf8_lossy(&pcd);
    assert!(
        pcd.contains(
            "FIELDS x y z a_b,c scalar_x rgb\nSIZE 8 8 8 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 \
        1\nWIDTH 1\nHEIGHT 1\n"
        ),
        "{pcd}"
    );
    let npy = written("npy", &cloud);
    assert!(
        String::from_utf8_lossy(&npy).contains(
            "{'descr': [('x', '<f8'), ('y', '<f8'), ('z', '<f8'), ('red', '<f8'), ('green', '<f8'), ('blue', '<f8'), \
             ('a b,c', '<f8'), ('scalar_x', '<f8')], 'fortran_order': False, 'shape': (1,), }"
        ),
        "fields have names: {}",
        String::from_utf8_lossy(&npy)
    );
    assert_eq!((npy.len() - 8 * 8) % 64, 0);
    // If the number of columns identifies them, a bare table is written.
    cloud.attributes.scalars = vec![ScalarField::new("scalar", vec![0.1])];
    let npy = written("npy", &cloud);
    assert!(String::from_utf8_lossy(&npy).contains("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 7), }"));
    assert_eq!((npy.len() - 7 * 8) % 64, 0);
}

#[test]
fn a_pcd_preserves_the_rows_and_viewpoint_of_an_organised_cloud() {
    let mut cloud = RawCloud::from_positions(Positions::F32(vec![[1.0; 3], [2.0; 3], [f32::NAN; 3], [4.0; 3]]));
    cloud.grid = ImageGrid::of(2, 2, 4);
    assert_eq!(
        read_back("pcd", "a.pcd", &cloud).grid,
        None,
        "its sensor would be taken to be at the origin"
    );
    for sensor in [glam::DVec3::ZERO, glam::DVec3::new(1.0, 2.0, 3.0)] {
        cloud.sensor = Some(sensor);
        let read = read_back("pcd", "a.pcd", &cloud);
        assert_eq!((read.grid, read.sensor), (cloud.grid, cloud.sensor));
        assert!(read.positions.get(2).is_nan());
        assert_eq!(read.positions.get(3), glam::DVec3::splat(4.0));
    }
}

#[test]
fn empty_clouds_are_written_as_valid_files() {
    let cloud = RawCloud::from_positions(Positions::F32(Vec::new()));
    for (format, name) in [
        ("ply", "a.ply"),
        ("ply-ascii", "a.ply"),
        ("pcd", "a.pcd"),
        ("xyz", "a.xyz"),
        ("npy", "a.npy"),
    ] {
        assert_eq!(read_back(format, name, &cloud).positions.len(), 0, "{format}");
    }
}

#[test]
fn formats_have_names_and_extensions() {
    for (name, extension) in [
        ("ply", "ply"),
        ("ply-ascii", ""),
        ("pcd", "pcd"),
        ("las", "las"),
        ("laz", "laz"),
        ("xyz", "xyz"),
        ("npy", "npy"),
    ] {
        let format: WriteFormat = name.parse().unwrap();
        assert_eq!(format.to_string(), name);
        if !extension.is_empty() {
            assert_eq!(
                WriteFormat::of_extension(Path::new(&format!("a.{}", extension.to_uppercase()))),
                Some(format)
            );
        }
    }
    assert!(
        "obj"
            .parse::<WriteFormat>()
            .unwrap_err()
            .contains("expected one of ply, ply-ascii")
    );
    assert_eq!(WriteFormat::of_extension(Path::new("a.obj")), None);
}
