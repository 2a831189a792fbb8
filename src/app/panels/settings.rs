//! All settings of the image, with term and unit in a tooltip. Only settings of the chosen primitive are listed.

use super::colors::{self, colors_ui};
use super::depth_filters::{self, depth_filters_ui};
use super::style::{section_rows, section_ui, word};
use crate::app::features::Features;
use crate::app::features::feature::Feature;
use crate::app::settings_row::{NamedRow, SettingsPart};
pub(super) use crate::app::widgets::rows::{choice, choice_among, heading, note_below, row, rows};
use crate::app::widgets::sought;
use crate::app::{PanelId, PresentChoice, State, Turntable};
use crate::playback::Player;
use crate::rgbd::Filters;
use crate::scene::describe::{Section, Word};
use crate::scene::{Camera, Choice, Primitive, Projection, Settings, Style, UpAxis};
use egui::{Button, Checkbox, CollapsingHeader, RichText, ScrollArea, Slider, Ui};

/// Width of the labels before sliders and of the numbers behind them, points.
const SLIDER_MARGIN: f32 = 190.0;

/// Size of the headings of parts, points.
const PART_SIZE: f32 = 16.5;

/// A narrower slider cannot be dragged well, points.
const MIN_SLIDER_WIDTH: f32 = 60.0;

/// Rows of no feature that the palette brings into view; see [`own_rows`].
const NAMED: [NamedRow; 5] = [
    NamedRow {
        title: "Up axis",
        text: "Up axis…",
        hint: "The axis of the file that points up on screen",
        also: &["axes", "orientation", "upside down", "vertical axis", "rotate model"],
    },
    NamedRow {
        title: "Projection",
        text: "Projection…",
        hint: "Perspective or orthographic projection",
        also: &["perspective", "orthographic", "isometric"],
    },
    NamedRow {
        title: "Field of view",
        text: "Field of view…",
        hint: "Vertical opening angle of the camera, degrees",
        also: &["fov", "focal length", "lens"],
    },
    NamedRow {
        title: "Turntable speed",
        text: "Turntable speed…",
        hint: "Speed of the turntable, degrees per second; negative in the other direction",
        also: &["rotation speed", "orbit speed", "spin"],
    },
    NamedRow {
        title: "Painted by",
        text: "Painted by…",
        hint: "The GPU or the CPU paints the window",
        also: &["window backend", "present", "software rendering"],
    },
];

/// Rows of the panel of no feature that the palette brings into view.
pub(in crate::app) fn own_rows() -> impl Iterator<Item = &'static NamedRow> {
    NAMED.iter().chain(colors::NAMED).chain(depth_filters::NAMED)
}

/// Request of the settings to the window, once they are shown.
enum SettingsRequest {
    /// Another axis is up.
    ChooseUp(UpAxis),
    /// Other filters of depth images.
    FilterDepth(Filters),
    /// Reset all settings of the image.
    Reset,
}

