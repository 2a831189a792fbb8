//! Clipping: a box or a plane in the coordinates of the file.

use super::points::in_window;
use super::settings::{choose, tap};
use super::window;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;
use pointreel::app::State;
use pointreel::scene::{Clip, ClipShape};

fn drag(harness: &mut Harness<'_, State>, label: &str, value: f64) {
    let field = harness.get_by_role_and_label(Role::SpinButton, label);
    field.scroll_to_me();
    harness.run();
    harness
        .get_by_role_and_label(Role::SpinButton, label)
        .set_value_accesskit(value);
    harness.run();
}

/// Around a cube of the test's sequence, which are of single precision.
fn cube(edge: f32) -> Clip {
    let half = f64::from(edge - 0.5 * edge);
    Clip::to(ClipShape::Box {
        min: DVec3::splat(f64::from(-0.5 * edge)),
        max: DVec3::splat(half),
    })
}

#[test]
fn a_clip_box_is_applied_and_restored_unchanged() {
    let mut harness = window();
    choose(&mut harness, "Clipping", "To a box");
    // Around the largest cube, the last frame's.
    assert_eq!(harness.state().style.clip, Some(cube(1.23)));
    tap(&mut harness, "This frame");
    let whole = cube(1.0);
    assert_eq!(harness.state().style.clip, Some(whole));
    drag(&mut harness, "Y from", 0.25);
    drag(&mut harness, "Z to", 0.0);
    choose(&mut harness, "Keep", "Outside");
    let cut = Clip {
        keeps_outside: true,
        ..Clip::to(ClipShape::Box {
            min: DVec3::new(-0.5, 0.25, -0.5),
            max: DVec3::new(0.5, 0.5, 0.0),
        })
    };
    assert_eq!(harness.state().style.clip, Some(cut));
    choose(&mut harness, "Clipping", "Off");
    assert!(harness.query_by_label("Y from").is_none());
    assert!(!harness.state().style.clip.unwrap().is_on);
    choose(&mut harness, "Clipping", "To a box");
    assert_eq!(harness.state().style.clip, Some(cut));
    tap(&mut harness, "This frame");
    assert_eq!(harness.state().style.clip.unwrap().shape, whole.shape);
    tap(&mut harness, "All frames");
    assert_eq!(harness.state().style.clip.unwrap().shape, cube(1.23).shape);
}

#[test]
fn a_clip_plane_is_perpendicular_to_an_axis() {
    let mut harness = window();
    choose(&mut harness, "Clipping", "At a plane");
    choose(&mut harness, "Plane across", "Z");
    drag(&mut harness, "Plane at", 0.125);
    let plane = Clip::to(ClipShape::Plane {
        normal: DVec3::Z,
        offset: 0.125,
    });
    assert_eq!(harness.state().style.clip, Some(plane));
    tap(&mut harness, "All frames");
    let ClipShape::Plane { offset, .. } = harness.state().style.clip.unwrap().shape else {
        panic!("it is a plane");
    };
    assert_eq!(offset, 0.0);
    tap(&mut harness, "Reset to defaults");
    assert_eq!(harness.state().style.clip, None);
}

/// Drags the handle named `handle` in the image to the pixel of `place`.
fn pull(harness: &mut Harness<'_, State>, handle: &str, place: DVec3) {
    let from = harness.get_by_role_and_label(Role::Slider, handle).rect().center();
    let to = in_window(harness, place);
    // Not quite at the centre, and not quite on the line.
    let slack = egui::vec2(2.0, -1.0);
    harness.drag_at(from + slack);
    harness.run();
    harness.hover_at(from.lerp(to, 0.5) + slack);
    harness.run();
    harness.hover_at(to + slack);
    harness.run();
    harness.drop_at(to + slack);
    harness.run();
}

#[test]
fn edges_of_the_box_are_dragged_in_the_image() {
    let mut harness = window();
    choose(&mut harness, "Clipping", "To a box");
    tap(&mut harness, "This frame");
    let camera = harness.state().camera;
    pull(&mut harness, "X to in the view", DVec3::new(0.2, 0.0, 0.0));
    pull(&mut harness, "Y from in the view", DVec3::new(-0.15, -0.1, 0.0));
    let ClipShape::Box { min, max } = harness.state().style.clip.unwrap().shape else {
        panic!("it is a box");
    };
    assert!((max - DVec3::new(0.2, 0.5, 0.5)).length() < 0.01, "{max}");
    assert!((min - DVec3::new(-0.5, -0.1, -0.5)).length() < 0.01, "{min}");
    assert_eq!(harness.state().camera, camera, "the picture was not dragged");
    // One edge does not cross the other.
    pull(&mut harness, "X to in the view", DVec3::new(-0.9, 0.2, 0.0));
    let ClipShape::Box { min, max } = harness.state().style.clip.unwrap().shape else {
        panic!("it is a box");
    };
    assert_eq!(max.x, min.x);
    // Without its outline there is nothing to drag.
    harness.get_by_role_and_label(Role::CheckBox, "Outline").scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::CheckBox, "Outline").click();
    harness.run();
    assert!(harness.query_by_label("X to in the view").is_none());
}

#[test]
fn a_plane_is_dragged_along_its_normal() {
    let mut harness = window();
    choose(&mut harness, "Clipping", "At a plane");
    choose(&mut harness, "Keep", "\u{2212}X side");
    pull(&mut harness, "Plane in the view", DVec3::new(0.3, 0.0, 0.0));
    let clip = harness.state().style.clip.unwrap();
    assert!(clip.keeps_outside);
    let ClipShape::Plane { normal, offset } = clip.shape else {
        panic!("it is a plane");
    };
    assert_eq!(normal, DVec3::X);
    assert!((offset - 0.3).abs() < 0.01, "{offset}");
}
