//! Commands of the window: undo, themes, lists, the end.

use super::common::{Row, group, needs_sequence};
use crate::app::command::{Chord, Command};
use crate::app::open_panels::PanelId;
use crate::app::state::{State, WindowRequest};
use egui::{Key, ThemePreference};
use std::borrow::Cow;

pub(super) const ROWS: &[Row] = &[
    Row::new(Command::UNDO, "Undo", State::undo)
        .titled(|state| titled("Undo", state.history.undo_name()))
        .what("Undo the last change of settings, path or labels")
        .also(&["revert"])
        .keys(group::FILE, "Ctrl+Z", &[Chord::ctrl(Key::Z)])
        .applies(|state| state.history.undo_name().map(|_| ()).ok_or("Nothing was changed")),
    Row::new(Command::REDO, "Redo", State::redo)
        .titled(|state| titled("Redo", state.history.redo_name()))
        .what("Redo the change that was undone")
        .also(&["repeat"])
        .keys(
            group::FILE,
            "Ctrl+Y, Ctrl+Shift+Z",
            &[Chord::ctrl(Key::Y), Chord::ctrl_shift(Key::Z)],
        )
        .applies(|state| state.history.redo_name().map(|_| ()).ok_or("Nothing was undone")),
    Row::new(
        Command::REVERT_SESSION,
        "Revert to saved session",
        State::revert_session,
    )
    .what("Revert the session to its saved state")
    .also(&["discard changes", "undo all"])
    .applies(|state| match state.session_file() {
        Some(_) if state.is_unsaved() => Ok(()),
        Some(_) => Err("The session is as it was saved"),
        None => Err("No session is open"),
    }),
    Row::new(Command::BEGIN_AGAIN, "Begin again from defaults", State::begin_again)
        .what("Begin the open document again from defaults")
        .also(&["reset settings", "reset all", "factory settings", "restore defaults"])
        .applies(needs_sequence),
    Row::new(
        Command::USE_AS_DEFAULTS,
        "Use this look for new files",
        State::use_as_defaults,
    )
    .what("Use this look for new files")
    .also(&["default settings", "save as default"])
    .applies(needs_sequence),
    Row::new(Command::FULL_SCREEN, "Full screen", |state| {
        state.request(WindowRequest::FullScreen);
    })
    .also(&["maximize", "kiosk", "presentation mode"])
    .keys(group::VIEW, "F11", &[Chord::plain(Key::F11)])
    .on_if(|state| state.appearance.full_screen),
    Row::new(Command::THEME_OF_SYSTEM, "System", |state| {
        state.appearance.theme = ThemePreference::System;
    })
    .what("Theme: as the system")
    .also(&["dark mode", "appearance"])
    .hint("Follows the system; dark if unknown")
    .on_if(|state| state.appearance.theme == ThemePreference::System),
    Row::new(Command::LIGHT_THEME, "Light", |state| {
        state.appearance.theme = ThemePreference::Light;
    })
    .what("Theme: light")
    .also(&["light mode", "bright mode", "appearance"])
    .hint("Light, regardless of the system")
    .on_if(|state| state.appearance.theme == ThemePreference::Light),
    Row::new(Command::DARK_THEME, "Dark", |state| {
        state.appearance.theme = ThemePreference::Dark;
    })
    .what("Theme: dark")
    .also(&["dark mode", "night mode", "appearance"])
    .hint("Dark, regardless of the system")
    .on_if(|state| state.appearance.theme == ThemePreference::Dark),
    Row::new(Command::panel(PanelId::HELP), "Keys and mouse", |state| {
        state.panels.toggle(PanelId::HELP);
    })
    .what("Keys and mouse")
    .also(&[
        "keyboard shortcuts",
        "hotkeys",
        "help",
        "controls",
        "keybindings",
        "manual",
        "navigation",
    ])
    .keys(group::FILE, "F1", &[Chord::plain(Key::F1)]),
    Row::new(Command::panel(PanelId::ABOUT), "About pointreel", |state| {
        state.panels.toggle(PanelId::ABOUT);
    })
    .what("About pointreel: version, GPU, folders")
    .also(&["license", "system information", "adapter", "log"]),
    Row::new(Command::ESCAPE, "Close panel or tool", State::escape)
        .what("Stop, close this list, clear points, leave full screen")
        .keys(group::FILE, "Esc", &[Chord::plain(Key::Escape)]),
    Row::new(Command::QUIT, "Quit", State::quit)
        .also(&["exit", "close window", "end"])
        .keys(group::FILE, "Ctrl+Q", &[Chord::ctrl(Key::Q)]),
];

/// A title with its subject, if known.
fn titled(title: &'static str, name: Option<&str>) -> Cow<'static, str> {
    name.map_or(Cow::Borrowed(title), |name| Cow::Owned(format!("{title}: {name}")))
}
