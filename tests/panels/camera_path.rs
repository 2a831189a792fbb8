//! The camera path: keyframes by keys and buttons, its times and frames, its preview and its file.

use super::{click, frame, is_playing, press, window};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, PanelId, State, WindowRequest};
use pointreel::scene::{CameraPath, Projection};
use std::time::{Duration, Instant};

const NONE: Modifiers = Modifiers::NONE;

fn set(harness: &mut Harness<'_, State>, label: &str, value: f64) {
    harness
        .get_by_role_and_label(Role::SpinButton, label)
        .set_value_accesskit(value);
    harness.run();
}

fn value(harness: &Harness<'_, State>, label: &str) -> f64 {
    use egui_kittest::kittest::NodeT as _;
    let field = harness.get_by_role_and_label(Role::SpinButton, label);
    field.accesskit_node().numeric_value().unwrap()
}

/// Chooses the sequence's behaviour after keyframe `number`.
fn choose_after(harness: &mut Harness<'_, State>, number: usize, entry: &str) {
    let list = format!("After keyframe {number}");
    harness.get_by_role_and_label(Role::ComboBox, &list).click();
    harness.run();
    click(harness, entry);
}

/// Times in seconds and frames, counted from 0.
fn keys(harness: &Harness<'_, State>) -> Vec<(f64, f64)> {
    let draft = &harness.state().features.path.draft;
    let keys = draft.keyframes().iter();
    keys.map(|key| (key.time_s, key.frame)).collect()
}

/// Three keyframes two seconds apart, the camera rotated by 40 degrees each, at frames 1, 6 and 6, counted from 1.
fn with_path() -> Harness<'static, State> {
    let mut harness = window();
    for (steps, fov_deg) in [(0, 45.0), (5, 38.7), (0, 45.0)] {
        harness.state_mut().camera.fov_deg = fov_deg;
        harness.state_mut().step_frames(steps);
        let now = harness.state().now();
        harness.state_mut().update(now);
        press(&mut harness, NONE, Key::K);
        harness.state_mut().camera.orbit(40.0, 0.0);
    }
    assert_eq!(keys(&harness), [(0.0, 0.0), (2.0, 5.0), (4.0, 5.0)]);
    harness
}

