//! Trails of points through time.

use super::points::{click_on, corner, in_squares, in_window};
use super::{FRAMES, click, options, press, sequence, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, State};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::sequence::{FrameEntry, Sequence};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A window on `sequence` with its points drawn as squares of 9 pixels, and the tool for values chosen.
fn picking(sequence: Arc<Sequence>) -> Harness<'static, State> {
    let mut harness = in_squares(window_on(sequence, options()));
    press(&mut harness, Modifiers::NONE, Key::I);
    harness
}

/// Picks a corner of the cube that is shown first.
fn pick(harness: &mut Harness<'_, State>, index: u32) {
    let at = in_window(harness, corner(index));
    click_on(harness, at, 1);
    // Two clicks in quick succession would be a double click.
    harness.run_steps(10);
    let picked = harness.state().features.inspection.point.clone().unwrap();
    assert_eq!(picked.values.index_in_file, index);
}

/// Lets the task end.
fn until_found(harness: &mut Harness<'_, State>) {
    let patience = Instant::now();
    loop {
        let now = harness.state().now();
        harness.state_mut().update(now);
        harness.run();
        let trails = &harness.state().features.trails;
        if trails.found().is_some() && trails.progress().is_none() {
            return;
        }
        assert!(patience.elapsed() < Duration::from_mins(1));
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn the_button_shows_the_trail_of_the_point_with_length_and_speed() {
    let mut harness = picking(sequence(&[]));
    pick(&mut harness, 6);
    assert!(harness.query_by_label("Travelled").is_none());
    click(&mut harness, "Trail");
    until_found(&mut harness);
    let trails = harness.state().features.trails.found().unwrap();
    assert_eq!((trails.frames(), trails.trail_count()), (0..FRAMES, 1));
    // The cube grows by a hundredth per frame: its corners move by half of that along three axes, at 24 frames per
    // second.
    let step = 0.005 * 3f64.sqrt();
    for frame in 0..FRAMES {
        let half = 0.5 * (1.0 + frame as f32 / 100.0);
        let place = trails.place(0, frame).unwrap();
        assert!((place - half * glam::Vec3::new(-1.0, 1.0, 1.0)).length() < 1e-6);
    }
    let player = harness.state().player.as_ref().unwrap();
    let measure = harness.state().features.trails.measure(6, |frame| player.time_s(frame));
    let measure = measure.unwrap();
    assert!((measure.length - 23.0 * step).abs() < 1e-6);
    assert!((measure.mean_speed - 24.0 * step).abs() < 1e-5);
    for name in ["Travelled", "Mean speed", "Largest speed"] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());

    // Only from the in point to the out point.
    harness.state_mut().step_frames(3);
    harness.state_mut().run(Command::SET_IN);
    harness.state_mut().step_frames(2);
    harness.state_mut().run(Command::SET_OUT);
    harness.run();
    until_found(&mut harness);
    assert_eq!(harness.state().features.trails.found().unwrap().frames(), 3..6);
    press(&mut harness, Modifiers::SHIFT, Key::T);
    assert!(harness.state().features.trails.found().is_none());
    assert!(harness.query_by_label("Travelled").is_none());
}

#[test]
fn trails_of_several_points_are_shown_together() {
    let mut harness = picking(sequence(&[]));
    pick(&mut harness, 6);
    click(&mut harness, "Trail");
    until_found(&mut harness);
    click(&mut harness, "Keep trail");
    pick(&mut harness, 7);
    until_found(&mut harness);
    assert_eq!(harness.state().features.trails.found().unwrap().trail_count(), 2);
    let measured = |harness: &Harness<'_, State>, index| {
        let trails = &harness.state().features.trails;
        trails.measure(index, |frame| frame as f64).is_some()
    };
    assert!(measured(&harness, 6) && measured(&harness, 7) && !measured(&harness, 5));
    click(&mut harness, "Forget kept trails");
    until_found(&mut harness);
    assert!(measured(&harness, 7) && !measured(&harness, 6));
    click(&mut harness, "Keep trail");
    pick(&mut harness, 5);
    // Trails of points sampled over the whole file are not among them.
    harness.state_mut().features.trails.field.is_on = true;
    harness.state_mut().features.trails.field.points = 4;
    harness.run();
    until_found(&mut harness);
    assert_eq!(harness.state().features.trails.found().unwrap().trail_count(), 6);
    assert!(measured(&harness, 5) && !measured(&harness, 3));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    until_found(&mut harness);
    assert_eq!(
        harness.state().features.trails.found().unwrap().trail_count(),
        5,
        "the kept one and four others"
    );
}

