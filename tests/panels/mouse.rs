//! Drags and the wheel on the image.

use super::{press, window};
use egui::{Key, Modifiers, PointerButton, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::State;

fn drag(
    harness: &mut Harness<'_, State>,
    button: PointerButton,
    modifiers: Modifiers,
    from: egui::Pos2,
    by: egui::Vec2,
) {
    let event = |pos, pressed| egui::Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers,
    };
    harness.hover_at(from);
    harness.event_modifiers(event(from, true), modifiers);
    // Within one step egui only sees the last position.
    for part in [0.5, 1.0] {
        harness.event_modifiers(egui::Event::PointerMoved(from + part * by), modifiers);
    }
    harness.event_modifiers(event(from + by, false), modifiers);
    harness.run();
}

#[test]
fn the_mouse_moves_the_camera_over_the_image_only() {
    let mut harness = window();
    let picture = harness.state().viewport.rect.center();
    let before = harness.state().camera;
    drag(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        picture,
        vec2(100.0, 0.0),
    );
    let orbited = harness.state().camera;
    assert!(orbited.azimuth_deg < before.azimuth_deg - 10.0, "{orbited:?}");
    assert_eq!(orbited.target_in_world, before.target_in_world);

    drag(
        &mut harness,
        PointerButton::Secondary,
        Modifiers::NONE,
        picture,
        vec2(0.0, 80.0),
    );
    let panned = harness.state().camera;
    assert_eq!(panned.azimuth_deg, orbited.azimuth_deg);
    assert!((panned.target_in_world - orbited.target_in_world).length() > 0.05 * panned.distance);
    drag(
        &mut harness,
        PointerButton::Primary,
        Modifiers::SHIFT,
        picture,
        vec2(0.0, -80.0),
    );
    let back = harness.state().camera;
    assert!((back.target_in_world - orbited.target_in_world).length() < 1e-3 * panned.distance);

    let style = harness.get_by_label("Background").rect().center();
    let timeline = harness.get_by_label("Timeline").rect().center();
    for from in [style, timeline, pos2(600.0, 12.0)] {
        drag(
            &mut harness,
            PointerButton::Primary,
            Modifiers::NONE,
            from,
            vec2(-300.0, -100.0),
        );
        drag(
            &mut harness,
            PointerButton::Secondary,
            Modifiers::NONE,
            from,
            vec2(-300.0, -100.0),
        );
        assert_eq!(harness.state().camera, back, "from {from}");
    }
}

#[test]
fn a_fast_drag_between_two_updates_moves_the_camera_like_a_slow_one() {
    let by = vec2(100.0, 30.0);
    for button in [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary] {
        let (mut slow, mut fast) = (window(), window());
        let from = slow.state().viewport.rect.center();
        drag(&mut slow, button, Modifiers::NONE, from, by);

        fast.hover_at(from);
        fast.run();
        let before = fast.state().camera;
        let event = |pos, pressed| egui::Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers: Modifiers::NONE,
        };
        fast.input_mut().events.extend([
            event(from, true),
            egui::Event::PointerMoved(from + 0.5 * by),
            egui::Event::PointerMoved(from + by),
            event(from + by, false),
        ]);
        fast.step();
        let (slow, fast) = (slow.state().camera, fast.state().camera);
        assert_ne!(fast, before, "{button:?}");
        let apart = (slow.target_in_world - fast.target_in_world).length()
            + (slow.azimuth_deg - fast.azimuth_deg).abs()
            + (slow.elevation_deg - fast.elevation_deg).abs();
        assert!(apart < 1e-3, "{button:?}: {slow:?} {fast:?}");
    }
}

#[test]
fn dragging_a_window_above_the_image_does_not_move_the_camera() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F1);
    let before = harness.state().camera;
    let from = harness.get_by_label("Ten frames on").rect().center();
    assert!(
        harness.state().viewport.rect.contains(from),
        "the list of keys lies above the picture"
    );
    for button in [PointerButton::Primary, PointerButton::Secondary] {
        drag(&mut harness, button, Modifiers::NONE, from, vec2(-250.0, -40.0));
        assert_eq!(harness.state().camera, before);
    }
}

fn scroll(harness: &mut Harness<'_, State>, at: egui::Pos2, delta: f32) {
    harness.hover_at(at);
    harness.step();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, delta),
        source: egui::MouseWheelSource::Wheel,
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(20);
}

#[test]
fn the_wheel_zooms_over_the_image_only() {
    let mut harness = window();
    let picture = harness.state().viewport.rect.center();
    let before = harness.state().camera;
    scroll(&mut harness, picture, 100.0);
    let near = harness.state().camera;
    assert!(
        near.distance < 0.95 * before.distance,
        "{} of {}",
        near.distance,
        before.distance
    );
    let style = harness.get_by_label("Background").rect().center();
    scroll(&mut harness, style, -100.0);
    assert_eq!(harness.state().camera, near);
}

#[test]
fn the_wheel_zooms_toward_the_pointer() {
    let mut harness = window();
    let picture = harness.state().viewport.rect;
    let pointer = picture.center() + vec2(120.0, -80.0);
    let state = harness.state();
    let size_px = state.viewport.size_px;
    // The position under the pointer at the depth of the target.
    let before = state.camera;
    let px = glam::DVec2::new(
        f64::from((pointer - picture.min).x),
        f64::from((pointer - picture.min).y),
    );
    let from_eye = before.target_in_world - before.eye_in_world();
    let right = from_eye.cross(before.up.direction()).normalize();
    let up = right.cross(from_eye).normalize();
    let along_right = before.along_line(before.target_in_world, right, px, size_px).unwrap();
    let along_up = before.along_line(before.target_in_world, up, px, size_px).unwrap();
    let place = before.target_in_world + right * along_right + up * along_up;
    harness.hover_at(pointer);
    harness.run();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 300.0),
        source: egui::MouseWheelSource::Wheel,
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(30);
    let after = harness.state().camera;
    assert!(after.distance < 0.8 * before.distance, "{after:?}");
    let seen = after.to_px(place, size_px).unwrap();
    assert!((seen - px).length() < 0.5, "{seen} for {px}");
}
