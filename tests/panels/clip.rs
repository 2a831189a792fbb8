//! Clipping: a box or a plane in the coordinates of the file.

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

#[test]
fn a_box_is_cut_to_and_comes_back_as_it_was() {
    let mut harness = window();
    choose(&mut harness, "Clipping", "To a box");
    // The cube of the test's first frame.
    let whole = Clip::to(ClipShape::Box {
        min: DVec3::splat(-0.5),
        max: DVec3::splat(0.5),
    });
    assert_eq!(harness.state().style.of_sequence.clip, Some(whole));
    drag(&mut harness, "Y from", 0.25);
    drag(&mut harness, "Z to", 0.0);
    choose(&mut harness, "Keeps", "Outside");
    let cut = Clip {
        keeps_outside: true,
        ..Clip::to(ClipShape::Box {
            min: DVec3::new(-0.5, 0.25, -0.5),
            max: DVec3::new(0.5, 0.5, 0.0),
        })
    };
    assert_eq!(harness.state().style.of_sequence.clip, Some(cut));
    choose(&mut harness, "Clipping", "Off");
    assert!(harness.query_by_label("Y from").is_none());
    assert!(!harness.state().style.of_sequence.clip.unwrap().is_on);
    choose(&mut harness, "Clipping", "To a box");
    assert_eq!(harness.state().style.of_sequence.clip, Some(cut));
    tap(&mut harness, "Fit to frame");
    assert_eq!(harness.state().style.of_sequence.clip.unwrap().shape, whole.shape);
}

#[test]
fn a_plane_stands_across_an_axis() {
    let mut harness = window();
    choose(&mut harness, "Clipping", "At a plane");
    choose(&mut harness, "Plane across", "Z");
    drag(&mut harness, "Plane at", 0.125);
    let plane = Clip::to(ClipShape::Plane {
        normal: DVec3::Z,
        offset: 0.125,
    });
    assert_eq!(harness.state().style.of_sequence.clip, Some(plane));
    tap(&mut harness, "Fit to frame");
    let ClipShape::Plane { offset, .. } = harness.state().style.of_sequence.clip.unwrap().shape else {
        panic!("it is a plane");
    };
    assert_eq!(offset, 0.0);
    tap(&mut harness, "Reset to defaults");
    assert_eq!(harness.state().style.of_sequence.clip, None);
}
