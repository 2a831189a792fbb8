//! Format of the output, its estimate, and its location.

use super::choices::{PrecisionKind, Save, SaveFormat};
use super::plan::Savable;
use super::summary::{lines, merge_price, warning};
use crate::app::open_panels::PanelId;
use crate::app::widgets::rows::{choice, row, rows};
use crate::app::widgets::settle::settle;
use crate::app::widgets::tool_window::tool_window;
use crate::convert::Place;
use crate::io::WriteFormat;
use crate::messages::grouped;
use crate::reel::Coding;
use egui::{Align2, Button, Checkbox, DragValue, Grid, Label, Pos2, RichText, Slider, TextEdit, Ui, vec2};

/// Width of the fields for folder and name, points.
const FIELD_WIDTH: f32 = 300.0;

/// Width of the window's contents, points: numbers that come and go below do not move it.
const WIDTH: f32 = 470.0;

/// Width of the names of numbers in it.
const VALUE_INDENT: f32 = 110.0;

/// Colour errors that are offered; others are for the command line.
const MAX_COLOR_ERROR: u8 = 32;

/// Request of the panel to the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum SaveRequest {
    /// Choose folder and name with a dialog.
    ChoosePlace,
    /// Compare the result of writing with the open sequence.
    Compare,
    /// Begin.
    Start,
}

/// The window while it is open, below `top`.
pub(in crate::app) fn save_ui(
    ui: &mut Ui,
    is_open: &mut bool,
    save: &mut Save,
    of: &Savable,
    top: Pos2,
) -> Option<SaveRequest> {
    let mut request = None;
    let shown = tool_window(ui.ctx(), PanelId::SAVE.name(), "Save as")
        .open(is_open)
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_TOP)
        .default_pos(top + vec2(0.0, 40.0))
        .show(ui, |ui| {
            ui.set_width(WIDTH);
            rows(ui, "save", |ui| {
                format(ui, save);
                if save.format == SaveFormat::Reel {
                    precision(ui, save, of);
                    merging(ui, save, of);
                    attributes(ui, save, of);
                }
                row(
                    ui,
                    "Frames",
                    "Only the frames between in and out point, which the timeline shows; all of them otherwise",
                    Checkbox::new(&mut save.is_of_range, "From in to out point"),
                );
                if of.clip.is_some() {
                    row(
                        ui,
                        "Points",
                        "Only the points that the clip leaves in the image, with the faces between them; all of them \
                            otherwise",
                        Checkbox::new(&mut save.crops, "As clipped"),
                    );
                }
                request = place(ui, save, of);
            });
            ui.separator();
            // Above the numbers, which come and go and may have to be scrolled to.
            request = start(ui, save, of).or(request);
            ui.separator();
            request = numbers(ui, save, of).or(request);
        });
    settle(ui, "Save as", shown);
    request
}

fn format(ui: &mut Ui, save: &mut Save) {
    let hint = "One file for the whole sequence: small, plays at once, and can be watched over the web";
    let names: Vec<String> = WriteFormat::all().map(|format| format!("Files: {format}")).collect();
    let mut choices = vec![("Sequence file (.reel)", SaveFormat::Reel, hint)];
    let files = WriteFormat::all().zip(&names);
    choices.extend(files.map(|(format, name)| {
        let hint = "A folder with one file per frame, for other programs";
        (name.as_str(), SaveFormat::Files(format), hint)
    }));
    let before = save.format;
    choice(ui, "Format", "File format of the frames", &mut save.format, &choices);
    if save.format != before {
        save.found = None;
    }
}

fn precision(ui: &mut Ui, save: &mut Save, of: &Savable) {
    let mut precision = save.precision.merged(false);
    choice(
        ui,
        "Positions",
        "How precisely positions are kept",
        &mut precision,
        &[
            (
                "Point spacing",
                PrecisionKind::PointSpacing,
                "Every point, within an eighth of the distance between the points around it",
            ),
            (
                "Bits",
                PrecisionKind::Bits,
                "Grid cells, bits along the longest side; points in one cell are merged",
            ),
            (
                "Length",
                PrecisionKind::Length,
                "Every point, and no coordinate off by more than a length",
            ),
            (
                "File size",
                PrecisionKind::FileSize,
                "Every point, as precisely as a file of a size allows, by a few frames",
            ),
            (
                "Mean error",
                PrecisionKind::RmsError,
                "Every point, with a root mean square error, by a few frames",
            ),
            (
                "Lossless",
                PrecisionKind::Lossless,
                "Every point, and every bit of its coordinates",
            ),
        ],
    );
    if precision != save.precision.merged(false) {
        save.choose_precision(precision);
    }
    match save.precision {
        PrecisionKind::Bits => {
            let tooltip = "The longest side of the cloud has 2 to the power of this many cells";
            row(ui, "Bits", tooltip, Slider::new(&mut save.bits, 4..=21));
        }
        PrecisionKind::FileSize => {
            let speed = (save.size_mb * 0.02).max(1e-6);
            let drag = DragValue::new(&mut save.size_mb)
                .speed(speed)
                .max_decimals(6)
                .suffix(" MB");
            let tooltip = "The largest size of the file, in millions of bytes";
            row(ui, "Size", tooltip, drag.range(1e-6..=1e9));
        }
        PrecisionKind::Length => {
            let tooltip = "The largest error of a coordinate, in the unit of the files";
            length(ui, save, of, "Length", tooltip);
        }
        PrecisionKind::RmsError => {
            let tooltip = "The root mean square distance of points from their originals, in the unit of the files";
            length(ui, save, of, "Error", tooltip);
        }
        PrecisionKind::PointSpacing | PrecisionKind::SamplingDensity | PrecisionKind::Lossless => {}
    }
}

