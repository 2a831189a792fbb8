//! Assumptions: the chip, the list, its alternatives, and remembered choices.

use super::until;
use super::walk::{options, sequence};
use super::window_on;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::{Command, ReadingChoices, State, StateOptions};
use pointreel::assumption::{Assumption, Evidence, Subject};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::document::DocumentFolder;
use pointreel::scene::{Choice, Primitive, UpAxis};
use pointreel::sequence::{FrameEntry, Sequence};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options of a window whose files are in `folder`.
fn retained_in(folder: &Path) -> StateOptions {
    let mut options = options();
    options.preferences.settings.primitive = Choice::Auto;
    let (reading_choices, problem) = ReadingChoices::load_from(&folder.join("reading.json"));
    assert_eq!(problem, None);
    StateOptions {
        documents: Some(DocumentFolder::at(folder.join("documents"), folder.join("timelines"))),
        reading_choices,
        ..options
    }
}

/// A window whose files are in `retained`, with `inputs` open.
fn window_of(retained: &Path, inputs: &[PathBuf]) -> Harness<'static, State> {
    let mut harness = window_on(sequence(&[]), retained_in(retained));
    harness.state_mut().run(Command::CLOSE_SEQUENCE);
    harness.state_mut().open_paths(inputs.to_vec());
    until(&mut harness, "it is not opened", is_looked_at);
    harness
}

fn is_looked_at(state: &State) -> bool {
    let is_shown = |state: &State| state.player.as_ref().is_some_and(|player| player.shown().is_some());
    is_shown(state) && state.has_looked()
}

fn source_of(state: &State) -> *const Sequence {
    state
        .player
        .as_ref()
        .map_or(std::ptr::null(), |player| Arc::as_ptr(player.sequence()))
}

/// Clicks, and waits until the inputs are open again.
/// Clicks an item that may be further down in the list.
fn click(harness: &mut Harness<'_, State>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).scroll_to_me();
    harness.run();
    super::click(harness, label);
}

fn click_and_reopen(harness: &mut Harness<'_, State>, label: &str) {
    let before = source_of(harness.state());
    click(harness, label);
    until(harness, label, |state| {
        source_of(state) != before && is_looked_at(state)
    });
}

/// The text of the chip.
fn chip(harness: &Harness<'_, State>) -> Option<String> {
    let mut chips = harness.query_all_by_role(Role::Button);
    let is_chip = |name: &String| name.ends_with(" assumption") || name.ends_with(" assumptions");
    chips.find_map(|node| node.accesskit_node().label().filter(is_chip))
}

fn open_list(harness: &mut Harness<'_, State>) {
    let text = chip(harness).unwrap();
    click(harness, &text);
}

fn chosen_count(harness: &Harness<'_, State>) -> usize {
    harness.query_all_by_label("chosen by you").count()
}

fn has(harness: &Harness<'_, State>, label: &str) -> bool {
    harness.query_all_by_label(label).next().is_some()
}

/// `count` points of a slab that is thin along Z, as `width` floats per point without a header.
fn write_slab(file: &Path, count: u16, width: usize) {
    let points = (0..count).flat_map(|index| {
        let (row, column) = (f32::from(index / 40), f32::from(index % 40));
        [row, column, 0.01 * (row * 0.7).sin(), 0.5].into_iter().take(width)
    });
    fs::write(file, points.flat_map(f32::to_le_bytes).collect::<Vec<u8>>()).unwrap();
}

fn slab(folder: &Path) -> PathBuf {
    let file = folder.join("slab.bin");
    write_slab(&file, 1600, 4);
    file
}

fn point_count(harness: &Harness<'_, State>) -> usize {
    let player = harness.state().player.as_ref().unwrap();
    player.shown().unwrap().frame.points_in_file()
}

#[test]
fn the_chip_shows_the_number_of_assumptions_and_opens_their_list() {
    let entries = vec![FrameEntry::file("/scans/0.bin"), FrameEntry::file("/scans/1.bin")];
    let sequence = Sequence::with_decoder(entries, |_| {
        let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| (corner >> axis & 1) as f32));
        let mut cloud = RawCloud::from_positions(Positions::F32(corners.collect()));
        let of = |subject, value, evidence| Assumption::new(subject, value, "some reason", evidence);
        cloud.assumptions = vec![
            of(Subject::Camera, "a Kinect", Evidence::Fallback),
            of(Subject::ColorDepth, "16 bits", Evidence::File),
        ];
        Ok(cloud)
    });
    let folder = tempfile::tempdir().unwrap();
    let mut harness = Harness::builder()
        .with_size([1280.0, 800.0])
        .with_max_steps(20)
        .with_context_setup(pointreel::app::apply_theme)
        .build_ui_state(
            |ui, state: &mut State| pointreel::app::panels::window_ui(ui, state),
            State::new(retained_in(folder.path())),
        );
    harness.run();
    assert_eq!(chip(&harness), None, "nothing is open");
    harness.state_mut().open(Arc::new(sequence));
    until(&mut harness, "it is shown", is_looked_at);
    // Up axis, primitive and colours, and two that both frames share.
    assert_eq!(chip(&harness).as_deref(), Some("5 assumptions"));
    open_list(&mut harness);
    for text in [
        "camera:",
        "a Kinect",
        "some reason (fallback: nothing says it)",
        "some reason (the file says so)",
        "Command line: --intrinsics",
    ] {
        assert!(has(&harness, text), "{text}");
    }
    // Sequences that were not read from files cannot be opened again.
    assert!(!has(&harness, "Apply camera") && has(&harness, "up axis: +Z"));
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
    open_list(&mut harness);
    assert!(!has(&harness, "a Kinect"), "the chip closes it as well");
}