/// The cube of eight corners, but ten points in the seventh frame.
fn varying() -> Arc<Sequence> {
    let sources = (0..FRAMES as u64).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("/scans/varying/frame_{number:04}.ply"))
    });
    Arc::new(Sequence::with_decoder(sources.collect(), |source| {
        let count = if source.number == Some(6) { 10 } else { 8 };
        let corner = |index: u32| [0, 1, 2].map(|axis| ((index % 8) >> axis & 1) as f32 - 0.5);
        let positions = (0..count).map(corner).collect();
        Ok(RawCloud::from_positions(Positions::F32(positions)))
    }))
}

#[test]
fn unstable_point_indices_are_reported_in_the_panel() {
    let mut harness = picking(varying());
    pick(&mut harness, 7);
    click(&mut harness, "Trail");
    until_found(&mut harness);
    let text = "Frame 7 has 10 points, frame 6 has 8: indices do not stay with the points";
    assert!(harness.query_by_label(text).is_some());
    let trails = harness.state().features.trails.found().unwrap();
    let places: Vec<usize> = (0..FRAMES).filter(|&frame| trails.place(0, frame).is_none()).collect();
    assert_eq!(places, [6]);
}

#[test]
fn trails_of_a_field_are_chosen_in_the_settings_and_can_be_cancelled() {
    let mut harness = window_on(sequence(&[]), options());
    let find = |harness: &Harness<'_, State>| {
        harness.get_by_role_and_label(Role::CheckBox, "Trails").scroll_to_me();
    };
    find(&harness);
    harness.run();
    harness.get_by_role_and_label(Role::CheckBox, "Trails").click();
    harness.run();
    until_found(&mut harness);
    assert_eq!(harness.state().features.trails.found().unwrap().trail_count(), 8);
    harness
        .get_by_role_and_label(Role::Slider, "Trail points")
        .scroll_to_me();
    harness.run();
    super::settings::slide(&mut harness, "Trail points", 3.0);
    super::settings::slide(&mut harness, "Trail length", 5.0);
    until_found(&mut harness);
    assert_eq!(harness.state().features.trails.found().unwrap().trail_count(), 3);
    assert_eq!(harness.state().features.trails.field.length, 5);
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
}

#[test]
fn finding_trails_can_be_cancelled() {
    let hold = Arc::new(std::sync::Mutex::new(()));
    let held = Arc::clone(&hold);
    let sources = (0..FRAMES as u64).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("/scans/slow/frame_{number:04}.ply"))
    });
    let slow = Sequence::with_decoder(sources.collect(), move |source| {
        if source.number != Some(0) {
            drop(held.lock().unwrap());
        }
        let corner = |index: u32| [0, 1, 2].map(|axis| (index >> axis & 1) as f32 - 0.5);
        let positions = (0..8).map(corner).collect();
        Ok(RawCloud::from_positions(Positions::F32(positions)))
    });
    let guard = hold.lock().unwrap();
    let mut state = State::new(options());
    state.open(Arc::new(slow));
    let patience = Instant::now();
    while state.player.as_ref().unwrap().shown().is_none() {
        state.update(Duration::ZERO);
        assert!(patience.elapsed() < Duration::from_mins(1));
        std::thread::sleep(Duration::from_millis(2));
    }
    state.features.trails.field.is_on = true;
    state.update(Duration::ZERO);
    assert_eq!(state.features.trails.progress().map(|(_, all)| all), Some(FRAMES));
    state.features.trails.cancel();
    assert_eq!(state.features.trails.progress(), None);
    drop(guard);
    std::thread::sleep(Duration::from_millis(50));
    state.update(Duration::ZERO);
    assert!(state.features.trails.found().is_none());
}

#[test]
fn trails_can_be_undone() {
    let mut harness = picking(sequence(&[]));
    pick(&mut harness, 6);
    press(&mut harness, Modifiers::SHIFT, Key::T);
    assert!(harness.state().features.trails.is_on);
    until_found(&mut harness);
    let anchor = harness.state().features.inspection.point.as_ref().unwrap().anchor;
    harness.state_mut().features.trails.toggle_pinned(anchor);
    // Past the time within which it would count as the same change.
    harness.run_steps(120);
    harness.state_mut().run(Command::UNDO);
    let trails = &harness.state().features.trails;
    assert!(trails.is_on && trails.pinned.is_empty());
    harness.state_mut().run(Command::REDO);
    let trails = &harness.state().features.trails;
    assert_eq!(trails.pinned, [anchor]);
    harness.state_mut().run(Command::UNDO);
    harness.state_mut().run(Command::UNDO);
    assert!(!harness.state().features.trails.is_on);
}
