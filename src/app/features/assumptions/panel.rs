//! The chip with the number of assumptions, and their list.

use super::change::{Change, Field};
use super::groups::{Alternative, Group, Line};
use crate::app::open_panels::PanelId;
use crate::app::theme::ODD;
use crate::app::widgets::names::named;
use crate::app::widgets::tool_window::tool_window;
use crate::assumption::Evidence;
use crate::messages::counted;
use egui::style::ScrollStyle;
use egui::{Align2, Button, Id, Key, Label, Pos2, RichText, ScrollArea, TextEdit, Ui, vec2};

/// The name of the window among panels.
pub(in crate::app) const PANEL: PanelId = PanelId::new("assumptions");

/// Width of the chip, points.
pub(in crate::app) const CHIP_WIDTH: f32 = 120.0;

/// Width of the list at first, points.
const WIDTH: f32 = 380.0;

/// Its height, points.
const HEIGHT: f32 = 700.0;

/// Width of a field, points.
const FIELD_WIDTH: f32 = 150.0;

/// Computes the evidence shown by the chip: the urgency of its call for attention.
fn evidence_of_chip(groups: &[Group]) -> Option<Evidence> {
    groups.iter().filter_map(Group::weakest).max()
}

/// The chip; true if it is clicked. Emphasised where something was guessed, and coloured where nothing speaks for it.
pub(in crate::app) fn chip_ui(ui: &mut Ui, groups: &[Group], is_open: bool) -> bool {
    let count = groups.iter().map(|group| group.lines.len()).sum::<usize>();
    let text = RichText::new(counted(count as i64, "assumption")).small();
    let (text, hint) = match evidence_of_chip(groups) {
        Some(Evidence::Fallback) => (
            text.strong().color(ODD),
            "Some settings were guessed without evidence: see the list",
        ),
        Some(Evidence::Statistics) => (
            text.strong(),
            "Some settings were estimated from the data: see the list",
        ),
        _ => (
            text,
            "Decisions that were made in your place: the files or their format say so",
        ),
    };
    let chip = Button::new(text).selected(is_open).corner_radius(9.0).frame(true);
    ui.add(chip).on_hover_text(hint).clicked()
}

/// The list while it is open, at `corner`. Returns the alternatives that were chosen.
pub(in crate::app) fn assumptions_ui(ui: &mut Ui, is_open: &mut bool, groups: &[Group], corner: Pos2) -> Vec<Change> {
    let mut changes = Vec::new();
    tool_window(ui.ctx(), PANEL.name(), "Assumptions")
        .open(is_open)
        .default_size(vec2(WIDTH, HEIGHT))
        .pivot(Align2::RIGHT_TOP)
        .default_pos(corner + vec2(-12.0, 12.0))
        .show(ui, |ui| {
            if groups.is_empty() {
                ui.weak("Nothing was assumed about the open sequence.");
                return;
            }
            ui.weak("Decided in your place. A choice is remembered for these inputs.");
            let resets: Vec<Change> = groups.iter().filter_map(|group| group.reset.clone()).collect();
            // A list cut off without a visible scroll bar looks complete.
            ui.spacing_mut().scroll = ScrollStyle::solid();
            ScrollArea::vertical().id_salt("list of assumptions").show(ui, |ui| {
                for group in groups {
                    ui.separator();
                    changes.extend(group_ui(ui, group));
                }
                if resets.len() > 1 {
                    ui.separator();
                    let tooltip = "Takes back every choice of this list";
                    if ui.button("All automatic").on_hover_text(tooltip).clicked() {
                        changes = resets;
                    }
                }
            });
        });
    changes
}

fn group_ui(ui: &mut Ui, group: &Group) -> Option<Change> {
    let mut change = None;
    let title = group.subject.title();
    for line in &group.lines {
        line_ui(ui, title, line);
    }
    if !group.alternatives.is_empty() {
        ui.horizontal_wrapped(|ui| {
            for alternative in &group.alternatives {
                if alternative_ui(ui, title, alternative) {
                    change = Some(alternative.change.clone());
                }
            }
        });
    }
    if let Some(field) = &group.field {
        change = field_ui(ui, title, field).or(change);
    }
    ui.horizontal(|ui| {
        if let Some(reset) = &group.reset {
            let button = ui.small_button("Reset").on_hover_text("Back to the automatic choice");
            named(&button, format!("Reset {title}"));
            if button.clicked() {
                change = Some(reset.clone());
            }
        }
        if let Some(option) = group.option {
            ui.weak(format!("Command line: {option}"));
        }
    });
    change
}

fn line_ui(ui: &mut Ui, title: &str, line: &Line) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(format!("{title}:")).strong());
        ui.add(Label::new(&line.value).wrap());
    });
    let evidence = match line.evidence {
        Some(evidence) => in_words(evidence),
        None => "chosen by you",
    };
    let text = match line.why.as_str() {
        "" => evidence.to_owned(),
        why => format!("{why} ({evidence})"),
    };
    let text = RichText::new(text);
    let text = match line.evidence {
        Some(Evidence::Fallback) => text.color(ODD),
        _ => text.weak(),
    };
    ui.add(Label::new(text).wrap());
}

/// Evidence in plain words.
fn in_words(evidence: Evidence) -> &'static str {
    match evidence {
        Evidence::File => "the file says so",
        Evidence::Convention => "convention of the format",
        Evidence::Statistics => "statistics of the data",
        Evidence::Fallback => "fallback: nothing says it",
    }
}

/// True if it is chosen now.
fn alternative_ui(ui: &mut Ui, title: &str, alternative: &Alternative) -> bool {
    let button = Button::selectable(alternative.is_current, &alternative.label);
    let button = ui
        .add_enabled(alternative.lack.is_none(), button)
        .on_hover_text(&alternative.hint)
        .on_disabled_hover_text(alternative.lack.as_deref().unwrap_or_default());
    named(&button, format!("{title}: {}", alternative.label));
    button.clicked() && !alternative.is_current
}

/// A field for any other value, taken by Enter or its button.
fn field_ui(ui: &mut Ui, title: &str, field: &Field) -> Option<Change> {
    let id = Id::unique(("assumption field", title));
    let mut text = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_default();
    let mut change = None;
    ui.horizontal(|ui| {
        let edit = TextEdit::singleline(&mut text)
            .hint_text(field.hint)
            .desired_width(FIELD_WIDTH);
        let edit = ui.add(edit);
        named(&edit, format!("{title}: {}", field.hint));
        let is_entered = edit.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let button = ui.add_enabled(!text.trim().is_empty(), Button::new("Apply"));
        named(&button, format!("Apply {title}"));
        if (button.clicked() || is_entered) && !text.trim().is_empty() {
            change = (field.parse)(&text).ok();
        }
    });
    if let Err(expected) = (field.parse)(&text)
        && !text.trim().is_empty()
    {
        ui.colored_label(ui.visuals().warn_fg_color, expected);
    }
    if change.is_some() {
        text.clear();
    }
    ui.data_mut(|data| data.insert_temp(id, text));
    change.map(Change::Read)
}