#[test]
fn the_up_axis_and_primitive_can_be_chosen_remembered_and_reset() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = [slab(folder.path())];
    let mut harness = window_of(folder.path(), &inputs);
    let guessed = harness.state().camera.up;
    let count = chip(&harness);
    open_list(&mut harness);
    assert_eq!(chosen_count(&harness), 0);
    assert_ne!(guessed, UpAxis::NegX);
    click(&mut harness, "up axis: -X");
    assert_eq!((harness.state().camera.up, chosen_count(&harness)), (UpAxis::NegX, 1));
    click(&mut harness, "primitive: Voxels");
    assert_eq!(harness.state().style.primitive, Primitive::Voxel);
    assert_eq!((chip(&harness), chosen_count(&harness)), (count, 2));
    let now = harness.state().now();
    harness.state_mut().update(now);

    let mut again = window_of(folder.path(), &inputs);
    assert_eq!(again.state().camera.up, UpAxis::NegX);
    assert_eq!(again.state().style.primitive, Primitive::Voxel);
    open_list(&mut again);
    assert_eq!(chosen_count(&again), 2);
    click(&mut again, "Reset up axis");
    assert_eq!((again.state().camera.up, chosen_count(&again)), (guessed, 1));
    assert_eq!(window_of(folder.path(), &inputs).state().camera.up, guessed);
    click(&mut again, "primitive: Auto");
    assert_eq!(chosen_count(&again), 0);
}

#[test]
fn other_columns_reopen_the_file_and_are_remembered_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = [slab(folder.path())];
    let mut harness = window_of(folder.path(), &inputs);
    assert_eq!(point_count(&harness), 1600);
    open_list(&mut harness);
    click_and_reopen(&mut harness, "columns: 5 values per point");
    assert_eq!(point_count(&harness), 1280);
    assert!(has(&harness, "Reset columns"));
    let columns = harness.state().session().unwrap().reading.columns;
    assert_eq!(columns.map(|columns| columns.to_string()).as_deref(), Some("5"));

    let mut again = window_of(folder.path(), &inputs);
    assert_eq!(point_count(&again), 1280);
    open_list(&mut again);
    click_and_reopen(&mut again, "Reset columns");
    assert_eq!(point_count(&again), 1600);
    assert_eq!(point_count(&window_of(folder.path(), &inputs)), 1600);
}

#[test]
fn a_choice_that_makes_every_frame_unreadable_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("odd.bin");
    // Not a whole number of points of 5 floats.
    write_slab(&file, 13, 4);
    let inputs = [file.clone()];
    let mut harness = window_of(folder.path(), &inputs);
    let before = source_of(harness.state());
    open_list(&mut harness);
    click(&mut harness, "columns: 5 values per point");
    until(&mut harness, "it is said", |state| !state.notices.list().is_empty());
    assert!(harness.state().notices.list()[0].text.contains("odd.bin"));
    assert_eq!(source_of(harness.state()), before);
    assert_eq!(harness.state().stored.reading_choices.of(&inputs), None);

    // A rewritten file does not fit the choice that was made for it before: it is opened nonetheless.
    click_and_reopen(&mut harness, "columns: 4 values per point");
    write_slab(&file, 81, 3);
    let again = window_of(folder.path(), &inputs);
    assert_eq!(point_count(&again), 81);
    let notices = again.state().notices.list();
    assert!(
        notices.iter().any(|notice| notice.text.contains("View > Assumptions")),
        "{notices:?}"
    );
}

#[test]
fn a_wrong_number_typed_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let frames: Vec<PathBuf> = (0..2)
        .map(|number| {
            let file = folder.path().join(format!("scan_{number}.xyz"));
            fs::write(&file, "0 0 0\n1 0 0\n0 1 0\n0 0 1\n").unwrap();
            file
        })
        .collect();
    let mut options = retained_in(folder.path());
    options.open.fps = Some(12.0);
    let mut harness = window_on(sequence(&[]), options);
    harness.state_mut().open_paths(frames);
    until(&mut harness, "it is not opened", |state| {
        is_looked_at(state) && state.player.as_ref().unwrap().sequence().len() == 2
    });
    open_list(&mut harness);
    assert!(has(&harness, "12 frames per second"));
    let field = "frame times: frames per second";
    let type_in = |harness: &mut Harness<'_, State>, text: &str| {
        harness.get_by_role_and_label(Role::TextInput, field).focus();
        harness.run();
        harness.get_by_role_and_label(Role::TextInput, field).type_text(text);
        harness.run();
    };
    type_in(&mut harness, "-");
    assert!(has(&harness, "expected a number above 0, found \"-\""));
    harness.key_press(egui::Key::Backspace);
    harness.run();
    type_in(&mut harness, "7.5");
    click_and_reopen(&mut harness, "Apply frame times");
    let fps = harness.state().player.as_ref().unwrap().sequence().fps();
    assert_eq!(fps, 7.5);
}

#[test]
fn the_palette_finds_the_list() {
    for query in ["assumptions", "guesses", "depth scale"] {
        let mut harness = super::window();
        harness.state_mut().run(Command::TOGGLE_PALETTE);
        harness.run();
        harness.get_by_label("Find a command").type_text(query);
        harness.run();
        harness.key_press(egui::Key::Enter);
        harness.run();
        assert!(has(&harness, "primitive: Auto"), "{query}");
    }
}
