//! The file of preferences: retained values, and the handling of unreadable ones.

use super::*;
use crate::analysis::ColorMap;
use crate::levels::octree::StopCriterion;
use crate::levels::{Lod, LodMetric};
use crate::scene::{
    Antialiasing, BackFaces, Backdrop, Background, Choice, CodeStyle, DrawingSettings, Environment, EstimationStyle,
    EyeDome, Footprint, Kernel, LevelStructure, LevelStyle, LightRig, LightSettings, Lighting, NormalBits, NormalFit,
    NormalSource, OffsetBits, OnOff, PhotoClipping, PhotoGains, PhotoHoles, PhotoMode, PhotoRelight, PhotoStyle,
    PointLight, PointShape, PointSizing, PointStyle, Primitive, RendererChoice, SplatFilter, SplatGeometry, Splatting,
    Strategy, SurfelColors, SurfelSettings, VisibilityShape, VoxelLight, VoxelStyle,
};
use crate::sequence::{ColorRange, ColorSource, Coloring, FieldName};
use proptest::prelude::{Just, prop, prop_assert_eq, prop_oneof, proptest};
use std::fs;

/// Nothing in it is as in a new window.
fn unusual() -> Preferences {
    Preferences {
        settings: Settings {
            primitive: Primitive::Voxel.into(),
            colors: Coloring::of(ColorSource::Scalar(None)),
            surfels: SurfelSettings {
                splatting: Splatting::NoDepth,
                filter: SplatFilter::Ewa,
                geometry: SplatGeometry::Triangle,
                kernel: Kernel::Hat,
                rims: OnOff::Off,
                visibility_shape: VisibilityShape::Square,
                normals: NormalSource::Screen,
                shown: SurfelColors::NormalErrors,
                splat_scale: 1.25,
                enlargement: 3.5,
                depth_offset: 0.5,
                back_faces: BackFaces::Drawn.into(),
            },
            points: PointStyle {
                sizing: PointSizing::Adaptive,
                size_px: 7.0,
                scale: 1.5,
                shape: PointShape::Disk,
                light: PointLight::Normals,
            },
            voxels: VoxelStyle {
                light: VoxelLight::Faces,
            },
            levels: LevelStyle {
                stop: StopCriterion::Loss(0.31),
                lod: Lod::ThresholdPx(2.5),
                surfel_lod: true,
                structure: LevelStructure::Octree,
                metric: LodMetric::Edge,
            },
            codes: CodeStyle {
                footprint: Footprint::Masks,
                normal_bits: NormalBits::Fifteen,
                offset_bits: OffsetBits::Two,
                block_nodes: 96.0,
            },
            light: LightSettings {
                lighting: Lighting::PerVertex.into(),
                rig: LightRig::ThreePoint.into(),
                metallic: 1.0,
                roughness: 0.25,
                environment: Environment::Sky,
                shadows: OnOff::On,
                ao: OnOff::On,
                ao_strength: 0.5,
                ao_radius: 2.0,
                eye_dome: EyeDome::On.into(),
                eye_dome_strength: 2.5,
                gamma: 1.5,
            },
            photos: PhotoStyle {
                gaps: 1.0,
                mode: PhotoMode::Single,
                views: 2.0,
                angle: 2.5,
                clipping: PhotoClipping::Paper,
                holes: PhotoHoles::Left,
                relight: PhotoRelight::DepthOnly,
                gains: PhotoGains::Off,
            },
            estimation: EstimationStyle {
                neighbours: 24.0,
                fit: NormalFit::Robust,
                smoothing: 3.0,
            },
            backdrop: Backdrop {
                grid: true,
                background: Background {
                    top: [1, 2, 250],
                    bottom: [0, 16, 255],
                },
            },
            clip: None,
            drawing: DrawingSettings {
                renderer: RendererChoice::Cpu.into(),
                strategy: Strategy::Compute,
                resolution: 0.5,
                antialiasing: Antialiasing::Supersample,
            },
        },
        present: PresentChoice::Cpu,
        loop_mode: LoopMode::PingPong,
        speed: 0.25,
        panels: RememberedPanels {
            settings: false,
            statistics: true,
            ..RememberedPanels::default()
        },
        thumbnails: false,
        scale_bar: false,
        theme: ThemePreference::Light,
        window_size: Some([900.0, 700.0]),
        advanced: true,
        benchmark_place: Some([10.0, 40.0, 470.0, 500.0]),
    }
}

/// As the first program of version 6 wrote it, which had no [`PresentChoice`], no [`VoxelLight`], no [`LightRig`], no
/// eye-dome lighting, no grid, no scale bar, no advanced settings and no place of the benchmarks' window; nothing in it
/// is by default.
const OF_VERSION_6: &str = include_str!("versions/6.json");

