//! Documents: additions to a sequence come back with it, and none of them is in another.

use super::until;
use super::walk::options;
use egui_kittest::Harness;
use glam::DVec3;
use pointreel::app::{Command, GivenStyle, State, StateOptions};
use pointreel::document::{DocumentFolder, MeasuredPoint, ReadSession, ShownTrails, SpreadTrails};
use pointreel::scene::{Clip, ClipShape, FollowedPoint, Label, MeasurementKind, Primitive, UpAxis};
use pointreel::timeline::PlayRange;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options of a window that keeps documents in `folder`.
fn retained_in(folder: &Path) -> StateOptions {
    StateOptions {
        documents: Some(DocumentFolder::at(folder.join("documents"), folder.join("timelines"))),
        ..options()
    }
}

/// A folder with three frames of a cube that grows.
fn scans(folder: &Path, name: &str) -> PathBuf {
    let folder = folder.join(name);
    fs::create_dir_all(&folder).unwrap();
    for size in 1..=3 {
        let corners = (0..8).map(|corner| {
            let [x, y, z] = [0, 1, 2].map(|axis| size * (corner >> axis & 1));
            format!("{x} {y} {z}\n")
        });
        fs::write(folder.join(format!("f{size}.xyz")), corners.collect::<String>()).unwrap();
    }
    folder
}

fn open(harness: &mut Harness<'_, State>, path: &Path) {
    let of = |state: &State| {
        let player = state.player.as_ref();
        player.map(|player| Arc::as_ptr(player.sequence()))
    };
    let before = of(harness.state());
    harness.state_mut().open_paths(vec![path.to_owned()]);
    until(harness, "it is not opened", |state| {
        let is_shown = state.player.as_ref().is_some_and(|player| player.shown().is_some());
        of(state) != before && is_shown && state.has_looked()
    });
}

/// A window on nothing but `path`.
fn window_of(options: StateOptions, path: &Path) -> Harness<'static, State> {
    let mut harness = Harness::builder()
        .with_size([1280.0, 800.0])
        .with_max_steps(20)
        .with_context_setup(pointreel::app::apply_theme)
        .build_ui_state(
            |ui, state: &mut State| pointreel::app::panels::window_ui(ui, state),
            State::new(options),
        );
    open(&mut harness, path);
    harness
}

fn close(harness: &mut Harness<'_, State>) {
    harness.run();
    harness.state_mut().run(Command::CLOSE_SEQUENCE);
    harness.run();
}

fn label(text: &str) -> Label {
    Label {
        text: text.to_owned(),
        frame: 1,
        point: Some(followed(7)),
        place: Some(DVec3::splat(2.0)),
        frames: PlayRange::default(),
    }
}

fn followed(index_in_file: u32) -> FollowedPoint {
    FollowedPoint {
        index_in_file,
        points_in_file: Some(8),
    }
}

/// Something of everything that a document holds.
fn work_on(harness: &mut Harness<'_, State>) {
    let state = harness.state_mut();
    for command in [
        Command::ADD_KEYFRAME,
        Command::NEXT_FRAME,
        Command::TOGGLE_MARKER,
        Command::SET_IN,
    ] {
        state.run(command);
    }
    let mut document = state.current_document();
    document.settings.primitive = Primitive::Point.into();
    document.settings.points.size_px = 5.0;
    document.clip = Some(Clip::to(ClipShape::Box {
        min: DVec3::ZERO,
        max: DVec3::splat(2.5),
    }));
    document.labels = Arc::new(vec![label("corner")]);
    let point = |index| MeasuredPoint {
        frame: 1,
        point: followed(index),
        place: DVec3::splat(2.0),
    };
    document.measurements = vec![pointreel::document::Measured {
        kind: MeasurementKind::Distance,
        points: vec![point(0), point(7)],
    }];
    document.trails = ShownTrails {
        of_picked: true,
        pinned: vec![point(3)],
        spread: Some(SpreadTrails { points: 4, frames: 2 }),
    };
    document.notes.push_str("from the north");
    state.apply_document(document);
    state.choose_up(UpAxis::Z);
    state.camera.azimuth_deg = 33.0;
    harness.run();
}

/// The texts of all notices.
fn told(state: &State) -> String {
    let notices = state.notices.list().iter();
    notices
        .map(|notice| notice.text.as_str())
        .collect::<Vec<_>>()
        .join("; ")
}

