//! Export panel: subject, format and destination.

use super::{Export, ExportSubject, Exportable};
use crate::app::open_panels::PanelId;
use crate::app::widgets::rows::{choice, row, rows};
use crate::app::widgets::settle::settle;
use crate::app::widgets::tool_window::tool_window;
use crate::export::VideoFormat;
use egui::{Align2, Button, Checkbox, ComboBox, DragValue, Pos2, RichText, Slider, TextEdit, Ui, vec2};

/// Image sizes offered in addition to the window's.
const SIZES: [(&str, [u32; 2], &str); 6] = [
    ("1280 × 720", [1280, 720], "HD"),
    ("1920 × 1080", [1920, 1080], "Full HD"),
    ("3840 × 2160", [3840, 2160], "4K"),
    ("1080 × 1080", [1080, 1080], "Square"),
    ("1080 × 1920", [1080, 1920], "Upright"),
    (
        "16384 × 16384",
        [16_384, 16_384],
        "A poster, rendered in tiles: the maximum of videos; images can be larger",
    ),
];

/// Width of the fields for folder and name, points.
const FIELD_WIDTH: f32 = 300.0;

/// Request of the panel to the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum ExportRequest {
    /// Choose folder and name with a dialog.
    ChoosePlace,
    /// Begin.
    Start,
}

/// The window while it is open, below `top`.
pub(in crate::app) fn export_ui(
    ui: &mut Ui,
    is_open: &mut bool,
    export: &mut Export,
    of: &Exportable,
    top: Pos2,
) -> Option<ExportRequest> {
    let mut request = None;
    // Choices come and go below: those above do not move.
    let shown = tool_window(ui.ctx(), PanelId::EXPORT.name(), "Export")
        .open(is_open)
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::CENTER_TOP)
        .default_pos(top + vec2(0.0, 60.0))
        .show(ui, |ui| {
            rows(ui, "export", |ui| {
                subject(ui, export, of);
                size(ui, export, of);
                if export.subject == ExportSubject::Turntable {
                    turntable(ui, export);
                }
                if export.subject != ExportSubject::Picture {
                    video(ui, export);
                }
                background(ui, export);
                row(
                    ui,
                    "Legend",
                    "Draws the colour legend over the images, where colours show numbers or classes",
                    Checkbox::new(&mut export.has_legend, "Drawn"),
                );
                row(
                    ui,
                    "Scale bar",
                    "Draws a scale bar at the lower left; in perspective it is exact at the distance of the \
                        orbit's centre",
                    Checkbox::new(&mut export.has_scale_bar, "Drawn"),
                );
                request = place(ui, export, of);
            });
            ui.separator();
            request = start(ui, export, of).or(request);
        });
    settle(ui, "Export", shown);
    request
}

fn subject(ui: &mut Ui, export: &mut Export, of: &Exportable) {
    let mut subject = export.subject;
    choice(
        ui,
        "What",
        "Content of the image or the video, rendered as on screen",
        &mut subject,
        &[
            ("Image", ExportSubject::Picture, "The current view, in any size"),
            (
                "Turntable",
                ExportSubject::Turntable,
                "The camera orbits about the up axis, from its current position",
            ),
            (
                "Camera path",
                ExportSubject::Path,
                "The camera path from the first keyframe to the last",
            ),
            (
                "Sequence",
                ExportSubject::Sequence,
                "The frames from in to out point, as they play, from the current viewpoint",
            ),
        ],
    );
    if subject != export.subject {
        export.choose(subject, of.clock.as_ref());
    }
}

fn size(ui: &mut Ui, export: &mut Export, of: &Exportable) {
    let mut choices = vec![("As the window", None, "The current size of the view")];
    choices.extend(SIZES.map(|(text, size_px, tooltip)| (text, Some(size_px), tooltip)));
    choice(
        ui,
        "Size",
        "Width and height of the images",
        &mut export.size_px,
        &choices,
    );
    let before = export.drawn_px(of.window_px);
    let mut size_px = before;
    let range = 1..=export.max_edge_px();
    for (name, edge) in ["Width", "Height"].into_iter().zip(&mut size_px) {
        let tooltip = "Pixels; images larger than a texture are rendered in tiles";
        let drag = DragValue::new(edge).range(range.clone()).suffix(" px");
        row(ui, name, tooltip, drag);
    }
    if size_px != before {
        export.size_px = Some(size_px);
    }
}

fn turntable(ui: &mut Ui, export: &mut Export) {
    row(
        ui,
        "Images",
        "Number of images of all revolutions; the last one leads to the first",
        DragValue::new(&mut export.pictures).range(2..=100_000),
    );
    row(
        ui,
        "Revolutions",
        "Revolutions about the up axis; negative in the other direction",
        DragValue::new(&mut export.turns).range(-1000.0..=1000.0).speed(0.02),
    );
    row(
        ui,
        "Frame",
        "Holds the current frame instead of playing the sequence",
        Checkbox::new(&mut export.holds_frame, "Held"),
    );
}

