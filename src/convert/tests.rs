use super::*;
use crate::cloud::{Attributes, Ellipse, ImageGrid, Positions, RawCloud, ScalarField};
use crate::io::WriteFormat;
use crate::progress::Progress;
use crate::scene::{Clip, ClipShape};
use crate::sequence::FrameEntry;
use glam::{DMat4, DVec3};
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Duration;

/// 1,000 points in a cube of ten metres, with everything a cloud can have.
fn cube() -> RawCloud {
    let positions: Vec<[f64; 3]> = (0..1000)
        .map(|index| [index % 10, index / 10 % 10, index / 100].map(|value| f64::from(value) + 0.5))
        .collect();
    let intensity = (0..1000).map(|index| index as f32).collect();
    let attributes = Attributes {
        colors: Some((0..1000).map(|index| [(index % 256) as u8, 7, 9, 255]).collect()),
        normals: Some(vec![[0.0, 0.0, 1.0]; 1000]),
        radii: Some(vec![0.5; 1000]),
        ellipses: Some(vec![
            Ellipse {
                axis: glam::Vec3::X,
                ratio: 0.25
            };
            1000
        ]),
        scalars: vec![ScalarField::new("intensity", intensity)],
    };
    RawCloud {
        attributes,
        grid: ImageGrid::of(10, 100, 1000),
        ..RawCloud::from_positions(Positions::F64(positions))
    }
}

fn edited(edit: &Edit) -> RawCloud {
    let mut cloud = cube();
    edit.apply(&mut cloud).unwrap();
    cloud
}

#[test]
fn smoothed_points_are_near_their_sheet_and_the_distances_are_reported() {
    let height = |at: u32| f64::from(at.wrapping_mul(0x9e37_79b9) >> 8) / f64::from(1 << 24) - 0.5;
    let place = |at: u32| [7e6 + f64::from(at % 30), height(at), f64::from(at / 30)];
    let mut places: Vec<[f64; 3]> = (0..900).map(place).collect();
    places.push([f64::NAN; 3]);
    let mut cloud = RawCloud::from_positions(Positions::F64(places.clone()));
    let edit = Edit {
        smoothing: Some(3.0),
        estimates_normals: true,
        ..Edit::default()
    };
    edit.apply(&mut cloud).unwrap();
    let roughness = |height: &dyn Fn(usize) -> f64| (0..900).map(|at| height(at).abs()).sum::<f64>() / 900.0;
    let (before, after) = (
        roughness(&|at| places[at][1]),
        roughness(&|at| cloud.positions.get(at).y),
    );
    assert!(after < 0.5 * before, "{before} before, {after} after");
    assert!(cloud.positions.get(900).is_nan());
    assert!((cloud.positions.get(17).x - 7e6 - 17.0).abs() < 0.5);
    let [told] = &cloud.warnings[..] else {
        panic!("{:?}", cloud.warnings);
    };
    assert!(
        told.starts_with("900 points are smoothed") && told.contains("at most"),
        "{told}"
    );
    assert!(
        cloud.attributes.normals.unwrap()[..900]
            .iter()
            .all(|normal| normal[1].abs() > 0.9)
    );
    assert_eq!(edit.to_string(), "smoothed within 3 point spacings, normals estimated");
}

#[test]
fn transforms_move_points_and_turn_normals() {
    // Z becomes X, twice as long, and 5,000,000 m away.
    let transform = DMat4::from_translation(DVec3::new(5e6, 0.0, 0.0))
        * DMat4::from_scale(DVec3::splat(2.0))
        * DMat4::from_cols_array(&[
            0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        ]);
    let cloud = edited(&Edit {
        transform: Some(transform),
        ..Edit::default()
    });
    assert_eq!(cloud.positions.get(123), DVec3::new(5e6 + 3.0, 7.0, 5.0));
    assert_eq!(cloud.attributes.normals.unwrap()[0], [1.0, 0.0, 0.0]);
    assert!((cloud.attributes.radii.unwrap()[0] - 1.0).abs() < 1e-6);
    // The long axis, X, becomes Y.
    let ellipse = cloud.attributes.ellipses.unwrap()[0];
    assert!(ellipse.axis.abs_diff_eq(glam::Vec3::Y, 1e-6), "{ellipse:?}");
    assert!((ellipse.ratio - 0.25).abs() < 1e-6, "{ellipse:?}");
    assert_eq!(cloud.grid, cube().grid);
    let flat = Edit {
        transform: Some(DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0))),
        ..Edit::default()
    };
    assert_eq!(flat.apply(&mut cube()), Err(EditError::FlatTransform));
}

