//! Windows of all sizes: no part of the menu bar and the timeline is cut, or overlaps another.

use super::menu::choose_item;
use super::{click, options, sequence, state_on};
use egui::accesskit::Role;
use egui::{Rect, ThemePreference, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::{Harness, Node};
use pointreel::app::panels::window_ui;
use pointreel::app::{PanelId, State, apply_theme};

const SIZES: [[f32; 2]; 4] = [[320.0, 240.0], [640.0, 480.0], [1280.0, 800.0], [2560.0, 1440.0]];

/// A window of this many pixels, with this many per point.
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

/// Names and positions of texts and controls.
fn widgets(harness: &Harness<'_, State>) -> Vec<(String, Rect)> {
    widgets_in(harness.root().children_recursive())
}

/// Those among some nodes.
fn widgets_in<'a>(nodes: impl Iterator<Item = Node<'a>>) -> Vec<(String, Rect)> {
    let roles = [
        Role::Button,
        Role::CheckBox,
        Role::ColorWell,
        Role::ComboBox,
        Role::Label,
        Role::Link,
        Role::RadioButton,
        Role::Slider,
        Role::SpinButton,
        Role::TextInput,
    ];
    let all = nodes.filter(|node| roles.contains(&node.accesskit_node().role()));
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

/// Items that overlap, or extend beyond the edge of the window.
fn collisions(harness: &Harness<'_, State>) -> Vec<String> {
    let widgets = widgets(harness);
    let window = harness.ctx.content_rect();
    let mut found = overlaps(&widgets);
    for (name, rect) in &widgets {
        if !window.expand(1.0).contains_rect(*rect) {
            found.push(format!("{name:?} at {rect:?} is cut by the window {window:?}"));
        }
    }
    found
}

/// Pairs of them that overlap, unless one is a part of the other.
fn overlaps(widgets: &[(String, Rect)]) -> Vec<String> {
    let mut found = Vec::new();
    for (index, (name, rect)) in widgets.iter().enumerate() {
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

/// A window over the image, and its contents.
#[derive(Debug)]
struct Tool {
    title: String,
    rect: Rect,
    widgets: Vec<(String, Rect)>,
}

fn tools(harness: &Harness<'_, State>) -> Vec<Tool> {
    let all = harness.root().children_recursive();
    let windows = all.filter(|node| node.accesskit_node().role() == Role::Window && node.rect().is_positive());
    let tools = windows.map(|window| Tool {
        title: window.accesskit_node().label().unwrap_or_default(),
        rect: window.rect(),
        widgets: widgets_in(window.children_recursive()),
    });
    tools.collect()
}

/// Faults of the windows over the image: beyond the edge, or printed over themselves; where the program's
/// window is large enough for them, wider than they show. In smaller ones they scroll.
fn faults_of_tools(harness: &Harness<'_, State>) -> Vec<String> {
    let window = harness.ctx.content_rect();
    let is_large = window.width() >= 1000.0;
    let tools = tools(harness);
    let mut found = Vec::new();
    for Tool { title, rect, widgets } in &tools {
        if !window.expand(1.0).contains_rect(*rect) {
            found.push(format!("window {title:?} at {rect:?} is cut by {window:?}"));
        }
        let sides = rect.x_range().expand(1.0);
        for (name, inner) in widgets.iter().filter(|_| is_large) {
            if !sides.contains(inner.left()) || !sides.contains(inner.right()) {
                found.push(format!(
                    "{name:?} at {inner:?} is cut by its window {title:?} at {rect:?}"
                ));
            }
        }
        found.extend(overlaps(widgets));
    }
    found
}

#[test]
fn nothing_is_clipped_or_overlaps() {
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
fn no_panel_is_clipped_or_overlaps_itself() {
    let panels = [
        PanelId::SETTINGS,
        PanelId::STATISTICS,
        PanelId::LEGEND,
        PanelId::HELP,
        PanelId::BENCHMARK,
        PanelId::CAMERA_PATH,
        PanelId::EXPORT,
        PanelId::ABOUT,
        PanelId::SAVE,
        PanelId::new("photographs"),
        PanelId::new("labels"),
    ];
    let mut found = Vec::new();
    for size_px in SIZES {
        for pixels_per_point in [1.0, 2.0] {
            let mut harness = window_of(size_px, pixels_per_point);
            for theme in [ThemePreference::Dark, ThemePreference::Light] {
                harness.state_mut().appearance.theme = theme;
                for panel in panels {
                    for other in panels {
                        harness.state_mut().panels.set(other, other == panel);
                    }
                    harness.run();
                    let faults = faults_of_tools(&harness).into_iter().chain(side_faults(&harness));
                    found.extend(
                        faults.map(|fault| format!("{panel:?} {size_px:?} {pixels_per_point} {theme:?}: {fault}")),
                    );
                }
            }
        }
    }
    assert!(found.is_empty(), "{}: {found:#?}", found.len());
}

/// Panels next to the image: visible items that are printed over one another, or cut at the sides of the window. Items
/// out of scroll are below, where the timeline is.
fn side_faults(harness: &Harness<'_, State>) -> Vec<String> {
    let picture = harness.state().viewport.rect;
    let split_view = widgets(harness).into_iter().filter(|(_, rect)| {
        let is_shown = picture.y_range().contains(rect.top()) && picture.y_range().contains(rect.bottom());
        is_shown && !picture.intersects(*rect)
    });
    let split_view: Vec<_> = split_view.collect();
    let sides = harness.ctx.content_rect().x_range().expand(1.0);
    let is_cut = |rect: &Rect| !sides.contains(rect.left()) || !sides.contains(rect.right());
    let cut = split_view.iter().filter(|(_, rect)| is_cut(rect));
    let cut = cut.map(|(name, rect)| format!("{name:?} at {rect:?} is cut at the side of the window"));
    cut.chain(overlaps(&split_view)).collect()
}

#[test]
fn a_narrow_window_leaves_space_for_the_image() {
    for size_px in SIZES {
        let mut harness = window_of(size_px, 1.0);
        let picture = harness.state().viewport.rect;
        assert!(
            picture.width() >= 160.0 && picture.height() >= 60.0,
            "{size_px:?}: {picture:?}"
        );
        if size_px[0] < 400.0 {
            // Over the image, and closed by its own button.
            assert!(harness.state().panels.has(PanelId::SETTINGS));
            click(&mut harness, "Close window");
            assert!(!harness.state().panels.has(PanelId::SETTINGS));
        }
    }
}

#[test]
fn menus_stay_inside_a_low_window() {
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
    // Below the window at first, and then scrolled to.
    assert!(!window.contains_rect(theme(&harness, true)));
    harness.run();
    let rect = theme(&harness, false);
    assert!(window.contains_rect(rect), "{rect:?} in {window:?}");
    choose_item(&mut harness, "Theme");
    choose_item(&mut harness, "Light");
    assert_eq!(harness.state().appearance.theme, ThemePreference::Light);
}