#[test]
fn each_sequence_has_its_own_document() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| scans(folder.path(), name));
    let mut harness = window_of(retained_in(folder.path()), &a);
    let new = harness.state().current_document();
    assert!(!harness.state().is_unsaved(), "nothing was made");
    work_on(&mut harness);
    assert!(harness.state().is_unsaved());
    let made = harness.state().current_document();

    open(&mut harness, &b);
    let mut of_b = harness.state().current_document();
    of_b.inputs.clone_from(&new.inputs);
    assert_eq!(of_b, new, "nothing of A is in it");
    assert!(!harness.state().is_unsaved());
    harness.state_mut().style.backdrop.grid = true;
    harness.run();

    open(&mut harness, &a);
    assert!(
        told(harness.state()).contains("view, look, up axis, clip"),
        "{}",
        told(harness.state())
    );
    let again = harness.state().current_document();
    assert!(again.is_stored_same(&made), "{again:#?} is not {made:#?}");
    assert_eq!(again.frame, made.frame);
    assert!(!harness.state().style.backdrop.grid, "that was B's");
    assert_eq!(harness.state().camera.azimuth_deg, 33.0);
    open(&mut harness, &b);
    let style = harness.state().style;
    assert!(style.backdrop.grid && style.primitive == Primitive::Surfel);
    close(&mut harness);

    // The next window has everything as well; a sequence that was only opened leaves nothing behind.
    let c = scans(folder.path(), "c");
    let mut next = window_of(retained_in(folder.path()), &c);
    close(&mut next);
    open(&mut next, &a);
    assert!(next.state().current_document().is_stored_same(&made));
    let files = fs::read_dir(folder.path().join("documents")).unwrap().count();
    assert_eq!(files, 2);
}

#[test]
fn documents_are_stored_as_sessions() {
    let folder = tempfile::tempdir().unwrap();
    let a = scans(folder.path(), "a");
    let mut harness = window_of(retained_in(folder.path()), &a);
    work_on(&mut harness);
    close(&mut harness);
    let mut files = fs::read_dir(folder.path().join("documents")).unwrap();
    let file = files.next().unwrap().unwrap().path();
    let read = ReadSession::read(&file).unwrap();
    assert_eq!(read.warnings, [""; 0]);
    assert_eq!(read.document.notes, "from the north");
    // Opened as a session it is the same.
    let copy = folder.path().join("copy.pointreel");
    fs::copy(&file, &copy).unwrap();
    let mut harness = window_of(options(), &copy);
    harness.run();
    assert_eq!(harness.state().features.labels.list[0].text, "corner");
    assert_eq!(harness.state().camera.azimuth_deg, 33.0);
}

#[test]
fn two_windows_on_one_sequence_do_not_lose_each_others_changes() {
    let folder = tempfile::tempdir().unwrap();
    let a = scans(folder.path(), "a");
    let [mut one, mut other] = [0, 1].map(|_| window_of(retained_in(folder.path()), &a));
    one.state_mut().features.labels.list = Arc::new(vec![label("one")]);
    other.state_mut().style.backdrop.grid = true;
    close(&mut one);
    close(&mut other);
    let third = window_of(retained_in(folder.path()), &a);
    assert_eq!(third.state().features.labels.list.len(), 1);
    assert!(third.state().style.backdrop.grid);
}

#[test]
fn changes_are_unsaved_until_in_a_session() {
    let folder = tempfile::tempdir().unwrap();
    let a = scans(folder.path(), "a");
    let mut harness = window_of(retained_in(folder.path()), &a);
    harness.state_mut().camera.azimuth_deg += 10.0;
    harness.state_mut().step_frames(1);
    harness.run();
    assert!(!harness.state().is_unsaved(), "looking around is no work");
    harness.state_mut().run(Command::TOGGLE_MARKER);
    harness.run();
    assert!(harness.state().is_unsaved());
    let file = folder.path().join("a.pointreel");
    harness.state_mut().save_session_to(file);
    until(&mut harness, "it is not saved", |state| state.session_file().is_some());
    assert!(!harness.state().is_unsaved());
    harness.state_mut().document.notes.push_str("later");
    harness.run();
    assert!(harness.state().is_unsaved());
    harness.state_mut().run(Command::UNDO);
    harness.run();
    assert!(!harness.state().is_unsaved() && harness.state().document.notes.is_empty());
}

