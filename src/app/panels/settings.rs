//! Every choice about the picture, with its term and unit in a tooltip. Only what the chosen primitive uses is listed.

use super::clip::clip_ui;
use super::colors::colors_ui;
use super::quality::quality_ui;
use super::style::{section_rows, section_ui, word};
use super::time::time_ui;
pub(super) use crate::app::widgets::rows::{choice, heading, note_below, row, rows};
use crate::app::{PresentChoice, State, Turntable};
use crate::scene::describe::Section;
use crate::scene::{Primitive, Projection, RendererChoice, UpAxis};
use egui::{Button, Checkbox, RichText, ScrollArea, Slider, Ui};

/// The panel at the right.
pub(super) fn settings_ui(ui: &mut Ui, state: &mut State) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        quality_ui(ui, state);
        picture(ui, state);
        colors_ui(ui, state);
        clip_ui(ui, state);
        time_ui(ui, state);
        let drawn = state.drawn_style();
        for section in [("Shading", Section::Shading), ("Background", Section::Background)] {
            section_ui(ui, &mut state.style, &drawn, section);
        }
        heading(ui, "Camera");
        rows(ui, "camera", |ui| camera(ui, state));
        heading(ui, "Window");
        rows(ui, "window", |ui| {
            let texts = (
                "Painted by",
                "Who paints the panels and brings the window onto the screen",
            );
            let (all, words) = (PresentChoice::ALL, PresentChoice::WORDS);
            word(ui, texts, &mut state.appearance.present, all, words);
        });
        ui.add_space(12.0);
        if ui
            .button("Reset to defaults")
            .on_hover_text("Every setting of the picture as it is at first; the camera stays")
            .clicked()
        {
            state.reset_settings();
        }
    });
}

/// What is drawn and how, but for colours and light.
fn picture(ui: &mut Ui, state: &mut State) {
    heading(ui, "Picture");
    primitive(ui, state);
    let drawn = state.drawn_style();
    let style = &mut state.style;
    rows(ui, "picture", |ui| {
        section_rows(ui, style, &drawn, Section::Picture);
    });
    section_ui(ui, style, &drawn, ("Surfels", Section::Surfels));
    let on_processor = drawn.drawing.renderer == RendererChoice::Cpu;
    let has_footprints = on_processor && style.surfels.splatting.has_visibility_pass();
    ui.add_enabled_ui(has_footprints, |ui| {
        rows(ui, "footprints", |ui| {
            section_rows(ui, style, &drawn, Section::Footprints);
        });
    });
    for section in [
        ("Points", Section::Points),
        ("Cubes", Section::Cubes),
        ("Octree", Section::Octree),
        ("Level of detail", Section::LevelOfDetail),
    ] {
        section_ui(ui, style, &drawn, section);
    }
}

fn primitive(ui: &mut Ui, state: &mut State) {
    ui.horizontal(|ui| {
        for (&primitive, word) in Primitive::ALL.iter().zip(Primitive::WORDS.list) {
            let button =
                Button::selectable(state.style.primitive == primitive, word.title).min_size(egui::vec2(62.0, 26.0));
            if ui.add(button).on_hover_text(word.hint).clicked() {
                state.style.primitive = primitive;
            }
        }
    });
    if let (Primitive::Auto, Some(look)) = (state.style.primitive, state.first_look()) {
        let text = format!("Drawn as {}s: {}", look.primitive, look.primitive_why);
        ui.label(RichText::new(text).weak());
    }
    ui.add_space(4.0);
}

fn camera(ui: &mut Ui, state: &mut State) {
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
    let mut up = state.camera.up;
    choice(
        ui,
        "Up axis",
        "The axis of the file that points up in the picture, kept for this sequence",
        &mut up,
        &axes,
    );
    if up != state.camera.up {
        state.choose_up(up);
    }
    if let Some(look) = state.first_look() {
        note_below(ui, look.up_why);
    }
    let texts = ("Projection", "Whether what is farther away is smaller (O)");
    let (all, words) = (Projection::ALL, Projection::WORDS);
    word(ui, texts, &mut state.camera.projection, all, words);
    if state.camera.projection == Projection::Perspective {
        // The slider rounds what it shows: what comes from a path or a text is not its to change.
        let before = state.camera.fov_deg.round().clamp(5.0, 120.0);
        let mut shown = before;
        let fov = Slider::new(&mut shown, 5.0..=120.0).max_decimals(0).suffix(" °");
        row(
            ui,
            "Field of view",
            "Vertical opening angle of the camera, degrees",
            fov,
        );
        if shown != before {
            state.camera.fov_deg = shown;
        }
    }
    let turntable = &mut state.motion.turntable;
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
}
