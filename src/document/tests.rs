//! Sessions written and read: nothing is lost, whatever is in them, and damage is reported with its line.

use super::*;
use crate::cloud::NoData;
use crate::rgbd::Filters;
use crate::scene::{
    Camera, CameraPath, Choice, Clip, ClipShape, FollowedPoint, Keyframe, Label, MAX_LABEL_CHARS, MeasurementKind,
    Primitive, Settings, UpAxis,
};
use crate::timeline::PlayRange;
use glam::DVec3;
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Written by hand.
const BY_HAND: &str = r#"{
  "pointreel_session": 1,
  "files": ["scans"],
  "frame": 7,
  "labels": [
    {"text": "knee", "frame": 3, "point": 17, "from": 2, "to": 9},
    {"text": "the door", "at": [1, 2.5, -3]}
  ],
  "measurements": [
    {"gauge": "distance", "points": [
      {"frame": 3, "point": 17, "of": 100, "at": [0, 0, 0]},
      {"frame": 3, "point": 18, "of": 100, "at": [3, 4, 0]}
    ]}
  ],
  "markers": [{"frame": 5, "name": "turn"}],
  "settings": {"primitive": "voxel"}
}
"#;

fn read(text: &str) -> Result<ReadSession, SessionError> {
    ReadSession::of_text(text.as_bytes(), Path::new("/data/walk/walk.pointreel"))
}

fn place() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1e12f64..1e12).prop_map(DVec3::from_array)
}

fn range() -> impl Strategy<Value = PlayRange> {
    (prop::option::of(0usize..50), prop::option::of(50usize..100)).prop_map(|(first, last)| {
        let mut range = PlayRange::default();
        range = first.map_or(range, |first| range.beginning_at(first));
        last.map_or(range, |last| range.ending_at(last))
    })
}

fn followed() -> impl Strategy<Value = FollowedPoint> {
    (0u32..1000, 1000usize..100_000).prop_map(|(index_in_file, points)| FollowedPoint {
        index_in_file,
        points_in_file: Some(points),
    })
}

fn label() -> impl Strategy<Value = Label> {
    let point = prop_oneof![
        (prop::option::of(followed()), place()).prop_map(|(point, place)| (point, Some(place))),
        followed().prop_map(|point| (Some(point), None)),
    ];
    ("[^\\p{Cc}]{0,30}", 0usize..1000, point, range()).prop_map(|(text, frame, (point, place), frames)| Label {
        text: Label::as_text(&text),
        frame,
        point,
        place,
        frames,
    })
}

fn measured() -> impl Strategy<Value = Measured> {
    let point =
        (0usize..1000, followed(), place()).prop_map(|(frame, point, place)| MeasuredPoint { frame, point, place });
    (0usize..3, prop::array::uniform3(point)).prop_map(|(kind, points)| {
        let kind = MeasurementKind::ALL[kind].0;
        let points = points[..kind.point_count()].to_vec();
        Measured { kind, points }
    })
}

fn trails() -> impl Strategy<Value = ShownTrails> {
    let point =
        (0usize..1000, followed(), place()).prop_map(|(frame, point, place)| MeasuredPoint { frame, point, place });
    let spread = (1usize..500, 1usize..240).prop_map(|(points, frames)| SpreadTrails { points, frames });
    let parts = (
        any::<bool>(),
        prop::collection::vec(point, 0..3),
        prop::option::of(spread),
    );
    parts.prop_map(|(of_picked, pinned, spread)| ShownTrails {
        of_picked,
        pinned,
        spread,
    })
}

fn camera() -> impl Strategy<Value = Camera> {
    (place(), 1e-3f64..1e6, -180f64..180.0, -90f64..90.0).prop_map(|(target_in_world, distance, azimuth, elevation)| {
        Camera {
            target_in_world,
            distance,
            azimuth_deg: azimuth,
            elevation_deg: elevation,
            ..Camera::framing(&crate::math::Aabb::EMPTY, DVec3::ZERO, UpAxis::NegZ)
        }
    })
}

