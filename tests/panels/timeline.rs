//! The timeline: buttons, bar, speed, loop mode.

use super::{FRAMES, click, clock, drag, frame, is_playing, window};
use egui::accesskit::Role;
use egui::pos2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, State};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::sequence::{FrameEntry, Sequence};
use pointreel::timeline::LoopMode;
use std::time::Duration;

#[test]
fn the_play_button_plays_and_pauses() {
    let mut harness = window();
    click(&mut harness, "Play");
    assert!(is_playing(&harness));
    // 24 frames per second: the third frame is due after 2/24 s.
    assert!(harness.state_mut().update(Duration::from_millis(85)).is_visible());
    assert_eq!(frame(&harness), 2);
    assert_eq!(harness.state().player.as_ref().unwrap().shown().unwrap().index, 2);
    harness.run();
    click(&mut harness, "Pause");
    assert!(!is_playing(&harness));
    assert!(!harness.state_mut().update(Duration::from_secs(9)).is_visible());
    assert_eq!(frame(&harness), 2);
}

#[test]
fn buttons_step_and_jump() {
    let mut harness = window();
    for (label, expected) in [
        ("Next frame", 1),
        ("Next frame", 2),
        ("Previous frame", 1),
        ("Last frame", 23),
        ("First frame", 0),
    ] {
        click(&mut harness, label);
        assert_eq!(frame(&harness), expected, "{label}");
    }
    assert!(harness.query_by_label(" 1 of 24").is_some());
}

#[test]
fn playback_continues_after_scrubbing() {
    let mut harness = window();
    click(&mut harness, "Play");
    let bar = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let at = |frame: f32| pos2(bar.left() + bar.width() * (frame + 0.5) / FRAMES as f32, bar.center().y);
    harness.drag_at(at(2.0));
    harness.hover_at(at(6.0));
    harness.run();
    assert!(!is_playing(&harness), "the playhead is in the hand");
    assert_eq!(frame(&harness), 6);
    harness.hover_at(at(18.0));
    harness.run();
    assert_eq!(frame(&harness), 18);
    harness.state_mut().update(Duration::from_secs(3));
    assert_eq!(frame(&harness), 18);
    harness.drop_at(at(18.0));
    harness.run();
    assert!(is_playing(&harness));
    harness.state_mut().update(Duration::from_millis(3050));
    assert_eq!(frame(&harness), 19);
    // Beyond the ends it stops at them.
    harness.drag_at(at(20.0));
    harness.hover_at(pos2(bar.right() + 300.0, bar.center().y));
    harness.run();
    assert_eq!(frame(&harness), 23);
}

#[test]
fn speed_rate_and_loop_mode_are_set_on_the_timeline() {
    let mut harness = window();
    choose_loop(&mut harness, "Loop", "Ping-pong");
    assert_eq!(clock(&harness).loop_mode(), LoopMode::PingPong);
    click(&mut harness, "Reverse");
    assert_eq!(clock(&harness).speed(), -1.0);
    harness.get_by_label("Speed").set_value_accesskit(2.5);
    harness.run();
    assert_eq!(clock(&harness).speed(), -2.5);
    harness.get_by_label("Frame rate").set_value_accesskit(30.0);
    harness.run();
    assert_eq!(clock(&harness).fps(), 30.0);
}

#[test]
fn dragging_in_and_out_points_does_not_move_the_playhead() {
    let mut harness = window();
    let bar = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let border = |frame: usize| pos2(bar.left() + bar.width() * frame as f32 / FRAMES as f32, bar.center().y);
    go_to(&mut harness, 4);
    harness.state_mut().run(Command::SET_IN);
    go_to(&mut harness, 15);
    harness.state_mut().run(Command::SET_OUT);
    harness.run();
    drag(&mut harness, border(4), border(8));
    drag(&mut harness, border(16), border(20));
    let range = clock(&harness).range();
    assert_eq!((range.first(), range.last()), (Some(8), Some(19)));
    assert_eq!(frame(&harness), 15, "that was not the playhead");
    // Neither crosses the other.
    drag(&mut harness, border(20), border(2));
    let range = clock(&harness).range();
    assert_eq!((range.first(), range.last()), (Some(8), Some(8)));
    // Elsewhere a drag scrubs.
    drag(
        &mut harness,
        border(12) + egui::vec2(3.0, 0.0),
        border(17) + egui::vec2(3.0, 0.0),
    );
    assert_eq!(clock(&harness).range(), range);
    assert_eq!(frame(&harness), 17);
}

