//! Light from the eye, and light from depths.

use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Typed, Unit, Values, When, group};

choices! {
    /// Where the head light is evaluated (paper 000 §V-B).
    Lighting, "lighting" {
        Unlit = "none", "None", "Plain colours";
        PerSurfel = "surfel", "Per surfel or face", "Once for each surfel or voxel face";
        PerVertex = "vertex", "Per vertex", "At each corner, interpolated between";
        PerFragment = "fragment", "Per fragment", "At each pixel";
    }
}

choices! {
    /// Whether depths shade the picture.
    EyeDome, "choice of eye-dome lighting" {
        /// Nobody has decided yet: none.
        Auto = "auto", "Automatic", "Where points have no other light";
        On = "on", "On", "Whatever is drawn";
        Off = "off", "Off", "Never";
    }
}

group! {
    /// Light from the eye, and light from depths.
    LightStyle {
        /// Where light is evaluated.
        lighting: Lighting = Lighting::PerFragment, "lighting" LIGHTING {
            flag: "lighting",
            value_name: "WHERE",
            help: "Where light is evaluated",
            title: "Lighting",
            hint: "Where the head light is evaluated",
            section: Section::Shading,
            when: When::Lit,
            label: Label::Unusual(Place::What, "lit per {}"),
            values: Values::Words(Lighting::WORDS),
        }
        /// Whether depths shade the picture as well (eye-dome lighting).
        eye_dome: EyeDome = EyeDome::Auto, "eye_dome" EYE_DOME {
            flag: "eye-dome",
            value_name: "WHETHER",
            help: "Shade by depths (eye-dome lighting)",
            title: "Eye-dome light",
            hint: "Darkens what stands behind its neighbours: depths show shapes without any normals",
            section: Section::Shading,
            when: When::Depths,
            values: Values::Words(EyeDome::WORDS),
        }
        /// How much they do; 1 is usual.
        eye_dome_strength: f32 = 1.0, "eye_dome_strength" EYE_DOME_STRENGTH {
            flag: "eye-dome-strength",
            value_name: "S",
            help: "How much --eye-dome shades (usually 1)",
            title: "Strength",
            hint: "How much the eye-dome light darkens; 1 is usual",
            section: Section::Shading,
            when: When::EyeDome,
            values: Values::Number(Numbers {
                kept: [0.0, 4.0],
                offered: [0.0, 4.0],
                typed: Typed::NotNegative,
                unit: Unit::Is(" ×"),
                ..Numbers::USUAL
            }),
        }
    }
}
