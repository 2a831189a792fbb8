//! The menu bar.

use super::bound;
use super::presets::presets_menu;
use super::table::menu_items;
use crate::app::command::{Command, keys_of};
use crate::app::features::assumptions::panel::CHIP_WIDTH;
use crate::app::recent::entry_name;
use crate::app::{Benchmark, PanelId, Side, State, Tool};
use crate::bench::suites;
use crate::playback::Player;
use crate::scene::{Projection, ViewPreset};
use crate::source::Example;
use egui::{Button, MenuBar, ScrollArea, ThemePreference, Ui};
use std::path::PathBuf;

/// Width left of the bar from which the name of the sequence is worth showing, points.
const LEAST_NAME_WIDTH: f32 = 60.0;

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
        if ui.available_width() <= LEAST_NAME_WIDTH {
            return;
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.available_width() > CHIP_WIDTH {
                bound::assumptions_chip(ui, state);
            }
            let name = state.sequence_name();
            if let Some(name) = name.filter(|_| ui.available_width() > LEAST_NAME_WIDTH) {
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
        item(ui, state, "Keys and mouse", Command::TogglePanel(PanelId::HELP));
        item(ui, state, "Find a command…", Command::TogglePalette);
        item(ui, state, "About pointreel", Command::TogglePanel(PanelId::ABOUT));
    });
}

/// A menu, which scrolls where it is higher than the window.
fn menu(ui: &mut Ui, title: &str, items: impl FnOnce(&mut Ui)) {
    let most_height = (ui.ctx().content_rect().height() - FREE_HEIGHT).max(FREE_HEIGHT);
    ui.menu_button(title, |ui| {
        // A menu is made before it is known how much room there is.
        let area = ScrollArea::vertical().max_height(most_height);
        area.min_scrolled_height(most_height).show(ui, items);
    });
}

fn item(ui: &mut Ui, state: &mut State, text: &str, command: Command) {
    run_by(ui, state, Button::new(text), command, "");
}

/// Runs `command` once `button` is clicked.
fn run_by(ui: &mut Ui, state: &mut State, button: Button<'_>, command: Command, tooltip: &str) {
    let mut button = ui.add(button.shortcut_text(keys_of(command)));
    if !tooltip.is_empty() {
        button = button.on_hover_text(tooltip);
    }
    if button.clicked() {
        state.run(command);
        ui.close();
    }
}

fn file_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(220.0);
    item(ui, state, "Open files…", Command::OpenFiles);
    item(ui, state, "Open folder…", Command::OpenFolder);
    ui.menu_button("Recent", |ui| recent_menu(ui, state));
    topic_menu(ui, state, Side::A);
    item(ui, state, "Demo", Command::OpenDemo);
    ui.menu_button("Examples", |ui| {
        for example in Example::ALL {
            let button = Button::new(example.title());
            run_by(ui, state, button, Command::OpenExample(example), example.credit());
        }
    });
    ui.add_enabled_ui(state.player.is_some(), |ui| {
        item(ui, state, "Close", Command::CloseSequence);
    });
    ui.add_enabled_ui(state.player.is_some(), |ui| {
        let tooltip = "One sequence file, or a folder of files; sizes and errors are shown before";
        run_by(ui, state, Button::new("Save as…"), Command::ToggleSave, tooltip);
        let tooltip = "Files, view, settings, clip, measurements, labels, markers and camera path, as a text file";
        let button = Button::new("Save session…");
        run_by(ui, state, button, Command::SaveSession, tooltip);
        item(ui, state, "Save session as…", Command::SaveSessionAs);
    });
    let live = state
        .player
        .as_ref()
        .and_then(|player| player.sequence().source().live());
    let is_recording = live.map(|live| live.status().recording.is_some());
    ui.add_enabled_ui(is_recording.is_some(), |ui| {
        let text = if is_recording == Some(true) {
            "Stop recording"
        } else {
            "Record…"
        };
        let tooltip = "Writes what arrives of a live stream to a file, as it comes; the file opens as any other";
        run_by(ui, state, Button::new(text), Command::ToggleRecording, tooltip);
    });
    ui.separator();
    ui.add_enabled_ui(state.player.is_some(), |ui| {
        ui.menu_button("Compare with…", |ui| compare_menu(ui, state));
    });
    topic_menu(ui, state, Side::B);
    ui.add_enabled_ui(state.pictures().is_some(), |ui| {
        item(ui, state, "Close comparison", Command::CloseComparison);
    });
    ui.separator();
    ui.add_enabled_ui(state.player.is_some(), |ui| {
        item(ui, state, "Save picture", Command::Screenshot);
        item(ui, state, "Save picture as…", Command::SaveScreenshotAs);
        let tooltip = "Pictures of any size, turntables, camera paths and the sequence as videos";
        run_by(ui, state, Button::new("Export…"), Command::ToggleExport, tooltip);
    });
    ui.separator();
    item(ui, state, "Quit", Command::Quit);
}

