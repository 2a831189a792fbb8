//! Filters of depth images, in the order in which they are applied.

use super::settings::{note_below, row, rows};
use crate::app::settings_row::NamedRow;
use crate::rgbd::{FilterParameter, Filters};
use egui::{Checkbox, DragValue, Id, Ui};

/// Rows that the palette brings into view, while depth images are open.
pub(super) const NAMED: &[NamedRow] = &[NamedRow {
    title: "Depth images",
    text: "Depth images: filters…",
    hint: "Range, median, bilateral and temporal filters of depth images, before they become points",
    also: &[
        "noise",
        "denoise",
        "smooth",
        "depth filter",
        "median filter",
        "bilateral filter",
        "temporal filter",
        "flying pixels",
        "depth range",
    ],
}];

/// Dragging distance that changes whole numbers by one, points of the screen.
const POINTS_PER_ONE: f64 = 20.0;

/// Shows the depth filter section of the settings. Returns the filters to be applied from now on: once dragging or
/// typing has ended, as all frames are then decoded again.
pub(super) fn depth_filters_ui(ui: &mut Ui, applied: Filters) -> Option<Filters> {
    let id = Id::unique("depth filters");
    let before = ui.data(|data| data.get_temp::<(Filters, Filters)>(id));
    let edited = before.filter(|(of, _)| *of == applied).map(|(_, edited)| edited);
    let mut edited = edited.unwrap_or(applied);
    let mut is_being_set = false;
    rows(ui, "depth filters", |ui| {
        for kind in Filters::kinds() {
            let was_on = (kind.is_on)(&edited);
            let mut is_on = was_on;
            row(ui, kind.title, kind.hint, Checkbox::new(&mut is_on, "Applied"));
            if is_on != was_on {
                (kind.set_on)(&mut edited, is_on);
            }
            for parameter in kind.parameters {
                is_being_set |= parameter_row(ui, parameter, &mut edited);
            }
        }
        if !edited.keep_any() {
            note_below(ui, "Nothing is left: the nearest depth has to be below the farthest");
        }
    });
    ui.data_mut(|data| data.insert_temp(id, (applied, edited)));
    (edited != applied && edited.keep_any() && !is_being_set).then_some(edited)
}

/// A number of a filter, if that is applied; returns true while the user edits it.
fn parameter_row(ui: &mut Ui, parameter: &FilterParameter, edited: &mut Filters) -> bool {
    let Some(mut value) = parameter.get(edited) else {
        return false;
    };
    let speed = match parameter.digits {
        0 => POINTS_PER_ONE.recip(),
        digits => 0.1_f64.powi(digits.into()),
    };
    let control = DragValue::new(&mut value)
        .range(parameter.range.clone())
        .speed(speed)
        .max_decimals(parameter.digits.into())
        .suffix(parameter.unit);
    let label = ui.label(parameter.title).on_hover_text(parameter.hint);
    let response = ui.add(control).labelled_by(label.id).on_hover_text(parameter.hint);
    ui.end_row();
    if response.changed() {
        parameter.set(edited, value);
    }
    response.dragged() || response.has_focus()
}