/// The panel at the right: settings that are useful for playing scans, and the rest in a section that retains its
/// state.
pub(super) fn settings_ui(ui: &mut Ui, state: &mut State) {
    // Open choices are replaced by the automatic settings.
    let drawn = state.drawn_style();
    let mut request = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        // A slider of the default width would widen the panel, which never shrinks again.
        let space = ui.available_width() - SLIDER_MARGIN;
        let spacing = ui.spacing_mut();
        spacing.slider_width = space.clamp(MIN_SLIDER_WIDTH, spacing.slider_width);
        request = look(ui, state, &drawn);
        part(ui, "Camera");
        rows(ui, "camera", |ui| {
            camera(ui, &mut state.camera, &mut state.motion.turntable);
        });
        part(ui, "Time");
        sections(ui, state, SettingsPart::Time);
        let player = state.player.as_ref();
        if let Some(applied) = player.and_then(|player| player.sequence().source().filters()) {
            part(ui, "Depth images");
            let filters = depth_filters_ui(ui, applied);
            request = filters.map(SettingsRequest::FilterDepth).or(request.take());
        }
        part(ui, "Clip");
        sections(ui, state, SettingsPart::Clip);
        ui.add_space(8.0);
        let title = RichText::new("Advanced").strong().size(PART_SIZE);
        let advanced = CollapsingHeader::new(title).open(Some(state.appearance.shows_advanced));
        let shown = advanced.show_unindented(ui, |ui| advanced_ui(ui, state, &drawn));
        state.appearance.shows_advanced ^= shown.header_response.clicked();
        if sought::is_missing(ui.ctx()) {
            // It is in this section, or nothing that is drawn uses it.
            if state.appearance.shows_advanced {
                sought::give_up(ui.ctx());
            }
            state.appearance.shows_advanced = true;
            ui.ctx().request_repaint();
        }
        ui.add_space(12.0);
        if ui
            .button("Reset to defaults")
            .on_hover_text("Resets all render settings; the camera stays")
            .clicked()
        {
            request = Some(SettingsRequest::Reset);
        }
    });
    match request {
        Some(SettingsRequest::ChooseUp(up)) => state.choose_up(up),
        Some(SettingsRequest::FilterDepth(filters)) => state.filter_depth(filters),
        Some(SettingsRequest::Reset) => state.reset_settings(),
        None => {}
    }
}

/// The sections of features that are in a part of the panel.
fn sections(ui: &mut Ui, state: &mut State, part: SettingsPart) {
    let rows = Features::rows::<State>().into_iter().flat_map(Feature::settings);
    let mut rows: Vec<_> = rows.filter(|row| row.part == part).collect();
    rows.sort_by_key(|row| row.rank);
    for row in rows {
        (row.show)(ui, state);
    }
}

/// The heading of a part of the panel.
fn part(ui: &mut Ui, title: &str) {
    ui.add_space(10.0);
    ui.separator();
    sought::meet(&ui.label(RichText::new(title).strong().size(PART_SIZE)), title);
    ui.add_space(2.0);
}

/// Shows the appearance settings: primitive, size, colours, light, background, up axis.
fn look(ui: &mut Ui, state: &mut State, drawn: &Style) -> Option<SettingsRequest> {
    ui.label(RichText::new("Look").strong().size(PART_SIZE));
    ui.add_space(2.0);
    let look = state.first_look();
    let guessed = look.map(|look| (look.primitive, look.primitive_why));
    let up_why = look.map(|look| look.up_why);
    let lack = |&primitive: &Primitive| Some((primitive, look?.lack_of(primitive)?));
    let lacks: Vec<_> = Primitive::ALL.iter().filter_map(lack).collect();
    let style = &mut state.style;
    primitive(ui, style, guessed, &lacks);
    rows(ui, "look", |ui| section_rows(ui, style, drawn, Section::Look));
    let shown = state.player.as_ref().and_then(Player::shown);
    let mut has_legend = state.panels.has(PanelId::LEGEND);
    colors_ui(ui, &mut style.colors, shown, &mut has_legend);
    state.panels.set(PanelId::LEGEND, has_legend);
    if drawn.of_sequence.has_photos {
        section_ui(ui, style, drawn, "Images", Section::Photos);
    }
    for (title, section) in [("Light", Section::Shading), ("Background", Section::Background)] {
        section_ui(ui, style, drawn, title, section);
    }
    let mut up = None;
    rows(ui, "up axis", |ui| up = up_axis(ui, state.camera.up, up_why));
    up.map(SettingsRequest::ChooseUp)
}

/// Shows the advanced settings: the renderer, its means, and their cost.
fn advanced_ui(ui: &mut Ui, state: &mut State, drawn: &Style) {
    sections(ui, state, SettingsPart::Advanced);
    let style = &mut state.style;
    section_ui(ui, style, drawn, "Drawing", Section::Picture);
    section_ui(ui, style, drawn, "Surfels", Section::Surfels);
    ui.add_enabled_ui(drawn.has_footprints(), |ui| {
        rows(ui, "footprints", |ui| {
            section_rows(ui, style, drawn, Section::Footprints);
        });
    });
    for (title, section) in [("Octree", Section::Octree), ("Level of detail", Section::LevelOfDetail)] {
        section_ui(ui, style, drawn, title, section);
    }
    heading(ui, "Window");
    rows(ui, "window", |ui| {
        let hint = "Whether the GPU or the CPU paints the panels and presents the window";
        let (all, words) = (PresentChoice::ALL, PresentChoice::WORDS);
        word(ui, "Painted by", hint, &mut state.appearance.present, all, words);
    });
}