/// What to open beside the open sequence.
fn compare_menu(ui: &mut Ui, state: &mut State) {
    item(ui, state, "Files…", Command::CompareFiles);
    item(ui, state, "Folder…", Command::CompareFolder);
    ui.separator();
    if let Some(inputs) = recent_items(ui, state) {
        state.compare_paths(inputs);
    }
}

/// Which of a recording's topics is the sequence, or the one beside it, where there are several.
fn topic_menu(ui: &mut Ui, state: &mut State, side: Side) {
    let player = state.player.as_ref();
    let beside = state.beside.as_ref();
    let (name, sequence) = match side {
        Side::A => ("Topic", player.map(Player::sequence)),
        Side::B => ("Topic of B", beside.map(|beside| beside.companion.sequence())),
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
    if state.recent.entries().is_empty() {
        ui.weak("Nothing yet");
        return;
    }
    let chosen = recent_items(ui, state);
    ui.separator();
    if ui.button("Clear the list").clicked() {
        if let Err(problem) = state.recent.clear() {
            state.notices.warn(problem);
        }
        ui.close();
    }
    if let Some(inputs) = chosen {
        state.open_paths(inputs);
    }
}

/// What was opened lately; what was chosen of it.
fn recent_items(ui: &mut Ui, state: &State) -> Option<Vec<PathBuf>> {
    let mut chosen = None;
    for inputs in state.recent.entries() {
        if ui.button(entry_name(inputs)).clicked() {
            chosen = Some(inputs.clone());
            ui.close();
        }
    }
    chosen
}

fn edit_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(190.0);
    let [undo, redo] = [state.history.undo_name(), state.history.redo_name()].map(|name| name.map(str::to_owned));
    for (what, name, command) in [("Undo", undo, Command::Undo), ("Redo", redo, Command::Redo)] {
        let title = name.as_ref().map_or(what.to_owned(), |name| format!("{what}: {name}"));
        ui.add_enabled_ui(name.is_some(), |ui| item(ui, state, &title, command));
    }
    ui.add_enabled_ui(state.player.is_some(), |ui| {
        item(ui, state, "Begin again from defaults", Command::BeginAgain);
        item(ui, state, "Use this look for new files", Command::UseAsDefaults);
    });
    ui.separator();
    item(ui, state, "Copy view", Command::CopyView);
    item(ui, state, "Paste view", Command::PasteView);
}

/// What the timeline's own buttons have no room for.
fn play_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(240.0);
    ui.add_enabled_ui(state.player.is_some(), |ui| {
        let is_playing = state.player.as_ref().is_some_and(Player::is_playing);
        let play = if is_playing { "Pause" } else { "Play" };
        item(ui, state, play, Command::TogglePlay);
        item(ui, state, "Slower", Command::Slower);
        item(ui, state, "Faster", Command::Faster);
        item(ui, state, "Reverse", Command::Reverse);
        item(ui, state, "Once, loop or ping-pong", Command::NextLoopMode);
        ui.separator();
        item(ui, state, "Set in point", Command::SetIn);
        item(ui, state, "Set out point", Command::SetOut);
        item(ui, state, "Clear in and out point", Command::ClearRange);
        ui.separator();
        item(ui, state, "Add or remove marker", Command::ToggleMarker);
        item(ui, state, "Next marker", Command::NextMarker);
        item(ui, state, "Previous marker", Command::PreviousMarker);
        ui.separator();
        item(ui, state, "Make thumbnails anew", Command::RedoThumbnails);
    });
}