/// Preferences of [`OF_VERSION_6`].
fn of_version_6() -> Preferences {
    let unusual = unusual();
    Preferences {
        settings: unusual.settings.with(|style| {
            style.surfels.filter = SplatFilter::Off;
            style.surfels.geometry = SplatGeometry::Quad;
            style.surfels.kernel = Kernel::Gaussian;
            style.surfels.rims = OnOff::On;
            style.surfels.normals = NormalSource::Neighbours;
            style.surfels.shown = SurfelColors::Points;
            style.surfels.depth_offset = 1.0;
            style.surfels.visibility_shape = VisibilityShape::Disk;
            style.codes.block_nodes = 48.0;
            style.voxels.light = VoxelLight::Normals;
            style.light.rig = Choice::Auto;
            style.light.metallic = 0.0;
            style.light.roughness = 0.5;
            style.light.environment = Environment::Studio;
            style.drawing.antialiasing = Antialiasing::None;
            style.light.shadows = OnOff::Off;
            style.light.ao = OnOff::Off;
            style.light.ao_strength = 1.0;
            style.light.ao_radius = 1.0;
            style.light.eye_dome = Choice::Auto;
            style.light.eye_dome_strength = 1.0;
            style.light.gamma = 1.0;
            style.backdrop.grid = false;
            style.photos = PhotoStyle::default();
            style.estimation = EstimationStyle::default();
            style.points = PointStyle {
                size_px: style.points.size_px,
                ..PointStyle::default()
            };
        }),
        present: PresentChoice::Auto,
        scale_bar: true,
        advanced: false,
        benchmark_place: None,
        ..unusual
    }
}

/// Preferences read from a text, and true if all of it could be read.
fn of_text(text: &str) -> (Preferences, bool) {
    let mut unread = Vec::new();
    let stored: Fields = serde_json::from_str(text).unwrap();
    let preferences = Preferences::of(&stored, &mut unread);
    (preferences, unread.is_empty())
}

/// Preferences after writing and reading.
fn again(preferences: Preferences) -> (Preferences, bool) {
    of_text(&Value::Object(preferences.to_fields()).to_string())
}