/// The list of primitives, and of words for some of them with other settings. One that the open files have not cannot
/// be chosen, and tells why.
fn primitive(ui: &mut Ui, style: &mut Settings, guessed: Option<(Primitive, &str)>, lacks: &[(Primitive, String)]) {
    let button = |is_chosen, word: &Word| Button::selectable(is_chosen, word.title).min_size(egui::vec2(62.0, 26.0));
    let short = Settings::PRIMITIVE
        .shorthands
        .iter()
        .find(|short| style.has_all_of(short));
    let lack_of = |primitive: Choice<Primitive>| {
        lacks
            .iter()
            .find(|(lacking, _)| primitive == *lacking)
            .map(|(_, lack)| lack)
    };
    ui.horizontal_wrapped(|ui| {
        for (primitive, word) in Choice::all().zip(Choice::<Primitive>::WORDS.list) {
            let button = button(short.is_none() && style.primitive == primitive, word);
            let lack = lack_of(primitive);
            let added = ui.add_enabled(lack.is_none(), button).on_hover_text(word.hint);
            if added.on_disabled_hover_text(lack.map_or("", String::as_str)).clicked() {
                style.primitive = primitive;
                // Exactly the clicked primitive is chosen, not a shorthand that combines it with other settings.
                Settings::PRIMITIVE
                    .shorthands
                    .iter()
                    .for_each(|short| style.take_back(short));
            }
        }
        for shorthand in Settings::PRIMITIVE.shorthands {
            let button = button(style.has_all_of(shorthand), &shorthand.word);
            if ui.add(button).on_hover_text(shorthand.word.hint).clicked() {
                style.take(shorthand);
            }
        }
    });
    if let Some(lack) = lack_of(style.primitive) {
        ui.label(RichText::new(lack).weak());
    }
    if let (Choice::Auto, Some((primitive, why))) = (style.primitive, guessed) {
        let text = format!("Drawn as {primitive}s: {why}");
        ui.label(RichText::new(text).weak());
    }
    ui.add_space(4.0);
}

/// Shows the up axis choice; returns another one, where it is chosen.
fn up_axis(ui: &mut Ui, before: UpAxis, why: Option<&'static str>) -> Option<UpAxis> {
    let axes = UpAxis::ALL
        .iter()
        .map(|&(_, axis)| (axis.label(), axis, "The axis of the file that points up on screen"));
    let axes: Vec<_> = axes.collect();
    let mut up = before;
    choice(
        ui,
        "Up axis",
        "The axis of the file that points up on screen; saved with this sequence",
        &mut up,
        &axes,
    );
    if let Some(why) = why {
        note_below(ui, why);
    }
    (up != before).then_some(up)
}

/// The rows of the camera.
fn camera(ui: &mut Ui, camera: &mut Camera, turntable: &mut Turntable) {
    let hint = "Perspective or orthographic projection (O)";
    let (all, words) = (Projection::ALL, Projection::WORDS);
    word(ui, "Projection", hint, &mut camera.projection, all, words);
    if camera.projection == Projection::Perspective {
        // The slider rounds the displayed value: it must not change a value that comes from a path or a text field.
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
        "Orbits about the up axis until the view is dragged (T)",
        Checkbox::new(&mut turntable.is_on, "Turning"),
    );
    let pace = Slider::new(&mut turntable.deg_per_sec, Turntable::PACES)
        .max_decimals(0)
        .suffix(" °/s");
    row(
        ui,
        "Turntable speed",
        "Speed of the turntable, degrees per second; negative in the other direction",
        pace,
    );
}
