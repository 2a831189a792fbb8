//! Sessions in the window: saved, opened again by another one, listed, and refused.

use super::{options, press, sequence, until, window, window_on};
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;
use pointreel::app::{Command, PanelId, State, StateOptions};
use pointreel::document::{DocumentFolder, ReadSession};
use pointreel::playback::PairBy;
use pointreel::scene::{Clip, ClipShape, FollowedPoint, Label, Primitive, UpAxis};
use pointreel::timeline::PlayRange;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn shown(state: &State) -> Option<usize> {
    Some(state.player.as_ref()?.shown()?.index)
}

/// A cube of points in a file, three times as large in the second.
fn scans(folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for (name, size) in [("a1.xyz", 1), ("a2.xyz", 3), ("a3.xyz", 9)] {
        let corners = (0..8).map(|corner| {
            let [x, y, z] = [0, 1, 2].map(|axis| size * (corner >> axis & 1));
            format!("{x} {y} {z}\n")
        });
        fs::write(folder.join(name), corners.collect::<String>()).unwrap();
    }
}

fn open(harness: &mut Harness<'_, State>, path: &Path) {
    harness.state_mut().open_paths(vec![path.to_owned()]);
    let before = harness
        .state()
        .player
        .as_ref()
        .map(|player| Arc::as_ptr(player.sequence()));
    until(harness, "it is not opened", |state| {
        let now = state.player.as_ref().map(|player| Arc::as_ptr(player.sequence()));
        now != before && shown(state).is_some() && state.has_looked()
    });
}

/// A window on scans with something of everything that a session holds.
fn worked_on(folder: &Path) -> Harness<'static, State> {
    scans(&folder.join("scans"));
    let mut harness = window();
    open(&mut harness, &folder.join("scans"));
    let state = harness.state_mut();
    state.style.primitive = Primitive::Point.into();
    state.style.points.size_px = 5.0;
    state.style.clip = Some(Clip::to(ClipShape::Box {
        min: DVec3::ZERO,
        max: DVec3::splat(2.5),
    }));
    state.camera.up = UpAxis::Z;
    state.camera.azimuth_deg = 33.0;
    for command in [
        Command::ADD_KEYFRAME,
        Command::NEXT_FRAME,
        Command::TOGGLE_MARKER,
        Command::SET_IN,
    ] {
        state.run(command);
    }
    state.panels.set(PanelId::CAMERA_PATH, false);
    let label = Label {
        text: "corner".to_owned(),
        frame: 1,
        point: Some(FollowedPoint {
            index_in_file: 7,
            points_in_file: Some(8),
        }),
        place: Some(DVec3::splat(3.0)),
        frames: PlayRange::default(),
    };
    state.features.labels.list = Arc::new(vec![label]);
    harness.run();
    harness
}

fn save(harness: &mut Harness<'_, State>, file: &Path) {
    harness.state_mut().save_session_to(file.to_owned());
    until(harness, "it is not saved", |state| state.session_file().is_some());
}

#[test]
fn a_session_is_restored_as_it_was_left() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.pointreel");
    let mut left = worked_on(folder.path());
    assert!(!left.state_mut().may_close(), "the camera path would be lost");
    left.state_mut().run(Command::ESCAPE);
    save(&mut left, &file);
    assert!(left.state_mut().may_close(), "it is in the session");
    assert_eq!(left.state().stored.recent.entries()[0], std::slice::from_ref(&file));

    let mut taken = window();
    let usual = taken.state().style;
    open(&mut taken, &file);
    let (left, state) = (left.state(), taken.state());
    assert_eq!(state.style, left.style);
    assert_eq!(state.camera, left.camera);
    assert_eq!(state.features.labels.list, left.features.labels.list);
    assert_eq!(state.features.path.draft, left.features.path.draft);
    assert_eq!(state.features.timeline.markers, left.features.timeline.markers);
    let of = |state: &State| {
        let player = state.player.as_ref().unwrap();
        (player.clock().frame(), player.clock().range(), player.is_playing())
    };
    assert_eq!(of(state), (1, PlayRange::default().beginning_at(1), false));
    assert_eq!(state.session_file(), Some(&file));
    assert!(state.notices.list().is_empty(), "{:?}", state.notices.list());
    // Opening and saving again gives the same text.
    assert_eq!(state.session().unwrap(), ReadSession::read(&file).unwrap().document);
    let text = fs::read(&file).unwrap();
    taken.state_mut().run(Command::SAVE_SESSION);
    until(&mut taken, "it is not saved", |state| !state.notices.list().is_empty());
    assert_eq!(fs::read(&file).unwrap(), text);

    // Others are drawn as before, and inherit nothing from it.
    open(&mut taken, &folder.path().join("scans/a1.xyz"));
    let style = taken.state().style;
    assert_eq!((style.points.size_px, style.clip), (usual.points.size_px, None));
    assert!(taken.state().features.labels.list.is_empty() && taken.state().session_file().is_none());
}