fn length(ui: &mut Ui, save: &mut Save, of: &Savable, name: &str, tooltip: &str) {
    let speed = (save.length * 0.02).max(1e-12);
    let drag = DragValue::new(&mut save.length)
        .speed(speed)
        .max_decimals(9)
        .suffix(format!(" {}", of.unit));
    row(ui, name, tooltip, drag.range(1e-12..=1e12));
}

/// Shows the merging option for points, where that is a separate choice, with its cost and savings.
fn merging(ui: &mut Ui, save: &mut Save, of: &Savable) {
    let mut merges = save.precision == PrecisionKind::SamplingDensity;
    if !merges && save.precision != PrecisionKind::PointSpacing {
        return;
    }
    let before = merges;
    row(
        ui,
        "Merging",
        "The points in a cell about as large as points are far apart become one point: fewer points and a smaller file",
        Checkbox::new(&mut merges, "Points in one cell become one"),
    );
    if merges != before {
        save.choose_precision(save.precision.merged(merges));
    }
    let estimate = save.estimates.estimate().filter(|(_, is_old)| !is_old);
    let price = estimate.and_then(|(estimate, _)| merge_price(&estimate, before, save.frames(of).count()));
    ui.label("");
    ui.scope(|ui| {
        ui.set_max_width(WIDTH - VALUE_INDENT);
        let text = price.unwrap_or_else(|| "Estimating size and error…".to_owned());
        ui.add(Label::new(RichText::new(text).weak()).wrap());
    });
    ui.end_row();
}

fn attributes(ui: &mut Ui, save: &mut Save, of: &Savable) {
    let keeps_points = save.precision.keeps_points();
    let tooltip = "Time against bits";
    let codings = [
        ("Compact", Coding::Compact, "As few bits as there can be"),
        (
            "Fast",
            Coding::Fast,
            "For weak machines: decoded six times as fast or more, at 1.1 to 1.5 times the bits",
        ),
    ];
    choice(ui, "Coding", tooltip, &mut save.coding, &codings);
    let can_estimate = !of.has_normals && of.samples_surface && save.precision == PrecisionKind::SamplingDensity;
    if can_estimate {
        row(
            ui,
            "Missing normals",
            "Normals of the surface, which the files have not: those of merged points are worse",
            Checkbox::new(&mut save.estimates_normals, "Estimated"),
        );
    }
    if of.has_normals || can_estimate && save.estimates_normals {
        let mut choices = vec![
            ("13 bits", 13, "Off by at most 2.5°"),
            ("15 bits", 15, "Off by at most 1.3°"),
            ("17 bits", 17, "Off by at most 0.7°"),
        ];
        if keeps_points {
            choices.push(("As they are", 0, "The numbers of the file"));
        }
        choice(ui, "Normals", "Bits of a normal", &mut save.normal_bits, &choices);
    }
    if of.has_colors {
        row(
            ui,
            "Colour error",
            "Maximum error per colour channel (0–255); 0 is lossless",
            Slider::new(&mut save.color_error, 0..=MAX_COLOR_ERROR).clamping(egui::SliderClamping::Edits),
        );
    }
    if keeps_points {
        row(
            ui,
            "Order",
            "Points stay in the order of the file, as trails and changes from frame to frame need it",
            Checkbox::new(&mut save.keeps_order, "Kept"),
        );
    }
}