#[test]
fn a_crop_keeps_the_points_of_a_box_with_their_attributes_and_faces() {
    let mut cloud = cube();
    // Point `x + 10 y + 100 z` is half a metre from (x, y, z); the second face has a corner outside.
    cloud.faces = vec![[0, 1, 10], [2, 3, 12], [111, 110, 101]];
    let edit = Edit {
        crop: Some(Clip::to(ClipShape::Box {
            min: DVec3::ZERO,
            max: DVec3::new(3.0, 2.0, 2.0),
        })),
        // The box is in the coordinates before this.
        transform: Some(DMat4::from_translation(DVec3::new(50.0, 0.0, 0.0))),
        ..Edit::default()
    };
    edit.apply(&mut cloud).unwrap();
    assert_eq!(cloud.positions.len(), 12);
    assert_eq!(cloud.positions.get(11), DVec3::new(52.5, 1.5, 1.5));
    let indices = [
        0.0, 1.0, 2.0, 10.0, 11.0, 12.0, 100.0, 101.0, 102.0, 110.0, 111.0, 112.0,
    ];
    assert_eq!(cloud.attributes.scalars[0].values, indices);
    assert_eq!(
        (cloud.faces.as_slice(), cloud.skipped_faces),
        (&[[0, 1, 3], [10, 9, 7]][..], 1)
    );
    assert_eq!(cloud.grid, None);

    let outside = edited(&Edit {
        crop: edit.crop.map(|clip| Clip {
            keeps_outside: true,
            ..clip
        }),
        ..Edit::default()
    });
    assert_eq!(outside.positions.len(), 988);
    let nowhere = Clip::to(ClipShape::Box {
        min: DVec3::splat(100.0),
        max: DVec3::splat(101.0),
    });
    let none = edited(&Edit {
        crop: Some(nowhere),
        ..Edit::default()
    });
    assert!(none.positions.is_empty());
    assert_eq!(
        none.warnings,
        ["no point is within the box from [100, 100, 100] to [101, 101, 101]: the frame is written without any"]
    );
}

#[test]
fn ellipses_are_stretched_with_their_splats() {
    // Half axes are 4 along X and 1 along Y: 4 and 8 afterwards.
    let cloud = edited(&Edit {
        transform: Some(DMat4::from_scale(DVec3::new(1.0, 8.0, 1.0))),
        ..Edit::default()
    });
    let ellipse = cloud.attributes.ellipses.unwrap()[0];
    assert!(ellipse.axis.abs().abs_diff_eq(glam::Vec3::Y, 1e-6), "{ellipse:?}");
    assert!((ellipse.ratio - 0.5).abs() < 1e-6, "{ellipse:?}");
}

#[test]
fn cells_merge_their_points() {
    let cloud = edited(&Edit {
        voxel_edge: Some(2.0),
        ..Edit::default()
    });
    assert_eq!(cloud.positions.len(), 125);
    assert_eq!(cloud.positions.get(0), DVec3::ONE);
    // Points 0, 1, 10, 11, 100, 101, 110 and 111 are in the first cell.
    assert_eq!(cloud.attributes.scalars[0].values[0], 55.5);
    assert_eq!(cloud.attributes.colors.unwrap()[0], [56, 7, 9, 255]);
    assert_eq!((&cloud.attributes.ellipses, cloud.grid), (&None, None));
    assert_eq!(cloud.attributes.normals.unwrap()[124], [0.0, 0.0, 1.0]);
    assert_eq!(cloud.attributes.radii.unwrap()[0], 1.0);
    let tiny = Edit {
        voxel_edge: Some(1e-18),
        ..Edit::default()
    };
    assert!(matches!(tiny.apply(&mut cube()), Err(EditError::TooManyCells { .. })));
}