fn at(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

/// Starts from `first`, changes to `then` and writes the file.
fn write(file: &Path, first: Preferences, then: Preferences) {
    let (mut stored, _) = PreferencesFile::load_from(file);
    stored.note(first, at(0));
    stored.note(then, at(1));
    stored.write();
}

#[test]
fn all_choices_round_trip() {
    assert_eq!(unusual().offered(), unusual(), "what the window offers is left alone");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("not yet/settings.json");
    assert_eq!(PreferencesFile::load_from(&file).1, Preferences::default());
    write(&file, Preferences::default(), unusual());
    assert_eq!(PreferencesFile::load_from(&file).1, unusual());
    for (colors, loop_mode) in ColorSource::ALL.into_iter().zip(LoopMode::ALL.into_iter().cycle()) {
        let mut preferences = unusual();
        preferences.settings.colors = Coloring::of(colors);
        preferences.loop_mode = loop_mode;
        assert_eq!(again(preferences), (preferences, true));
    }
}

/// Preferences of the files in `versions`: one of each version, as its first program wrote it with no value at its
/// default, and one of the last program whose settings had no groups. Each lacks the fields of later ones.
fn of_versions() -> [(&'static str, Preferences); 7] {
    let usual = Preferences::default();
    let last = Preferences {
        settings: unusual().settings.with(|style| {
            style.surfels = SurfelSettings {
                back_faces: BackFaces::Darker.into(),
                ..of_version_6().settings.surfels
            };
            style.colors = Coloring {
                source: ColorSource::Scalar(Some(FieldName::new("intensity"))),
                map: ColorMap::Turbo,
                range: ColorRange::Fixed { low: 3.0, high: 7.0 },
                is_logarithmic: true,
                one_color: [9, 8, 7],
            };
            style.points = of_version_6().settings.points;
            style.codes = of_version_6().settings.codes;
            style.drawing = of_version_6().settings.drawing;
            style.photos = PhotoStyle::default();
            style.estimation = EstimationStyle::default();
            style.light = LightSettings {
                eye_dome: style.light.eye_dome,
                eye_dome_strength: style.light.eye_dome_strength,
                ..of_version_6().settings.light
            };
        }),
        advanced: false,
        benchmark_place: None,
        ..unusual()
    };
    let sixth = of_version_6();
    let mut fifth = sixth;
    fifth.thumbnails = usual.thumbnails;
    fifth.theme = usual.theme;
    let mut fourth = fifth;
    fourth.settings.drawing.resolution = usual.settings.drawing.resolution;
    fourth.settings.codes = usual.settings.codes;
    let mut third = fourth;
    third.settings.drawing.renderer = usual.settings.drawing.renderer;
    let mut second = third;
    second.settings.levels.surfel_lod = usual.settings.levels.surfel_lod;
    // No later version has read its fields `delta` and `lod_px`.
    let mut first = second;
    first.settings.levels = usual.settings.levels;
    [
        (include_str!("versions/1.json"), first),
        (include_str!("versions/2.json"), second),
        (include_str!("versions/3.json"), third),
        (include_str!("versions/4.json"), fourth),
        (include_str!("versions/5.json"), fifth),
        (OF_VERSION_6, sixth),
        (include_str!("versions/6-ungrouped.json"), last),
    ]
}

#[test]
fn files_of_every_version_keep_their_meaning() {
    for (text, expected) in of_versions() {
        assert_eq!(of_text(text), (expected, true), "{text}");
    }
}

#[test]
fn every_name_of_version_6_is_still_valid() {
    let mut stored: Fields = serde_json::from_str(OF_VERSION_6).unwrap();
    let written = serde_json::to_value(unusual()).unwrap();
    stored.remove("version");
    for (name, value) in &stored {
        assert!(written.get(name).is_some(), "{name} has another name now");
        // Each on its own, so that none is read from another.
        let alone = serde_json::json!({ name: value }).to_string();
        let (read, is_whole) = of_text(&alone);
        assert!(is_whole && read != Preferences::default(), "{alone}");
    }
}

proptest! {
    #[test]
    fn all_values_accepted_on_the_command_line_are_read_back(
        sizes in prop::array::uniform4(prop_oneof![0f32..50.0, 0f32..=f32::MAX, Just(f32::INFINITY)]),
        speed_percent in 0u32..100_000,
        is_time: bool,
        depth in 0u32..40,
        window_size in prop::option::of(prop::array::uniform2(0f64..1e5)),
    ) {
        let speed = f64::from(speed_percent) / 100.0;
        let mut preferences = Preferences { speed, window_size, ..unusual() };
        let [splat_scale, enlargement, point_size_px, size] = sizes;
        let lod = if is_time { Lod::FrameTimeMs(size) } else { Lod::ThresholdPx(size) };
        let stop = StopCriterion::Depth(depth);
        let style = &mut preferences.settings;
        style.surfels = SurfelSettings { splat_scale, enlargement, ..style.surfels };
        style.points.size_px = point_size_px;
        style.levels = LevelStyle { stop, lod, ..style.levels };
        let offered = preferences.offered();
        prop_assert_eq!(again(offered), (offered, true));
        prop_assert_eq!(offered.offered(), offered);
    }
}

#[test]
fn each_value_is_read_independently() {
    let whole = of_version_6();
    let default = Preferences::default();
    let with = |change: fn(&mut Settings)| {
        let mut preferences = whole;
        change(&mut preferences.settings);
        preferences
    };
    let theme = default.theme;
    let window_size = None;
    let speed = MIN_SPEED;
    let cases = [
        // Missing, or from a later version of the program.
        ("\"theme\": \"light\",", "", Preferences { theme, ..whole }, true),
        ("\"version\": 6", "\"version\": 5", whole, true),
        ("\"version\": 6,", "", whole, true),
        ("\"version\": 6,", "\"of later\": 6,", whole, true),
        ("\"version\": 6", "\"version\": 7", whole, false),
        // Not an offered value: the nearest one is used.
        ("0.31", "0.61", with(|s| s.levels.stop = StopCriterion::Loss(0.6)), true),
        (
            "0.31",
            "-1e39",
            with(|s| s.levels.stop = StopCriterion::Loss(0.0)),
            true,
        ),
        ("2.5", "-2.5", with(|s| s.levels.lod = Lod::ThresholdPx(0.0)), true),
        ("0.25", "0.0", Preferences { speed, ..whole }, true),
        ("900.0", "1e9", Preferences { window_size, ..whole }, true),
        // Unknown.
        ("\"voxel\"", "\"cone\"", with(|s| s.primitive = Choice::Auto), false),
        (
            "\"scalar\"",
            "\"sound\"",
            with(|s| s.colors = Coloring::default()),
            false,
        ),
        ("\"light\"", "\"bright\"", Preferences { theme, ..whole }, false),
        (
            "\"loss\"",
            "\"gain\"",
            with(|s| s.levels.stop = StopCriterion::default()),
            false,
        ),
        (
            "\"#0102fa",
            "\"0102fa",
            with(|s| s.backdrop.background = Background::default()),
            false,
        ),
        ("900.0", "\"wide\"", Preferences { window_size, ..whole }, false),
    ];
    for (from, to, expected, is_whole) in cases {
        let changed = OF_VERSION_6.replacen(from, to, 1);
        assert_ne!(changed, OF_VERSION_6, "{from}");
        assert_eq!(of_text(&changed), (expected, is_whole), "{from} → {to}");
    }
}

#[test]
fn unreadable_files_are_backed_up_before_being_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.json");
    let half = &OF_VERSION_6[..OF_VERSION_6.len() / 2];
    let copies = ["settings.json.unreadable", "settings.json.unreadable-2"];
    for (damaged, copy) in ["[]", half].into_iter().zip(copies) {
        fs::write(&file, damaged).unwrap();
        let (stored, preferences) = PreferencesFile::load_from(&file);
        assert_eq!(preferences, Preferences::default(), "{damaged}");
        assert!(stored.problem().unwrap().contains(copy));
        write(&file, preferences, unusual());
        assert_eq!(PreferencesFile::load_from(&file).1, unusual());
        assert_eq!(fs::read_to_string(folder.path().join(copy)).unwrap(), damaged);
    }
}

#[test]
fn entries_of_later_versions_are_preserved() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.json");
    let later = OF_VERSION_6.replacen('{', "{\"of later\": {\"a\": [1, 2.5]},", 1);
    fs::write(&file, later).unwrap();
    let (stored, preferences) = PreferencesFile::load_from(&file);
    assert_eq!(stored.problem(), None);
    write(&file, preferences, unusual());
    assert_eq!(PreferencesFile::load_from(&file).1, unusual());
    let written: Fields = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    assert_eq!(written["of later"], serde_json::json!({ "a": [1, 2.5] }));
}

