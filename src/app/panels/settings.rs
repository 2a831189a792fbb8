//! Every choice about the picture, with its term and unit in a tooltip. Only what the chosen primitive uses is listed.

use super::clip::{ClipContext, clip_ui};
use super::colors::colors_ui;
use super::quality::{QualityRequest, quality_ui};
use super::style::{section_rows, section_ui, word};
use crate::app::features::clipping::ClippedFrames;
use crate::app::features::temporal::panel::poses_ui;
use crate::app::features::thumbnails::panel::thumbnails_ui;
use crate::app::features::trails::panel::field_ui;
pub(super) use crate::app::widgets::rows::{choice, choice_among, heading, note_below, row, rows};
use crate::app::{Clipping, MeasuredQuality, PresentChoice, Temporal, Thumbnails, Trails, Turntable};
use crate::playback::Player;
use crate::scene::describe::{Section, Word};
use crate::scene::{Camera, Primitive, Projection, Style, UpAxis};
use egui::{Button, Checkbox, RichText, ScrollArea, Slider, Ui};
use glam::DVec3;

/// Width of the labels before sliders and of the numbers behind them, points.
const BESIDE_SLIDERS: f32 = 190.0;

/// A narrower slider cannot be dragged well, points.
const LEAST_SLIDER_WIDTH: f32 = 60.0;

/// The parts of the window that settings are about.
pub(super) struct SettingsContext<'a> {
    pub(super) player: Option<&'a Player>,
    pub(super) style: &'a mut Style,
    /// The style with what was guessed in place of what is left open.
    pub(super) drawn: Style,
    /// What was guessed, with the reason: the primitive.
    pub(super) primitive: Option<(Primitive, &'static str)>,
    /// The primitives that the files have not, and what is drawn instead, in words.
    pub(super) lacks: &'a [(Primitive, String)],
    /// Why the up axis was guessed so.
    pub(super) up_why: Option<&'static str>,
    /// The points of the last angle that was measured.
    pub(super) angle: Option<[DVec3; 3]>,
    pub(super) clipping: &'a mut Clipping,
    /// What a clip is put around.
    pub(super) frames: Option<ClippedFrames>,
    pub(super) quality: &'a mut MeasuredQuality,
    pub(super) camera: &'a mut Camera,
    pub(super) turntable: &'a mut Turntable,
    pub(super) present: &'a mut PresentChoice,
    pub(super) has_legend: &'a mut bool,
    pub(super) thumbnails: &'a mut Thumbnails,
    pub(super) trails: &'a mut Trails,
    pub(super) temporal: &'a mut Temporal,
}

/// What settings ask of the window.
pub(super) enum SettingsRequest {
    /// Measure the ways to draw, or draw in one of them.
    Quality(QualityRequest),
    /// Another axis is up.
    ChooseUp(UpAxis),
    /// All settings of the picture as they are at first.
    Reset,
}

/// The panel at the right.
pub(super) fn settings_ui(ui: &mut Ui, context: &mut SettingsContext<'_>) -> Option<SettingsRequest> {
    let mut request = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        // A slider that is as wide as usual would widen the panel, which stays as wide as it ever was.
        let room = ui.available_width() - BESIDE_SLIDERS;
        let spacing = ui.spacing_mut();
        spacing.slider_width = room.clamp(LEAST_SLIDER_WIDTH, spacing.slider_width);
        if context.player.is_some() {
            request = quality_ui(ui, context.quality, context.style).map(SettingsRequest::Quality);
        }
        picture(ui, context);
        let shown = context.player.and_then(Player::shown);
        colors_ui(ui, &mut context.style.colors, shown, context.has_legend);
        let mut clip = ClipContext {
            clip: &mut context.style.of_sequence.clip,
            clipping: context.clipping,
            frames: context.frames,
            angle: context.angle,
        };
        clip_ui(ui, &mut clip);
        heading(ui, "Time");
        thumbnails_ui(ui, context.thumbnails);
        field_ui(ui, context.trails);
        poses_ui(ui, context.temporal);
        for section in [("Shading", Section::Shading), ("Background", Section::Background)] {
            section_ui(ui, context.style, &context.drawn, section);
        }
        heading(ui, "Camera");
        rows(ui, "camera", |ui| {
            if let Some(up) = camera(ui, context) {
                request = Some(SettingsRequest::ChooseUp(up));
            }
        });
        heading(ui, "Window");
        rows(ui, "window", |ui| {
            let texts = (
                "Painted by",
                "Who paints the panels and brings the window onto the screen",
            );
            let (all, words) = (PresentChoice::ALL, PresentChoice::WORDS);
            word(ui, texts, context.present, all, words);
        });
        ui.add_space(12.0);
        if ui
            .button("Reset to defaults")
            .on_hover_text("Every setting of the picture as it is at first; the camera stays")
            .clicked()
        {
            request = Some(SettingsRequest::Reset);
        }
    });
    request
}

