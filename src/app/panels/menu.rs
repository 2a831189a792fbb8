//! The menu bar.

use super::items::{item, items, row_item};
use super::presets::presets_menu;
use super::table::{menu_panels, panels};
use crate::app::command::{Command, Menu};
use crate::app::commands::{commands, opens_example, row_of};
use crate::app::panel_row::Dock;
use crate::app::recent::entry_name;
use crate::app::{PanelId, Side, State};
use crate::bench::suites;
use crate::playback::Player;
use crate::source::Example;
use egui::{Button, MenuBar, ScrollArea, Ui};
use std::path::PathBuf;

/// Width left of the bar from which the name of the sequence is worth showing, points.
const MIN_NAME_WIDTH: f32 = 60.0;

/// Height of a window that menus leave free, points.
const FREE_HEIGHT: f32 = 48.0;

/// A narrower bar has one menu with the others in it, points.
const BAR_WIDTH: f32 = 480.0;

/// File, Edit, Playback, View, Presets, Tools, Benchmark, Help; in a narrow window all in one.
pub(super) fn menu_ui(ui: &mut Ui, state: &mut State) {
    MenuBar::new().ui(ui, |ui| {
        if ui.available_width() < BAR_WIDTH {
            menu(ui, "Menu", |ui| menus_ui(ui, state));
        } else {
            menus_ui(ui, state);
        }
        if ui.available_width() <= MIN_NAME_WIDTH {
            return;
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for row in panels() {
                if matches!(row.place, Dock::Chip(width) if ui.available_width() > width) {
                    (row.show)(ui, state);
                }
            }
            let name = state.sequence_name();
            if let Some(name) = name.filter(|_| ui.available_width() > MIN_NAME_WIDTH) {
                ui.add(egui::Label::new(egui::RichText::new(name).weak()).truncate());
            }
        });
    });
}

fn menus_ui(ui: &mut Ui, state: &mut State) {
    menu(ui, "File", |ui| file_menu(ui, state));
    menu(ui, "Edit", |ui| edit_menu(ui, state));
    menu(ui, "Playback", |ui| play_menu(ui, state));
    menu(ui, "View", |ui| view_menu(ui, state));
    menu(ui, "Presets", |ui| presets_menu(ui, state));
    menu(ui, "Tools", |ui| tools_menu(ui, state));
    menu(ui, "Benchmark", |ui| benchmark_menu(ui, state));
    menu(ui, "Help", |ui| {
        let help = Command::panel(PanelId::HELP);
        let about = Command::panel(PanelId::ABOUT);
        items(ui, state, &[help, Command::TOGGLE_PALETTE, about]);
    });
}

/// A menu, which scrolls where it is higher than the window.
fn menu(ui: &mut Ui, title: &str, items: impl FnOnce(&mut Ui)) {
    let max_height = (ui.ctx().content_rect().height() - FREE_HEIGHT).max(FREE_HEIGHT);
    ui.menu_button(title, |ui| {
        // A menu is built before its available space is known.
        let area = ScrollArea::vertical().max_height(max_height);
        area.min_scrolled_height(max_height).show(ui, items);
    });
}

/// The commands that say themselves that they are in `menu`.
fn own_items(ui: &mut Ui, state: &mut State, menu: Menu) {
    for row in commands().filter(|row| row.menu == Some(menu)) {
        row_item(ui, state, row);
    }
}

fn file_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(220.0);
    items(ui, state, &[Command::OPEN_FILES, Command::OPEN_FOLDER]);
    ui.menu_button("Recent", |ui| recent_menu(ui, state));
    topic_menu(ui, state, Side::A);
    item(ui, state, Command::OPEN_DEMO);
    ui.menu_button("Examples", |ui| {
        for example in Example::ALL {
            if ui.button(example.title()).on_hover_text(example.credit()).clicked() {
                state.run(opens_example(example));
                ui.close();
            }
        }
    });
    items(
        ui,
        state,
        &[
            Command::CLOSE_SEQUENCE,
            Command::TOGGLE_SAVE,
            Command::SAVE_SESSION,
            Command::SAVE_SESSION_AS,
            Command::TOGGLE_RECORDING,
        ],
    );
    ui.separator();
    ui.add_enabled_ui(state.player.is_some(), |ui| {
        ui.menu_button("Compare with…", |ui| compare_menu(ui, state));
    });
    topic_menu(ui, state, Side::B);
    item(ui, state, Command::CLOSE_COMPARISON);
    ui.separator();
    let pictures = [Command::SCREENSHOT, Command::SAVE_SCREENSHOT_AS, Command::TOGGLE_EXPORT];
    items(ui, state, &pictures);
    own_items(ui, state, Menu::File);
    ui.separator();
    item(ui, state, Command::QUIT);
}

/// Shows the compare menu: sequences to open alongside the open one.
fn compare_menu(ui: &mut Ui, state: &mut State) {
    items(ui, state, &[Command::COMPARE_FILES, Command::COMPARE_FOLDER]);
    ui.separator();
    if let Some(inputs) = recent_items(ui, state) {
        state.compare_paths(inputs);
    }
}