fn path() -> impl Strategy<Value = CameraPath> {
    (prop::collection::vec((camera(), 0f64..1000.0), 1..5), any::<bool>()).prop_map(|(views, eases)| {
        let keys = views.into_iter().enumerate();
        let keys = keys.map(|(index, (camera, frame))| Keyframe {
            time_s: index as f64 * 0.7,
            camera,
            frame,
        });
        CameraPath::new(keys.collect(), eases).unwrap()
    })
}

fn clip() -> impl Strategy<Value = Clip> {
    let shape = prop_oneof![
        (place(), place()).prop_map(|(a, b)| ClipShape::Box {
            min: a.min(b),
            max: a.max(b)
        }),
        (0.1f64..1.0, -1f64..1.0, -1e6f64..1e6).prop_map(|(x, y, offset)| ClipShape::Plane {
            normal: DVec3::new(x, y, 0.3),
            offset
        }),
    ];
    (shape, any::<bool>(), any::<bool>()).prop_map(|(shape, is_on, keeps_outside)| Clip {
        is_on,
        shape,
        keeps_outside,
    })
}

fn compared() -> impl Strategy<Value = Compared> {
    let by = prop::option::of(prop_oneof![
        Just(ComparedBy::Index),
        Just(ComparedBy::Number),
        Just(ComparedBy::Time)
    ]);
    let layout = prop_oneof![Just(ComparedLayout::SideBySide), Just(ComparedLayout::Line)];
    (
        prop::option::of("[a-z/]{1,10}"),
        by,
        any::<i64>(),
        layout,
        0u16..=10_000,
    )
        .prop_map(|(topic, by, offset_frames, layout, line)| Compared {
            inputs: vec!["/data/walk/smooth".into(), "demo:".into()],
            topic,
            by,
            offset_frames,
            layout,
            line: f64::from(line) / 1e4,
        })
}