fn view_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(190.0);
    for &(name, preset, _, _) in ViewPreset::ALL {
        item(ui, state, name, Command::Look(preset));
    }
    ui.add_enabled_ui(state.sensor().is_some(), |ui| {
        let tooltip = "As the depth camera saw what is shown: in the size of its image, pixel by pixel";
        run_by(
            ui,
            state,
            Button::new("Look from the sensor"),
            Command::LookFromSensor,
            tooltip,
        );
    });
    ui.separator();
    item(ui, state, "Reset view", Command::ResetView);
    item(ui, state, "Frame everything", Command::FrameAll);
    ui.separator();
    let is_orthographic = state.camera.projection == Projection::Orthographic;
    let has_legend = state.panels.has(PanelId::LEGEND);
    let legend = Command::TogglePanel(PanelId::LEGEND);
    for (text, is_on, command) in [
        ("Orthographic", is_orthographic, Command::ToggleOrthographic),
        ("Turntable", state.motion.turntable.is_on, Command::ToggleTurntable),
        ("Grid", state.style.backdrop.grid, Command::ToggleGrid),
        ("Scale bar", state.appearance.shows_scale_bar, Command::ToggleScaleBar),
        ("Thumbnails", state.thumbnails.is_on, Command::ToggleThumbnails),
        ("Legend", has_legend, legend),
    ] {
        choice(ui, state, (text, is_on), command);
    }
    for (text, panel) in menu_items() {
        let is_open = state.panels.has(panel);
        choice(ui, state, (text, is_open), Command::TogglePanel(panel));
    }
    let is_compared = state.comparison.is_some();
    let compares = ("Compare A/B", is_compared);
    choice(ui, state, compares, Command::ToggleComparison);
    let fills_screen = ("Full screen", state.appearance.full_screen);
    choice(ui, state, fills_screen, Command::FullScreen);
    ui.menu_button("Theme", |ui| theme_menu(ui, state));
}

/// An item that shows whether it is on.
fn choice(ui: &mut Ui, state: &mut State, (text, is_on): (&str, bool), command: Command) {
    run_by(ui, state, Button::selectable(is_on, text), command, "");
}

fn theme_menu(ui: &mut Ui, state: &mut State) {
    for (text, theme, tooltip) in [
        (
            "System",
            ThemePreference::System,
            "Light or dark as the system is; dark where it does not say",
        ),
        ("Light", ThemePreference::Light, "Light, whatever the system is"),
        ("Dark", ThemePreference::Dark, "Dark, whatever the system is"),
    ] {
        let button = Button::selectable(state.appearance.theme == theme, text);
        if ui.add(button).on_hover_text(tooltip).clicked() {
            state.run(Command::Theme(theme));
            ui.close();
        }
    }
}

fn tools_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(190.0);
    for (text, tool, tooltip) in [
        (
            "Point values",
            Tool::Point,
            "A click on a point shows all that its file says of it",
        ),
        (
            "Measure",
            Tool::Measure,
            "Clicks on points measure distances, angles and heights",
        ),
        (
            "Label",
            Tool::Label,
            "Clicks put texts at points, in the window, in pictures and in videos",
        ),
    ] {
        let button = Button::selectable(state.inspection.tool == tool, text);
        run_by(ui, state, button, Command::ToggleTool(tool), tooltip);
    }
}

fn benchmark_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(200.0);
    let can_start = state.player.is_some() && !matches!(state.benchmark, Benchmark::Running(_));
    for suite in suites::all() {
        let button = ui
            .add_enabled(can_start, Button::new(suite.title))
            .on_hover_text(suite.hint);
        if button.clicked() {
            state.start_benchmark(suite);
            ui.close();
        }
    }
    ui.separator();
    let has_result = !matches!(state.benchmark, Benchmark::Idle);
    let show = Button::new("Show the last result");
    if ui.add_enabled(has_result, show).clicked() {
        state.panels.set(PanelId::BENCHMARK, true);
        ui.close();
    }
}
