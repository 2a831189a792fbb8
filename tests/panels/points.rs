//! Picking points and measuring between them.

use super::{click, frame, load_all, press, window};
use egui::accesskit::Role;
use egui::{Key, Modifiers, OutputCommand, PointerButton, Pos2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;
use pointreel::app::{Command, State, Tool};
use pointreel::scene::{MeasurementKind, Primitive, Settings};
use std::time::Duration;

/// A window on the cube that grows, its corners drawn as squares of 9 pixels, seen from the front and above.
fn cube() -> Harness<'static, State> {
    in_squares(window())
}

/// The window with all frames there and points drawn as squares of 9 pixels.
pub(super) fn in_squares(mut harness: Harness<'static, State>) -> Harness<'static, State> {
    harness.state_mut().style = Settings::default().with(|style| {
        style.primitive = Primitive::Point.into();
        style.points.size_px = 9.0;
    });
    load_all(harness.state_mut());
    harness.run();
    harness.state_mut().next_packet().unwrap();
    harness
}

/// Corner of the cube of the first frame, by its index in the file.
pub(super) fn corner(index: u32) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| f64::from(index >> axis & 1) - 0.5))
}

/// The pixel of a position in the window.
pub(super) fn in_window(harness: &Harness<'_, State>, place: DVec3) -> Pos2 {
    let state = harness.state();
    let px = state.camera.to_px(place, state.viewport.size_px).unwrap();
    state.viewport.rect.min + egui::vec2(px.x as f32, px.y as f32)
}

pub(super) fn click_on(harness: &mut Harness<'_, State>, place: Pos2, times: usize) {
    let event = |pressed| egui::Event::PointerButton {
        pos: place,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.hover_at(place);
    harness.run();
    for _ in 0..times {
        harness.input_mut().events.extend([event(true), event(false)]);
    }
    harness.run();
}

/// Clicks a button and returns the contents of the clipboard.
pub(super) fn copied(harness: &mut Harness<'_, State>, button: &str) -> String {
    harness.get_by_role_and_label(Role::Button, button).click();
    for _ in 0..4 {
        harness.step();
        for command in &harness.output().platform_output.commands {
            if let OutputCommand::CopyText(text) = command {
                return text.clone();
            }
        }
    }
    panic!("{button} copied nothing");
}

#[test]
fn a_click_shows_the_values_of_a_point_and_escape_clears_them() {
    let mut harness = cube();
    let place = in_window(&harness, corner(7));
    click_on(&mut harness, place, 1);
    assert!(harness.state().features.inspection.point.is_none(), "no tool is chosen");

    press(&mut harness, Modifiers::NONE, Key::I);
    assert!(harness.query_by_label_contains("Click on a point").is_some());
    // A few pixels next to the corner.
    click_on(&mut harness, place + egui::vec2(7.0, -3.0), 1);
    let values = harness.state().features.inspection.point.clone().unwrap().values;
    assert_eq!((values.index_in_file, values.frame), (7, 0));
    assert_eq!(values.position, corner(7));
    for name in ["Index", "x", "y", "z", "Drawn as", "Distance to camera"] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
    assert!(harness.query_by_label("Colour").is_none(), "the file has none");
    assert_eq!(copied(&mut harness, "Copy Index"), "7");
    assert_eq!(copied(&mut harness, "Copy x"), "0.5");
    let all = copied(&mut harness, "Copy all");
    assert!(all.contains("Frame\t1\nIndex\t7\nx\t0.5\n"), "{all}");
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());

    // Next to the cube nothing is picked, and the panel stays as it is.
    let aside = harness.state().viewport.rect.left_bottom() + egui::vec2(30.0, -30.0);
    click_on(&mut harness, aside, 1);
    assert_eq!(
        harness.state().features.inspection.point.clone().unwrap().values,
        values
    );
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().features.inspection.point.is_none());
    assert_eq!(harness.state().features.inspection.tool, Tool::Point);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(harness.state().features.inspection.tool, Tool::Camera);
    assert!(harness.query_by_label_contains("Click on a point").is_none());
}

#[test]
fn a_point_is_followed_through_the_frames() {
    let mut harness = cube();
    press(&mut harness, Modifiers::NONE, Key::I);
    let place = in_window(&harness, corner(3));
    click_on(&mut harness, place, 1);
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    harness.state_mut().update(Duration::ZERO);
    harness.run();
    assert_eq!(frame(&harness), 10);
    let values = harness.state().features.inspection.point.clone().unwrap().values;
    assert_eq!((values.index_in_file, values.frame), (3, 10));
    assert!((values.position - 1.1 * corner(3)).length() < 1e-6);
    assert!(harness.query_all_by_value("11 of 24").next().is_some());
}

