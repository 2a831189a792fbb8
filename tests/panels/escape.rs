//! Esc closes the topmost item, one at a time.

use super::settings::choose;
use super::{click, press, window};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, PanelId, State, Tool, WindowRequest};

fn escape(harness: &mut Harness<'_, State>) {
    press(harness, Modifiers::NONE, Key::Escape);
}

#[test]
fn escape_closes_menus_lists_and_color_pickers_before_the_tool() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::M);
    let tool = |harness: &Harness<'_, State>| harness.state().features.inspection.tool;
    click(&mut harness, "Help");
    assert!(harness.query_by_label_contains("Keys and mouse").is_some());
    escape(&mut harness);
    assert!(harness.query_by_label_contains("Keys and mouse").is_none());
    assert_eq!(tool(&harness), Tool::Measure, "one thing at a time");

    choose(&mut harness, "Colours", "One colour");
    let swatch = |harness: &Harness<'_, State>| harness.get_by_role_and_label(Role::ColorWell, "Point colour").rect();
    let area = swatch(&harness);
    assert!(area.width() >= 16.0 && area.height() >= 12.0, "{area:?}");
    harness.get_by_role_and_label(Role::ColorWell, "Point colour").click();
    harness.run();
    let is_picking = |harness: &Harness<'_, State>| egui::Popup::is_any_open(&harness.ctx);
    assert!(is_picking(&harness));
    escape(&mut harness);
    assert!(!is_picking(&harness));
    assert_eq!(tool(&harness), Tool::Measure);
    escape(&mut harness);
    assert_eq!(tool(&harness), Tool::Camera);
}

#[test]
fn opening_a_window_by_key_closes_the_menu() {
    let mut harness = window();
    click(&mut harness, "Help");
    press(&mut harness, Modifiers::NONE, Key::F1);
    assert!(harness.state().panels.has(PanelId::HELP));
    assert!(harness.query_by_label_contains("Find a command…").is_none());
}

#[test]
fn escape_closes_windows_top_down_then_leaves_full_screen() {
    let mut harness = window();
    harness.state_mut().appearance.full_screen = true;
    let has = |harness: &Harness<'_, State>| {
        let all = [PanelId::CAMERA_PATH, PanelId::HELP, PanelId::BENCHMARK];
        all.map(|panel| harness.state().panels.has(panel))
    };
    for panel in [PanelId::HELP, PanelId::BENCHMARK, PanelId::CAMERA_PATH] {
        harness.state_mut().run(Command::panel(panel));
        harness.run();
    }
    // A click brings the bottom window to the top.
    let of_help = harness.get_by_label("Orbit").rect().center();
    super::points::click_on(&mut harness, of_help, 1);
    for left in [[true, false, true], [false, false, true], [false; 3]] {
        escape(&mut harness);
        assert_eq!(has(&harness), left);
    }
    assert_eq!(harness.state_mut().take_requests(), []);
    escape(&mut harness);
    assert_eq!(harness.state_mut().take_requests(), [WindowRequest::FullScreen]);
}
