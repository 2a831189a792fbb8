//! The window's panels without a window: by role and label, with a time of the test's own.
#![allow(
    clippy::unwrap_used,
    reason = "a helper of a test that cannot go on fails the test"
)]

use egui::{Key, Modifiers, PointerButton, accesskit::Role, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::panels::window_ui;
use pointreel::app::{
    BINDINGS, Benchmark, BenchmarkJob, BenchmarkTable, Command, GESTURES, Mark, Progress, Recent,
    Severity, State, StateOptions, WindowRequest, apply_theme,
};
use pointreel::bench::Table;
use pointreel::cloud::{Positions, RawCloud};
use pointreel::octree::StopCriterion;
use pointreel::scene::{
    Background, Lighting, Lod, Primitive, Scene, Settings, Splatting, Strategy, UpAxis,
};
use pointreel::sequence::{ColorSource, LoopMode, Sequence, Source};
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

const FRAMES: usize = 24;

/// A cube of points that grows with the frame; frames in `broken` cannot be read.
fn sequence(broken: &'static [u64]) -> Arc<Sequence> {
    let sources = (0..FRAMES as u64)
        .map(|number| Source {
            number: Some(number),
            ..Source::file(format!("/scans/walk/frame_{number:04}.ply"))
        })
        .collect();
    Arc::new(Sequence::with_decoder(sources, move |source| {
        let number = source.number.unwrap_or(0);
        if broken.contains(&number) {
            return Err(format!("{}: line 3: expected an element", source.name).into());
        }
        let size = 1.0 + number as f32 / 100.0;
        let corners = (0..8)
            .map(|corner| [0, 1, 2].map(|axis| size * (corner >> axis & 1) as f32 - 0.5 * size));
        Ok(RawCloud::from_positions(Positions::F32(corners.collect())))
    }))
}

fn options() -> StateOptions {
    StateOptions {
        paused: true,
        ..StateOptions::default()
    }
}

/// A window of 1280×800 on `sequence`, all frames loaded, at time zero.
fn window_on(sequence: Arc<Sequence>, options: StateOptions) -> Harness<'static, State> {
    let mut state = State::new(options);
    state.open(sequence);
    load_all(&mut state);
    state.update(Duration::ZERO);
    Harness::builder()
        .with_size([1280.0, 800.0])
        .with_max_steps(20)
        .with_context_setup(apply_theme)
        .build_ui_state(|ui, state: &mut State| window_ui(ui, state), state)
}

fn window() -> Harness<'static, State> {
    window_on(sequence(&[]), options())
}

