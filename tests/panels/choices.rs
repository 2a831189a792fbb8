//! The command palette, undo, and presets.

use super::{click, frame, options, press, sequence, window, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Presets, State, StateOptions};
use pointreel::scene::Primitive;

#[test]
fn the_palette_finds_selects_and_runs_commands() {
    let mut harness = window();
    press(&mut harness, Modifiers::COMMAND, Key::P);
    let field = || (Role::TextInput, "Find a command");
    let (role, label) = field();
    harness.get_by_role_and_label(role, label).type_text("frm");
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Button, "Turntable").is_none());
    // Next, previous: the second of the results.
    press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    press(&mut harness, Modifiers::NONE, Key::ArrowUp);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.state().features.palette.search.is_none());
    assert_eq!(frame(&harness), 1, "Next frame is the first that is found");

    press(&mut harness, Modifiers::COMMAND, Key::P);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().features.palette.search.is_none());
    assert_eq!(frame(&harness), 1);
}

#[test]
fn the_palette_brings_the_row_of_a_setting_into_view() {
    let mut harness = window();
    let choose = |harness: &mut Harness<'_, State>, text: &str| {
        press(harness, Modifiers::COMMAND, Key::P);
        harness
            .get_by_role_and_label(Role::TextInput, "Find a command")
            .type_text(text);
        harness.run();
        press(harness, Modifiers::NONE, Key::Enter);
        // Scrolling takes several frames.
        for _ in 0..60 {
            harness.step();
        }
    };
    let is_seen = |harness: &Harness<'_, State>, label: &str| {
        let node = harness.query_by_role_and_label(Role::Label, label);
        node.is_some_and(|node| harness.ctx.content_rect().contains_rect(node.rect()))
    };
    assert!(!is_seen(&harness, "Clip"));
    choose(&mut harness, "clip to a box");
    assert!(is_seen(&harness, "Clip"));
    // One of those in a collapsed section.
    assert!(!is_seen(&harness, "Painted by"));
    choose(&mut harness, "painted by");
    assert!(is_seen(&harness, "Painted by"));
    assert!(harness.state().appearance.shows_advanced);
}

#[test]
fn settings_are_undone_and_redone() {
    let mut harness = window();
    let before = harness.state().style;
    harness.state_mut().style.primitive = Primitive::Point.into();
    harness.run();
    let after = harness.state().style;
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(harness.state().style, before);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(harness.state().style, before);
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    assert_eq!(harness.state().style, after);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(harness.state().style, after);
}

#[test]
fn presets_are_applied_saved_and_deleted() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("presets.json");
    let mut harness = window_on(
        sequence(&[]),
        StateOptions {
            presets: Presets::load_from(&file),
            ..options()
        },
    );
    harness.state_mut().style.surfels.splat_scale = 1.5;
    let style = harness.state().style;
    harness.run();
    click(&mut harness, "Presets");
    harness.get_by_label_contains("Save settings…").click();
    harness.run();
    harness
        .get_by_role_and_label(Role::TextInput, "Name of the preset")
        .type_text("mine");
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(Presets::load_from(&file).list()[0].name, "mine");

    click(&mut harness, "Presets");
    click(&mut harness, "Fast");
    assert_eq!(harness.state().style.drawing.resolution, 0.5);
    click(&mut harness, "Presets");
    click(&mut harness, "mine");
    assert_eq!(harness.state().style, style);
    click(&mut harness, "Presets");
    click(&mut harness, "Delete");
    click(&mut harness, "Delete mine");
    assert!(Presets::load_from(&file).list().is_empty());
}
