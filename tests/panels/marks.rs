//! In and out point, markers and the curve on the timeline.

use super::points::click_on;
use super::{FRAMES, click, clock, frame, options, press, sequence, window, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, Quantity, StateOptions};
use pointreel::document::DocumentFolder;
use std::time::Duration;

#[test]
fn playback_stays_between_in_and_out_point() {
    let mut harness = window();
    harness.state_mut().step_frames(3);
    press(&mut harness, Modifiers::SHIFT, Key::I);
    harness.state_mut().step_frames(2);
    press(&mut harness, Modifiers::SHIFT, Key::O);
    let range = clock(&harness).range();
    assert_eq!((range.first(), range.last()), (Some(3), Some(5)));
    click(&mut harness, "Play");
    let frames = [0.5, 1.5, 2.5, 3.5].map(|frames: f64| {
        let now = Duration::from_secs_f64(frames / 24.0);
        harness.state_mut().update(now);
        frame(&harness)
    });
    assert_eq!(frames, [5, 3, 4, 5]);
    harness.run();
    click(&mut harness, "Pause");
    press(&mut harness, Modifiers::SHIFT, Key::X);
    assert_eq!(clock(&harness).range().of(FRAMES), 0..FRAMES);
}

#[test]
fn markers_are_set_named_jumped_to_and_stored() {
    let folder = tempfile::tempdir().unwrap();
    let retained = || StateOptions {
        documents: Some(DocumentFolder::at(
            folder.path().join("documents"),
            folder.path().join("timelines"),
        )),
        ..options()
    };
    let mut harness = window_on(sequence(&[]), retained());
    for step in [4, 6] {
        harness.state_mut().step_frames(step);
        press(&mut harness, Modifiers::COMMAND, Key::M);
    }
    press(&mut harness, Modifiers::SHIFT, Key::M);
    assert_eq!(frame(&harness), 4);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::M);
    assert_eq!(frame(&harness), 10);
    harness.state_mut().run(Command::FIRST);
    click(&mut harness, "Marker at frame 5");
    assert_eq!(frame(&harness), 4);
    press(&mut harness, Modifiers::SHIFT, Key::I);

    // The second click of a double click renames it.
    let flag = harness.get_by_role_and_label(Role::Button, "Marker at frame 5");
    let place = flag.rect().center();
    click_on(&mut harness, place, 2);
    harness
        .get_by_role_and_label(Role::TextInput, "Name of the marker")
        .type_text("turn");
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::Enter);
    click(&mut harness, "Marker turn");

    let next = window_on(sequence(&[]), retained());
    let markers = next.state().features.timeline.markers.list();
    let known: Vec<_> = markers
        .iter()
        .map(|marker| (marker.frame, marker.name.as_str()))
        .collect();
    assert_eq!(known, [(4, "turn"), (10, "")]);
    assert_eq!(clock(&next).range().first(), Some(4));
    // Removed as they were set.
    harness.state_mut().run(Command::TOGGLE_MARKER);
    harness.run();
    assert!(harness.query_by_label("Marker turn").is_none());
}

#[test]
fn a_curve_can_be_chosen_and_shows_values() {
    let mut harness = window();
    assert!(harness.query_by_label("Curve: Points").is_none());
    for quantity in Quantity::ALL {
        harness.state_mut().features.timeline.quantity = Some(quantity);
        harness.run();
        let label = format!("Curve: {}", quantity.name());
        assert!(harness.query_by_label(&label).is_some(), "{label}");
    }
    harness.state_mut().features.timeline.quantity = Some(Quantity::Points);
    harness.run();
    let curve = harness.get_by_role_and_label(Role::Image, "Curve: Points");
    harness.hover_at(curve.rect().center());
    harness.run();
    // The tooltip appears after a delay.
    for _ in 0..60 {
        harness.step();
    }
    assert!(harness.query_by_label_contains("Points: 8").is_some());
}
