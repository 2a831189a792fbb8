//! Colour panel: the source, of those available, and the mapping of its numbers to colours.

use super::settings::{choice, choice_among, heading, note_below, row, rows};
use super::style::word;
use crate::analysis::{ColorMap, ColorScale};
use crate::app::color_sources::{fields, lack_of, sources};
use crate::app::settings_row::NamedRow;
use crate::app::widgets::ramp::{handles_ui, ramp_ui};
use crate::cloud::Frame;
use crate::scene::describe::Described;
use crate::scene::{Legend, coloring, field_title};
use crate::sequence::{ColorRange, ColorSource, Coloring, HeightAxis, Paint, PaintValues, PreparedFrame, value_kind};
use egui::{Checkbox, DragValue, Ui};
use std::sync::Arc;

/// Rows that the palette brings into view.
pub(super) const NAMED: &[NamedRow] = &[
    NamedRow {
        title: coloring::COLORS.title,
        text: "Colours…",
        hint: coloring::COLORS.hint,
        also: &["colour by", "colour source", "scalar field", "histogram"],
    },
    NamedRow {
        title: coloring::RANGE.title,
        text: "Colour range and histogram…",
        hint: coloring::RANGE.hint,
        also: &[
            "percentiles",
            "min max",
            "clamp",
            "scale limits",
            "saturation",
            "colour limits",
            "distribution",
        ],
    },
    NamedRow {
        title: coloring::LOGARITHM.title,
        text: "Colour logarithm…",
        hint: coloring::LOGARITHM.hint,
        also: &["log scale", "logarithmic scale"],
    },
];

/// The section of the settings: colours of the `shown` frame, and whether their legend is open.
pub(super) fn colors_ui(
    ui: &mut Ui,
    coloring: &mut Coloring,
    shown: Option<&Arc<PreparedFrame>>,
    has_legend: &mut bool,
) {
    heading(ui, "Colours");
    let before = coloring.source;
    rows(ui, "colours", |ui| {
        source(ui, coloring, shown);
        match coloring.source {
            ColorSource::Height(_) => height_axis(ui, coloring),
            ColorSource::Uniform => one_color(ui, coloring),
            _ => {}
        }
    });
    let source = std::mem::replace(&mut coloring.source, before);
    coloring.choose(source);
    let paint = shown.map(|frame| *frame.paint());
    if let (Some(frame), Some(Paint::Scale { values, scale, .. })) = (shown, paint) {
        rows(ui, "colour map", |ui| map(ui, coloring));
        ramp_ui(ui, coloring.map);
        range(ui, coloring, &frame.frame, &values, &scale);
    }
    if shown.is_some_and(|frame| Legend::of(frame).is_some()) {
        rows(ui, "legend", |ui| {
            row(
                ui,
                "Legend",
                "The colour legend, at the right of the view",
                Checkbox::new(has_legend, "Shown"),
            );
        });
    }
}

fn source(ui: &mut Ui, coloring: &mut Coloring, shown: Option<&Arc<PreparedFrame>>) {
    let frame = shown.map(|shown| &*shown.frame);
    let named = fields(frame);
    let sources = sources(coloring.source, &named);
    let lack_of = |source: &ColorSource| lack_of(*source, frame?);
    let (title, hint) = (coloring::COLORS.title, coloring::COLORS.hint);
    choice_among(ui, title, hint, &mut coloring.source, &sources, lack_of);
    let Some(shown) = shown else { return };
    let found = found(shown.paint());
    if let Some(lack) = lack_of(&coloring.source) {
        note_below(ui, &format!("{lack}. Shown instead: {found}"));
    } else if coloring.source == ColorSource::Auto {
        note_below(ui, &found);
    }
}

/// Returns the source found by the automatic choice.
fn found(paint: &Paint) -> String {
    match paint {
        Paint::File => "From the file".to_owned(),
        Paint::Normal => "Normal".to_owned(),
        Paint::Uniform(_) => "One colour".to_owned(),
        Paint::Classes(name) => field_title(name.as_str()),
        Paint::Scale { values, .. } => match values {
            PaintValues::Field(name) => field_title(name.as_str()),
            PaintValues::Height(_) => "Height".to_owned(),
            PaintValues::Distance(_) => "Distance".to_owned(),
            PaintValues::Change => "Change".to_owned(),
        },
    }
}