/// What is drawn and how, but for colours and light.
fn picture(ui: &mut Ui, context: &mut SettingsContext<'_>) {
    heading(ui, "Picture");
    let SettingsContext { style, drawn, .. } = context;
    primitive(ui, style, context.primitive, context.lacks);
    rows(ui, "picture", |ui| {
        section_rows(ui, style, drawn, Section::Picture);
    });
    section_ui(ui, style, drawn, ("Surfels", Section::Surfels));
    ui.add_enabled_ui(drawn.has_footprints(), |ui| {
        rows(ui, "footprints", |ui| {
            section_rows(ui, style, drawn, Section::Footprints);
        });
    });
    for section in [
        ("Points", Section::Points),
        ("Cubes", Section::Cubes),
        ("Octree", Section::Octree),
        ("Level of detail", Section::LevelOfDetail),
    ] {
        section_ui(ui, style, drawn, section);
    }
}

/// The list of primitives, and of words for some of them with other settings. One that the open files have not cannot
/// be chosen, and tells why.
fn primitive(ui: &mut Ui, style: &mut Style, guessed: Option<(Primitive, &str)>, lacks: &[(Primitive, String)]) {
    let button = |is_chosen, word: &Word| Button::selectable(is_chosen, word.title).min_size(egui::vec2(62.0, 26.0));
    let short = Style::PRIMITIVE.shorthands.iter().find(|short| style.has_all_of(short));
    let lack_of = |primitive| {
        lacks
            .iter()
            .find(|(lacking, _)| *lacking == primitive)
            .map(|(_, lack)| lack)
    };
    ui.horizontal_wrapped(|ui| {
        for (&primitive, word) in Primitive::ALL.iter().zip(Primitive::WORDS.list) {
            let button = button(short.is_none() && style.primitive == primitive, word);
            let lack = lack_of(primitive);
            let added = ui.add_enabled(lack.is_none(), button).on_hover_text(word.hint);
            if added.on_disabled_hover_text(lack.map_or("", String::as_str)).clicked() {
                style.primitive = primitive;
                // What was clicked is what is chosen, not what with other settings has another word.
                Style::PRIMITIVE
                    .shorthands
                    .iter()
                    .for_each(|short| style.take_back(short));
            }
        }
        for shorthand in Style::PRIMITIVE.shorthands {
            let button = button(style.has_all_of(shorthand), &shorthand.word);
            if ui.add(button).on_hover_text(shorthand.word.hint).clicked() {
                style.take(shorthand);
            }
        }
    });
    if let Some(lack) = lack_of(style.primitive) {
        ui.label(RichText::new(lack).weak());
    }
    if let (Primitive::Auto, Some((primitive, why))) = (style.primitive, guessed) {
        let text = format!("Drawn as {primitive}s: {why}");
        ui.label(RichText::new(text).weak());
    }
    ui.add_space(4.0);
}

/// The rows of the camera; the axis that is to be up, where another one is chosen.
fn camera(ui: &mut Ui, context: &mut SettingsContext<'_>) -> Option<UpAxis> {
    let SettingsContext { camera, turntable, .. } = context;
    let axes = UpAxis::ALL.iter().map(|&(name, axis)| {
        let text = match name {
            "y" => "+Y",
            "z" => "+Z",
            "x" => "+X",
            "-y" => "-Y",
            "-z" => "-Z",
            _ => "-X",
        };
        (text, axis, "The axis of the file that points up in the picture")
    });
    let axes: Vec<_> = axes.collect();
    let mut up = camera.up;
    choice(
        ui,
        "Up axis",
        "The axis of the file that points up in the picture, kept for this sequence",
        &mut up,
        &axes,
    );
    if let Some(why) = context.up_why {
        note_below(ui, why);
    }
    let texts = ("Projection", "Whether what is farther away is smaller (O)");
    let (all, words) = (Projection::ALL, Projection::WORDS);
    word(ui, texts, &mut camera.projection, all, words);
    if camera.projection == Projection::Perspective {
        // The slider rounds what it shows: what comes from a path or a text is not its to change.
        let before = camera.fov_deg.round().clamp(5.0, 120.0);
        let mut shown = before;
        let fov = Slider::new(&mut shown, 5.0..=120.0).max_decimals(0).suffix(" °");
        row(
            ui,
            "Field of view",
            "Vertical opening angle of the camera, degrees",
            fov,
        );
        if shown != before {
            camera.set_fov_deg(shown);
        }
    }
    row(
        ui,
        "Turntable",
        "The camera turns about the up axis until the picture is dragged (T)",
        Checkbox::new(&mut turntable.is_on, "Turning"),
    );
    let pace = Slider::new(&mut turntable.deg_per_sec, Turntable::PACES)
        .max_decimals(0)
        .suffix(" °/s");
    row(
        ui,
        "Pace",
        "How fast the turntable turns, degrees a second; negative the other way",
        pace,
    );
    (up != camera.up).then_some(up)
}