/// Shows the topic menu: the recording topic of the sequence, or of the one compared with it, where there are several.
fn topic_menu(ui: &mut Ui, state: &mut State, side: Side) {
    let player = state.player.as_ref();
    let split_view = state.features.split_view.as_ref();
    let (name, sequence) = match side {
        Side::A => ("Topic", player.map(Player::sequence)),
        Side::B => (
            "Topic of B",
            split_view.map(|split_view| split_view.companion.sequence()),
        ),
    };
    let topics = sequence.map_or_else(Vec::new, |sequence| sequence.source().topics());
    if topics.len() < 2 {
        return;
    }
    let mut chosen = None;
    ui.menu_button(name, |ui| {
        for topic in &topics {
            let button = Button::selectable(topic.is_read, topic.name.as_str())
                .shortcut_text(format!("{} clouds", topic.cloud_count));
            if ui.add_enabled(topic.cloud_count > 0, button).clicked() {
                chosen = Some(topic.name.clone());
                ui.close();
            }
        }
    });
    if let Some(topic) = chosen {
        match side {
            Side::A => state.open_topic(&topic),
            Side::B => state.compare_topic(&topic),
        }
    }
}

fn recent_menu(ui: &mut Ui, state: &mut State) {
    if state.stored.recent.entries().is_empty() {
        ui.weak("Nothing yet");
        return;
    }
    let chosen = recent_items(ui, state);
    ui.separator();
    if ui.button("Clear list").clicked() {
        if let Err(problem) = state.stored.recent.clear() {
            state.notices.warn(problem);
        }
        ui.close();
    }
    if let Some(inputs) = chosen {
        state.open_paths(inputs);
    }
}

/// Lists recently opened items; returns the chosen ones.
fn recent_items(ui: &mut Ui, state: &State) -> Option<Vec<PathBuf>> {
    let mut chosen = None;
    for inputs in state.stored.recent.entries() {
        if ui.button(entry_name(inputs)).clicked() {
            chosen = Some(inputs.clone());
            ui.close();
        }
    }
    chosen
}

fn edit_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(190.0);
    items(
        ui,
        state,
        &[
            Command::UNDO,
            Command::REDO,
            Command::REVERT_SESSION,
            Command::BEGIN_AGAIN,
            Command::USE_AS_DEFAULTS,
        ],
    );
    ui.separator();
    items(ui, state, &[Command::COPY_VIEW, Command::PASTE_VIEW]);
    own_items(ui, state, Menu::Edit);
}

/// Shows the play menu with commands that do not fit among the timeline's own buttons.
fn play_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(240.0);
    let pace = [
        Command::TOGGLE_PLAY,
        Command::SLOWER,
        Command::FASTER,
        Command::REVERSE,
        Command::NEXT_LOOP_MODE,
    ];
    let range = [Command::SET_IN, Command::SET_OUT, Command::CLEAR_RANGE];
    let markers = [Command::TOGGLE_MARKER, Command::NEXT_MARKER, Command::PREVIOUS_MARKER];
    for part in [&pace[..], &range, &markers] {
        items(ui, state, part);
        ui.separator();
    }
    item(ui, state, Command::REDO_THUMBNAILS);
}

fn view_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(190.0);
    let directions = [
        Command::FRONT,
        Command::BACK,
        Command::LEFT,
        Command::RIGHT,
        Command::TOP,
        Command::BOTTOM,
        Command::LOOK_FROM_SENSOR,
    ];
    items(ui, state, &directions);
    ui.separator();
    items(ui, state, &[Command::RESET_VIEW, Command::FRAME_ALL]);
    ui.separator();
    let shown = [
        Command::TOGGLE_ORTHOGRAPHIC,
        Command::TOGGLE_TURNTABLE,
        Command::TOGGLE_GRID,
        Command::TOGGLE_SCALE_BAR,
        Command::TOGGLE_THUMBNAILS,
        Command::panel(PanelId::LEGEND),
    ];
    items(ui, state, &shown);
    for (title, panel) in menu_panels() {
        panel_item(ui, state, title, panel);
    }
    items(ui, state, &[Command::TOGGLE_COMPARISON, Command::FULL_SCREEN]);
    ui.menu_button("Theme", |ui| {
        items(
            ui,
            state,
            &[Command::THEME_OF_SYSTEM, Command::LIGHT_THEME, Command::DARK_THEME],
        );
    });
}

/// The item of a panel, whether it has a row of commands or not.
fn panel_item(ui: &mut Ui, state: &mut State, title: &str, panel: PanelId) {
    let command = Command::panel(panel);
    if row_of(command).is_some() {
        return item(ui, state, command);
    }
    if ui.add(Button::selectable(state.panels.has(panel), title)).clicked() {
        state.run(command);
        ui.close();
    }
}

fn tools_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(190.0);
    own_items(ui, state, Menu::Tools);
}

fn benchmark_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(200.0);
    let why_not = row_of(Command::SET_UP_BENCHMARK).and_then(|row| row.why_not(state));
    for suite in suites::all() {
        let button = ui
            .add_enabled(why_not.is_none(), Button::new(format!("{}…", suite.title)))
            .on_hover_text(suite.hint)
            .on_disabled_hover_text(why_not.unwrap_or_default());
        if button.clicked() {
            state.give_or_tell(Command::SET_UP_BENCHMARK, suite.name());
            ui.close();
        }
    }
    ui.separator();
    item(ui, state, Command::panel(PanelId::BENCHMARK));
}