fn place(ui: &mut Ui, save: &mut Save, of: &Savable) -> Option<SaveRequest> {
    let mut request = None;
    let tooltip = "Output folder";
    let label = ui.label("Folder").on_hover_text(tooltip);
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut save.folder).desired_width(FIELD_WIDTH);
        ui.add(field).labelled_by(label.id).on_hover_text(tooltip);
        let browse = ui.button("Browse…");
        if browse.on_hover_text("Chooses folder and name with a dialog").clicked() {
            request = Some(SaveRequest::ChoosePlace);
        }
    });
    ui.end_row();
    let tooltip = match save.format {
        SaveFormat::Reel => "The name of the file",
        SaveFormat::Files(_) => "The name of the folder, which is made",
    };
    let label = ui.label("Name").on_hover_text(tooltip);
    ui.horizontal(|ui| {
        let mut name = save.file_stem(&of.stem);
        let field = TextEdit::singleline(&mut name).desired_width(FIELD_WIDTH);
        let field = ui.add(field).labelled_by(label.id);
        if field.on_hover_text(tooltip).changed() {
            save.name = Some(name);
        }
        ui.weak(save.suffix());
    });
    ui.end_row();
    request
}

/// Sizes and errors, before anything is written.
fn numbers(ui: &mut Ui, save: &Save, of: &Savable) -> Option<SaveRequest> {
    let estimates = &save.estimates;
    let frames = save.frames(of).count();
    let estimate = estimates.estimate();
    let judged = estimate
        .as_ref()
        .map_or(0, |(estimate, is_old)| if *is_old { 0 } else { estimate.frames });
    let heading = match (judged, estimates.is_busy()) {
        (0, true) => "Estimate: encoding the shown frame…".to_owned(),
        (0, false) => "Estimate".to_owned(),
        (1, true) => "Estimate by the shown frame, others follow…".to_owned(),
        (1, false) => format!("Estimate by 1 frame of {}", grouped(frames)),
        (judged, true) => format!("Estimate by {judged} frames of {}, others follow…", grouped(frames)),
        (judged, false) => format!("Estimate by {judged} frames of {}", grouped(frames)),
    };
    let mut request = None;
    ui.horizontal(|ui| {
        ui.label(RichText::new(heading).strong());
        // The precision of a goal is known once it is saved, and what is compared is not cropped.
        let is_comparable = save.goal().is_none() && save.edit(of).crop.is_none();
        if save.format == SaveFormat::Reel && of.sequence.is_some() && is_comparable {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let compare = ui.button("Compare");
                let tooltip = "Shows the result next to the open sequence, in the same view";
                if compare.on_hover_text(tooltip).clicked() {
                    request = Some(SaveRequest::Compare);
                }
            });
        }
    });
    if let Some(problem) = estimates.problem() {
        let text = format!("A frame could not be evaluated: {problem}");
        ui.add(Label::new(RichText::new(text).color(ui.visuals().warn_fg_color)).wrap());
    }
    let Some((estimate, is_old)) = estimate else {
        return request;
    };
    // Estimates for the previous choices are shown in a weak colour.
    let text = |ui: &Ui, text: String| {
        let text = RichText::new(text);
        if is_old {
            text.weak()
        } else {
            text.color(ui.visuals().text_color())
        }
    };
    Grid::new("estimate")
        .num_columns(2)
        .min_col_width(96.0)
        .spacing([10.0, 4.0])
        .show(ui, |ui| {
            for (what, value, tooltip) in lines(&estimate, frames, estimates.source_bytes(), of) {
                let value = text(ui, value);
                ui.weak(what).on_hover_text(tooltip);
                ui.scope(|ui| {
                    ui.set_max_width(WIDTH - VALUE_INDENT);
                    ui.add(Label::new(value).wrap()).on_hover_text(tooltip);
                });
                ui.end_row();
            }
        });
    let name = save.target(1.0).name();
    let losses = estimate.losses.lines(&name, estimate.frames).into_iter();
    for text in warning(&estimate).into_iter().chain(losses).filter(|_| !is_old) {
        ui.add(Label::new(RichText::new(text).color(ui.visuals().warn_fg_color)).wrap());
    }
    request
}

fn start(ui: &mut Ui, save: &mut Save, of: &Savable) -> Option<SaveRequest> {
    let problem = save.problem(of);
    let mut word = "Save";
    if let Some(problem) = &problem {
        ui.label(RichText::new(problem).color(ui.visuals().error_fg_color));
    } else {
        match save.place(of) {
            Place::Taken => {
                word = "Replace";
                let text = "A file of this name exists: it is replaced";
                ui.label(RichText::new(text).color(ui.visuals().warn_fg_color));
            }
            Place::Interrupted => {
                word = "Go on";
                ui.weak("A part of it is there: it goes on from that, unless frames have changed since");
            }
            _ => {
                ui.weak("Saves in the background; can be cancelled and resumed");
            }
        }
    }
    let button = ui.add_enabled(problem.is_none(), Button::new(word));
    let tooltip = "Starts the export with the current settings, in the background";
    button.on_hover_text(tooltip).clicked().then_some(SaveRequest::Start)
}