#[test]
fn a_comparison_is_reopened_with_its_layout() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.pointreel");
    let mut left = worked_on(folder.path());
    scans(&folder.path().join("smooth"));
    left.state_mut().compare_paths(vec![folder.path().join("smooth")]);
    until(&mut left, "nothing is beside it", |state| {
        state.features.split_view.is_some()
    });
    left.state_mut().run(Command::NEXT_LAYOUT);
    let split_view = left.state_mut().features.split_view.as_mut().unwrap();
    split_view.companion.pair_by(PairBy::Index);
    split_view.companion.set_offset_frames(1);
    split_view.pictures.split = 0.25;
    save(&mut left, &file);
    assert!(fs::read_to_string(&file).unwrap().contains("\"smooth\""));

    let mut taken = window();
    open(&mut taken, &file);
    until(&mut taken, "nothing is beside it", |state| {
        state.features.split_view.is_some()
    });
    let of = |state: &State| {
        let split_view = state.features.split_view.as_ref().unwrap();
        let companion = &split_view.companion;
        let paired = (companion.paired_by(), companion.offset_frames());
        (
            split_view.name.clone(),
            split_view.layout,
            paired,
            split_view.pictures.split,
        )
    };
    assert_eq!(of(taken.state()), of(left.state()));
    assert_eq!(
        taken.state().session().unwrap(),
        ReadSession::read(&file).unwrap().document
    );
    // Closing the comparison removes it.
    taken.state_mut().run(Command::CLOSE_COMPARISON);
    assert_eq!(taken.state().session().unwrap().compare, None);

    // A failure to open is reported, and the entry stays in the session.
    fs::remove_dir_all(folder.path().join("smooth")).unwrap();
    let mut without = window();
    open(&mut without, &file);
    until(&mut without, "no reason is given", |state| {
        !state.notices.list().is_empty()
    });
    assert!(without.state().notices.list()[0].text.contains("smooth"));
    assert!(without.state().features.split_view.is_none());
    assert!(without.state().session().unwrap().compare.is_some());
    // A session without a second sequence closes the previous one.
    let other = folder.path().join("alone.pointreel");
    fs::write(&other, r#"{"pointreel_session": 1, "files": ["scans"]}"#).unwrap();
    open(&mut left, &other);
    assert!(left.state().features.split_view.is_none());
}

#[test]
fn measurements_and_the_demo_are_stored_in_sessions() {
    use super::points::{click_on, in_squares, in_window};
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("demo.pointreel");
    let mut harness = window();
    harness.state_mut().run(Command::OPEN_DEMO);
    until(&mut harness, "the demo", |state| {
        shown(state).is_some() && state.has_looked()
    });
    let mut harness = in_squares(harness);
    press(&mut harness, Modifiers::NONE, Key::M);
    let frame = Arc::clone(harness.state().player.as_ref().unwrap().shown().unwrap());
    let mut taken = 0;
    for slot in (0..frame.frame.len()).step_by(97) {
        let place = in_window(&harness, frame.frame.positions()[slot].as_dvec3());
        if taken < 2 && harness.state().viewport.rect.shrink(150.0).contains(place) {
            click_on(&mut harness, place, 1);
            harness.run_steps(10);
            taken += 1;
        }
    }
    assert_eq!(harness.state().features.inspection.measurements.len(), 1);
    save(&mut harness, &file);
    let mut again = window();
    open(&mut again, &file);
    assert_eq!(again.state().sequence_name().as_deref(), Some("demo"));
    let value = |harness: &Harness<'_, State>| harness.state().features.inspection.measurements[0].value(DVec3::Y);
    assert!(value(&harness).is_some());
    assert_eq!(value(&again), value(&harness));
}

