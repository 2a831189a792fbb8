//! Rows of choices: a label, a control named by it, and a tooltip on both.

use super::sought;
use egui::{Button, ComboBox, Grid, Label, RichText, Ui, Widget};

/// Longer lists of choices scroll, points.
const LIST_HEIGHT: f32 = 420.0;

pub(in crate::app) fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(4.0);
    heading_of_list(ui, text);
    ui.add_space(2.0);
}

/// Above lines of text, which are closer together than controls.
pub(in crate::app) fn heading_of_list(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    sought::meet(&ui.label(RichText::new(text).strong().size(14.5)), text);
}

pub(in crate::app) fn rows(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    Grid::new(id)
        .num_columns(2)
        .min_col_width(96.0)
        .spacing([10.0, 7.0])
        .show(ui, add);
}

/// A label and a control named by it, both with the tooltip.
pub(in crate::app) fn row(ui: &mut Ui, name: &str, tooltip: &str, control: impl Widget) {
    let label = ui.label(name).on_hover_text(tooltip);
    sought::meet(&label, name);
    ui.add(control).labelled_by(label.id).on_hover_text(tooltip);
    ui.end_row();
}

/// A label and a list to choose from.
pub(in crate::app) fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    value: &mut T,
    choices: &[(&str, T, &str)],
) {
    choice_among(ui, name, tooltip, value, choices, |_| None);
}

/// Shows a [`choice`] with some entries disabled; `lack_of` gives the reason.
pub(in crate::app) fn choice_among<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    value: &mut T,
    choices: &[(&str, T, &str)],
    lack_of: impl Fn(&T) -> Option<&'static str>,
) {
    let label = ui.label(name).on_hover_text(tooltip);
    sought::meet(&label, name);
    let selected = choices
        .iter()
        .find(|(_, choice, _)| choice == value)
        .map_or("Custom", |(text, _, _)| text);
    ComboBox::from_id_salt(name)
        .height(LIST_HEIGHT)
        .selected_text(selected)
        .show_ui(ui, |ui| {
            for (text, choice, hint) in choices {
                let lack = lack_of(choice);
                let button = Button::selectable(value == choice, *text);
                let added = ui.add_enabled(lack.is_none(), button).on_hover_text(*hint);
                if added.on_disabled_hover_text(lack.unwrap_or_default()).clicked() {
                    *value = *choice;
                }
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text(tooltip);
    ui.end_row();
}

/// Shows a note below a choice of a grid, whose cells are as wide as their content.
pub(in crate::app) fn note_below(ui: &mut Ui, text: &str) {
    const WIDTH: f32 = 190.0;
    ui.label("");
    ui.scope(|ui| {
        ui.set_max_width(WIDTH);
        ui.add(Label::new(RichText::new(text).weak()).wrap());
    });
    ui.end_row();
}
