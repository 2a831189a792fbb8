//! Style resolution with guessed values, or with another render mode.

use super::{
    BackFaces, Background, EyeDome, LightSettings, Lighting, PhotoRelight, Primitive, Settings, Style, SurfelSettings,
};
use crate::scene::FirstLook;
use crate::sequence::ColorSource;

impl Settings {
    /// Returns these settings with the render mode of `way`: the colours, estimation, the background and the grid stay,
    /// as do the clip region and back-face culling. Eye-dome lighting is taken from `way` if it specifies it, which
    /// benchmarked render modes do not.
    #[must_use]
    pub fn drawn_as(&self, way: &Self) -> Self {
        let decides = !way.light.eye_dome.is_open();
        let light = if decides { way } else { self };
        Self {
            colors: self.colors,
            surfels: SurfelSettings {
                back_faces: self.surfels.back_faces,
                ..way.surfels
            },
            light: LightSettings {
                eye_dome: light.light.eye_dome,
                eye_dome_strength: light.light.eye_dome_strength,
                ..way.light
            },
            estimation: self.estimation,
            backdrop: self.backdrop,
            clip: self.clip,
            ..*way
        }
    }

    /// Resolves these settings to a style for the examined sequence: every choice left open takes its guessed value.
    pub fn resolved(&self, look: &FirstLook) -> Style {
        let primitive = match self.primitive.chosen() {
            None => look.primitive,
            Some(Primitive::Mesh) if !look.has_faces => look.primitive,
            Some(chosen) => chosen,
        };
        let settings = self.with(|settings| {
            settings.primitive = primitive.into();
            let back_faces = &mut settings.surfels.back_faces;
            *back_faces = back_faces.or(usual_back_faces(look)).into();
            let lighting = &mut settings.light.lighting;
            *lighting = lighting.or(self.usual_lighting(look, primitive)).into();
            // A user who has chosen points has chosen their size.
            if self.primitive.is_open() {
                settings.points.size_px = settings.points.size_px.max(look.point_size_px);
            }
            let is_lost = look.is_dark && self.backdrop.background == Background::default();
            if is_lost {
                settings.backdrop.background = Background::BEHIND_DARK;
            }
        });
        settings.decided().with(|style| {
            style.light.eye_dome = self.light.eye_dome.or(usual_eye_dome(style, look));
            style.of_sequence.color_hints = look.color_hints();
            style.of_sequence.ground_box = Some(look.trimmed);
            style.of_sequence.has_photos = look.has_photos();
        })
    }

    fn usual_lighting(&self, look: &FirstLook, primitive: Primitive) -> Lighting {
        if self.shows_light_of(look, primitive) {
            Lighting::Unlit
        } else {
            Lighting::PerFragment
        }
    }

    /// Returns true if surfaces have colours with baked-in lighting, drawn as `primitive` is. Voxels would have no
    /// edges without light, and light on points or relighting of posed images is only set if wanted.
    fn shows_light_of(&self, look: &FirstLook, primitive: Primitive) -> bool {
        let is_surface = !matches!(primitive, Primitive::Voxel | Primitive::Point);
        let is_relit = look.has_photos() && self.photos.relight != PhotoRelight::Off;
        let shows_colors = matches!(self.colors.source, ColorSource::Auto | ColorSource::File);
        is_surface && look.colors_have_light && shows_colors && !is_relit
    }
}

fn usual_back_faces(look: &FirstLook) -> BackFaces {
    if look.is_closed {
        BackFaces::Culled
    } else if look.knows_outside {
        BackFaces::Darker
    } else {
        BackFaces::Drawn
    }
}

/// Returns the default eye-dome lighting: on if points have no other light. For points that sample no surface, normals
/// are noise.
fn usual_eye_dome(style: &Style, look: &FirstLook) -> EyeDome {
    let shows_shape = match style.primitive {
        Primitive::Mesh => true,
        Primitive::Point if !style.lights_points() => false,
        _ => look.has_surface(),
    };
    if shows_shape { EyeDome::Off } else { EyeDome::On }
}