#[test]
fn session_errors_are_reported_and_no_content_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    scans(&folder.path().join("scans"));
    let file = folder.path().join("walk.pointreel");
    let mut harness = window_on(super::sequence(&[]), StateOptions { ..options() });
    fs::write(&file, "{\n  \"pointreel_session\": 1,\n  \"files\": 3\n}\n").unwrap();
    harness.state_mut().open_paths(vec![file.clone()]);
    until(&mut harness, "an answer", |state| !state.notices.list().is_empty());
    let said = harness.state().notices.list()[0].text.clone();
    assert!(said.contains("walk.pointreel") && said.contains("line 3"), "{said}");
    assert!(harness.state().session_file().is_none());

    // An unreadable setting becomes the default, and the file is copied before it is replaced.
    let text = r#"{"pointreel_session": 1, "files": ["scans"], "settings": {"primitive": "cone"}, "of later": 7}"#;
    fs::write(&file, text).unwrap();
    let mut harness = window();
    open(&mut harness, &file);
    let said = harness.state().notices.list()[0].text.clone();
    assert!(said.contains("primitive"), "{said}");
    harness.state_mut().run(Command::SAVE_SESSION);
    let copy = folder.path().join("walk.pointreel.unreadable");
    until(&mut harness, "a copy", |state| {
        state
            .notices
            .list()
            .iter()
            .any(|notice| notice.text.starts_with("Saved"))
    });
    assert_eq!(fs::read_to_string(copy).unwrap(), text);
    assert!(fs::read_to_string(&file).unwrap().contains("\"of later\": 7"));

    // A window whose sequence is not a file has no session.
    let mut harness = window();
    harness.state_mut().save_session_to(file);
    harness.run();
    assert!(harness.state().notices.list()[0].text.contains("not a file"));
}

#[test]
fn a_session_asks_before_it_leaves_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    scans(&folder.path().join("scans"));
    fs::create_dir(folder.path().join("sent")).unwrap();
    let file = folder.path().join("sent/walk.pointreel");
    fs::write(&file, r#"{"pointreel_session": 1, "files": ["../scans"]}"#).unwrap();
    let mut harness = window();
    harness.state_mut().open_paths(vec![file.clone()]);
    until(&mut harness, "nobody asks", |state| {
        state.opening.session_question.is_some()
    });
    let opened = |state: &State| state.player.as_ref().map(|player| Arc::as_ptr(player.sequence()));
    let before = opened(harness.state());
    let beyond = &harness.state().opening.session_question.as_ref().unwrap().beyond;
    assert!(beyond.addresses.is_empty() && beyond.outside.len() == 1, "{beyond:?}");
    harness.get_by_label("Cancel").click();
    harness.run();
    assert!(harness.state().opening.session_question.is_none());
    assert_eq!(opened(harness.state()), before);

    harness.state_mut().open_paths(vec![file]);
    until(&mut harness, "nobody asks", |state| {
        state.opening.session_question.is_some()
    });
    harness.get_by_label("Open").click();
    harness.run();
    until(&mut harness, "it is not opened", |state| {
        state.player.as_ref().is_some_and(|player| player.sequence().len() == 3)
    });
}

/// Options of a window that keeps documents, and unsaved changes, in `folder`.
fn retained_in(folder: &Path) -> StateOptions {
    StateOptions {
        documents: Some(DocumentFolder::at(folder.join("documents"), folder.join("timelines"))),
        ..options()
    }
}

/// A new window that has the session `file` open.
fn window_of(options: StateOptions, file: &Path) -> Harness<'static, State> {
    let mut harness = window_on(sequence(&[]), options);
    open(&mut harness, file);
    harness.run();
    harness
}

fn told(state: &State) -> String {
    let notices = state.notices.list().iter();
    let texts: Vec<&str> = notices.map(|notice| notice.text.as_str()).collect();
    texts.join("; ")
}

