//! The file of preferences: what is kept, and what is left aside.

use super::*;
use crate::scene::{
    Footprint, Lighting, NormalBits, OffsetBits, Primitive, RendererChoice, Splatting, Strategy,
};
use proptest::prelude::{Just, prop, prop_assert_eq, prop_oneof, proptest};
use std::fs;

/// Nothing in it is as in a new window.
fn unusual() -> Preferences {
    Preferences {
        settings: Settings {
            primitive: Primitive::Voxel,
            renderer: RendererChoice::Cpu,
            splatting: Splatting::NoDepth,
            strategy: Strategy::Compute,
            splat_scale: 1.25,
            enlargement: 3.5,
            cull_back_faces: false,
            lighting: Lighting::PerVertex,
            background: Background {
                top: [1, 2, 250],
                bottom: [0, 16, 255],
            },
            colors: ColorSource::Scalar,
            point_size_px: 7.0,
            stop: StopCriterion::Loss(0.31),
            lod: Lod::ThresholdPx(2.5),
            surfel_lod: true,
            resolution: 0.5,
            footprint: Footprint::Masks,
            normal_bits: NormalBits::Fifteen,
            offset_bits: OffsetBits::Two,
            clip: None,
        },
        loop_mode: LoopMode::PingPong,
        speed: 0.25,
        panels: OpenPanels {
            settings: false,
            statistics: true,
            ..OpenPanels::default()
        },
        thumbnails: false,
        theme: ThemePreference::Light,
        window_size: Some([900.0, 700.0]),
    }
}

fn at(seconds: u64) -> Duration {
    Duration::from_secs(seconds)
}

/// Begins with `first`, is told of `then` and written.
fn write(file: &Path, first: Preferences, then: Preferences) {
    let (mut kept, _) = PreferencesFile::load_from(file.to_owned());
    kept.note(first, at(0));
    kept.note(then, at(1));
    kept.write();
}

#[test]
fn all_choices_survive() {
    assert_eq!(
        unusual().offered(),
        unusual(),
        "what the window offers is left alone"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("not yet/settings.json");
    assert_eq!(
        PreferencesFile::load_from(file.clone()).1,
        Preferences::default()
    );
    write(&file, Preferences::default(), unusual());
    assert_eq!(PreferencesFile::load_from(file).1, unusual());
    for (colors, loop_mode) in ColorSource::ALL
        .into_iter()
        .zip(LoopMode::ALL.into_iter().cycle())
    {
        let mut preferences = unusual();
        preferences.settings.colors = colors;
        preferences.loop_mode = loop_mode;
        let json = preferences.to_json().unwrap();
        assert_eq!(Preferences::from_json(&json), Ok(preferences));
    }
}

#[test]
fn files_from_before_there_was_a_theme_are_read() {
    let json = String::from_utf8(unusual().to_json().unwrap()).unwrap();
    let before = json.replace("  \"theme\": \"light\",\n", "");
    assert_ne!(before, json);
    let expected = Preferences {
        theme: ThemePreference::System,
        ..unusual()
    };
    assert_eq!(Preferences::from_json(before.as_bytes()), Ok(expected));
}

proptest! {
    #[test]
    fn whatever_the_command_line_lets_through_is_read_again(
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
        preferences.settings = Settings { splat_scale, enlargement, point_size_px, stop, lod, ..preferences.settings };
        let offered = preferences.offered();
        prop_assert_eq!(Preferences::from_json(&offered.to_json().unwrap()), Ok(offered));
        prop_assert_eq!(offered.offered(), offered);
    }
}

#[test]
fn what_cannot_be_used_is_left_aside_and_written_anew() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.json");
    let good = String::from_utf8(unusual().to_json().unwrap()).unwrap();
    assert!(Preferences::from_json(good.as_bytes()).is_ok());
    let damaged = [
        String::new(),
        "{".to_owned(),
        "[]".to_owned(),
        good[..good.len() / 2].to_owned(),
        good.replace("\"version\": 6", "\"version\": 5"),
        good.replace("\"version\": 6,", ""),
        good.replace("\"voxel\"", "\"cone\""),
        good.replace("\"scalar\"", "\"sound\""),
        good.replace("\"light\"", "\"bright\""),
        good.replace("0.31", "0.61"),
        good.replace("0.31", "-1e39"),
        good.replace("0.25", "0.0"),
        good.replace("900.0", "1e9"),
        good.replace("\"loss\"", "\"gain\""),
        good.replace("2.5", "-2.5"),
    ];
    for damaged in damaged {
        assert_ne!(damaged, good, "nothing was damaged");
        fs::write(&file, &damaged).unwrap();
        assert!(read(&file).is_err(), "{damaged}");
        let (_, preferences) = PreferencesFile::load_from(file.clone());
        assert_eq!(preferences, Preferences::default(), "{damaged}");
        write(&file, preferences, unusual());
        assert_eq!(read(&file), Ok(unusual()));
    }
}

#[test]
fn a_change_is_written_once_it_has_settled() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("settings.json");
    let (mut kept, begun) = PreferencesFile::load_from(file.clone());
    kept.note(begun, at(0));
    assert_eq!(kept.next_deadline(), None);
    kept.write();
    assert!(!file.exists(), "nothing was changed");

    let mut dragged = begun;
    for (seconds, delta) in [(10, 0.1), (11, 0.2), (12, 0.3)] {
        dragged.settings.stop = StopCriterion::Loss(delta);
        kept.note(dragged, at(seconds));
        assert_eq!(kept.next_deadline(), Some(at(seconds) + WRITE_DELAY));
    }
    kept.note(dragged, at(13));
    assert_eq!(
        kept.next_deadline(),
        Some(at(12) + WRITE_DELAY),
        "unchanged since"
    );
    kept.write_if_due(at(12));
    assert!(!file.exists(), "too early");
    kept.write_if_due(at(13));
    assert_eq!(read(&file), Ok(dragged));
    assert_eq!(kept.next_deadline(), None);

    // There and back again is no change.
    kept.note(unusual(), at(20));
    kept.note(dragged, at(20));
    assert_eq!(kept.next_deadline(), None);
}

#[test]
fn what_cannot_be_written_is_tried_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let (mut kept, begun) = PreferencesFile::load_from(folder.path().join("file/settings.json"));
    kept.note(begun, at(0));
    kept.note(unusual(), at(1));
    kept.write_if_due(at(9));
    assert_eq!(kept.next_deadline(), None);
    // Without a file nothing is ever due.
    let mut nowhere = PreferencesFile::default();
    nowhere.note(begun, at(0));
    nowhere.note(unusual(), at(1));
    assert_eq!(nowhere.next_deadline(), None);
}
