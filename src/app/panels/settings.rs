//! Every choice about the picture, with its term and unit in a tooltip. Only what the chosen primitive uses is listed.

use super::clip::clip_ui;
use super::colors::colors_ui;
use super::footprints::footprints_ui;
use super::quality::quality_ui;
use super::shading::shading;
use super::time::time_ui;
use super::voxels::octree_ui;
use crate::app::state::{POINT_SIZE_RANGE_PX, SPLAT_SCALE_RANGE};
pub(super) use crate::app::widgets::rows::{choice, heading, note_below, row, rows};
use crate::app::{PresentChoice, State, Turntable};
use crate::scene::{
    BackFaces, Background, Primitive, Projection, RendererChoice, Splatting, Strategy, Style,
    UpAxis,
};
use egui::{Button, Checkbox, RichText, ScrollArea, Slider, Ui};

/// The panel at the right.
pub(super) fn settings_ui(ui: &mut Ui, state: &mut State) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        quality_ui(ui, state);
        heading(ui, "Picture");
        primitive(ui, state);
        let drawn = state.drawn_settings();
        rows(ui, "picture", |ui| {
            if drawn.draws_surfels() {
                splatting(ui, &mut state.settings);
            }
            renderer(ui, &mut state.settings);
            strategy(ui, &mut state.settings);
            resolution(ui, &mut state.settings);
        });
        match drawn.primitive {
            Primitive::Auto | Primitive::Surfel => {
                surfels(ui, &mut state.settings);
                let is_software = state.graphics.is_software;
                let on_processor = state.settings.renderer.is_processor(is_software);
                footprints_ui(ui, &mut state.settings, on_processor);
            }
            Primitive::Voxel => {}
            Primitive::Point => points(ui, &mut state.settings),
        }
        if drawn.draws_cells() || drawn.draws_codes() {
            octree_ui(ui, &mut state.settings);
        }
        colors_ui(ui, state);
        clip_ui(ui, state);
        time_ui(ui, state);
        heading(ui, "Shading");
        rows(ui, "shading", |ui| shading(ui, &mut state.settings, &drawn));
        heading(ui, "Background");
        rows(ui, "background", |ui| {
            background(ui, &mut state.settings.backdrop.background);
            row(
                ui,
                "Ground",
                "Lines on the plane below the cloud; a cell is a power of ten wide (G)",
                Checkbox::new(&mut state.settings.backdrop.grid, "Grid"),
            );
        });
        heading(ui, "Camera");
        rows(ui, "camera", |ui| camera(ui, state));
        heading(ui, "Window");
        rows(ui, "window", |ui| {
            present(ui, &mut state.appearance.present);
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

fn primitive(ui: &mut Ui, state: &mut State) {
    ui.horizontal(|ui| {
        for (primitive, text, tooltip) in [
            (
                Primitive::Auto,
                "Auto",
                "Surfels where the points sample a surface, else points",
            ),
            (
                Primitive::Surfel,
                "Surfels",
                "Oriented disks with a Gaussian mask, blended where they overlap",
            ),
            (
                Primitive::Voxel,
                "Voxels",
                "Cubes of the octree's cells, as fine as the picture needs",
            ),
            (
                Primitive::Point,
                "Points",
                "Plain squares of a size in pixels: the fastest",
            ),
        ] {
            let button = Button::selectable(state.settings.primitive == primitive, text)
                .min_size(egui::vec2(62.0, 26.0));
            if ui.add(button).on_hover_text(tooltip).clicked() {
                state.settings.primitive = primitive;
            }
        }
    });
    if let (Primitive::Auto, Some(look)) = (state.settings.primitive, state.first_look()) {
        let text = format!("Drawn as {}s: {}", look.primitive, look.primitive_why);
        ui.label(RichText::new(text).weak());
    }
    ui.add_space(4.0);
}

fn splatting(ui: &mut Ui, settings: &mut Style) {
    choice(
        ui,
        "Splatting",
        "How overlapping surfels become one surface (the six modes of the paper's Fig. 3)",
        &mut settings.surfels.splatting,
        &[
            (
                "Regular",
                Splatting::Regular,
                "One pass, depth test and blending",
            ),
            (
                "No depth",
                Splatting::NoDepth,
                "One pass without depth test: far splats shine through",
            ),
            (
                "Visibility",
                Splatting::Visibility,
                "The depths of the first pass as grey",
            ),
            (
                "Two-pass",
                Splatting::TwoPass,
                "Visibility first, then blending at the surface",
            ),
            (
                "Enlarged",
                Splatting::Enlarged,
                "Two passes, both with enlarged splats",
            ),
            (
                "Two-pass, enlarged",
                Splatting::TwoPassEnlarged,
                "Two passes, enlarged in the second only: the smoothest",
            ),
        ],
    );
}

fn renderer(ui: &mut Ui, settings: &mut Style) {
    choice(
        ui,
        "Renderer",
        "Who draws. Both draw the same picture",
        &mut settings.renderer,
        &[
            (
                "Automatic",
                RendererChoice::Auto,
                "The GPU if there is a real one, else the processor",
            ),
            (
                "GPU",
                RendererChoice::Gpu,
                "The adapter of the graphics library, be it a software one",
            ),
            (
                "CPU",
                RendererChoice::Cpu,
                "The processor, without instancing: what Instancing says has no effect",
            ),
        ],
    );
}

fn present(ui: &mut Ui, present: &mut PresentChoice) {
    choice(
        ui,
        "Painted by",
        "Who paints the panels and brings the window onto the screen",
        present,
        &[
            (
                "Automatic",
                PresentChoice::Auto,
                "The GPU if there is a real one, else the processor",
            ),
            (
                "GPU",
                PresentChoice::Gpu,
                "The adapter of the graphics library, be it a software one",
            ),
            (
                "CPU",
                PresentChoice::Cpu,
                "The processor, without any driver: only what has changed is painted",
            ),
        ],
    );
}

fn resolution(ui: &mut Ui, settings: &mut Style) {
    let share = Slider::new(&mut settings.resolution, Style::RESOLUTIONS)
        .step_by(0.05)
        .custom_formatter(|share, _| format!("{:.0} %", share * 100.0))
        .custom_parser(|text| {
            let percent: f64 = text.trim_end_matches('%').trim().parse().ok()?;
            Some(percent / 100.0)
        });
    row(
        ui,
        "Resolution",
        "Edge of the picture that is drawn, as a share of the one that is shown: at 50 % a quarter of the pixels are \
         drawn and scaled up",
        share,
    );
}

fn strategy(ui: &mut Ui, settings: &mut Style) {
    choice(
        ui,
        "Instancing",
        "How instances reach the GPU's vertex stage. All strategies draw the same picture; their speed differs",
        &mut settings.strategy,
        &[
            (
                "Storage buffer",
                Strategy::Storage,
                "Records pulled from a storage buffer",
            ),
            (
                "Uniform buffers",
                Strategy::Uniform,
                "Records in 64 KiB uniform buffers, one draw for each",
            ),
            ("Texture", Strategy::Texture, "Records fetched as texels"),
            (
                "Vertex attributes",
                Strategy::Vertex,
                "Records as attributes stepped per instance",
            ),
            (
                "Compute",
                Strategy::Compute,
                "A compute pass writes the quads and cubes; one indirect draw",
            ),
        ],
    );
}

fn surfels(ui: &mut Ui, settings: &mut Style) {
    heading(ui, "Surfels");
    rows(ui, "surfels", |ui| {
        let scale = Slider::new(&mut settings.surfels.splat_scale, SPLAT_SCALE_RANGE)
            .logarithmic(true)
            .max_decimals(2)
            .suffix(" ×");
        row(
            ui,
            "Splat scale",
            "Factor on every splat's radius (+ and -)",
            scale,
        );
        let uses_enlargement = matches!(
            settings.surfels.splatting,
            Splatting::Enlarged | Splatting::TwoPassEnlarged
        );
        if uses_enlargement {
            let enlargement = Slider::new(&mut settings.surfels.enlargement, 1.0..=4.0)
                .max_decimals(2)
                .suffix(" ×");
            row(
                ui,
                "Enlargement",
                "Further factor on the radius in the enlarged passes; the paper uses 2",
                enlargement,
            );
        }
        back_faces(ui, settings);
        row(
            ui,
            "Surfel detail",
            "One surfel for all points of an octree's cell that is small on the screen: fewer are drawn from afar",
            Checkbox::new(&mut settings.levels.surfel_lod, "By the octree"),
        );
    });
}

fn back_faces(ui: &mut Ui, settings: &mut Style) {
    choice(
        ui,
        "Back faces",
        "Surfels that face away from the eye",
        &mut settings.surfels.back_faces,
        &[
            (
                "Auto",
                BackFaces::Auto,
                "Left out where the surface is closed, so that nothing is missed",
            ),
            ("Drawn", BackFaces::Drawn, "From behind as from the front"),
            (
                "Darker",
                BackFaces::Darker,
                "From behind a little darker than from the front",
            ),
            (
                "Culled",
                BackFaces::Culled,
                "Left out: looks into rooms from outside",
            ),
        ],
    );
}

fn points(ui: &mut Ui, settings: &mut Style) {
    heading(ui, "Points");
    rows(ui, "points", |ui| {
        let size = Slider::new(&mut settings.points.size_px, POINT_SIZE_RANGE_PX)
            .max_decimals(1)
            .suffix(" px");
        row(
            ui,
            "Point size",
            "Edge of the square drawn for a point, pixels (+ and -)",
            size,
        );
    });
}

fn background(ui: &mut Ui, background: &mut Background) {
    let names = ["Dusk", "Black", "Gray", "White", "Sky"];
    let presets: Vec<(&str, Background, &str)> = Background::PRESETS
        .iter()
        .zip(names)
        .map(|(&(_, preset), name)| (name, preset, "A background to begin with"))
        .collect();
    choice(
        ui,
        "Preset",
        "What is behind the cloud",
        background,
        &presets,
    );
    for (name, tooltip, color) in [
        (
            "Top colour",
            "Colour at the upper edge of the picture",
            &mut background.top,
        ),
        (
            "Bottom colour",
            "Colour at the lower edge of the picture",
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
        (
            text,
            axis,
            "The axis of the file that points up in the picture",
        )
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
    choice(
        ui,
        "Projection",
        "Whether what is farther away is smaller (O)",
        &mut state.camera.projection,
        &[
            (
                "Perspective",
                Projection::Perspective,
                "As an eye sees: what is farther away is smaller",
            ),
            (
                "Orthographic",
                Projection::Orthographic,
                "By parallel rays: everything is as large as at the middle of the orbit",
            ),
        ],
    );
    if state.camera.projection == Projection::Perspective {
        // The slider rounds what it shows: what comes from a path or a text is not its to change.
        let before = state.camera.fov_deg.round().clamp(5.0, 120.0);
        let mut shown = before;
        let fov = Slider::new(&mut shown, 5.0..=120.0)
            .max_decimals(0)
            .suffix(" °");
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