/// Updates until a task is done.
fn until(harness: &mut Harness<'_, State>, is_done: impl Fn(&State) -> bool) {
    let patience = Instant::now();
    while !is_done(harness.state()) {
        assert!(patience.elapsed() < Duration::from_secs(20));
        let now = harness.state().now();
        harness.state_mut().update(now);
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run();
}

#[test]
fn k_sets_a_keyframe_of_the_current_view_and_advances_the_time() {
    let mut harness = with_path();
    assert!(
        harness.state().panels.has(PanelId::CAMERA_PATH),
        "the first key opens the list"
    );
    assert_eq!(value(&harness, "Time"), 6.0);
    let turned = |number: usize| {
        let keys = harness.state().features.path.draft.keyframes();
        keys[number].camera.azimuth_deg - keys[0].camera.azimuth_deg
    };
    assert!((turned(1) - 40.0).abs() < 1e-9 && (turned(2) - 80.0).abs() < 1e-9);

    // Clicking a keyframe shows it; K then replaces it, and the time stays.
    click(&mut harness, "Go to keyframe 2");
    assert_eq!(value(&harness, "Time"), 2.0);
    assert_eq!(frame(&harness), 5);
    assert!(
        (harness.state().camera.azimuth_deg - {
            harness.state().features.path.draft.keyframes()[1].camera.azimuth_deg
        })
        .abs()
            < 1e-9
    );
    press(&mut harness, NONE, Key::Home);
    press(&mut harness, NONE, Key::K);
    assert_eq!(keys(&harness), [(0.0, 0.0), (2.0, 0.0), (4.0, 5.0)]);
    assert_eq!(value(&harness, "Time"), 2.0);

    // Between two keyframes.
    set(&mut harness, "Time", 3.0);
    click(&mut harness, "Add keyframe");
    assert_eq!(keys(&harness).len(), 4);
    click(&mut harness, "Delete keyframe 3");
    press(&mut harness, NONE, Key::End);
    click(&mut harness, "Replace keyframe 1");
    assert_eq!(keys(&harness), [(0.0, 23.0), (2.0, 0.0), (4.0, 5.0)]);
}

#[test]
fn times_frames_and_speeds_are_set_in_the_list() {
    let mut harness = with_path();
    set(&mut harness, "Time of keyframe 2", 2.5);
    set(&mut harness, "Time of keyframe 3", 1.0);
    set(&mut harness, "Frame of keyframe 1", 3.0);
    assert_eq!(keys(&harness), [(0.0, 2.0), (2.5, 5.0), (2.501, 5.0)]);
    set(&mut harness, "Time of keyframe 3", 4.5);
    // 24 frames per second for two and a half seconds, then two seconds back at half that rate.
    choose_after(&mut harness, 1, "Plays");
    choose_after(&mut harness, 2, "Backward, × 0.5");
    assert_eq!(keys(&harness), [(0.0, 2.0), (2.5, 62.0), (4.5, 38.0)]);
    choose_after(&mut harness, 1, "Holds");
    assert_eq!(keys(&harness), [(0.0, 2.0), (2.5, 2.0), (4.5, 0.0)]);
    harness.get_by_role_and_label(Role::CheckBox, "Ease in and out").click();
    harness.run();
    assert!(harness.state().features.path.draft.path().unwrap().eases());
}

#[test]
fn path_changes_are_undone_in_order_with_setting_changes() {
    let mut harness = with_path();
    let splat_scale = harness.state().style.surfels.splat_scale;
    press(&mut harness, NONE, Key::Plus);
    click(&mut harness, "Delete keyframe 2");
    let undo = |harness: &mut Harness<'_, State>| press(harness, Modifiers::COMMAND, Key::Z);
    undo(&mut harness);
    assert_eq!(keys(&harness).len(), 3);
    assert_ne!(harness.state().style.surfels.splat_scale, splat_scale);
    undo(&mut harness);
    assert_eq!(harness.state().style.surfels.splat_scale, splat_scale);
    assert_eq!(keys(&harness).len(), 3);
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    assert_eq!(keys(&harness), [(0.0, 0.0), (4.0, 5.0)]);
}

#[test]
fn the_preview_plays_the_path_at_its_speed_until_it_is_stopped() {
    let mut harness = with_path();
    click(&mut harness, "Go to keyframe 1");
    let path = harness.state().features.path.draft.path().unwrap().clone();
    click(&mut harness, "Preview");
    for seconds in [0.5, 1.0, 1.9] {
        let begin = Duration::from_secs_f64(seconds);
        assert!(harness.state_mut().update(begin).is_visible());
        let (camera, shown) = path.at(seconds);
        assert_eq!(harness.state().camera, camera);
        assert_eq!(frame(&harness), shown);
        assert_eq!(harness.state().next_deadline(), Some(begin), "it moves on");
        harness.run();
        assert_eq!(harness.state().camera, camera, "no control changes it");
    }
    assert!((value(&harness, "Time") - 1.9).abs() < 1e-9);
    press(&mut harness, NONE, Key::Escape);
    assert!(!harness.state().features.path.is_playing());
    let stopped = harness.state().camera;
    harness.state_mut().update(Duration::from_secs(3));
    assert_eq!(harness.state().camera, stopped);

    // It continues from there to the end.
    press(&mut harness, Modifiers::SHIFT, Key::K);
    harness.state_mut().update(Duration::from_secs(4));
    assert!(harness.state().features.path.is_playing());
    harness.run();
    assert_eq!(harness.state().camera, path.at(2.9).0);
    harness.state_mut().update(Duration::from_secs(40));
    assert!(!harness.state().features.path.is_playing());
    assert_eq!(harness.state().camera, path.at(4.0).0);

    // When the user moves the camera, playback stops.
    press(&mut harness, Modifiers::SHIFT, Key::K);
    harness.state_mut().update(Duration::from_secs(41));
    harness.state_mut().camera.orbit(5.0, 5.0);
    let taken = harness.state().camera;
    harness.state_mut().update(Duration::from_secs(42));
    assert_eq!(harness.state().camera, taken);
    harness.run();
    assert!(harness.query_by_label("Preview").is_some());
}

#[test]
fn the_sequence_that_played_before_the_preview_plays_after_it() {
    let mut harness = with_path();
    click(&mut harness, "Play");
    click(&mut harness, "Preview");
    assert!(!is_playing(&harness));
    click(&mut harness, "Stop");
    assert!(is_playing(&harness));
}

#[test]
fn a_view_of_another_projection_cannot_be_a_keyframe_of_the_path() {
    let mut harness = with_path();
    harness.state_mut().camera.projection = Projection::Orthographic;
    press(&mut harness, NONE, Key::K);
    assert_eq!(keys(&harness).len(), 3);
    let notice = &harness.state().notices.list()[0].text;
    assert!(notice.contains("projection"), "{notice}");
}

#[test]
fn a_path_is_saved_in_the_command_line_format_and_reopened() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("flight.json");
    let mut harness = with_path();
    assert!(harness.query_by_label("not saved").is_some());
    harness.state_mut().save_path_to(file.clone());
    until(&mut harness, |state| !state.features.path.is_unsaved());
    assert!(harness.query_by_label("not saved").is_none());
    let written = CameraPath::read(&file).unwrap();
    assert_eq!(Some(&written), harness.state().features.path.draft.path());

    click(&mut harness, "Delete keyframe 1");
    harness.state_mut().open_path(file);
    until(&mut harness, |state| !state.features.path.is_unsaved());
    assert_eq!(keys(&harness).len(), 3);

    let broken = folder.path().join("broken.json");
    std::fs::write(&broken, "{}").unwrap();
    harness.state_mut().open_path(broken);
    until(&mut harness, |state| {
        let notices = state.notices.list().iter();
        notices.clone().any(|notice| notice.text.contains("broken.json"))
    });
    assert_eq!(keys(&harness).len(), 3, "what was there stays");
}

#[test]
fn an_unsaved_path_is_not_lost_without_asking() {
    let mut harness = with_path();
    click(&mut harness, "New camera path");
    assert_eq!(keys(&harness).len(), 3);
    click(&mut harness, "Back");
    harness.state_mut().run(Command::QUIT);
    harness.run();
    assert!(harness.query_by_label("The camera path is not saved.").is_some());
    assert_eq!(harness.state_mut().take_requests(), []);
    press(&mut harness, NONE, Key::Escape);
    assert!(harness.query_by_label("Quit anyway").is_none());
    // The window's own button: the second click closes it.
    assert!(!harness.state_mut().may_close());
    assert!(harness.state_mut().may_close());
    harness.run();
    click(&mut harness, "Quit anyway");
    assert_eq!(harness.state_mut().take_requests(), [WindowRequest::Quit]);

    click(&mut harness, "New camera path");
    click(&mut harness, "Discard it");
    assert!(keys(&harness).is_empty());
    assert!(harness.state_mut().may_close());
}

#[test]
fn every_control_of_the_path_has_a_name() {
    let harness = with_path();
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
}
