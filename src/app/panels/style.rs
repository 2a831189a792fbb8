//! Controls of settings, made of their descriptions.

use crate::app::widgets::rows::{choice, heading, row, rows};
use crate::scene::describe::{Described, Kind, Numbers, Section, Unit, Value, Values, Words};
use crate::scene::{Background, Environment, Settings, Style};
use egui::{Checkbox, Slider, Ui};

/// A section of the panel with its heading, if one of its settings has an effect on the style `drawn`, in which
/// automatic settings are resolved.
pub(super) fn section_ui(ui: &mut Ui, style: &mut Settings, drawn: &Style, title: &str, section: Section) {
    let is_in_it = |described: &Described| described.section == section && (described.when)(drawn);
    if (style.settings().iter()).any(|(described, _)| is_in_it(described)) {
        heading(ui, title);
        rows(ui, title, |ui| section_rows(ui, style, drawn, section));
    }
}

/// The settings of a section that have an effect on the style `drawn`.
pub(super) fn section_rows(ui: &mut Ui, style: &mut Settings, drawn: &Style, section: Section) {
    style.edit(&mut |described, value| {
        if described.section == section && (described.when)(drawn) {
            setting(ui, described, value)
        } else {
            value
        }
    });
}

/// A list of words to choose from.
pub(super) fn word<T: Copy + PartialEq>(ui: &mut Ui, title: &str, hint: &str, value: &mut T, all: &[T], words: &Words) {
    let choices: Vec<_> = all
        .iter()
        .zip(words.list)
        .map(|(&value, word)| (word.title, value, word.hint))
        .collect();
    choice(ui, title, hint, value, &choices);
}

/// The row of a setting; returns its new value.
fn setting(ui: &mut Ui, described: &Described, value: Value) -> Value {
    match (&described.values, value) {
        (Values::Words(words), Value::Word(mut place)) => {
            let places: Vec<usize> = (0..words.list.len()).collect();
            word(ui, described.title, described.hint, &mut place, &places, words);
            Value::Word(place)
        }
        (Values::Number(numbers), Value::Number(number)) => {
            Value::Number(number_row(ui, described.title, described.hint, numbers, number))
        }
        (Values::Switch(text), Value::Switch(mut is_on)) => {
            let control = Checkbox::new(&mut is_on, *text);
            row(ui, described.title, described.hint, control);
            Value::Switch(is_on)
        }
        (Values::Kinds(kinds), Value::Kind(place, number)) => kind_rows(ui, described, kinds, place, number),
        (Values::Background, Value::Background(mut background)) => {
            background_rows(ui, described, &mut background);
            Value::Background(background)
        }
        (Values::Environment, Value::Environment(mut environment)) => {
            environment_row(ui, described, &mut environment);
            Value::Environment(environment)
        }
        // Colours have their own section.
        _ => value,
    }
}

fn number_row(ui: &mut Ui, title: &str, hint: &str, numbers: &Numbers, number: f64) -> f64 {
    let mut shown = match numbers.unit {
        Unit::Percent => f64::from(number as f32 * 100.0),
        Unit::Is(_) | Unit::Share => number,
    };
    row(ui, title, hint, slider(numbers, &mut shown));
    match numbers.unit {
        // Whole tenths only: every other value would rebuild the octrees of all frames.
        Unit::Percent => f64::from((shown as f32 * 10.0).round() / 1000.0),
        Unit::Is(_) | Unit::Share => shown,
    }
}

fn slider<'a>(numbers: &'a Numbers, shown: &'a mut f64) -> Slider<'a> {
    let factor = match numbers.unit {
        Unit::Percent => 100.0,
        Unit::Is(_) | Unit::Share => 1.0,
    };
    let [min, max] = numbers.offered.map(|end| f64::from(end * factor));
    let slider = Slider::new(shown, min..=max).logarithmic(numbers.is_logarithmic);
    match numbers.unit {
        _ if !numbers.zero.is_empty() => {
            let slider = if numbers.are_whole() {
                slider.integer()
            } else {
                slider.max_decimals(numbers.decimals)
            };
            slider
                .custom_formatter(|number, decimals| match number {
                    0.0 => numbers.zero.to_owned(),
                    _ => format!("{number:.*}", decimals.end()),
                })
                .custom_parser(|text| {
                    if numbers.is_zero_word(text.trim()) {
                        Some(0.0)
                    } else {
                        text.trim().parse().ok()
                    }
                })
        }
        _ if numbers.are_whole() => slider.integer(),
        Unit::Is(suffix) => slider.max_decimals(numbers.decimals).suffix(suffix),
        Unit::Percent => slider.max_decimals(numbers.decimals).suffix(" %"),
        Unit::Share => slider
            .step_by(0.05)
            .custom_formatter(|share, _| format!("{:.0} %", share * 100.0))
            .custom_parser(|text| {
                let percent: f64 = text.trim_end_matches('%').trim().parse().ok()?;
                Some(percent / 100.0)
            }),
    }
}

/// Shows the list of kinds, and below it the number of the one that is chosen. A newly chosen kind has its default
/// number.
fn kind_rows(ui: &mut Ui, described: &Described, kinds: &[Kind], before: usize, number: f64) -> Value {
    let choices: Vec<_> = kinds
        .iter()
        .enumerate()
        .map(|(place, kind)| (kind.title, place, kind.hint))
        .collect();
    let mut place = before;
    choice(ui, described.title, described.hint, &mut place, &choices);
    let Some(told) = &kinds[place].number else {
        return Value::Kind(place, 0.0);
    };
    let number = if place == before { number } else { told.usual };
    let number = number_row(ui, told.title, told.hint, &told.numbers, number);
    Value::Kind(place, number)
}

/// The list of environments, with the file that is chosen, if one is.
fn environment_row(ui: &mut Ui, described: &Described, environment: &mut Environment) {
    let name = match environment {
        Environment::File(file) => file.path().file_name().map(|name| name.to_string_lossy().into_owned()),
        _ => None,
    };
    let built_in = Environment::BUILT_IN.iter();
    let mut choices: Vec<_> = built_in.map(|word| (word.title, word.environment, word.hint)).collect();
    choices.extend(name.as_deref().map(|name| (name, *environment, "Custom image")));
    choice(ui, described.title, described.hint, environment, &choices);
}

fn background_rows(ui: &mut Ui, described: &Described, background: &mut Background) {
    let presets: Vec<_> = Background::PRESETS
        .iter()
        .map(|&(_, title, preset)| (title, preset, "A background to begin with"))
        .collect();
    choice(ui, described.title, described.hint, background, &presets);
    for (name, tooltip, color) in [
        (
            "Top colour",
            "Colour at the upper edge of the view",
            &mut background.top,
        ),
        (
            "Bottom colour",
            "Colour at the lower edge of the view",
            &mut background.bottom,
        ),
    ] {
        let label = ui.label(name).on_hover_text(tooltip);
        ui.color_edit_button_srgb(color)
            .labelled_by(label.id)
            .on_hover_text(tooltip);
        ui.end_row();
    }
}