/// Waits until the loader has every frame as the settings need it.
fn load_all(state: &mut State) {
    state.update(state.now());
    let needs = Scene::needs(&state.settings);
    let loader = state.player.as_ref().unwrap().loader();
    for index in 0..FRAMES {
        // A broken frame is an answer as well.
        let _ = loader.wait(index, &needs);
    }
    state.update(state.now());
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

#[test]
fn the_play_button_plays_and_pauses() {
    let mut harness = window();
    click(&mut harness, "Play");
    assert!(is_playing(&harness));
    // 24 frames a second: the third frame is due after 2/24 s.
    assert!(harness.state_mut().update(Duration::from_millis(85)));
    assert_eq!(frame(&harness), 2);
    assert_eq!(
        harness
            .state()
            .player
            .as_ref()
            .unwrap()
            .shown()
            .unwrap()
            .index,
        2
    );
    harness.run();
    click(&mut harness, "Pause");
    assert!(!is_playing(&harness));
    assert!(!harness.state_mut().update(Duration::from_secs(9)));
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
    assert!(harness.query_by_label_contains("frame  1/24").is_some());
}

#[test]
fn the_timeline_scrubs_and_playing_goes_on_after() {
    let mut harness = window();
    click(&mut harness, "Play");
    let bar = harness
        .get_by_role_and_label(Role::Slider, "Timeline")
        .rect();
    let at = |frame: f32| {
        pos2(
            bar.left() + bar.width() * (frame + 0.5) / FRAMES as f32,
            bar.center().y,
        )
    };
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
fn a_broken_frame_is_marked_told_once_and_played_over() {
    let mut harness = window_on(sequence(&[5]), options());
    harness.run();
    let runs = harness.state().player.as_ref().unwrap().runs().to_vec();
    let marks: Vec<_> = runs
        .iter()
        .map(|run| (run.start, run.end, run.mark))
        .collect();
    assert_eq!(
        marks,
        [
            (0, 5, Mark::Resident),
            (5, 6, Mark::Failed),
            (6, 24, Mark::Resident)
        ]
    );
    assert!(harness.state().notices.list().is_empty());

    let bar = harness.get_by_label("Timeline").rect();
    harness.hover_at(pos2(bar.left() + bar.width() * 5.5 / 24.0, bar.center().y));
    harness.run_steps(60);
    assert!(
        harness
            .query_by_label_contains("frame_0005.ply: line 3: expected an element")
            .is_some()
    );
    harness.hover_at(pos2(640.0, 300.0));
    harness.run();

    for _ in 0..3 {
        harness
            .state_mut()
            .player
            .as_mut()
            .unwrap()
            .seek(5, Duration::ZERO);
        harness.state_mut().update(Duration::ZERO);
        harness
            .state_mut()
            .player
            .as_mut()
            .unwrap()
            .seek(6, Duration::ZERO);
        harness.state_mut().update(Duration::ZERO);
    }
    let notices = harness.state().notices.list();
    assert_eq!(notices.len(), 1);
    assert_eq!(
        (notices[0].severity, notices[0].count),
        (Severity::Error, 1)
    );
    assert!(
        notices[0].text.starts_with("Frame 6 of 24 is left out. "),
        "{}",
        notices[0].text
    );

    let state = harness.state_mut();
    state.player.as_mut().unwrap().seek(4, Duration::ZERO);
    state.run(Command::TogglePlay);
    let mut shown = Vec::new();
    for step in 0..4 {
        state.update(Duration::from_millis(step * 42));
        let player = state.player.as_ref().unwrap();
        shown.push(player.shown().unwrap().index);
    }
    assert_eq!(shown, [4, 4, 6, 7]);
}

#[test]
fn notices_are_copied_and_dismissed() {
    let mut harness = window();
    harness.state_mut().notices.error("the disk is gone");
    harness.run();
    assert!(harness.query_by_label("the disk is gone").is_some());
    harness.get_by_label("Copy").click();
    harness.step();
    harness.step();
    harness.run();
    click(&mut harness, "Dismiss");
    assert!(harness.query_by_label("the disk is gone").is_none());
    assert!(harness.state().notices.list().is_empty());
}

/// Opens the list called `list` and chooses `entry`.
fn choose(harness: &mut Harness<'_, State>, list: &str, entry: &str) {
    harness.get_by_role_and_label(Role::ComboBox, list).click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, entry).click();
    harness.run();
}

fn slide(harness: &mut Harness<'_, State>, label: &str, value: f64) {
    harness
        .get_by_role_and_label(Role::Slider, label)
        .set_value_accesskit(value);
    harness.run();
}

#[test]
fn every_setting_can_be_changed_and_reset() {
    let mut harness = window();
    choose(&mut harness, "Splatting", "Visibility");
    assert_eq!(harness.state().settings.splatting, Splatting::Visibility);
    assert!(
        harness.query_by_label("Enlargement").is_none(),
        "this mode has no enlargement"
    );
    choose(&mut harness, "Splatting", "Enlarged");
    slide(&mut harness, "Enlargement", 3.0);
    assert_eq!(harness.state().settings.enlargement, 3.0);
    choose(&mut harness, "Instancing", "Compute");
    assert_eq!(harness.state().settings.strategy, Strategy::Compute);
    slide(&mut harness, "Splat scale", 2.5);
    assert_eq!(harness.state().settings.splat_scale, 2.5);
    harness
        .get_by_role_and_label(Role::CheckBox, "Back faces")
        .click();
    harness.run();
    assert!(!harness.state().settings.cull_back_faces);
    choose(&mut harness, "Lighting", "Per vertex");
    assert_eq!(harness.state().settings.lighting, Lighting::PerVertex);
    choose(&mut harness, "Colours", "One colour");
    assert_eq!(harness.state().settings.colors, ColorSource::Uniform);
    choose(&mut harness, "Preset", "White");
    assert_eq!(
        harness.state().settings.background,
        Background::solid([255; 3])
    );
    choose(&mut harness, "Up axis", "+Z");
    assert_eq!(harness.state().camera.up, UpAxis::Z);
    slide(&mut harness, "Field of view", 60.0);
    assert_eq!(harness.state().camera.fov_deg, 60.0);

    click(&mut harness, "Voxels");
    assert_eq!(harness.state().settings.primitive, Primitive::Voxel);
    slide(&mut harness, "Loss δ", 20.0);
    assert_eq!(harness.state().settings.stop, StopCriterion::Loss(0.2));
    choose(&mut harness, "Divide", "To a level");
    slide(&mut harness, "Leaf level", 9.0);
    assert_eq!(harness.state().settings.stop, StopCriterion::Depth(9));
    choose(&mut harness, "Divide", "By points");
    slide(&mut harness, "Points a leaf", 16.0);
    assert_eq!(
        harness.state().settings.stop,
        StopCriterion::PointsPerOctant(16)
    );
    slide(&mut harness, "Threshold τ", 8.0);
    assert_eq!(harness.state().settings.lod, Lod::ThresholdPx(8.0));
    choose(&mut harness, "Level of detail", "Fixed level");
    slide(&mut harness, "Level", 7.0);
    assert_eq!(harness.state().settings.lod, Lod::Level(7));
    choose(&mut harness, "Level of detail", "Voxel budget");
    slide(&mut harness, "Voxels", 2000.0);
    assert_eq!(harness.state().settings.lod, Lod::Budget(2000));
    choose(&mut harness, "Level of detail", "Frame time");
    slide(&mut harness, "Time", 20.0);
    assert_eq!(harness.state().settings.lod, Lod::FrameTimeMs(20.0));
    click(&mut harness, "Points");
    slide(&mut harness, "Point size", 4.0);
    assert_eq!(harness.state().settings.point_size_px, 4.0);
    click(&mut harness, "Surfels");
    assert_eq!(harness.state().settings.primitive, Primitive::Surfel);

    click(&mut harness, "Reset to defaults");
    assert_eq!(harness.state().settings, Settings::default());
    assert_eq!(harness.state().camera.up, UpAxis::Z);
}

#[test]
fn an_untouched_slider_changes_no_setting() {
    let mut harness = window();
    for primitive in ["Voxels", "Points", "Surfels"] {
        click(&mut harness, primitive);
        harness.state_mut().settings.primitive = Settings::default().primitive;
        assert_eq!(harness.state().settings, Settings::default(), "{primitive}");
    }
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

fn clock<'a>(harness: &'a Harness<'_, State>) -> &'a pointreel::sequence::Clock {
    harness.state().player.as_ref().unwrap().clock()
}

fn choose_loop(harness: &mut Harness<'_, State>, now: &str, entry: &str) {
    harness.get_by_value(now).click();
    harness.run();
    click(harness, entry);
}

#[test]
fn keys_do_what_the_table_says() {
    const SHIFT: Modifiers = Modifiers::SHIFT;
    const NONE: Modifiers = Modifiers::NONE;
    let mut harness = window();
    press(&mut harness, NONE, Key::ArrowRight);
    assert_eq!(frame(&harness), 1);
    press(&mut harness, SHIFT, Key::ArrowRight);
    assert_eq!(frame(&harness), 11);
    press(&mut harness, SHIFT, Key::ArrowLeft);
    press(&mut harness, NONE, Key::ArrowLeft);
    assert_eq!(frame(&harness), 0);
    press(&mut harness, NONE, Key::End);
    assert_eq!(frame(&harness), 23);
    press(&mut harness, NONE, Key::Home);
    assert_eq!(frame(&harness), 0);
    press(&mut harness, NONE, Key::Space);
    assert!(is_playing(&harness));
    press(&mut harness, NONE, Key::Space);
    assert!(!is_playing(&harness));
    for expected in [LoopMode::PingPong, LoopMode::Off, LoopMode::Loop] {
        press(&mut harness, NONE, Key::L);
        assert_eq!(clock(&harness).loop_mode(), expected);
    }
    press(&mut harness, NONE, Key::CloseBracket);
    assert_eq!(clock(&harness).speed(), 1.5);
    press(&mut harness, NONE, Key::OpenBracket);
    press(&mut harness, NONE, Key::OpenBracket);
    assert_eq!(clock(&harness).speed(), 0.75);
    press(&mut harness, NONE, Key::Backspace);
    assert_eq!(clock(&harness).speed(), -0.75);
    press(&mut harness, NONE, Key::Num5);
    assert_eq!(harness.state().camera.elevation_deg, 90.0);
    press(&mut harness, NONE, Key::R);
    assert_eq!(harness.state().camera.elevation_deg, 15.0);
    press(&mut harness, NONE, Key::Plus);
    assert_eq!(harness.state().settings.splat_scale, 1.25);
    press(&mut harness, NONE, Key::Minus);
    assert_eq!(harness.state().settings.splat_scale, 1.0);
    press(&mut harness, NONE, Key::F2);
    assert!(!harness.state().panels.settings);
    assert!(harness.state_mut().take_requests().is_empty());
    press(&mut harness, NONE, Key::P);
    press(&mut harness, NONE, Key::F11);
    press(&mut harness, Modifiers::COMMAND, Key::Q);
    assert_eq!(
        harness.state_mut().take_requests(),
        [
            WindowRequest::Screenshot(None),
            WindowRequest::FullScreen,
            WindowRequest::Quit
        ]
    );
}

#[test]
fn a_text_field_keeps_its_keys() {
    let mut harness = window();
    let camera = harness.state().camera;
    harness.get_by_label("Frame rate").click();
    harness.run();
    assert!(harness.ctx.text_edit_focused());
    for key in [Key::L, Key::Space, Key::ArrowRight, Key::W, Key::Num5] {
        harness.key_down(key);
        harness.step();
    }
    assert_eq!(clock(&harness).loop_mode(), LoopMode::Loop);
    assert_eq!(frame(&harness), 0);
    assert!(!is_playing(&harness));
    assert!(!harness.state().fly.is_flying());
    assert_eq!(harness.state().camera, camera);
}

#[test]
fn the_help_lists_every_key_and_escape_closes_it() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F1);
    for binding in BINDINGS {
        assert!(
            harness.query_all_by_label(binding.text).next().is_some(),
            "{}",
            binding.text
        );
        assert!(
            harness.query_all_by_label(binding.keys).next().is_some(),
            "{}",
            binding.keys
        );
    }
    for (gesture, text) in GESTURES {
        assert!(
            harness.query_all_by_label(gesture).next().is_some(),
            "{gesture}"
        );
        assert!(harness.query_all_by_label(text).next().is_some(), "{text}");
    }
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!harness.state().panels.help);
    assert!(harness.query_by_label("Ten frames on").is_none());
}

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
    // Within one step egui sees only the last place.
    for part in [0.5, 1.0] {
        harness.event_modifiers(egui::Event::PointerMoved(from + part * by), modifiers);
    }
    harness.event_modifiers(event(from + by, false), modifiers);
    harness.run();
}

