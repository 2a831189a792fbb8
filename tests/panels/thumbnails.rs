//! Thumbnails over the timeline.

use super::{click, frame, options, press, sequence, window, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::{Command, Preferences, State, StateOptions};
use pointreel::scene::UpAxis;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

fn with_thumbnails() -> StateOptions {
    StateOptions {
        preferences: Preferences::default(),
        ..options()
    }
}

/// Waits until all thumbnails of the strip are there.
fn until_made(harness: &mut Harness<'_, State>) -> usize {
    let patience = Instant::now();
    loop {
        let now = harness.state().now();
        harness.state_mut().update(now);
        harness.run();
        let [made, all] = harness.state().features.thumbnails.progress();
        if made == all && all > 0 {
            return all;
        }
        assert!(patience.elapsed() < Duration::from_mins(1), "{made} of {all}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn pictures(harness: &Harness<'_, State>) -> usize {
    let all = harness.query_all_by_label_contains("Thumbnail of frame");
    all.count()
}

#[test]
fn the_strip_shows_frames_in_place_and_a_click_seeks() {
    let mut harness = window_on(sequence(&[7]), with_thumbnails());
    harness.run();
    assert!(
        harness
            .query_all_by_label_contains("has no thumbnail yet")
            .next()
            .is_some(),
        "pictures come one by one"
    );
    let cells = until_made(&mut harness);
    assert!((15..24).contains(&cells), "{cells} fit the window");
    let pictures = pictures(&harness);
    // Frame 8, the broken one, may fall between two cells.
    let broken = harness.query_by_label("Frame 8 cannot be read");
    assert_eq!(pictures + usize::from(broken.is_some()), cells);
    assert!(harness.state().features.thumbnails.byte_size() <= 16 << 20);
    assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());

    let bar = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let last = harness.get_all_by_label_contains("Thumbnail of frame").last().unwrap();
    assert!(last.rect().bottom() <= bar.top(), "over the bar");
    let name = last.accesskit_node().label().unwrap();
    let number: usize = name.rsplit(' ').next().unwrap().parse().unwrap();
    let center = (last.rect().center().x - bar.left()) / bar.width();
    let at = (center * super::FRAMES as f32) as usize;
    assert_eq!(at + 1, number, "where its frame is on the bar");
    click(&mut harness, &name);
    assert_eq!(frame(&harness) + 1, number);
}

#[test]
fn the_tooltip_of_the_bar_has_a_larger_thumbnail() {
    let mut harness = window_on(sequence(&[]), with_thumbnails());
    until_made(&mut harness);
    let bar = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let bytes = harness.state().features.thumbnails.byte_size();
    // Each frame in turn, including those that are not on the strip.
    for number in 0..super::FRAMES {
        let x = bar.left() + bar.width() * (number as f32 + 0.5) / super::FRAMES as f32;
        harness.hover_at(pos2(x, bar.center().y));
        harness.run();
        until_made(&mut harness);
        std::thread::sleep(Duration::from_millis(20));
    }
    until_made(&mut harness);
    assert!(
        harness.state().features.thumbnails.byte_size() > bytes,
        "frames between those of the strip have pictures too"
    );
    for _ in 0..60 {
        harness.step();
    }
    assert!(
        harness
            .query_by_label_contains("Frame 24 of 24 (file 23), 0.96 s")
            .is_some()
    );
}

#[test]
fn thumbnails_arrive_one_by_one_and_then_nothing_is_redrawn() {
    let wakes = Arc::new(AtomicU64::new(0));
    let counted = Arc::clone(&wakes);
    let mut harness = window_on(
        sequence(&[]),
        StateOptions {
            wake: Arc::new(move || {
                counted.fetch_add(1, Ordering::Relaxed);
            }),
            ..with_thumbnails()
        },
    );
    let cells = until_made(&mut harness);
    // The loader's last wake-up may come slightly after its frame.
    std::thread::sleep(Duration::from_millis(50));
    let state = harness.state_mut();
    let loader = state.player.as_ref().unwrap().loader().stats();
    assert_eq!((loader.decoded, loader.cancelled), (super::FRAMES as u64 + 4, 0));
    // The loader wakes for each frame. The automatic settings decode four more, and wake once.
    let expected = (super::FRAMES + cells + 1) as u64;
    assert_eq!(wakes.load(Ordering::Relaxed), expected);
    let now = state.now();
    assert!(!state.update(now).is_visible());
    assert_eq!(state.next_deadline(), None);
    std::thread::sleep(Duration::from_millis(50));
    assert!(!state.update(now).is_visible());
    assert_eq!(wakes.load(Ordering::Relaxed), expected);
}

#[test]
fn another_up_axis_or_a_command_regenerates_thumbnails() {
    let mut harness = window_on(sequence(&[]), with_thumbnails());
    let cells = until_made(&mut harness);
    harness.state_mut().camera.up = UpAxis::Z;
    harness.run();
    assert!(harness.state().features.thumbnails.progress()[0] < cells);
    assert_eq!(until_made(&mut harness), cells);
    harness.state_mut().run(Command::REDO_THUMBNAILS);
    assert_eq!(harness.state().features.thumbnails.progress(), [0, cells]);
    assert_eq!(until_made(&mut harness), cells);
}

#[test]
fn thumbnails_can_be_switched_off_and_stay_off() {
    let mut harness = window_on(sequence(&[]), with_thumbnails());
    until_made(&mut harness);
    harness
        .get_by_role_and_label(Role::CheckBox, "Thumbnails")
        .scroll_to_me();
    harness.run();
    harness.get_by_role_and_label(Role::CheckBox, "Thumbnails").click();
    harness.run();
    assert_eq!(pictures(&harness), 0);
    assert!(!harness.state().preferences().thumbnails);
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness
        .get_by_role_and_label(Role::TextInput, "Find a command")
        .type_text("hide thumbnails");
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.state().preferences().thumbnails);
    assert!(pictures(&harness) > 0);
    // A window whose preferences disable it starts without.
    let other = window();
    let cells = other.query_all_by_label_contains("thumbnail");
    assert_eq!(cells.count(), 0);
}

#[test]
fn no_thumbnails_are_made_while_playback_falls_behind() {
    let mut harness = window();
    click(&mut harness, "Play");
    harness.state_mut().features.thumbnails.is_on = true;
    // 24 frames per second are requested, twelve are shown.
    let play = |harness: &mut Harness<'_, State>, seconds: f64| {
        harness.state_mut().update(Duration::from_secs_f64(seconds));
        harness.run();
        harness.state().features.thumbnails.progress()[0]
    };
    for step in 1..=12 {
        play(&mut harness, f64::from(step) / 12.0);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(play(&mut harness, 1.0), 0);
    // On time: thumbnails are made, at most ten per second.
    for step in 1..=2400 {
        let seconds = f64::from(step) / 24.0;
        let made = play(&mut harness, 1.0 + seconds);
        assert!(made as f64 <= 1.0 + 10.0 * seconds, "{made} in {seconds} s");
        if made >= 5 {
            return;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("nothing is made although there is time");
}

#[test]
fn uncached_frames_are_read_when_nothing_plays() {
    let mut harness = window_on(
        sequence(&[]),
        StateOptions {
            budget_bytes: Some(2000),
            ..with_thumbnails()
        },
    );
    let cells = until_made(&mut harness);
    let loader = harness.state().player.as_ref().unwrap().loader().stats();
    assert!(
        loader.resident_frames < cells / 2,
        "{} frames are in memory",
        loader.resident_frames
    );
    assert!(loader.resident_bytes <= 2000);
}