#[test]
fn impossible_frame_numbers_are_rejected() {
    let most = usize::MAX;
    for field in [
        format!(r#""frame": {most}"#),
        format!(r#""range": {{"first": {most}}}"#),
        format!(r#""range": {{"last": {most}}}"#),
        format!(r#""markers": [{{"frame": {most}}}]"#),
        format!(r#""labels": [{{"text": "x", "frame": {most}, "at": [0, 0, 0]}}]"#),
        format!(r#""labels": [{{"text": "x", "to": {most}, "at": [0, 0, 0]}}]"#),
        format!(
            r#""measurements": [{{"gauge": "distance", "points": [
                {{"frame": 0, "point": 1, "of": 9, "at": [0, 0, 0]}},
                {{"frame": {most}, "point": 1, "of": 9, "at": [1, 0, 0]}}]}}]"#
        ),
    ] {
        let text = format!(r#"{{"pointreel_session": 1, "files": ["scans"], {field}}}"#);
        let problem = read(&text).unwrap_err().to_string();
        assert!(problem.contains("expected at most 4294967295"), "{field}: {problem}");
    }
}

#[test]
fn hand_written_comparisons_are_read_and_errors_reported() {
    let with = |compare: &str| {
        let compare = format!("\"compare\": {compare},\n  \"frame\"");
        read(&BY_HAND.replace("\"frame\": 7", &format!("{compare}: 7")))
    };
    let compared = with(r#"{"files": ["smooth"], "layout": "line"}"#)
        .unwrap()
        .document
        .compare;
    let expected = Compared {
        inputs: vec!["/data/walk/smooth".into()],
        topic: None,
        by: None,
        offset_frames: 0,
        layout: ComparedLayout::Line,
        line: 0.5,
    };
    assert_eq!(compared, Some(expected));
    assert_eq!(read(BY_HAND).unwrap().document.compare, None);
    for (wrong, expected) in [
        (r#"{"files": []}"#, "expected at least one"),
        (r#"{"files": ["a"], "line": 1.5}"#, "expected 0 to 1"),
        (r#"{"files": ["a"], "by": "colour"}"#, "colour"),
        (r#"{"files": ["a"], "of later": 1}"#, "of later"),
        ("7", "expected an object in braces"),
    ] {
        let said = with(wrong).unwrap_err().to_string();
        assert!(said.contains(expected) && said.contains("line "), "{wrong}: {said}");
    }
}

fn session() -> impl Strategy<Value = Document> {
    let settings = (0.1f32..10.0, 0usize..3, any::<bool>()).prop_map(|(scale, primitive, grid)| {
        Settings::default()
            .with(|style| {
                style.surfels.splat_scale = scale;
                style.primitive = [Choice::Auto, Primitive::Voxel.into(), Primitive::Point.into()][primitive];
                style.backdrop.grid = grid;
            })
            .nearest()
    });
    let reading = (
        prop::option::of("[a-z/]{1,10}"),
        prop::option::of(0.1f64..1000.0),
        any::<bool>(),
    );
    let reading = reading.prop_map(|(topic, fps, merge_scans)| Reading {
        topic,
        fps,
        merge_scans,
        no_data: merge_scans.then_some(NoData::Value(-9999.0)),
        rgbd_filters: merge_scans.then_some(Filters::NONE),
        merge_frames: merge_scans.then_some((3, 9)),
        merge_cells_m: merge_scans.then_some(0.01),
        ..Reading::default()
    });
    let markers = prop::collection::btree_map(0usize..1000, "[^\\p{Cc}]{0,20}", 0..4);
    let markers = markers.prop_map(|list| list.into_iter().map(|(frame, name)| Marker { frame, name }).collect());
    let view = (
        reading,
        0usize..1000,
        prop::option::of(camera()),
        settings,
        prop::option::of(clip()),
    );
    let marks = (
        range(),
        markers,
        prop::collection::vec(measured(), 0..4),
        prop::collection::vec(label(), 0..6),
        prop::option::of(path()),
        prop::option::of(compared()),
        trails(),
    );
    let notes = (prop::option::of(0..UpAxis::ALL.len()), ".{0,40}");
    (view, marks, notes).prop_map(
        |(
            (reading, frame, view, settings, clip),
            (range, markers, measurements, labels, path, compare, trails),
            (up, notes),
        )| Document {
            inputs: vec!["/data/walk/scans".into(), "/data/b.ply".into(), "demo:".into()],
            reading,
            frame,
            view,
            settings,
            clip,
            range,
            markers,
            measurements,
            labels: Arc::new(labels),
            trails,
            path: Arc::new(path.map(Draft::of).unwrap_or_default()),
            compare,
            notes,
            up: up.map(|axis| UpAxis::ALL[axis].1),
            unknown: Unknown::default(),
        },
    )
}

proptest! {
    #[test]
    fn every_session_round_trips_bit_for_bit(session in session()) {
        let text = session.to_text(Path::new("/data/walk/walk.pointreel")).unwrap();
        let read = read(&text).unwrap();
        prop_assert_eq!(&read.warnings, &Vec::<String>::new());
        // The text has relative paths where the folder leads to the input.
        let inputs: Vec<PathBuf> = vec!["/data/walk/scans".into(), "/data/walk/../b.ply".into(), "demo:".into()];
        prop_assert_eq!(&read.document.inputs, &inputs);
        let read = Document { inputs: session.inputs.clone(), ..read.document };
        prop_assert_eq!(&read, &session);
        // Writing it again gives the same text.
        prop_assert_eq!(read.to_text(Path::new("/data/walk/walk.pointreel")).unwrap(), text);
    }

    #[test]
    fn no_text_causes_a_panic(session in session(), cut in 0usize..4000, letter in any::<u8>(), text in ".{0,60}") {
        let _ = read(&text);
        let mut bytes = session.to_text(Path::new("/data/walk/walk.pointreel")).unwrap().into_bytes();
        let place = cut % bytes.len();
        bytes[place] = letter;
        let _ = ReadSession::of_text(&bytes, Path::new("walk.pointreel"));
        let whole = read(std::str::from_utf8(&bytes[..place]).unwrap_or(""));
        prop_assert!(whole.is_err(), "a half is no session");
    }
}

#[test]
fn a_session_is_text_that_can_be_written_by_hand() {
    let ReadSession {
        document: session,
        warnings,
        ..
    } = read(BY_HAND).unwrap();
    assert_eq!(warnings, [""; 0]);
    assert_eq!(session.inputs, [PathBuf::from("/data/walk/scans")]);
    assert_eq!(
        (session.frame, session.settings.primitive),
        (7, Primitive::Voxel.into())
    );
    assert_eq!(session.view, None);
    let [knee, door] = session.labels.as_slice() else {
        panic!("{:?}", session.labels)
    };
    assert_eq!((knee.text.as_str(), knee.frame), ("knee", 3));
    let point = knee.point.unwrap();
    assert_eq!((point.index_in_file, point.points_in_file), (17, None));
    assert_eq!(
        (knee.frames.first(), knee.frames.last(), knee.place),
        (Some(2), Some(9), None)
    );
    assert_eq!((door.place, door.point), (Some(DVec3::new(1.0, 2.5, -3.0)), None));
    let distance = &session.measurements[0];
    let places: Vec<DVec3> = distance.points.iter().map(|point| point.place).collect();
    assert_eq!(distance.kind.value(&places, DVec3::Y), Some(5.0));
    assert_eq!(session.markers[0].name, "turn");
}

#[test]
fn labels_markers_and_settings_take_one_line_each() {
    let text = read(BY_HAND).unwrap().document;
    let text = text.to_text(Path::new("/data/walk/walk.pointreel")).unwrap();
    for line in [
        r#"  "files": ["scans"],"#,
        r#"    {"frame": 3, "from": 2, "point": 17, "text": "knee", "to": 9},"#,
        r#"    {"at": [1.0, 2.5, -3.0], "frame": 0, "text": "the door"}"#,
        r#"    {"frame": 5, "name": "turn"}"#,
        r#"    "primitive": "voxel","#,
    ] {
        assert!(text.lines().any(|written| written == line), "{line}\n{text}");
    }
    assert!(!text.contains("null"), "{text}");
}

#[test]
fn errors_name_the_line_and_the_expected_value() {
    for (from, to, line, message) in [
        (
            "\"point\": 17, \"from\"",
            "\"from\"",
            6,
            "a label has a `point`, a place (`at`), or both",
        ),
        ("\"from\": 2", "\"from\": 20", 6, "from frame 20 to frame 9"),
        ("17, \"from\"", "17, \"of\": 17, \"from\"", 6, "point 17 of 17"),
        ("[1, 2.5, -3]", "[1, 2.5]", 7, "array of length 3"),
        ("[1, 2.5, -3]", "[1, 2.5, 1e200]", 7, "expected numbers within"),
        ("\"distance\"", "\"volume\"", 10, "volume"),
        ("\"distance\"", "\"angle\"", 13, "2 points: the gauge Angle takes 3"),
        (", \"at\": [3, 4, 0]", "", 13, "and a place (`at`)"),
        ("\"frame\": 7", "\"frame\": -7", 4, "-7"),
        (
            "\"frame\": 7",
            "\"frame\": 7,\n  \"view\": \"here\"",
            5,
            "this is not a view",
        ),
        (
            "\"frame\": 7",
            "\"frame\": 7, \"clip\": {\"on\": true}",
            4,
            "either a `box` or a `plane`",
        ),
        (
            "\"frame\": 7",
            "\"frame\": 7, \"range\": {\"first\": 3, \"last\": 2}",
            4,
            "after the last one",
        ),
        (
            "\"frame\": 7",
            "\"frame\": 7, \"reading\": {\"fps\": 0}",
            4,
            "0 is not above 0",
        ),
        (
            "\"frame\": 7",
            "\"frame\": 7, \"reading\": {\"speed\": 1}",
            4,
            "unknown field `speed`",
        ),
        (
            "\"frame\": 7",
            "\"frame\": 7, \"camera_path\": {\"pointreel_path\": 1}",
            4,
            "missing field",
        ),
        ("\"files\": [\"scans\"],", "", 17, "missing field `files`"),
    ] {
        let damaged = BY_HAND.replacen(from, to, 1);
        assert_ne!(damaged, BY_HAND, "{from}");
        let error = read(&damaged).unwrap_err().to_string();
        assert!(error.contains(message), "{to}: {error}");
        assert!(error.contains(&format!("at line {line} ")), "{to}: {error}");
        assert!(
            error.starts_with("/data/walk/walk.pointreel is not a session"),
            "{error}"
        );
    }
}

#[test]
fn other_files_and_later_versions_are_rejected() {
    let later = BY_HAND.replace("\"pointreel_session\": 1", "\"pointreel_session\": 4");
    let later = later.replace("\"files\"", "\"sources\"");
    let error = read(&later).unwrap_err().to_string();
    assert_eq!(
        error,
        "/data/walk/walk.pointreel is a session of version 4, and this program knows version 1: open it with a newer \
         pointreel"
    );
    for (text, message) in [
        ("", "is not a session that can be opened"),
        ("{}", "missing field `pointreel_session`"),
        ("ply\nformat ascii 1.0\n", "at line 1"),
        (r#"{"pointreel_session": 1, "files": []}"#, "has no `files`"),
        (
            r#"{"pointreel_session": 1, "files": ["b.pointreel"]}"#,
            "names the session",
        ),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }
    let label = r#"{"text": "a", "at": [0, 0, 0]}, "#.repeat(1001);
    let many = format!(
        r#"{{"pointreel_session": 1, "files": ["a"], "labels": [{}]}}"#,
        label.trim_end_matches(", ")
    );
    let error = read(&many).unwrap_err().to_string();
    assert!(error.contains("has 1001 labels: expected at most 1000"), "{error}");
    let long = BY_HAND.replace("knee", &"x".repeat(5000));
    assert_eq!(read(&long).unwrap().document.labels[0].text.len(), MAX_LABEL_CHARS);
}

#[test]
fn entries_of_other_versions_are_preserved_or_reported() {
    let text = BY_HAND
        .replace("\"frame\": 7", "\"frame\": 7, \"sound\": {\"volume\": [1, 2]}")
        .replace(
            "{\"primitive\"",
            "{\"sparkle\": 0.5, \"splat_scale\": \"large\", \"primitive\"",
        )
        .replace("\"text\": \"knee\"", "\"text\": \"knee\", \"hue\": 3");
    let ReadSession {
        document: session,
        warnings,
        ..
    } = read(&text).unwrap();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("the setting splat_scale"), "{warnings:?}");
    assert!(warnings[1].contains("`hue` of a label is not known"), "{warnings:?}");
    assert_eq!(
        session.settings.primitive,
        Primitive::Voxel,
        "the other settings are read"
    );
    let again = session.to_text(Path::new("/data/walk/walk.pointreel")).unwrap();
    assert!(again.contains(r#""volume": [1, 2]"#), "{again}");
    assert!(again.contains(r#""sparkle": 0.5"#), "{again}");
}

#[test]
fn a_session_moves_with_its_folder_and_is_replaced_atomically() {
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = ["before", "after"].map(|name| folder.path().join(name));
    fs::create_dir_all(before.join("scans")).unwrap();
    let file = before.join("walk.pointreel");
    let session = Document {
        inputs: vec![before.join("scans")],
        reading: Reading {
            poses: Some(before.join("poses.txt")),
            intrinsics: Some("500,500,320,240".to_owned()),
            ..Reading::default()
        },
        ..Document::default()
    };
    session.write(&file).unwrap();
    session.write(&file).unwrap();
    let names = fs::read_dir(&before).unwrap().map(|entry| entry.unwrap().file_name());
    assert_eq!(names.count(), 2, "nothing is left beside it");
    fs::rename(&before, &after).unwrap();
    let file = after.join("walk.pointreel");
    let read = session_of(std::slice::from_ref(&file)).unwrap().unwrap();
    assert_eq!(read.document.inputs, [after.join("scans")]);
    assert_eq!(read.document.reading.poses, Some(after.join("poses.txt")));
    assert_eq!(read.document.reading.intrinsics.as_deref(), Some("500,500,320,240"));
    // Other files are not sessions, nor is a folder with such a name.
    assert_eq!(session_of(&[after.join("scans")]).unwrap(), None);
    fs::create_dir(after.join("folder.pointreel")).unwrap();
    assert_eq!(session_of(&[after.join("folder.pointreel")]).unwrap(), None);
    let missing = session_of(&[after.join("gone.pointreel")]).unwrap_err().to_string();
    assert!(missing.contains("gone.pointreel cannot be read"), "{missing}");
    let unwritable = Document::default().write(&after.join("no/such/folder/a.pointreel"));
    assert!(unwritable.unwrap_err().to_string().contains("could not be saved"));
}

/// As a program wrote it before documents had trails, notes and an up axis.
const OF_VERSION_1: &str = include_str!("versions/1.pointreel");

#[test]
fn a_session_of_each_version_is_read() {
    let ReadSession { document, warnings, .. } = read(OF_VERSION_1).unwrap();
    assert_eq!(warnings, [""; 0]);
    assert_eq!(document.reading.topic.as_deref(), Some("/points"));
    assert_eq!((document.frame, document.reading.fps), (2, Some(12.5)));
    assert_eq!(
        document.view.map(|view| (view.up, view.distance)),
        Some((UpAxis::Z, 4.0))
    );
    assert_eq!((document.range.first(), document.range.last()), (Some(1), Some(9)));
    let counts = [
        document.markers.len(),
        document.labels.len(),
        document.measurements.len(),
    ];
    assert_eq!(counts, [1, 1, 1]);
    assert!(document.clip.is_some_and(|clip| clip.is_on));
    let compared = document.compare.as_ref().unwrap();
    assert_eq!(
        (compared.by, compared.layout),
        (Some(ComparedBy::Number), ComparedLayout::Line)
    );
    assert_eq!(
        (document.settings.primitive, document.settings.surfels.splat_scale),
        (Primitive::Voxel.into(), 1.25)
    );
    // Fields that it does not know have the values of a new document.
    let new = Document::new(Settings::default());
    assert_eq!((document.up, document.notes.as_str()), (new.up, ""));
    assert_eq!(document.trails, new.trails);
    let summary = document.summary(&new).join(", ");
    assert_eq!(
        summary,
        "view, look, clip, in and out point, 1 marker, 1 label, 1 measurement, second sequence"
    );
}

#[test]
fn looking_around_does_not_count_as_work() {
    let document = read(OF_VERSION_1).unwrap().document;
    let mut looked = document.clone();
    looked.frame = 7;
    looked.measurements[0].points[0].place = DVec3::ONE;
    assert!(looked.is_same_work(&document) && looked.is_stored_same(&document));
    looked.view = None;
    assert!(looked.is_same_work(&document) && !looked.is_stored_same(&document));
    looked.notes.push('a');
    assert!(!looked.is_same_work(&document));
}