#[test]
fn a_document_can_be_reset() {
    let folder = tempfile::tempdir().unwrap();
    let a = scans(folder.path(), "a");
    let mut harness = window_of(retained_in(folder.path()), &a);
    let new = harness.state().current_document();
    let first_view = harness.state().camera;
    work_on(&mut harness);
    harness.state_mut().run(Command::BEGIN_AGAIN);
    harness.run();
    let begun = harness.state().current_document();
    assert!(begun.is_stored_same(&new), "{begun:#?} is not {new:#?}");
    assert_eq!(harness.state().camera, first_view);
    // Undone changes come back, under their own names.
    harness.state_mut().run(Command::UNDO);
    assert_eq!(harness.state().features.labels.list.len(), 1);
    assert_eq!(harness.state().document.notes, "from the north");
    harness.state_mut().run(Command::REDO);
    close(&mut harness);
    let again = window_of(retained_in(folder.path()), &a);
    assert!(again.state().current_document().is_stored_same(&new));
    assert_eq!(told(again.state()), "");
}

#[test]
fn a_fresh_window_starts_from_defaults_and_deletes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| scans(folder.path(), name));
    let mut harness = window_of(retained_in(folder.path()), &a);
    work_on(&mut harness);
    close(&mut harness);
    let fresh = || StateOptions {
        is_fresh: true,
        ..retained_in(folder.path())
    };
    let mut harness = window_of(fresh(), &a);
    assert!(harness.state().features.labels.list.is_empty());
    close(&mut harness);
    let mut harness = window_of(retained_in(folder.path()), &a);
    assert_eq!(harness.state().features.labels.list.len(), 1, "it is kept still");
    close(&mut harness);
    // Changes made in it take precedence over earlier ones.
    let mut harness = window_of(fresh(), &a);
    harness.state_mut().document.notes.push_str("anew");
    open(&mut harness, &b);
    open(&mut harness, &a);
    assert!(harness.state().features.labels.list.is_empty());
    assert_eq!(harness.state().document.notes, "anew");
}

#[test]
fn command_line_options_override_stored_values_and_are_not_stored() {
    let folder = tempfile::tempdir().unwrap();
    let a = scans(folder.path(), "a");
    let mut harness = window_of(retained_in(folder.path()), &a);
    work_on(&mut harness);
    close(&mut harness);
    let given = StateOptions {
        given: GivenStyle::new(|style| style.with(|style| style.points.size_px = 9.0)),
        ..retained_in(folder.path())
    };
    let mut harness = window_of(given, &a);
    let points = harness.state().style.points.size_px;
    assert_eq!(
        (points, harness.state().style.primitive),
        (9.0, Primitive::Point.into())
    );
    harness.state_mut().style.backdrop.grid = true;
    close(&mut harness);
    let harness = window_of(retained_in(folder.path()), &a);
    let style = harness.state().style;
    assert_eq!((style.points.size_px, style.backdrop.grid), (5.0, true));
}

#[test]
fn marks_and_choices_of_versions_before_documents_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let a = scans(folder.path(), "a");
    let mut harness = window_of(retained_in(folder.path()), &a);
    harness.state_mut().run(Command::TOGGLE_MARKER);
    close(&mut harness);
    let documents = folder.path().join("documents");
    let file = fs::read_dir(&documents).unwrap().next().unwrap().unwrap().path();
    fs::remove_file(&file).unwrap();
    let timelines = folder.path().join("timelines");
    fs::create_dir_all(&timelines).unwrap();
    let text = r#"{"version": 1, "range": {"first": 1, "last": 2}, "markers": [{"frame": 2, "name": "turn"}],
        "up": "-x", "primitive": "voxel"}"#;
    let old = timelines.join(file.with_extension("json").file_name().unwrap());
    fs::write(old, text).unwrap();
    let harness = window_of(retained_in(folder.path()), &a);
    let state = harness.state();
    assert_eq!(state.features.timeline.markers.list()[0].name, "turn");
    assert_eq!(
        (state.style.primitive, state.camera.up),
        (Primitive::Voxel.into(), UpAxis::NegX)
    );
    let range = state.player.as_ref().unwrap().clock().range();
    assert_eq!((range.first(), range.last()), (Some(1), Some(2)));
}

#[test]
fn current_settings_can_become_the_defaults_for_new_files() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| scans(folder.path(), name));
    let mut harness = window_of(retained_in(folder.path()), &a);
    harness.state_mut().style.backdrop.grid = true;
    harness.run();
    assert!(
        !harness.state().preferences().settings.backdrop.grid,
        "it is the document's"
    );
    harness.state_mut().run(Command::USE_AS_DEFAULTS);
    assert!(harness.state().preferences().settings.backdrop.grid);
    open(&mut harness, &b);
    assert!(harness.state().style.backdrop.grid);
}
