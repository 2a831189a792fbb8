//! How surfels are drawn.

use super::choices::choices;

choices! {
    /// The six ways of splatting of paper 000, Fig. 3.
    Splatting, "splatting mode" {
        /// (a) One pass, depth test and blending: square artefacts where splats cut each other.
        Regular = "regular",
        /// (b) One pass without depth: far splats shine through.
        NoDepth = "no-depth",
        /// (c) The depths that the visibility pass leaves, as grey.
        Visibility = "visibility",
        /// (d) Visibility pass, then blending of what lies at the surface.
        TwoPass = "two-pass",
        /// (e) Two passes, both with enlarged splats.
        Enlarged = "enlarged",
        /// (f) Two passes, enlarged in the second only: the paper's proposal.
        TwoPassEnlarged = "two-pass-enlarged",
    }
}

impl Splatting {
    /// Factors on the splat radius in the visibility and in the attribute pass.
    pub fn scales(self, enlargement: f32) -> [f32; 2] {
        match self {
            Self::Regular | Self::NoDepth | Self::Visibility | Self::TwoPass => [1.0, 1.0],
            Self::Enlarged => [enlargement, enlargement],
            Self::TwoPassEnlarged => [1.0, enlargement],
        }
    }
}

choices! {
    /// Whether surfels are drawn whose normals point away from the eye.
    BackFaces, "choice for back faces" {
        /// Left out where the surface is closed, so that nothing is missed, else drawn, and darker where the normals
        /// are known to point outwards; see [`super::FirstLook`]. Left out where nobody has looked.
        Auto = "auto",
        /// From behind as from the front.
        Drawn = "drawn",
        /// From behind a little darker than from the front, if there is light.
        Darker = "darker",
        /// Left out.
        Culled = "culled",
    }
}

/// What was written when there were two choices: to leave them out was the default, so it says nothing.
#[derive(serde::Deserialize)]
#[serde(untagged)]
enum StoredBackFaces {
    Are(BackFaces),
    AreCulled(bool),
}

fn stored_back_faces<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<BackFaces, D::Error> {
    Ok(match serde::Deserialize::deserialize(deserializer)? {
        StoredBackFaces::Are(choice) => choice,
        StoredBackFaces::AreCulled(true) => BackFaces::Auto,
        StoredBackFaces::AreCulled(false) => BackFaces::Drawn,
    })
}

/// How surfels are drawn.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct SurfelStyle {
    /// How they become a surface.
    pub splatting: Splatting,
    /// Factor on every splat radius.
    pub splat_scale: f32,
    /// Further factor of the enlarged passes; the paper uses 2.
    pub enlargement: f32,
    /// Whether what faces away is drawn.
    #[serde(rename = "cull_back_faces", deserialize_with = "stored_back_faces")]
    pub back_faces: BackFaces,
}

impl Default for SurfelStyle {
    fn default() -> Self {
        Self {
            splatting: Splatting::TwoPass,
            splat_scale: 1.0,
            enlargement: 2.0,
            back_faces: BackFaces::Auto,
        }
    }
}