fn height_axis(ui: &mut Ui, coloring: &mut Coloring) {
    let mut axes = vec![(
        "As the view",
        ColorSource::Height(HeightAxis::Auto),
        "The axis of the file that points up",
    )];
    let names = [["+X", "+Y", "+Z"], ["-X", "-Y", "-Z"]];
    for (is_down, names) in [false, true].into_iter().zip(names) {
        for (axis, name) in (0..).zip(names) {
            let source = ColorSource::Height(HeightAxis::Axis(axis, is_down));
            axes.push((name, source, "Along this axis of the file"));
        }
    }
    choice(
        ui,
        "Along",
        "The axis along which height grows",
        &mut coloring.source,
        &axes,
    );
}

fn one_color(ui: &mut Ui, coloring: &mut Coloring) {
    let Described { title, hint, .. } = coloring::ONE_COLOR;
    let label = ui.label(title).on_hover_text(hint);
    ui.color_edit_button_srgb(&mut coloring.one_color)
        .labelled_by(label.id)
        .on_hover_text(hint);
    ui.end_row();
}

fn map(ui: &mut Ui, coloring: &mut Coloring) {
    let (title, hint) = (coloring::MAP.title, coloring::MAP.hint);
    word(ui, title, hint, &mut coloring.map, &ColorMap::ALL, coloring::MAPS);
}

/// Kind of range: percentiles or numbers.
#[derive(Clone, Copy, PartialEq)]
enum RangeKind {
    Percentiles,
    Fixed,
}

fn range(ui: &mut Ui, coloring: &mut Coloring, frame: &Frame, values: &PaintValues, scale: &ColorScale) {
    let sample = frame.value_sample();
    let sorted = value_kind(values, sample).map(|(kind, offset)| (sample.sorted(kind), offset));
    if let Some((sorted, offset)) = &sorted
        && let Some(ends) = handles_ui(ui, sorted, *offset, scale, coloring.map)
    {
        let [low, high] = ends;
        coloring.range = ColorRange::Fixed { low, high };
    }
    rows(ui, "colour range", |ui| {
        let is_fixed = matches!(coloring.range, ColorRange::Fixed { .. });
        let before = if is_fixed {
            RangeKind::Fixed
        } else {
            RangeKind::Percentiles
        };
        let mut kind = before;
        choice(
            ui,
            coloring::RANGE.title,
            coloring::RANGE.hint,
            &mut kind,
            &[
                (
                    "Percentiles",
                    RangeKind::Percentiles,
                    "Shares of the values of the first frame: all frames have the same colours",
                ),
                ("Fixed", RangeKind::Fixed, "Numbers of the file"),
            ],
        );
        if kind != before {
            let [low, high] = scale.ends();
            coloring.range = match kind {
                RangeKind::Percentiles => ColorRange::USUAL,
                RangeKind::Fixed => ColorRange::Fixed { low, high },
            };
        }
        ends(ui, &mut coloring.range, scale);
        row(
            ui,
            coloring::LOGARITHM.title,
            coloring::LOGARITHM.hint,
            Checkbox::new(&mut coloring.is_logarithmic, "On"),
        );
    });
}

/// The two numbers of a range, which stay in order.
fn ends(ui: &mut Ui, range: &mut ColorRange, scale: &ColorScale) {
    let [shown_low, shown_high] = scale.ends();
    let (speed, limits, suffix, [low, high]) = match range {
        ColorRange::Percentiles { low, high } => (0.1, 0.0..=100.0, " %", [low, high]),
        ColorRange::Fixed { low, high } => {
            let speed = ((shown_high - shown_low) / 200.0).clamp(1e-12, 1e12);
            (speed, -1e300..=1e300, "", [low, high])
        }
    };
    let (min, max) = (*limits.start(), *limits.end());
    let before = [*low, *high];
    let number = |value, limits| {
        DragValue::new(value)
            .range(limits)
            .speed(speed)
            .suffix(suffix)
            .max_decimals(6)
    };
    row(
        ui,
        "First colour",
        "The value in the first colour, or how many percent of the values are below it",
        number(&mut *low, min..=before[1]),
    );
    row(
        ui,
        "Last colour",
        "The value in the last colour, or how many percent of the values are below it",
        number(&mut *high, before[0]..=max),
    );
}
