//! The menu of presets, and the window for the name of a new one.

use super::items::item;
use crate::app::State;
use crate::app::command::Command;
use crate::app::presets::built_in;
use egui::{Align2, Button, Key, TextEdit, Ui, Window};

/// Built-in presets, the user's presets, and actions on the present settings.
pub(super) fn presets_menu(ui: &mut Ui, state: &mut State) {
    ui.set_min_width(180.0);
    for (name, what, style) in built_in() {
        let is_present = state.style.drawn_as(&style) == state.style;
        let button = ui.add(Button::selectable(is_present, name));
        if button.on_hover_text(what).clicked() {
            state.give_or_tell(Command::BUILT_IN_PRESET, name);
            ui.close();
        }
    }
    ui.separator();
    let presets = state.stored.presets.list().to_vec();
    for preset in &presets {
        let is_present = state.style == preset.settings;
        let button = ui.add(Button::selectable(is_present, preset.name.as_str()));
        let what = "All settings as they were when this was saved";
        if button.on_hover_text(what).clicked() {
            state.give_or_tell(Command::PRESET, &preset.name);
            ui.close();
        }
    }
    item(ui, state, Command::SAVE_PRESET);
    ui.add_enabled_ui(!presets.is_empty(), |ui| {
        ui.menu_button("Delete", |ui| {
            for preset in &presets {
                if ui.button(format!("Delete {}", preset.name)).clicked() {
                    state.give_or_tell(Command::DELETE_PRESET, &preset.name);
                    ui.close();
                }
            }
        });
    });
}

/// Asks for the name of a new preset: Enter keeps it, Esc or a click elsewhere leaves it.
pub(super) fn preset_name_ui(ui: &mut Ui, state: &mut State) {
    let Some(name) = &mut state.stored.preset_name else {
        return;
    };
    let mut has_lost_focus = false;
    Window::new("Save settings")
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .show(ui.ctx(), |ui| {
            let edit = TextEdit::singleline(name).hint_text("Name").desired_width(240.0);
            let edit = ui.add(edit);
            let label = "Name of the preset";
            ui.ctx().accesskit_node_builder(edit.id, |node| node.set_label(label));
            has_lost_focus = edit.lost_focus();
            if !has_lost_focus && !edit.has_focus() {
                edit.request_focus();
            }
            edit.on_hover_text("Enter keeps the settings under this name, Esc does not");
        });
    if !has_lost_focus {
        return;
    }
    let is_wanted = ui.input(|input| input.key_pressed(Key::Enter));
    if let Some(name) = state.stored.preset_name.take().filter(|_| is_wanted)
        && let Err(problem) = state.stored.presets.save(&name, state.style)
    {
        state.notices.warn(problem);
    }
}
