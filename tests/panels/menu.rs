//! The menus.

use super::{FRAMES, click, options, sequence, window_on};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::{Recent, State, StateOptions, WindowRequest};
use std::time::{Duration, Instant};

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