#[test]
fn two_windows_do_not_undo_each_others_changes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.json");
    fs::write(&file, r#"{"version": 6, "speed": 2.0, "of later": 1}"#).unwrap();
    let mut windows = [(); 2].map(|()| PreferencesFile::load_from(&file));
    for (stored, begun) in &mut windows {
        stored.note(*begun, at(0));
    }
    let [(mut first, mut in_first), (mut second, mut in_second)] = windows;
    in_first.settings.levels.stop = StopCriterion::Loss(0.25);
    in_first.scale_bar = false;
    in_second.loop_mode = unusual().loop_mode;
    in_second.settings.drawing.resolution = 0.5;
    first.note(in_first, at(1));
    second.note(in_second, at(1));
    first.write();
    second.write();
    // A window writes only its own changes.
    in_first.speed = 0.5;
    first.note(in_first, at(5));
    first.write();
    let (_, read) = PreferencesFile::load_from(&file);
    let mut expected = in_first;
    expected.loop_mode = in_second.loop_mode;
    expected.settings.drawing.resolution = 0.5;
    assert_eq!(read, expected);
    let written: Fields = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    assert_eq!(written["of later"], 1);
}

#[test]
fn a_file_damaged_meanwhile_is_backed_up_before_being_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.json");
    let (mut stored, begun) = PreferencesFile::load_from(&file);
    stored.note(begun, at(0));
    let later = r#"{"version": 99, "speed": "of later"}"#;
    fs::write(&file, later).unwrap();
    stored.note(unusual(), at(1));
    stored.write();
    assert_eq!(PreferencesFile::load_from(&file).1, unusual());
    let copy = folder.path().join("settings.json.unreadable");
    assert_eq!(fs::read_to_string(copy).unwrap(), later);
}

#[test]
fn changes_are_written_once_they_have_settled() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.json");
    let (mut stored, begun) = PreferencesFile::load_from(&file);
    stored.note(begun, at(0));
    assert_eq!(stored.next_deadline(), None);
    stored.write();
    assert!(!file.exists(), "nothing was changed");

    let mut dragged = begun;
    for (seconds, delta) in [(10, 0.1), (11, 0.2), (12, 0.3)] {
        dragged.settings.levels.stop = StopCriterion::Loss(delta);
        stored.note(dragged, at(seconds));
        assert_eq!(stored.next_deadline(), Some(at(seconds) + WRITE_DELAY));
    }
    stored.note(dragged, at(13));
    assert_eq!(stored.next_deadline(), Some(at(12) + WRITE_DELAY), "unchanged since");
    stored.write_if_due(at(12));
    assert!(!file.exists(), "too early");
    stored.write_if_due(at(13));
    assert_eq!(PreferencesFile::load_from(&file).1, dragged);
    assert_eq!(stored.next_deadline(), None);

    // A change that is reverted does not count.
    stored.note(unusual(), at(20));
    stored.note(dragged, at(20));
    assert_eq!(stored.next_deadline(), None);
}

#[test]
fn failed_writes_are_not_retried() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let (mut stored, begun) = PreferencesFile::load_from(&folder.path().join("file/settings.json"));
    stored.note(begun, at(0));
    stored.note(unusual(), at(1));
    stored.write_if_due(at(9));
    assert_eq!(stored.next_deadline(), None);
    // Without a file nothing is ever due.
    let mut nowhere = PreferencesFile::default();
    nowhere.note(begun, at(0));
    nowhere.note(unusual(), at(1));
    assert_eq!(nowhere.next_deadline(), None);
}