#[test]
fn subsampling_is_even_and_preserves_the_order() {
    let cloud = edited(&Edit {
        sample_count: NonZeroUsize::new(125),
        ..Edit::default()
    });
    assert_eq!(cloud.positions.len(), 125);
    let values = &cloud.attributes.scalars[0].values;
    assert!(values.is_sorted());
    // Each octant of the cube has its share.
    let mut counts = [0; 8];
    for index in 0..125 {
        let position = cloud.positions.get(index);
        let octant = (0..3).fold(0, |octant, axis| octant * 2 + usize::from(position[axis] > 5.0));
        counts[octant] += 1;
    }
    assert!(counts.iter().all(|count| (14..=17).contains(count)), "{counts:?}");
}

#[test]
fn normals_are_estimated_where_there_are_none() {
    let mut plane = RawCloud::from_positions(Positions::F64(
        (0..400)
            .map(|index| [f64::from(index % 20), f64::from(index / 20), 1e6])
            .chain([[f64::NAN; 3]])
            .collect(),
    ));
    let edit = Edit {
        estimates_normals: true,
        ..Edit::default()
    };
    edit.apply(&mut plane).unwrap();
    let normals = plane.attributes.normals.unwrap();
    assert!(normals[..400].iter().all(|normal| normal[2].abs() > 0.999));
    assert_eq!(normals[400], [0.0; 3]);
    assert!(plane.attributes.radii.unwrap()[210] > 0.3);
}

/// Ten frames, each with its number in all coordinates; frame 3 fails.
fn sequence() -> Sequence {
    let sources = (0..10).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("nowhere/{number}.ply"))
    });
    Sequence::with_decoder(sources.collect(), |source| match source.number {
        Some(3) => Err("broken".into()),
        Some(number) => Ok(RawCloud::from_positions(Positions::F64(vec![[number as f64; 3]]))),
        None => Err("no number".into()),
    })
}

fn conversion(folder: &Path) -> Conversion {
    Conversion {
        frames: None,
        shard: Shard::WHOLE,
        edit: Edit::default(),
        format: WriteFormat::default(),
        output: Output::Folder(folder.to_owned()),
        goal: None,
        overwrites: false,
        reading: String::new(),
    }
}

fn run(conversion: &Conversion) -> Converted {
    convert(&sequence(), conversion, &Progress::default()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| !name.starts_with(".pointreel"))
        .collect();
    names.sort();
    names
}

#[test]
fn every_frame_is_written_but_the_one_that_fails() {
    let folder = tempfile::tempdir().unwrap();
    let converted = run(&conversion(folder.path()));
    assert_eq!((converted.written, converted.left), (9, 0));
    assert_eq!(converted.failed.len(), 1);
    assert_eq!(converted.failed[0].0, 3);
    assert_eq!(names(folder.path()).len(), 9);
    let seventh = crate::io::read(&folder.path().join("7.ply")).unwrap();
    assert_eq!(seventh.positions.get(0), DVec3::splat(7.0));
}

#[test]
fn a_restarted_conversion_only_does_what_is_left() {
    let folder = tempfile::tempdir().unwrap();
    run(&conversion(folder.path()));
    fs::remove_file(folder.path().join("5.ply")).unwrap();
    let again = run(&conversion(folder.path()));
    assert_eq!((again.written, again.left), (1, 8));
    // Other options mean another conversion.
    let other = Conversion {
        format: "ply-ascii".parse().unwrap(),
        ..conversion(folder.path())
    };
    let refused = convert(&sequence(), &other, &Progress::default());
    assert!(matches!(refused, Err(ConvertError::OtherConversion { .. })));
    let fresh = Conversion {
        overwrites: true,
        ..other
    };
    assert_eq!(run(&fresh).written, 9);
}

#[test]
fn foreign_files_are_not_mistaken_for_frames() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("5.ply"), "mine").unwrap();
    let refused = convert(&sequence(), &conversion(folder.path()), &Progress::default());
    assert!(
        matches!(refused, Err(ConvertError::Exists { more: 0, .. })),
        "{refused:?}"
    );
    assert_eq!(names(folder.path()), ["5.ply"]);
    // Nor is a frame whose line in the ledger was truncated by a power failure.
    let fresh = Conversion {
        overwrites: true,
        ..conversion(folder.path())
    };
    assert_eq!(run(&fresh).written, 9);
    let ledger = folder.path().join(".pointreel-convert.1-of-1.jsonl");
    let text = fs::read(&ledger).unwrap();
    let last = text.iter().rposition(|&byte| byte == b'{').unwrap();
    fs::write(&ledger, &text[..last + 9]).unwrap();
    let refused = convert(&sequence(), &conversion(folder.path()), &Progress::default());
    assert!(
        matches!(refused, Err(ConvertError::Exists { more: 0, .. })),
        "{refused:?}"
    );
    // A line appended after a partial one is complete.
    assert_eq!(run(&fresh).written, 9);
    assert_eq!(run(&conversion(folder.path())).left, 9);
}

