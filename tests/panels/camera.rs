//! Projection, turntable, and views as text.

use super::{options, press, sequence, window, window_on};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;
use pointreel::app::{Command, Severity, StateOptions, WindowRequest};
use pointreel::scene::{Camera, Projection};
use std::time::Duration;

fn at(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

#[test]
fn the_projection_is_chosen_by_key_and_in_the_settings() {
    let mut harness = window();
    let seen_before = harness.state_mut().next_packet().unwrap().view;
    press(&mut harness, Modifiers::NONE, Key::O);
    assert_eq!(harness.state().camera.projection, Projection::Orthographic);
    assert!(harness.query_by_label("Field of view").is_none(), "there is none");
    let view = harness.state_mut().next_packet().unwrap().view;
    // The plane through the target keeps its size: the telephoto lens is farther away in proportion.
    let target = harness.state().camera.target_in_world;
    let size_px = |view: pointreel::scene::ViewTransform| {
        f64::from(view.pixels_per_unit_at_1) / (view.eye_high.as_dvec3() - target).length()
    };
    assert!(view.eye_high.length() > 400.0 * seen_before.eye_high.length());
    assert!((size_px(view) / size_px(seen_before) - 1.0).abs() < 1e-5);
    // Rotating about the eye would mean rotating about a distant position: the image stays around the target.
    let before = harness.state().camera;
    harness.state_mut().camera.look_around(10.0, 0.0);
    let moved = harness.state().camera.target_in_world - before.target_in_world;
    assert!(moved.length() < 0.2 * before.distance);

    let list = harness.get_by_role_and_label(Role::ComboBox, "Projection");
    list.scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::ComboBox, "Projection").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Perspective").click();
    harness.run();
    assert_eq!(harness.state().camera.projection, Projection::Perspective);
    assert!(harness.query_all_by_label("Field of view").next().is_some());
}

#[test]
fn a_reset_keeps_the_projection() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::O);
    press(&mut harness, Modifiers::NONE, Key::R);
    let framed = harness.state().camera.distance;
    harness.state_mut().camera.zoom(0.2);
    press(&mut harness, Modifiers::NONE, Key::R);
    let camera = harness.state().camera;
    assert_eq!(camera.projection, Projection::Orthographic);
    assert!((camera.distance / framed - 1.0).abs() < 0.1, "{camera:?}");
}

#[test]
fn the_turntable_turns_until_the_image_is_dragged() {
    let mut harness = window();
    let begin = harness.state().camera;
    assert_eq!(harness.state().next_deadline(), None);
    press(&mut harness, Modifiers::NONE, Key::T);
    let state = harness.state_mut();
    state.update(at(1000));
    assert_eq!(state.next_deadline(), Some(at(1000)));
    assert!(state.update(at(1100)).is_visible());
    let turned = state.camera.azimuth_deg - begin.azimuth_deg;
    assert!((turned - 2.0).abs() < 1e-9, "{turned} degrees at 20 a second");
    assert!(state.next_packet().is_some());
    harness
        .get_by_role_and_label(Role::Slider, "Turntable speed")
        .set_value_accesskit(-90.0);
    harness.run();
    harness.state_mut().update(at(1100));
    harness.state_mut().update(at(1200));
    let turned = harness.state().camera.azimuth_deg - begin.azimuth_deg;
    assert!((turned + 7.0).abs() < 1e-9, "{turned}");

    let from = harness.state().viewport.rect.center();
    let event = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.hover_at(from);
    harness.event(event(from, true));
    harness.hover_at(from + vec2(40.0, 0.0));
    harness.event(event(from + vec2(40.0, 0.0), false));
    harness.run();
    assert!(!harness.state().motion.turntable.is_on);
    let rested = harness.state().camera;
    harness.state_mut().update(at(2000));
    assert_eq!(harness.state().camera, rested);
    assert_eq!(harness.state().next_deadline(), None);

    let (role, label) = (Role::CheckBox, "Turntable");
    harness.get_by_role_and_label(role, label).scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(role, label).click();
    harness.run();
    assert!(harness.state().motion.turntable.is_on);
}

#[test]
fn a_view_is_copied_and_pasted_as_text() {
    let mut harness = window();
    harness.state_mut().camera.orbit(12.5, -3.0);
    let camera = harness.state().camera;
    harness.event(Event::Copy);
    harness.run();
    let requests = harness.state_mut().take_requests();
    let [WindowRequest::Copy(text)] = requests.as_slice() else {
        panic!("{requests:?}");
    };
    assert!(text.starts_with("pointreel view 1: target "), "{text}");
    harness.state_mut().run(Command::RESET_VIEW);
    assert_ne!(harness.state().camera, camera);
    harness.event(Event::Paste(format!("{text}\n")));
    harness.run();
    assert_eq!(harness.state().camera, camera);
    // From the menu, the window is asked for the clipboard.
    harness.state_mut().run(Command::PASTE_VIEW);
    assert_eq!(harness.state_mut().take_requests(), [WindowRequest::PasteView]);
}

#[test]
fn invalid_view_text_is_reported_and_moves_nothing() {
    let mut harness = window();
    let camera = harness.state().camera;
    let text = camera.to_string();
    for (damaged, said) in [
        (text.replace("view 1", "view 9"), "this is not a view"),
        (
            text.replace("distance", "x"),
            "`x` in a view where `distance` was expected",
        ),
        ("word ".repeat(1 << 16), "this is not a view"),
        (text.replace("perspective", &"p".repeat(1 << 16)), "unknown projection"),
    ] {
        harness.event(Event::Paste(damaged));
        harness.run();
        let state = harness.state();
        assert_eq!(state.camera, camera);
        let notices = state.notices.list();
        let notice = notices.iter().find(|notice| notice.text.contains(said));
        let notice = notice.unwrap_or_else(|| panic!("{said} is not said: {notices:?}"));
        assert_eq!(notice.severity, Severity::Error);
        assert!(notice.text.len() < 300, "{} bytes", notice.text.len());
    }
    // A text field handles pasting itself.
    let count = harness.state().notices.list().len();
    harness.get_by_label("Frame rate").click();
    harness.run();
    harness.event(Event::Paste("30".to_owned()));
    harness.run();
    assert_eq!(harness.state().notices.list().len(), count);
}

#[test]
fn a_window_starts_with_the_requested_view() {
    let window_camera = window().state().camera;
    let view = Camera {
        target_in_world: DVec3::new(0.0, 0.25, 0.0),
        distance: 9.0,
        ..window_camera
    };
    let mut harness = window_on(
        sequence(&[]),
        StateOptions {
            view: Some(view),
            ..options()
        },
    );
    assert_eq!(harness.state().camera, view);
    press(&mut harness, Modifiers::NONE, Key::R);
    assert_eq!(harness.state().camera, window_camera, "a reset shows all");
}
