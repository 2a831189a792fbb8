//! The window's panels without a window: by role and label, with a time of the test's own.
#![allow(clippy::unwrap_used, reason = "a helper of a test that cannot go on fails the test")]

#[path = "common/walk.rs"]
mod walk;

#[path = "panels/agreement.rs"]
mod agreement;
#[path = "panels/assumptions.rs"]
mod assumptions;
#[path = "panels/benchmark.rs"]
mod benchmark;
#[path = "panels/camera.rs"]
mod camera;
#[path = "panels/camera_path.rs"]
mod camera_path;
#[path = "panels/choices.rs"]
mod choices;
#[path = "panels/clip.rs"]
mod clip;
#[path = "panels/colors.rs"]
mod colors;
#[path = "panels/comparison.rs"]
mod comparison;
#[path = "panels/depth_filters.rs"]
mod depth_filters;
#[path = "panels/documents.rs"]
mod documents;
#[path = "panels/escape.rs"]
mod escape;
#[path = "panels/export.rs"]
mod export;
#[path = "panels/idle.rs"]
mod idle;
#[path = "panels/keys.rs"]
mod keys;
#[path = "panels/labels.rs"]
mod labels;
#[path = "panels/marks.rs"]
mod marks;
#[path = "panels/menu.rs"]
mod menu;
#[path = "panels/mouse.rs"]
mod mouse;
#[path = "panels/notes.rs"]
mod notes;
#[path = "panels/notices.rs"]
mod notices;
#[path = "panels/opening.rs"]
mod opening;
#[path = "panels/photos.rs"]
mod photos;
#[path = "panels/points.rs"]
mod points;
#[path = "panels/reading.rs"]
mod reading;
#[path = "panels/save.rs"]
mod save;
#[path = "panels/sessions.rs"]
mod sessions;
#[path = "panels/settings.rs"]
mod settings;
#[path = "panels/sizes.rs"]
mod sizes;
#[path = "panels/split_view.rs"]
mod split_view;
#[path = "panels/statistics.rs"]
mod statistics;
#[path = "panels/temporal.rs"]
mod temporal;
#[path = "panels/thumbnails.rs"]
mod thumbnails;
#[path = "panels/timeline.rs"]
mod timeline;
#[path = "panels/trails.rs"]
mod trails;
#[path = "panels/viewport.rs"]
mod viewport;

use self::walk::{FRAMES, load_all, options, sequence, state_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::panels::window_ui;
use pointreel::app::{Command, PanelId, State, StateOptions, apply_theme};
use pointreel::levels::octree::StopCriterion;
use pointreel::sequence::Sequence;
use pointreel::timeline::LoopMode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A window of 1280×800 on `sequence`, all frames loaded, at time zero.
fn window_on(sequence: Arc<Sequence>, options: StateOptions) -> Harness<'static, State> {
    let state = state_on(sequence, options);
    Harness::builder()
        .with_size([1280.0, 800.0])
        .with_max_steps(20)
        .with_context_setup(apply_theme)
        .build_ui_state(|ui, state: &mut State| window_ui(ui, state), state)
}

fn window() -> Harness<'static, State> {
    window_on(sequence(&[]), options())
}

fn frame(harness: &Harness<'_, State>) -> usize {
    harness.state().player.as_ref().unwrap().clock().frame()
}

fn is_playing(harness: &Harness<'_, State>) -> bool {
    harness.state().player.as_ref().unwrap().is_playing()
}

fn press(harness: &mut Harness<'_, State>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

fn click(harness: &mut Harness<'_, State>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run();
}

/// Waits for the work of another thread, with the time of the window at rest.
fn until(harness: &mut Harness<'_, State>, what: &str, is_so: impl Fn(&State) -> bool) {
    let begin = Instant::now();
    while !is_so(harness.state()) {
        assert!(begin.elapsed() < Duration::from_secs(20), "{what}");
        let now = harness.state().now();
        harness.state_mut().update(now);
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run();
}

/// Drags from one place to another, with the pointer seen on its way.
fn drag(harness: &mut Harness<'_, State>, from: egui::Pos2, to: egui::Pos2) {
    harness.drag_at(from);
    harness.run();
    harness.hover_at(to);
    harness.run();
    harness.drop_at(to);
    harness.run();
}

fn clock<'a>(harness: &'a Harness<'_, State>) -> &'a pointreel::timeline::Clock {
    harness.state().player.as_ref().unwrap().clock()
}

#[test]
fn choices_apply_to_the_next_window() {
    let mut harness = window();
    click(&mut harness, "Next frame");
    press(&mut harness, Modifiers::NONE, Key::L);
    press(&mut harness, Modifiers::NONE, Key::CloseBracket);
    let state = harness.state_mut();
    state.style.levels.stop = StopCriterion::Loss(0.2);
    state.panels.set(PanelId::SETTINGS, false);
    state.panels.set(PanelId::HELP, true);
    let retained = state.preferences();
    assert_eq!(retained.loop_mode, LoopMode::PingPong);
    assert_eq!(retained.speed, 1.5);

    let next = window_on(
        sequence(&[]),
        StateOptions {
            preferences: retained,
            ..options()
        },
    );
    assert_eq!(next.state().preferences(), retained);
    assert!(!next.state().panels.has(PanelId::HELP), "the list of keys is not kept");
    assert!(next.query_by_label("Background").is_none());

    // Played backward when it was closed: the next one starts forward.
    let mut harness = window();
    harness.state_mut().run(Command::REVERSE);
    assert_eq!(harness.state().preferences().speed, 1.0);
}

#[test]
fn every_control_has_a_name_for_screen_readers() {
    let mut harness = window();
    for panel in [Key::F3, Key::F1] {
        press(&mut harness, Modifiers::NONE, panel);
        assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
    }
}