#[test]
fn distances_angles_and_heights_are_measured() {
    let mut harness = cube();
    press(&mut harness, Modifiers::NONE, Key::M);
    assert!(harness.query_by_label("Click on point 1 of 2. Esc ends.").is_some());
    let take = |harness: &mut Harness<'_, State>, indices: &[u32]| {
        for &index in indices {
            let place = in_window(harness, corner(index));
            click_on(harness, place, 1);
            // Two clicks at the same position in quick succession would be a double click.
            harness.run_steps(10);
        }
    };
    take(&mut harness, &[7]);
    assert!(harness.query_by_label("Click on point 2 of 2. Esc ends.").is_some());
    take(&mut harness, &[4]);
    assert!(harness.query_by_label("1.414").is_some());
    click(&mut harness, "Angle");
    take(&mut harness, &[5, 7, 6]);
    assert!(harness.query_by_label("90.000°").is_some());
    click(&mut harness, "Height");
    take(&mut harness, &[5, 7]);
    let measurements = &harness.state().features.inspection.measurements;
    let kinds: Vec<MeasurementKind> = measurements.iter().map(|measured| measured.kind).collect();
    assert_eq!(
        kinds,
        [
            MeasurementKind::Distance,
            MeasurementKind::Angle,
            MeasurementKind::Height
        ]
    );
    assert_eq!(measurements[2].value(DVec3::Y), Some(1.0));
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());

    let text = copied(&mut harness, "Copy as text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3);
    assert_eq!(
        lines[2],
        "height\t1\tframe 1 point 5 at 0.5 -0.5 0.5\tframe 1 point 7 at 0.5 0.5 0.5"
    );
    click(&mut harness, "Delete measurement 2");
    let measurements = &harness.state().features.inspection.measurements;
    assert_eq!(measurements.len(), 2);
    assert_eq!(measurements[1].kind, MeasurementKind::Height);
    // They grow with the cube.
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    harness.state_mut().update(Duration::ZERO);
    harness.run();
    assert!(harness.query_by_label("1.556").is_some());
    click(&mut harness, "Delete all");
    assert_eq!(harness.state().features.inspection.measurements, []);
    // A measurement in progress is discarded first.
    take(&mut harness, &[]);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(harness.state().features.inspection.tool, Tool::Camera);
}

#[test]
fn a_double_click_glides_to_the_point_or_frames_the_cloud() {
    let mut harness = cube();
    let before = harness.state().camera;
    let place = in_window(&harness, corner(6));
    click_on(&mut harness, place, 2);
    let state = harness.state_mut();
    assert_eq!(state.camera, before, "it has not begun");
    assert_eq!(state.next_deadline(), Some(Duration::ZERO));
    assert!(state.update(Duration::from_millis(100)).is_visible());
    let on_its_way = state.camera;
    assert!(on_its_way.distance < before.distance && on_its_way.target_in_world != corner(6));
    state.update(Duration::from_millis(300));
    assert!(!state.update(Duration::from_millis(301)).is_visible());
    assert_eq!(state.next_deadline(), None);
    assert!((state.camera.target_in_world - corner(6)).length() < 1e-6);
    let expected = 0.5 * before.eye_in_world().distance(corner(6));
    assert!((state.camera.distance - expected).abs() < 1e-6);
    assert_eq!(state.camera.azimuth_deg, before.azimuth_deg);
    state.next_packet().unwrap();

    let rect = harness.state().viewport.rect;
    click_on(&mut harness, pos2(rect.left() + 8.0, rect.top() + 8.0), 2);
    let state = harness.state_mut();
    state.update(state.now() + Duration::from_secs(1));
    let framed = state.camera;
    assert!(framed.distance > before.distance, "everything is seen");
    assert!(framed.target_in_world.length() < 1e-6, "{framed:?}");
}

#[test]
fn the_key_focuses_on_the_point_under_the_pointer() {
    let mut harness = cube();
    let before = harness.state().camera;
    let place = in_window(&harness, corner(2));
    harness.hover_at(place);
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::F);
    harness.state_mut().update(Duration::from_millis(300));
    let focused = harness.state().camera;
    assert!((focused.target_in_world - corner(2)).length() < 1e-6);
    // Outside the image the pointer is over nothing.
    harness.state_mut().camera = before;
    harness.hover_at(pos2(500.0, 5.0));
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::F);
    harness.state_mut().update(Duration::from_millis(900));
    assert_eq!(harness.state().camera, before);
}

#[test]
fn undone_measurements_use_the_current_positions_of_their_points() {
    let mut harness = cube();
    let count = |harness: &Harness<'_, State>| harness.state().features.inspection.measurements.len();
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::M);
    for index in [6, 7] {
        let place = in_window(&harness, corner(index));
        click_on(&mut harness, place, 1);
        harness.run_steps(10);
    }
    assert_eq!(count(&harness), 1);
    let measured = harness.state().features.inspection.measurements.clone();

    // Points that move with the frames are not a change.
    harness.state_mut().step_frames(5);
    load_all(harness.state_mut());
    harness.run();
    let moved = harness.state().features.inspection.measurements.clone();
    assert_ne!(moved, measured, "the cube grows");

    harness.state_mut().run(Command::UNDO);
    assert_eq!(count(&harness), 0);
    harness.run();
    harness.state_mut().run(Command::REDO);
    load_all(harness.state_mut());
    harness.run();
    assert_eq!(
        harness.state().features.inspection.measurements,
        moved,
        "not where they were clicked"
    );
    click(&mut harness, "Edit");
    assert!(
        harness
            .query_all_by_label_contains("Undo: Measurement")
            .next()
            .is_some()
    );
}
