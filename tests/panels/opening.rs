//! Inputs that cannot be opened, and recently opened ones.

use super::menu::choose_item;
use super::walk::{FRAMES, load_all, options, sequence};
use super::{click, until, window, window_on};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{State, StateOptions};
use pointreel::sequence::{FrameEntry, Sequence};
use pointreel::source::Example;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

#[test]
fn a_single_broken_file_leaves_the_welcome_view_with_its_error() {
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("broken.ply");
    std::fs::write(&broken, "ply\nformat ascii 1.0\nelement vertex 2\nend_header\n").unwrap();
    let mut harness = window();
    harness.state_mut().open_paths(vec![broken.clone()]);
    until(&mut harness, "it cannot be shown", |state| state.player.is_none());
    let failed = harness.state().opening.failed.clone().unwrap();
    assert_eq!(failed.name, "broken.ply");
    assert!(failed.reason.contains("broken.ply"), "{failed:?}");
    assert!(harness.query_by_label(&failed.reason).is_some());
    assert!(harness.state().stored.recent.entries().is_empty(), "it was never shown");
    assert!(harness.state().notices.list().is_empty(), "said once");
    for button in ["Open files", "Open folder"] {
        assert!(harness.query_by_label_contains(button).is_some(), "{button}");
    }
    choose_item(&mut harness, "Play the demo");
    assert_eq!(harness.state().sequence_name().as_deref(), Some("demo"));
    assert!(harness.state().opening.failed.is_none());
}

#[test]
fn a_sequence_of_broken_files_is_one_as_well_and_one_good_frame_is_enough() {
    let all: Vec<u64> = (0..FRAMES as u64).collect();
    let mut harness = window_on(sequence(Vec::leak(all)), options());
    until(&mut harness, "all are broken", |state| state.player.is_none());
    assert!(harness.state().opening.failed.is_some());

    let but_one: Vec<u64> = (0..FRAMES as u64).filter(|&number| number != 7).collect();
    let mut harness = window_on(sequence(Vec::leak(but_one)), options());
    load_all(harness.state_mut());
    harness.run();
    assert!(harness.state().player.is_some());
}

#[test]
fn a_single_frame_has_its_name_and_no_playback_controls() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("alone.xyz");
    std::fs::write(&file, "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    let mut harness = window();
    let controls = ["Play", "Next frame", "Frame rate", "Reverse"];
    for control in controls {
        assert!(harness.query_by_label(control).is_some(), "{control}");
    }
    harness.state_mut().open_paths(vec![file]);
    until(&mut harness, "it is shown", |state| {
        !state.stored.recent.entries().is_empty()
    });
    let is_below = |name: &str| {
        let mut nodes = harness.query_all_by_label(name);
        nodes.any(|node| node.rect().top() > 700.0)
    };
    assert!(is_below("alone.xyz"));
    for control in controls {
        assert!(harness.query_by_label(control).is_none(), "{control}");
    }
}

#[test]
fn shown_inputs_are_listed_as_recent() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.xyz");
    std::fs::write(&whole, "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    let mut harness = window();
    harness.state_mut().open_paths(vec![whole.clone()]);
    until(&mut harness, "it is shown", |state| {
        !state.stored.recent.entries().is_empty()
    });
    assert_eq!(harness.state().stored.recent.entries(), [vec![whole]]);
    // In addition, one that does not exist, and one that is broken.
    let broken = folder.path().join("broken.ply");
    std::fs::write(&broken, "ply\n").unwrap();
    harness.state_mut().compare_paths(vec![broken]);
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_millis(300) {
        let now = harness.state().now();
        harness.state_mut().update(now);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(harness.state().stored.recent.entries().len(), 1);
}

#[test]
fn without_a_sequence_a_missing_path_is_reported_in_the_center() {
    let state = State::new(StateOptions::default());
    let mut harness = Harness::builder()
        .with_size([640.0, 480.0])
        .with_max_steps(20)
        .build_ui_state(
            |ui, state: &mut State| pointreel::app::panels::window_ui(ui, state),
            state,
        );
    assert!(harness.query_by_label("No sequence is open").is_some());
    harness.state_mut().open_paths(vec![PathBuf::from("/nowhere/at/all")]);
    until(&mut harness, "it is missing", |state| state.opening.failed.is_some());
    assert!(
        harness
            .query_by_label_contains("/nowhere/at/all cannot be shown")
            .is_some()
    );
    click(&mut harness, "Copy");
    let decoder = |_: &FrameEntry| Err("never".into());
    let one = Sequence::with_decoder(vec![FrameEntry::file("a.ply")], decoder);
    harness.state_mut().open(Arc::new(one));
    assert!(harness.state().opening.failed.is_none());
}

#[test]
fn recent_inputs_are_offered_with_thumbnails() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan.xyz");
    let rows: Vec<String> = (0..400)
        .map(|index| format!("{} {} 0", index % 20, index / 20))
        .collect();
    std::fs::write(&scan, rows.join("\n")).unwrap();
    let (recent, problem) = pointreel::app::Recent::load_from(&folder.path().join("recent.json"));
    assert_eq!(problem, None);
    let options = StateOptions {
        recent,
        preferences: pointreel::app::Preferences::default(),
        ..options()
    };
    let mut harness = window_on(sequence(&[]), options);
    harness.state_mut().open_paths(vec![scan.clone()]);
    let begin = Instant::now();
    let pictures = folder.path().join("recent");
    while !std::fs::read_dir(&pictures).is_ok_and(|mut files| files.next().is_some()) {
        assert!(begin.elapsed() < Duration::from_secs(30), "a picture is kept");
        let now = harness.state().now() + Duration::from_millis(20);
        harness.state_mut().update(now);
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    click(&mut harness, "File");
    choose_item(&mut harness, "Close");
    harness.run();
    assert!(harness.state().player.is_none());
    assert!(harness.query_by_label("No sequence is open").is_some());
    assert!(harness.query_by_label("find anything by its name").is_some());
    let name = scan.display().to_string();
    click(&mut harness, &name);
    until(&mut harness, "it is open again", |state| state.player.is_some());
    assert_eq!(harness.state().sequence_name().as_deref(), Some("scan.xyz"));
}

#[test]
fn examples_are_opened_by_a_click_and_can_be_in_a_session() {
    for example in Example::ALL {
        let state = State::new(options());
        let mut harness = Harness::builder()
            .with_size([1280.0, 800.0])
            .with_max_steps(20)
            .build_ui_state(
                |ui, state: &mut State| pointreel::app::panels::window_ui(ui, state),
                state,
            );
        click(&mut harness, &format!("Example: {}", example.title()));
        until(&mut harness, "it is not shown", |state| {
            state.player.as_ref().is_some_and(|player| player.shown().is_some())
        });
        let state = harness.state();
        assert_eq!(state.sequence_name(), Some(example.input()));
        assert!(state.stored.recent.entries().is_empty(), "it is in the menu");
        assert_eq!(state.session().unwrap().inputs, [PathBuf::from(example.input())]);
    }
}

#[test]
fn program_information_can_be_copied() {
    let mut harness = window();
    click(&mut harness, "Help");
    choose_item(&mut harness, "About pointreel");
    harness.run();
    let text = super::points::copied(&mut harness, "Copy for a report");
    assert!(text.contains(concat!("Version: ", env!("CARGO_PKG_VERSION"))), "{text}");
    for line in ["System: ", "Adapter: ", "Settings: ", "Open: walk, 24 frames, 8 points"] {
        assert!(text.contains(line), "{line} in {text}");
    }
}
