//! Choices about light.

use super::settings::{choice, row};
use crate::scene::{EyeDome, Lighting, Primitive, Splatting, Style};
use egui::{Slider, Ui};

/// Light of what is `drawn`: the settings without what is left open.
pub(super) fn shading(ui: &mut Ui, settings: &mut Style, drawn: &Style) {
    if drawn.primitive != Primitive::Point {
        choice(
            ui,
            "Lighting",
            "Where the head light is evaluated",
            &mut settings.light.lighting,
            &[
                ("None", Lighting::Unlit, "Plain colours"),
                (
                    "Per surfel or face",
                    Lighting::PerSurfel,
                    "Once for each surfel or voxel face",
                ),
                (
                    "Per vertex",
                    Lighting::PerVertex,
                    "At each corner, interpolated between",
                ),
                ("Per fragment", Lighting::PerFragment, "At each pixel"),
            ],
        );
    }
    eye_dome(ui, settings, drawn);
}

/// Eye-dome lighting; what is drawn without depth has none.
fn eye_dome(ui: &mut Ui, settings: &mut Style, drawn: &Style) {
    if drawn.draws_surfels() && settings.surfels.splatting == Splatting::NoDepth {
        return;
    }
    choice(
        ui,
        "Eye-dome light",
        "Darkens what stands behind its neighbours: depths show shapes without any normals",
        &mut settings.light.eye_dome,
        &[
            (
                "Automatic",
                EyeDome::Auto,
                "Where points have no other light",
            ),
            ("On", EyeDome::On, "Whatever is drawn"),
            ("Off", EyeDome::Off, "Never"),
        ],
    );
    if drawn.light.eye_dome == EyeDome::On {
        let strength = Slider::new(
            &mut settings.light.eye_dome_strength,
            Style::EYE_DOME_STRENGTHS,
        )
        .max_decimals(2)
        .suffix(" ×");
        row(
            ui,
            "Strength",
            "How much the eye-dome light darkens; 1 is usual",
            strength,
        );
    }
}
