//! Change maps and onion skin: additions to the image from other frames.

use super::settings::slide;
use super::{options, sequence, window, window_on};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::State;
use pointreel::scene::Lighting;
use std::time::{Duration, Instant};

fn check(harness: &mut Harness<'_, State>, label: &str) {
    let find = |harness: &Harness<'_, State>| {
        harness.get_by_role_and_label(Role::CheckBox, label).scroll_to_me();
    };
    find(harness);
    harness.run();
    harness.get_by_role_and_label(Role::CheckBox, label).click();
    harness.run();
}

fn set(harness: &mut Harness<'_, State>, label: &str, value: f64) {
    harness
        .get_by_role_and_label(Role::SpinButton, label)
        .set_value_accesskit(value);
    harness.run();
}

/// Lets tasks finish: until the packet is made of `points` points.
fn until_points(harness: &mut Harness<'_, State>, points: usize) -> Vec<[u8; 4]> {
    let patience = Instant::now();
    loop {
        let now = harness.state().now();
        harness.state_mut().update(now);
        harness.run();
        harness.state_mut().forget_picture();
        let packet = harness.state_mut().next_packet().unwrap();
        let records = packet.content.points().unwrap();
        if records.len() == points {
            return records.iter().map(|point| point.color).collect();
        }
        assert!(patience.elapsed() < Duration::from_mins(1), "{}", records.len());
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn until_measured(harness: &mut Harness<'_, State>) {
    let patience = Instant::now();
    loop {
        let now = harness.state().now();
        harness.state_mut().update(now);
        harness.run();
        if harness.query_by_label("Copy numbers").is_some() {
            return;
        }
        assert!(patience.elapsed() < Duration::from_mins(1));
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn the_change_map_is_measured_shown_and_can_be_copied() {
    let mut harness = window();
    check(&mut harness, "Change map");
    until_measured(&mut harness);
    // A cube of edge 1 grows by a hundredth per frame: every corner moves by half of that along three axes.
    let moved = |frames: f64| f64::from(3f32.sqrt()) * 0.005 * frames;
    let pose = harness.state().player.as_ref().unwrap().shown().unwrap().clone();
    let (mean, share) = {
        let (change, range) = harness.state().features.temporal.measured(&pose).unwrap();
        assert!((range - moved(1.0)).abs() < 1e-6);
        (change.mean, change.share_above(0.0))
    };
    assert!((mean - moved(1.0)).abs() < 1e-6, "{mean}");
    assert_eq!(share, 1.0);
    assert!(harness.query_by_label("1 → 2").is_some());
    assert!(harness.query_by_label("100.00 %").is_some());
    set(&mut harness, "Threshold", 0.5);
    assert!(harness.query_by_label("0.00 %").is_some());

    set(&mut harness, "Compared with", 4.0);
    until_measured(&mut harness);
    let (change, _) = harness.state().features.temporal.measured(&pose).unwrap();
    assert!((change.mean - moved(4.0)).abs() < 1e-6);
    set(&mut harness, "Compared with", -1.0);
    assert!(harness.query_by_label("The sequence has no such frame").is_some());
    set(&mut harness, "Compared with", 1.0);
    check(&mut harness, "Range");
    set(&mut harness, "Largest", 2.0);
    assert_eq!(harness.state().features.temporal.change.range, Some(2.0));
}

#[test]
fn the_change_map_colors_the_image_until_closed() {
    let mut harness = window();
    harness.state_mut().style.light.lighting = Lighting::Unlit.into();
    let before = until_points(&mut harness, 8);
    check(&mut harness, "Change map");
    until_measured(&mut harness);
    let colors = until_points(&mut harness, 8);
    assert_ne!(colors, before);
    // All corners have moved equally far, which is the end of the map.
    assert!(
        colors
            .iter()
            .all(|color| *color == pointreel::analysis::ColorMap::Viridis.color(1.0))
    );
    check(&mut harness, "Change map");
    assert_eq!(until_points(&mut harness, 8), before);
}

#[test]
fn ghosts_are_a_sample_of_neighbouring_poses() {
    let mut harness = window();
    check(&mut harness, "Onion skin");
    for (label, value) in [
        ("Frames before", 3.0),
        ("Frames after", 1.0),
        ("Frame step", 2.0),
        ("Ghost strength", 1.0),
    ] {
        slide(&mut harness, label, value);
    }
    let onion = harness.state().features.temporal.onion;
    assert_eq!((onion.before, onion.after, onion.step, onion.strength), (3, 1, 2, 1.0));
    // The first frame has no predecessor.
    until_points(&mut harness, 8 + 8);
    harness.key_press(egui::Key::ArrowRight);
    harness.run();
    harness.key_press(egui::Key::ArrowRight);
    harness.run();
    until_points(&mut harness, 8 + 8 + 8);
    check(&mut harness, "Onion skin");
    until_points(&mut harness, 8);
}

#[test]
fn an_unreadable_frame_has_no_change_map() {
    let mut harness = window_on(sequence(&[1]), options());
    check(&mut harness, "Change map");
    let patience = Instant::now();
    while harness.state().features.temporal.problem().is_none() {
        let now = harness.state().now();
        harness.state_mut().update(now);
        assert!(patience.elapsed() < Duration::from_mins(1));
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.run();
    let problem = harness.state().features.temporal.problem().unwrap().to_owned();
    assert!(problem.contains("expected an element"), "{problem}");
    assert!(harness.query_by_label_contains("expected an element").is_some());
}