#[test]
fn the_rate_is_shown_while_playing() {
    let mut harness = window();
    assert!(harness.query_by_label_contains(" fps").is_none(), "it rests");
    click(&mut harness, "Play");
    for tick in 1..=60 {
        harness.state_mut().update(Duration::from_millis(tick * 1000 / 24));
    }
    harness.run();
    assert!(harness.query_by_label_contains(" of 24 fps").is_some());
    click(&mut harness, "Pause");
    assert!(harness.query_by_label_contains("of 24 fps").is_none());
}

#[test]
fn the_wheel_zooms_in_around_the_pointer() {
    let mut harness = window();
    let bar = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let wheel = |harness: &mut Harness<'_, State>, at: egui::Pos2, by: f32| {
        harness.hover_at(at);
        harness.run();
        harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, by),
            source: egui::MouseWheelSource::Wheel,
            phase: egui::TouchPhase::Move,
            modifiers: egui::Modifiers::NONE,
        });
        harness.run_steps(30);
    };
    // The first frame is at the pointer, and stays there.
    wheel(&mut harness, bar.left_center() + egui::vec2(2.0, 0.0), 2000.0);
    let press = |harness: &mut Harness<'_, State>, at: egui::Pos2| {
        harness.drag_at(at);
        harness.run();
        harness.drop_at(at);
        harness.run();
    };
    press(&mut harness, bar.right_center() - egui::vec2(2.0, 0.0));
    assert_eq!(frame(&harness), 7, "eight frames are shown");
    press(&mut harness, bar.left_center() + egui::vec2(2.0, 0.0));
    assert_eq!(frame(&harness), 0);
    wheel(&mut harness, bar.center(), -4000.0);
    press(&mut harness, bar.right_center() - egui::vec2(2.0, 0.0));
    assert_eq!(frame(&harness), 23, "all are shown again");
}

#[test]
fn missing_numbers_are_marked() {
    let numbers = [1, 2, 3, 6, 7, 9];
    let entries = numbers.map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("/scans/walk/{number}.ply"))
    });
    let sequence = Sequence::with_decoder(entries.into(), |_| {
        Ok(RawCloud::from_positions(Positions::F32(vec![[0.0; 3], [1.0; 3]])))
    });
    let mut harness = super::window_on(std::sync::Arc::new(sequence), super::options());
    harness.run();
    let bar = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    for (text, after) in [
        ("2 files are missing here: 4 to 5", 3.0),
        ("File 8 is missing here", 5.0),
    ] {
        let notch = harness.get_by_label(text).rect();
        let x = bar.left() + bar.width() * after / 6.0;
        assert!((notch.center().x - x).abs() < 1.0, "{text} at {notch:?}");
    }
    go_to(&mut harness, 3);
    harness.run();
    assert!(harness.query_by_label("4 of 6").is_some());
    assert!(harness.query_by_label("file 6").is_some());
    click(&mut harness, "Legend of the timeline");
    assert!(harness.query_by_label("Numbers of files are missing here").is_some());
}

fn go_to(harness: &mut Harness<'_, State>, frame: usize) {
    let now = harness.state().now();
    harness.state_mut().player.as_mut().unwrap().seek(frame, now);
}

fn choose_loop(harness: &mut Harness<'_, State>, now: &str, entry: &str) {
    harness.get_by_value(now).click();
    harness.run();
    click(harness, entry);
}
