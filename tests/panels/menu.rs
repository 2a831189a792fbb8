//! The menus.

use super::{FRAMES, click, options, press, sequence, window_on};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Theme, ThemePreference};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::{Command, Recent, State, StateOptions, WindowRequest};
use std::time::{Duration, Instant};

#[test]
fn menus_open_close_and_list_recent_files() {
    let mut recent = Recent::default();
    recent.add(&["/nowhere/at/all".into()]).unwrap();
    let mut harness = window_on(sequence(&[]), StateOptions { recent, ..options() });
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
    assert!(harness.state().notices.list()[0].text.contains("/nowhere/at/all"));
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

#[test]
fn unavailable_menu_items_are_gray() {
    let mut harness = window_on(sequence(&[]), options());
    let can_choose = |harness: &mut Harness<'_, State>, menu: &str, label: &str| {
        click(harness, menu);
        // The shortcut of an item is part of its name.
        let is_it = |text: String| text.starts_with(label);
        let is_grey = harness
            .get_all_by_role(Role::Button)
            .find(|node| node.accesskit_node().label().is_some_and(is_it))
            .expect("the menu has the item")
            .accesskit_node()
            .is_disabled();
        press(harness, Modifiers::NONE, Key::Escape);
        !is_grey
    };
    assert!(!can_choose(&mut harness, "Edit", "Undo"));
    assert!(!can_choose(&mut harness, "Edit", "Redo"));
    assert!(!can_choose(&mut harness, "Benchmark", "Show the last result"));
    press(&mut harness, Modifiers::NONE, Key::G);
    assert!(can_choose(&mut harness, "Edit", "Undo: Grid on"));
    harness.state_mut().run(Command::UNDO);
    harness.run();
    assert!(!can_choose(&mut harness, "Edit", "Undo"));
    assert!(can_choose(&mut harness, "Edit", "Redo: Grid on"));
}

#[test]
fn the_theme_is_chosen_and_stored() {
    let mut harness = window_on(sequence(&[]), options());
    let is_dark = |harness: &Harness<'_, State>| harness.ctx.global_style().visuals.dark_mode;
    assert!(is_dark(&harness), "the system does not say");
    for (name, theme, dark) in [
        ("Light", ThemePreference::Light, false),
        ("Dark", ThemePreference::Dark, true),
        ("Light", ThemePreference::Light, false),
        ("System", ThemePreference::System, true),
    ] {
        click(&mut harness, "View");
        choose_item(&mut harness, "Theme");
        choose_item(&mut harness, name);
        assert_eq!(is_dark(&harness), dark, "{name}");
        assert_eq!(harness.state().preferences().theme, theme);
    }

    // The next window starts as this one was closed, even though the system theme is light.
    harness.state_mut().run(Command::DARK_THEME);
    let preferences = harness.state().preferences();
    let mut next = window_on(
        sequence(&[]),
        StateOptions {
            preferences,
            ..options()
        },
    );
    let set_system = |harness: &mut Harness<'_, State>| {
        harness.input_mut().system_theme = Some(Theme::Light);
        harness.run();
    };
    set_system(&mut next);
    assert!(is_dark(&next));
    next.state_mut().run(Command::THEME_OF_SYSTEM);
    set_system(&mut next);
    assert!(!is_dark(&next), "as the system is");
}

/// A recording with one cloud of one point on each of two topics, and another one on the first.
fn recording(path: &std::path::Path) {
    let mut file = std::fs::File::create(path).unwrap();
    let mut writer = mcap::Writer::new(&mut file).unwrap();
    let schema = writer.add_schema("sensor_msgs/PointCloud2", "ros1msg", b"").unwrap();
    for (topic, cloud_count) in [("/front", 2), ("/rear", 1)] {
        let channel = writer
            .add_channel(schema, topic, "ros1", &std::collections::BTreeMap::default())
            .unwrap();
        for second in 1..=cloud_count {
            let mut message = Vec::new();
            let number = |message: &mut Vec<u8>, value: u32| message.extend(value.to_le_bytes());
            // Sequence, time, no name, 1 x 1 points, three fields.
            for value in [0, second, 0, 0, 1, 1, 3] {
                number(&mut message, value);
            }
            for (name, offset) in [(b"x", 0), (b"y", 4), (b"z", 8)] {
                number(&mut message, 1);
                message.extend(name);
                number(&mut message, offset);
                message.push(7);
                number(&mut message, 1);
            }
            message.push(0);
            for value in [12, 12, 12, 0, 0, 0] {
                number(&mut message, value);
            }
            message.push(1);
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: second,
                log_time: 1,
                publish_time: 1,
            };
            writer.write_to_known_channel(&header, &message).unwrap();
        }
    }
    writer.finish().unwrap();
}

#[test]
fn another_topic_of_a_recording_can_be_chosen_in_the_menu() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.mcap");
    recording(&path);
    let frame_count = |harness: &Harness<'_, State>| harness.state().player.as_ref().unwrap().sequence().len();
    let mut harness = window_on(sequence(&[]), options());
    click(&mut harness, "File");
    assert!(harness.query_by_label("Topic").is_none(), "files have none");
    click(&mut harness, "File");

    let wait_for = |harness: &mut Harness<'_, State>, count: usize| {
        let begin = Instant::now();
        while frame_count(harness) != count {
            assert!(
                begin.elapsed() < Duration::from_secs(20),
                "{count} frames were expected"
            );
            harness.state_mut().update(Duration::ZERO);
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    harness.state_mut().open_paths(vec![path.clone()]);
    wait_for(&mut harness, 2);
    click(&mut harness, "File");
    click(&mut harness, "Topic");
    choose_item(&mut harness, "/rear");
    wait_for(&mut harness, 1);
    assert!(harness.state().notices.list().is_empty());

    // The sequence next to it has its own choice.
    let begin = Instant::now();
    let wait_for_b = |harness: &mut Harness<'_, State>, count: usize| {
        let count_of_b = |state: &State| {
            let split_view = state.features.split_view.as_ref();
            split_view.map(|split_view| split_view.companion.sequence().len())
        };
        while count_of_b(harness.state()) != Some(count) {
            assert!(begin.elapsed() < Duration::from_secs(20), "{count} of B");
            harness.state_mut().update(Duration::ZERO);
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    harness.state_mut().compare_paths(vec![path]);
    wait_for_b(&mut harness, 2);
    harness.run();
    click(&mut harness, "File");
    click(&mut harness, "Topic of B");
    choose_item(&mut harness, "/rear");
    wait_for_b(&mut harness, 1);
    assert_eq!(frame_count(&harness), 1);
}

/// Clicks an item of the open menu; its label has the key after the text.
pub(super) fn choose_item(harness: &mut Harness<'_, State>, text: &str) {
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