fn video(ui: &mut Ui, export: &mut Export) {
    row(
        ui,
        "Rate",
        "Frames per second (fps); at most 50 in GIF",
        Slider::new(&mut export.per_second, 1.0..=120.0)
            .clamping(egui::SliderClamping::Edits)
            .suffix(" /s"),
    );
    format(ui, export);
}

fn format(ui: &mut Ui, export: &mut Export) {
    let tooltip = "File format of the video";
    let label = ui.label("Format").on_hover_text(tooltip);
    let list = ComboBox::from_id_salt("format")
        .selected_text(format_name(export.format))
        .show_ui(ui, |ui| {
            for (format, what) in [
                (
                    VideoFormat::Mp4,
                    "H.264, for players and slides: small, nearly the same colours",
                ),
                (VideoFormat::Gif, "Runs everywhere; 255 colours per image"),
                (VideoFormat::Webp, "Lossless and transparent, for browsers"),
                (VideoFormat::PngFiles, "One numbered file per image, for other programs"),
            ] {
                let is_there = format != VideoFormat::Mp4 || export.has_ffmpeg;
                let button = Button::selectable(export.format == format, format_name(format));
                let button = ui.add_enabled(is_there, button).on_hover_text(what);
                let button = button.on_disabled_hover_text(
                    "MP4 is encoded by ffmpeg, which is not on the PATH: install it and open this window again",
                );
                if button.clicked() {
                    export.format = format;
                }
            }
        });
    list.response.labelled_by(label.id).on_hover_text(tooltip);
    ui.end_row();
}

fn format_name(format: VideoFormat) -> &'static str {
    match format {
        VideoFormat::PngFiles => "PNG files",
        VideoFormat::Gif => "GIF",
        VideoFormat::Webp => "WebP",
        VideoFormat::Mp4 => "MP4",
    }
}

fn background(ui: &mut Ui, export: &mut Export) {
    let tooltip = "Transparent instead of the background of the settings";
    let label = ui.label("Background").on_hover_text(tooltip);
    let mut has_alpha = export.has_alpha();
    let check = ui.add_enabled(export.can_have_alpha(), Checkbox::new(&mut has_alpha, "Transparent"));
    if check.changed() {
        export.is_transparent = has_alpha;
    }
    check
        .labelled_by(label.id)
        .on_hover_text(tooltip)
        .on_disabled_hover_text(format!(
            "{} has no soft transparency: choose WebP or PNG files",
            format_name(export.format)
        ));
    ui.end_row();
}

fn place(ui: &mut Ui, export: &mut Export, of: &Exportable) -> Option<ExportRequest> {
    let mut request = None;
    let tooltip = "Output folder";
    let label = ui.label("Folder").on_hover_text(tooltip);
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut export.folder).desired_width(FIELD_WIDTH);
        ui.add(field).labelled_by(label.id).on_hover_text(tooltip);
        let browse = ui.button("Browse…");
        if browse.on_hover_text("Chooses folder and name with a dialog").clicked() {
            request = Some(ExportRequest::ChoosePlace);
        }
    });
    ui.end_row();
    let tooltip = "File name; images of a video as PNG files are numbered";
    let label = ui.label("Name").on_hover_text(tooltip);
    ui.horizontal(|ui| {
        let mut name = export.file_stem(&of.stem);
        let field = TextEdit::singleline(&mut name).desired_width(FIELD_WIDTH);
        let field = ui.add(field).labelled_by(label.id);
        if field.on_hover_text(tooltip).changed() {
            export.name = Some(name);
        }
        ui.weak(export.suffix().replace("{frame}", "0000"));
    });
    ui.end_row();
    request
}

fn start(ui: &mut Ui, export: &mut Export, of: &Exportable) -> Option<ExportRequest> {
    let problem = export.problem(of);
    if let Some(problem) = &problem {
        ui.label(RichText::new(problem).color(ui.visuals().error_fg_color));
    } else {
        ui.weak(summary(export, of));
        if export.replaces(of) {
            ui.label(RichText::new("A file of this name exists: it is replaced").color(ui.visuals().warn_fg_color));
        }
    }
    let button = ui.add_enabled(problem.is_none(), Button::new("Export"));
    if button
        .on_hover_text("Starts the export with the current settings, in the background")
        .clicked()
    {
        return Some(ExportRequest::Start);
    }
    None
}

fn summary(export: &Export, of: &Exportable) -> String {
    let [width, height] = export.drawn_px(of.window_px);
    let count = export.picture_count(of);
    let seconds = count as f64 / export.per_second;
    match export.subject {
        ExportSubject::Picture => format!("1 image of {width} × {height}"),
        _ => format!("{count} images of {width} × {height}, {seconds:.1} s"),
    }
}