#[test]
fn another_frame_with_the_same_name_does_not_count_as_finished() {
    let folder = tempfile::tempdir().unwrap();
    run(&conversion(folder.path()));
    let other = Sequence::with_decoder(vec![FrameEntry::file("nowhere/deeper/../7.ply")], |_| Ok(cube()));
    let written = convert(&other, &conversion(folder.path()), &Progress::default());
    assert!(written.is_err(), "{written:?}");
}

#[test]
fn missing_frames_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for frames in [20..=30, 8..=10, 10..=10] {
        let beyond = Conversion {
            frames: Some(frames),
            ..conversion(folder.path())
        };
        let refused = convert(&sequence(), &beyond, &Progress::default());
        assert!(matches!(refused, Err(ConvertError::NoSuchFrames(_))), "{refused:?}");
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_translation_within_f32_precision_keeps_single_precision() {
    let moved = |transform: DMat4| {
        let mut cloud = RawCloud::from_positions(Positions::F32(vec![[0.1, 2.0, 3.5], [f32::NAN; 3]]));
        let edit = Edit {
            transform: Some(transform),
            ..Edit::default()
        };
        edit.apply(&mut cloud).unwrap();
        matches!(cloud.positions, Positions::F32(_))
    };
    assert!(moved(DMat4::IDENTITY));
    assert!(moved(DMat4::from_scale(DVec3::new(1.0, -1.0, 2.0))));
    assert!(!moved(DMat4::from_translation(DVec3::splat(1e6))));
}

#[test]
fn a_cancelled_conversion_leaves_only_complete_files() {
    let folder = tempfile::tempdir().unwrap();
    let progress = Progress::told_to(|progress| {
        if progress.done() > 0 {
            progress.cancel();
        }
    });
    let converted = convert(&sequence(), &conversion(folder.path()), &progress).unwrap();
    assert!(converted.is_cancelled);
    assert_eq!(names(folder.path()).len(), converted.written);
    for name in names(folder.path()) {
        assert_eq!(
            Path::new(&name).extension().and_then(|it| it.to_str()),
            Some("ply"),
            "{name}"
        );
        crate::io::read(&folder.path().join(name)).unwrap();
    }
    assert_eq!(run(&conversion(folder.path())).left, converted.written);
}

#[test]
fn shards_divide_the_frames() {
    let folder = tempfile::tempdir().unwrap();
    let counts: Vec<usize> = (0..3)
        .map(|index| {
            run(&Conversion {
                shard: Shard { index, count: 3 },
                ..conversion(folder.path())
            })
            .written
        })
        .collect();
    assert_eq!(counts, [3, 3, 3]);
    assert_eq!(names(folder.path()).len(), 9);
}

#[test]
fn times_are_in_the_names() {
    let folder = tempfile::tempdir().unwrap();
    let sources = vec![FrameEntry {
        time: Some(Duration::from_millis(1_305_031_102_175)),
        ..FrameEntry::file("a.bag")
    }];
    let stamped = Sequence::with_decoder(sources, |_| Ok(cube()));
    convert(&stamped, &conversion(folder.path()), &Progress::default()).unwrap();
    assert_eq!(names(folder.path()), ["a_1305031102.175000000.ply"]);
}

#[test]
fn times_in_written_names_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let sources = (0..3).map(|place| FrameEntry {
        time: Some(Duration::from_millis([0, 40, 120][place])),
        ..FrameEntry::file("fox.glb")
    });
    let animated = Sequence::with_decoder(sources.collect(), |_| Ok(cube()));
    convert(&animated, &conversion(folder.path()), &Progress::default()).unwrap();
    let again = Sequence::discover(&[folder.path().to_owned()]).unwrap();
    let times: Vec<Option<Duration>> = again.entries().iter().map(|source| source.time).collect();
    let expected = [0, 40, 120].map(|millis| Some(Duration::from_millis(millis)));
    assert_eq!(times, expected);
    assert_eq!(again.pace(), animated.pace());
}
