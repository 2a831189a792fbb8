//! Items of menus: a command each.

use crate::app::State;
use crate::app::command::{Command, CommandRow};
use crate::app::commands::row_of;
use egui::{Button, Ui};

/// The item of a command: grey where it does not apply, with the reason.
pub(super) fn item(ui: &mut Ui, state: &mut State, command: Command) {
    if let Some(row) = row_of(command) {
        row_item(ui, state, row);
    }
}

pub(super) fn row_item(ui: &mut Ui, state: &mut State, row: &CommandRow<State>) {
    let title = row.title(state);
    let button = match row.is_on {
        Some(is_on) => Button::selectable(is_on(state), title.as_ref()),
        None => Button::new(title.as_ref()),
    };
    let why_not = row.why_not(state);
    let mut response = ui.add_enabled(why_not.is_none(), button.shortcut_text(row.keys_text()));
    if let Some(reason) = why_not {
        response = response.on_disabled_hover_text(reason);
    } else if !row.hint.is_empty() {
        response = response.on_hover_text(row.hint);
    }
    if response.clicked() {
        state.run(row.command);
        ui.close();
    }
}

/// The items of `commands`.
pub(super) fn items(ui: &mut Ui, state: &mut State, commands: &[Command]) {
    for &command in commands {
        item(ui, state, command);
    }
}