#[test]
fn the_mouse_moves_the_camera_on_the_picture_only() {
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
    assert!(
        orbited.azimuth_deg < before.azimuth_deg - 10.0,
        "{orbited:?}"
    );
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

    let settings = harness.get_by_label("Background").rect().center();
    let timeline = harness.get_by_label("Timeline").rect().center();
    for from in [settings, timeline, pos2(600.0, 12.0)] {
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
fn a_drag_between_two_passes_moves_the_camera_as_a_slow_one_does() {
    let by = vec2(100.0, 30.0);
    for button in [
        PointerButton::Primary,
        PointerButton::Middle,
        PointerButton::Secondary,
    ] {
        let [mut slow, mut fast] = [window(), window()];
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
fn a_drag_on_a_window_above_the_picture_is_not_the_camera_s() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F1);
    let before = harness.state().camera;
    let from = harness.get_by_label("Ten frames on").rect().center();
    assert!(
        harness.state().viewport.rect.contains(from),
        "the list of keys lies above the picture"
    );
    for button in [PointerButton::Primary, PointerButton::Secondary] {
        drag(
            &mut harness,
            button,
            Modifiers::NONE,
            from,
            vec2(-250.0, -40.0),
        );
        assert_eq!(harness.state().camera, before);
    }
}

#[test]
fn the_picture_follows_the_scale_factor() {
    let mut harness = window();
    let [width, height] = harness.state().viewport.size_px;
    assert!(harness.state_mut().next_packet().is_some());
    for (scale, factor) in [(2.0, 2.0), (1.5, 1.5), (1.0, 1.0)] {
        let root = harness.input_mut().viewports.entry(egui::ViewportId::ROOT);
        root.or_default().native_pixels_per_point = Some(scale);
        harness.run();
        let size_px = harness.state().viewport.size_px;
        // As many points of the window, more pixels.
        for (edge, before) in size_px.iter().zip([width, height]) {
            let expected = f64::from(before) * factor;
            assert!(
                (f64::from(*edge) - expected).abs() <= 2.0,
                "{scale}: {size_px:?}"
            );
        }
        let packet = harness.state_mut().next_packet();
        assert_eq!(packet.unwrap().viewport_px, size_px);
        harness.run();
        assert!(harness.state_mut().next_packet().is_none(), "once");
    }
}

#[test]
fn a_window_without_room_draws_nothing() {
    let mut harness = window();
    assert!(harness.state_mut().next_packet().is_some());
    let pictures = harness.state().counters.pictures;
    for size in [vec2(0.0, 0.0), vec2(1.0, 1.0), vec2(300.0, 0.0)] {
        harness.set_size(size);
        harness.run_ok();
        let has_room = !harness.state().viewport.size_px.contains(&0);
        assert_eq!(
            harness.state_mut().next_packet().is_some(),
            has_room,
            "{size}"
        );
    }
    assert!(harness.state().counters.pictures <= pictures + 1);
    harness.set_size(vec2(1280.0, 800.0));
    harness.run();
    assert!(!harness.state().viewport.size_px.contains(&0));
}

#[test]
fn what_a_person_chose_is_how_the_next_window_begins() {
    let mut harness = window();
    click(&mut harness, "Next frame");
    press(&mut harness, Modifiers::NONE, Key::L);
    press(&mut harness, Modifiers::NONE, Key::CloseBracket);
    let state = harness.state_mut();
    state.settings.stop = StopCriterion::Loss(0.2);
    state.panels.settings = false;
    state.panels.help = true;
    let kept = state.preferences();
    assert_eq!(kept.loop_mode, LoopMode::PingPong);
    assert_eq!(kept.speed, 1.5);

    let next = window_on(
        sequence(&[]),
        StateOptions {
            preferences: kept,
            ..options()
        },
    );
    assert_eq!(next.state().preferences(), kept);
    assert!(!next.state().panels.help, "the list of keys is not kept");
    assert!(next.query_by_label("Background").is_none());

    // Played backward when it was left: the next begins forward.
    let mut harness = window();
    harness.state_mut().run(Command::Reverse);
    assert_eq!(harness.state().preferences().speed, 1.0);
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
fn the_wheel_zooms_on_the_picture_only() {
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
    let settings = harness.get_by_label("Background").rect().center();
    scroll(&mut harness, settings, -100.0);
    assert_eq!(harness.state().camera, near);
}

#[test]
fn a_paused_untouched_window_does_nothing() {
    let mut harness = window();
    harness.state_mut().settings.primitive = Primitive::Voxel;
    load_all(harness.state_mut());
    harness.run();
    assert!(harness.state_mut().next_packet().is_some());
    let (counters, scene) = (harness.state().counters, harness.state().scene_stats());
    assert_eq!(scene.traversals, 1);
    for second in 1..100 {
        let state = harness.state_mut();
        assert!(!state.update(Duration::from_secs(second)));
        assert_eq!(state.next_deadline(), None);
        assert!(state.next_packet().is_none());
    }
    assert_eq!(
        (harness.state().counters, harness.state().scene_stats()),
        (counters, scene)
    );
    assert!(!harness.ctx.has_requested_repaint());
    // A panel that is run again, as for a moved mouse, is no new picture.
    harness.hover_at(pos2(100.0, 100.0));
    harness.run();
    assert!(harness.state_mut().next_packet().is_none());
    harness.state_mut().camera.orbit(5.0, 0.0);
    assert!(harness.state_mut().next_packet().is_some());
    assert_eq!(harness.state().scene_stats().traversals, 2);
}

#[test]
fn the_picture_stays_until_the_new_primitive_is_there() {
    let mut harness = window();
    assert_eq!(
        harness
            .state_mut()
            .next_packet()
            .unwrap()
            .settings
            .primitive,
        Primitive::Surfel
    );
    harness.state_mut().settings.primitive = Primitive::Voxel;
    harness.state_mut().settings.splat_scale = 2.0;
    // No update yet: the frame has no octree.
    assert_eq!(
        harness
            .state_mut()
            .next_packet()
            .unwrap()
            .settings
            .primitive,
        Primitive::Surfel
    );
    load_all(harness.state_mut());
    let packet = harness.state_mut().next_packet().unwrap();
    assert_eq!(packet.settings.primitive, Primitive::Voxel);
    assert!(packet.voxels.is_some());
}

#[test]
fn statistics_tell_points_octree_and_budget() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F3);
    assert!(harness.query_by_label("not supported").is_some());
    assert!(harness.query_by_label("Leaves").is_none());
    click(&mut harness, "Voxels");
    load_all(harness.state_mut());
    harness.run();
    for label in [
        "Points",
        "Depth",
        "Nodes",
        "Leaves",
        "Loss",
        "Visited",
        "Uploads",
        "Passes",
        "Draw calls",
    ] {
        assert!(
            harness.query_all_by_label(label).next().is_some(),
            "{label}"
        );
    }
    harness
        .get_by_role_and_label(Role::SpinButton, "Budget")
        .set_value_accesskit(64.0);
    harness.run();
    let stats = harness.state().player.as_ref().unwrap().loader().stats();
    assert_eq!(stats.budget_bytes, 64 << 20);
}

#[test]
fn menus_open_close_and_list_what_was_opened() {
    let mut recent = Recent::default();
    recent.add(&["/nowhere/at/all".into()]).unwrap();
    let mut harness = window_on(
        sequence(&[]),
        StateOptions {
            recent,
            ..options()
        },
    );
    click(&mut harness, "File");
    click(&mut harness, "Recent");
    click(&mut harness, "/nowhere/at/all");
    let begin = Instant::now();
    while harness.state().notices.list().is_empty() {
        assert!(
            begin.elapsed() < Duration::from_secs(20),
            "no answer for the missing folder"
        );
        harness.state_mut().update(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        harness.state().notices.list()[0]
            .text
            .contains("/nowhere/at/all")
    );
    assert_eq!(
        harness.state().player.as_ref().unwrap().sequence().len(),
        FRAMES,
        "what was open stays"
    );

    click(&mut harness, "File");
    choose_item(&mut harness, "Demo");
    assert_eq!(harness.state().sequence_name().as_deref(), Some("demo"));

    click(&mut harness, "View");
    choose_item(&mut harness, "Top");
    assert_eq!(harness.state().camera.elevation_deg, 90.0);
    click(&mut harness, "File");
    choose_item(&mut harness, "Quit");
    assert_eq!(harness.state_mut().take_requests(), [WindowRequest::Quit]);
}

/// Clicks an item of the open menu; its label has the key after the text.
fn choose_item(harness: &mut Harness<'_, State>, text: &str) {
    harness
        .get_all_by_role(Role::Button)
        .find(|node| {
            node.accesskit_node()
                .label()
                .is_some_and(|label| label.starts_with(text))
        })
        .expect("the menu has the item")
        .click();
    harness.run_steps(3);
}

/// A table of a report from its heading and two rows.
fn table(name: &str, lines: [[&str; 2]; 3]) -> Table {
    let [columns, first, second] = lines.map(|line| line.map(str::to_owned).to_vec());
    Table {
        name: name.to_owned(),
        columns,
        rows: vec![first, second],
    }
}

/// Starts `job` in the benchmark window.
fn start(harness: &mut Harness<'_, State>, job: BenchmarkJob) {
    harness.state_mut().start_benchmark_job("surfels", job);
    harness.run();
}

/// Updates until the benchmark is no longer running.
fn finish(harness: &mut Harness<'_, State>) {
    let begin = Instant::now();
    while matches!(harness.state().benchmark, Benchmark::Running(_)) {
        assert!(
            begin.elapsed() < Duration::from_secs(20),
            "the benchmark does not end"
        );
        harness.state_mut().update(Duration::ZERO);
        std::thread::sleep(Duration::from_millis(2));
    }
    harness.run();
}

#[test]
fn a_benchmark_shows_progress_then_its_table() {
    let mut harness = window();
    let (go_on, gate) = sync_channel::<()>(0);
    let (reached, half_way) = sync_channel::<()>(0);
    let job: BenchmarkJob = Box::new(move |report, _| {
        report(Progress {
            done: 3,
            total: 6,
            label: "storage".to_owned(),
        });
        reached.send(()).unwrap();
        gate.recv().unwrap();
        Ok(BenchmarkTable {
            suite: "surfels".to_owned(),
            adapter: "Test adapter".to_owned(),
            tables: vec![
                table(
                    "",
                    [
                        ["strategy", "median"],
                        ["storage", "1.25"],
                        ["texture", "2.50"],
                    ],
                ),
                table("leaves", [["δ", "loss"], ["2 %", "1.75"], ["10 %", "8.25"]]),
            ],
            bars_title: "median ms".to_owned(),
            bars: vec![("storage".to_owned(), 1.25), ("texture".to_owned(), 2.5)],
            ..BenchmarkTable::default()
        })
    });
    start(&mut harness, job);
    half_way.recv().unwrap();
    harness.run();
    assert!(harness.query_by_label("storage").is_some());
    assert!(harness.query_by_label_contains("3 of 6").is_some());
    go_on.send(()).unwrap();
    finish(&mut harness);
    for label in [
        "Suite surfels",
        "Test adapter",
        "strategy",
        "median",
        "texture",
        "2.50",
        "leaves",
        "8.25",
        "Export JSON…",
        "Export CSV…",
    ] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
}

#[test]
fn a_benchmark_is_cancelled_or_fails_with_its_reason() {
    let mut harness = window();
    let patient: BenchmarkJob = Box::new(|_, cancel| {
        while !cancel.load(std::sync::atomic::Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
        Err("cancelled".to_owned())
    });
    start(&mut harness, patient);
    click(&mut harness, "Cancel");
    finish(&mut harness);
    assert!(matches!(harness.state().benchmark, Benchmark::Cancelled));
    assert!(
        harness
            .query_by_label("The benchmark was cancelled.")
            .is_some()
    );

    start(
        &mut harness,
        Box::new(|_, _| Err("the GPU is out of memory".to_owned())),
    );
    finish(&mut harness);
    assert!(harness.query_by_label("the GPU is out of memory").is_some());
}

#[test]
fn controls_tell_their_term_and_unit() {
    let mut harness = window();
    let label = harness
        .get_by_role_and_label(Role::Label, "Splat scale")
        .rect()
        .center();
    harness.hover_at(label);
    harness.run_steps(60);
    assert!(
        harness
            .query_by_label_contains("Factor on every splat's radius")
            .is_some()
    );
}

#[test]
fn every_control_has_a_name_for_screen_readers() {
    let mut harness = window();
    for panel in [Key::F3, Key::F1] {
        press(&mut harness, Modifiers::NONE, panel);
        assert_eq!(harness.unnamed_widgets(), Vec::<String>::new());
    }
}