#[test]
fn unsaved_changes_of_a_session_are_restored_until_they_are_saved_or_reverted() {
    let folder = tempfile::tempdir().unwrap();
    scans(&folder.path().join("scans"));
    let file = folder.path().join("walk.pointreel");
    fs::write(&file, r#"{"pointreel_session": 1, "files": ["scans"]}"#).unwrap();
    let mut harness = window_of(retained_in(folder.path()), &file);
    let saved = harness.state().current_document();
    harness.state_mut().camera.azimuth_deg += 10.0;
    harness.run();
    assert!(!harness.state().is_unsaved(), "looking around is no work");
    harness.state_mut().document.notes.push_str("later");
    harness.state_mut().style.backdrop.grid = true;
    harness.run();
    // The window closes without a question, and another file is opened without one.
    assert!(harness.state_mut().may_close());
    harness.state_mut().open(sequence(&[]));
    harness.run();
    assert!(harness.state().document.notes.is_empty());
    drop(harness);
    let text = fs::read_to_string(&file).unwrap();
    assert!(!text.contains("later"), "only the user writes the session");

    let mut harness = window_of(retained_in(folder.path()), &file);
    assert!(harness.state().is_unsaved() && harness.state().style.backdrop.grid);
    assert_eq!(harness.state().document.notes, "later");
    let notice = "Unsaved changes of walk.pointreel were restored: Notes, Grid on.";
    assert!(told(harness.state()).contains(notice), "{}", told(harness.state()));
    // Reverts to the saved state, in one step that can be undone.
    harness.state_mut().run(Command::REVERT_SESSION);
    harness.run();
    assert!(harness.state().current_document().is_same_work(&saved) && !harness.state().is_unsaved());
    harness.state_mut().run(Command::UNDO);
    harness.run();
    assert_eq!(harness.state().document.notes, "later");
    harness.state_mut().run(Command::REDO);
    harness.run();
    harness.state_mut().open(sequence(&[]));
    drop(harness);

    let mut harness = window_of(retained_in(folder.path()), &file);
    assert!(!harness.state().is_unsaved() && harness.state().document.notes.is_empty());
    assert_eq!(told(harness.state()), "", "nothing is left to restore");
    // Once they are saved there are none left, either.
    harness.state_mut().document.notes.push_str("kept");
    harness.run();
    let before = harness.state().current_document();
    harness.state_mut().open(sequence(&[]));
    open(&mut harness, &file);
    harness.state_mut().save_session_to(file.clone());
    until(&mut harness, "it is not saved", |state| !state.is_unsaved());
    drop(harness);
    let harness = window_of(retained_in(folder.path()), &file);
    assert!(harness.state().current_document().is_same_work(&before) && !harness.state().is_unsaved());
    assert_eq!(told(harness.state()), "");
}

#[test]
fn an_externally_changed_session_overrides_unsaved_changes_and_both_are_retained() {
    let folder = tempfile::tempdir().unwrap();
    scans(&folder.path().join("scans"));
    let file = folder.path().join("walk.pointreel");
    fs::write(&file, r#"{"pointreel_session": 1, "files": ["scans"]}"#).unwrap();
    let mut harness = window_of(retained_in(folder.path()), &file);
    harness.state_mut().document.notes.push_str("here");
    harness.run();
    harness.state_mut().open(sequence(&[]));
    drop(harness);
    let other = r#"{"pointreel_session": 1, "files": ["scans"], "notes": "there"}"#;
    fs::write(&file, other).unwrap();
    let harness = window_of(retained_in(folder.path()), &file);
    assert_eq!(harness.state().document.notes, "there");
    let told = told(harness.state());
    let aside = told
        .split("those changes are in ")
        .nth(1)
        .and_then(|text| text.split(", which").next());
    let aside = PathBuf::from(aside.unwrap_or_else(|| panic!("{told}")));
    assert_eq!(ReadSession::read(&aside).unwrap().document.notes, "here");
}

#[test]
fn unsaved_changes_are_asked_about_where_nothing_can_be_stored() {
    let folder = tempfile::tempdir().unwrap();
    scans(&folder.path().join("scans"));
    let file = folder.path().join("walk.pointreel");
    fs::write(&file, r#"{"pointreel_session": 1, "files": ["scans"]}"#).unwrap();
    let mut harness = window_of(options(), &file);
    assert!(harness.state_mut().may_close());
    harness.state_mut().document.notes.push_str("here");
    harness.run();
    assert!(!harness.state_mut().may_close());
    harness.run();
    assert!(
        harness
            .query_by_label("The session has changes that are not saved.")
            .is_some()
    );
}
