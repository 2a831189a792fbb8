//! Keys, and the list of them.

use super::{clock, frame, is_playing, press, window};
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{GESTURES, PanelId, WindowRequest, commands};
use pointreel::timeline::LoopMode;

#[test]
fn keys_match_the_table() {
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
    press(&mut harness, NONE, Key::G);
    assert!(harness.state().style.backdrop.grid);
    press(&mut harness, NONE, Key::G);
    assert!(!harness.state().style.backdrop.grid);
    press(&mut harness, NONE, Key::Plus);
    assert_eq!(harness.state().style.surfels.splat_scale, 1.25);
    press(&mut harness, NONE, Key::Minus);
    assert_eq!(harness.state().style.surfels.splat_scale, 1.0);
    press(&mut harness, NONE, Key::F2);
    assert!(!harness.state().panels.has(PanelId::SETTINGS));
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
fn a_text_field_receives_its_keys() {
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
    assert!(!harness.state().motion.fly.is_flying());
    assert_eq!(harness.state().camera, camera);
}

#[test]
fn the_help_lists_every_key_and_escape_closes_it() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::F1);
    for (what, keys) in commands().filter_map(|row| Some((row.what, row.keys?))) {
        assert!(harness.query_all_by_label(what).next().is_some(), "{what}");
        assert!(harness.query_all_by_label(keys.text).next().is_some(), "{}", keys.text);
    }
    for (gesture, text) in GESTURES {
        assert!(harness.query_all_by_label(gesture).next().is_some(), "{gesture}");
        assert!(harness.query_all_by_label(text).next().is_some(), "{text}");
    }
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!harness.state().panels.has(PanelId::HELP));
    assert!(harness.query_by_label("Ten frames on").is_none());
}
