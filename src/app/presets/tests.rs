//! The file of presets: retained values, and the handling of unreadable ones.

use super::*;
use crate::levels::{Lod, LodMetric};
use crate::scene::{
    Antialiasing, BackFaces, Backdrop, Background, Choice, CodeStyle, DrawingSettings, Environment, EstimationStyle,
    Footprint, LevelStructure, LevelStyle, LightSettings, Lighting, NormalBits, OffsetBits, OnOff, PhotoStyle,
    PointStyle, RendererChoice, Splatting, Strategy, SurfelSettings, VoxelLight, VoxelStyle,
};
use crate::sequence::{ColorSource, Coloring};

/// As version 0.1 wrote it when nothing was by default, and cut short.
const OF_VERSION_1: &str = r#"{
  "version": 1,
  "presets": [
    {
      "name": "day",
      "settings": {
        "primitive": "voxel",
        "renderer": "cpu",
        "splatting": "no-depth",
        "strategy": "compute",
        "splat_scale": 1.25,
        "enlargement": 3.5,
        "cull_back_faces": false,
        "lighting": "vertex",
        "background": {
          "top": [1, 2, 250],
          "bottom": [0, 16, 255]
        },
        "colors": "scalar",
        "point_size_px": 7.0,
        "stop": {
          "loss": 0.31
        },
        "lod": {
          "threshold_px": 2.5
        },
        "surfel_lod": true,
        "resolution": 0.5,
        "footprint": "masks",
        "normal_bits": "15",
        "offset_bits": "2"
      }
    }
  ]
}"#;

fn of_version_1() -> Settings {
    Settings {
        primitive: Primitive::Voxel.into(),
        colors: Coloring::of(ColorSource::Scalar(None)),
        surfels: SurfelSettings {
            splatting: Splatting::NoDepth,
            splat_scale: 1.25,
            enlargement: 3.5,
            back_faces: BackFaces::Drawn.into(),
            ..SurfelSettings::default()
        },
        points: PointStyle {
            size_px: 7.0,
            ..PointStyle::default()
        },
        voxels: VoxelStyle {
            // The file predates this setting.
            light: VoxelLight::Normals,
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
            // The file predates this setting.
            block_nodes: 48.0,
        },
        light: LightSettings {
            lighting: Lighting::PerVertex.into(),
            rig: Choice::Auto,
            metallic: 0.0,
            roughness: 0.5,
            environment: Environment::Studio,
            shadows: OnOff::Off,
            ao: OnOff::Off,
            ao_strength: 1.0,
            ao_radius: 1.0,
            eye_dome: Choice::Auto,
            eye_dome_strength: 1.0,
            gamma: 1.0,
        },
        photos: PhotoStyle::default(),
        estimation: EstimationStyle::default(),
        backdrop: Backdrop {
            grid: false,
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
            antialiasing: Antialiasing::None,
        },
    }
}

/// Presets read from `text` in its own file, next to its copies in the folder.
fn read_of(text: &str) -> (tempfile::TempDir, Presets) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("presets.json");
    std::fs::write(&file, text).unwrap();
    let presets = Presets::load_from(&file);
    (folder, presets)
}

#[test]
fn presets_are_stored_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("presets.json");
    let mut presets = Presets::load_from(&file);
    let [(_, _, fast), (_, _, exact), ..] = built_in();
    presets.save("night", fast).unwrap();
    presets.save(" day ", exact).unwrap();
    presets.save("night", exact).unwrap();
    assert!(presets.save("  ", fast).is_err());
    let names: Vec<_> = presets.list().iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["day", "night"]);
    assert_eq!(presets.list()[1].settings, exact);
    assert_eq!(Presets::load_from(&file), presets);
    presets.delete("day").unwrap();
    assert_eq!(Presets::load_from(&file).list().len(), 1);
}

#[test]
fn files_of_version_1_keep_their_meaning() {
    let (_folder, presets) = read_of(OF_VERSION_1);
    assert_eq!(presets.problem(), None);
    let expected = Preset {
        name: "day".to_owned(),
        settings: of_version_1(),
    };
    assert_eq!(presets.list(), [expected]);
}

#[test]
fn each_value_is_read_independently() {
    let whole = of_version_1();
    let default = Settings::default();
    let scale = |splat_scale| whole.with(|style| style.surfels.splat_scale = splat_scale);
    let cases = [
        ("\"splat_scale\": 1.25,", "", scale(1.0), true),
        ("1.25,", "1.25, \"of later\": {\"a\": 1},", whole, true),
        ("1.25", "1e9", scale(10.0), true),
        ("1.25", "\"big\"", scale(1.0), false),
        (
            "\"voxel\"",
            "\"cone\"",
            Settings {
                primitive: default.primitive,
                ..whole
            },
            false,
        ),
        (
            "\"threshold_px\"",
            "\"of later\"",
            whole.with(|style| style.levels.lod = default.levels.lod),
            false,
        ),
        ("\"version\": 1", "\"version\": 2", whole, false),
    ];
    for (from, to, settings, is_whole) in cases {
        let changed = OF_VERSION_1.replacen(from, to, 1);
        assert_ne!(changed, OF_VERSION_1, "{from}");
        let (folder, presets) = read_of(&changed);
        let read: Vec<Settings> = presets.list().iter().map(|p| p.settings).collect();
        assert_eq!(read, [settings], "{to}");
        assert_eq!(presets.problem().is_none(), is_whole, "{to}");
        let files = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(files, if is_whole { 1 } else { 2 }, "{to}");
    }
}

#[test]
fn unreadable_files_are_backed_up_before_being_overwritten() {
    for damaged in [
        OF_VERSION_1.replacen('{', "", 1),
        OF_VERSION_1.replace("\"day\"", "\"\""),
        OF_VERSION_1.replace("\"settings\"", "\"set\""),
        OF_VERSION_1
            .replace("\"presets\": [", "\"presets\": [7,")
            .replace("\"day\"", "3"),
        "{\"presets\": {}}".to_owned(),
    ] {
        let (folder, mut presets) = read_of(&damaged);
        assert!(presets.list().is_empty(), "{damaged}");
        assert!(presets.problem().unwrap().contains("presets.json.unreadable"));
        presets.save("new", Settings::default()).unwrap();
        let copy = std::fs::read_to_string(folder.path().join("presets.json.unreadable"));
        assert_eq!(copy.unwrap(), damaged);
        assert_eq!(Presets::load_from(&folder.path().join("presets.json")).list().len(), 1);
    }
}

#[test]
fn hand_written_lists_are_sorted() {
    let entry = |name: &str| format!(r#"{{"name": "{name}", "settings": {{}}}}"#);
    let list = [entry("b"), entry(" a "), entry("b"), entry(&"c".repeat(80))].join(",");
    let (_folder, presets) = read_of(&format!(r#"{{"presets": [{list}]}}"#));
    let names: Vec<_> = presets.list().iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["a", "b", &"c".repeat(60)]);
    assert!(presets.problem().unwrap().contains("`b` is there twice"));
}

#[test]
fn built_in_presets_are_offered() {
    for (name, _, settings) in built_in() {
        assert_eq!(settings.nearest(), settings, "{name}");
    }
}
