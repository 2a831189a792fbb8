//! Light.

use super::choices::choices;

choices! {
    /// Where the head light is evaluated (paper 000 §V-B).
    Lighting, "lighting" {
        /// Plain colours.
        Unlit = "none",
        /// Once a surfel or face.
        PerSurfel = "surfel",
        /// At each corner, interpolated.
        PerVertex = "vertex",
        /// At each pixel.
        PerFragment = "fragment",
    }
}

choices! {
    /// Whether depths shade the picture.
    EyeDome, "choice of eye-dome lighting" {
        /// Where points are shown without light; nobody has decided yet: none.
        Auto = "auto",
        /// All pictures.
        On = "on",
        /// None.
        Off = "off",
    }
}

/// Light from the eye, and light from depths.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct LightStyle {
    /// Where light is evaluated.
    pub lighting: Lighting,
    /// Whether depths shade the picture as well (eye-dome lighting).
    pub eye_dome: EyeDome,
    /// How much they do; 1 is usual.
    pub eye_dome_strength: f32,
}

impl Default for LightStyle {
    fn default() -> Self {
        Self {
            lighting: Lighting::PerFragment,
            eye_dome: EyeDome::Auto,
            eye_dome_strength: 1.0,
        }
    }
}
