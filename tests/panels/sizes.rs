//! Windows of all sizes: nothing of the menu bar and the timeline is cut, or lies over something else.

use super::menu::choose_item;
use super::{click, options, sequence, state_on};
use egui::accesskit::Role;
use egui::{Rect, ThemePreference, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointreel::app::panels::window_ui;
use pointreel::app::{PanelId, State, apply_theme};

const SIZES: [[f32; 2]; 4] = [[320.0, 240.0], [640.0, 480.0], [1280.0, 800.0], [2560.0, 1440.0]];

/// A window of so many pixels, with so many to a point.
fn window_of(size_px: [f32; 2], pixels_per_point: f32) -> Harness<'static, State> {
    let state = state_on(sequence(&[]), options());
    let size = vec2(size_px[0], size_px[1]) / pixels_per_point;
    let mut harness = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(pixels_per_point)
        .with_max_steps(20)
        .with_context_setup(apply_theme)
        .build_ui_state(|ui, state: &mut State| window_ui(ui, state), state);
    harness.run();
    harness
}

/// Names and places of what is read or pressed.
fn widgets(harness: &Harness<'_, State>) -> Vec<(String, Rect)> {
    let roles = [Role::Button, Role::ComboBox, Role::SpinButton, Role::Label];
    let all = harness.root().children_recursive();
    let all = all.filter(|node| roles.contains(&node.accesskit_node().role()));
    let named = all.map(|node| {
        let node_of_tree = node.accesskit_node();
        let name = node_of_tree
            .label()
            .or_else(|| node_of_tree.value())
            .unwrap_or_default();
        (name, node.rect())
    });
    named.filter(|(_, rect)| rect.is_positive()).collect()
}

/// What lies over each other, or beyond the edge of the window.
fn collisions(harness: &Harness<'_, State>) -> Vec<String> {
    let widgets = widgets(harness);
    let window = harness.ctx.content_rect();
    let mut found = Vec::new();
    for (index, (name, rect)) in widgets.iter().enumerate() {
        if !window.expand(1.0).contains_rect(*rect) {
            found.push(format!("{name:?} at {rect:?} is cut by the window {window:?}"));
        }
        for (other, other_rect) in &widgets[index + 1..] {
            let common = rect.intersect(*other_rect);
            let is_nested = rect.contains_rect(*other_rect) || other_rect.contains_rect(*rect);
            if common.width() > 1.0 && common.height() > 1.0 && !is_nested {
                found.push(format!("{name:?} at {rect:?} lies over {other:?} at {other_rect:?}"));
            }
        }
    }
    found
}

#[test]
fn nothing_is_cut_or_lies_over_something_else() {
    for size_px in SIZES {
        for pixels_per_point in [1.0, 2.0] {
            let mut harness = window_of(size_px, pixels_per_point);
            harness.state_mut().panels.set(PanelId::SETTINGS, false);
            harness.run();
            let found = collisions(&harness);
            assert!(found.is_empty(), "{size_px:?} at {pixels_per_point}: {found:#?}");
        }
    }
}

#[test]
fn a_narrow_window_keeps_room_for_the_picture() {
    for size_px in SIZES {
        let mut harness = window_of(size_px, 1.0);
        let picture = harness.state().viewport.rect;
        assert!(
            picture.width() >= 160.0 && picture.height() >= 60.0,
            "{size_px:?}: {picture:?}"
        );
        if size_px[0] < 400.0 {
            // Over the picture, and closed by its own button.
            assert!(harness.state().panels.has(PanelId::SETTINGS));
            click(&mut harness, "Close window");
            assert!(!harness.state().panels.has(PanelId::SETTINGS));
        }
    }
}

#[test]
fn menus_stay_inside_of_a_low_window() {
    let mut harness = window_of([640.0, 480.0], 1.0);
    click(&mut harness, "View");
    let window = harness.ctx.content_rect();
    let theme = |harness: &Harness<'_, State>, scrolls: bool| {
        let mut items = harness.get_all_by_role(Role::Button);
        let is_theme = |label: String| label.starts_with("Theme");
        let item = items.find(|node| node.accesskit_node().label().is_some_and(is_theme));
        let item = item.unwrap();
        if scrolls {
            item.scroll_to_me();
        }
        item.rect()
    };
    // Below the window at first, and scrolled to.
    assert!(!window.contains_rect(theme(&harness, true)));
    harness.run();
    let rect = theme(&harness, false);
    assert!(window.contains_rect(rect), "{rect:?} in {window:?}");
    choose_item(&mut harness, "Theme");
    choose_item(&mut harness, "Light");
    assert_eq!(harness.state().appearance.theme, ThemePreference::Light);
}
