//! A style with what was guessed, or with another way to draw.

use super::{BackFaces, Background, EyeDome, LightStyle, Lighting, PhotoRelight, Primitive, Style, SurfelStyle};
use crate::scene::FirstLook;
use crate::sequence::ColorSource;

impl Style {
    /// These settings, but drawn as `way` is: the colours, the background and the grid stay, what is clipped, and
    /// whether back faces are left out. Eye-dome lighting is that of `way` where that decides, which ways to draw that
    /// are measured do not.
    #[must_use]
    pub fn drawn_as(&self, way: &Self) -> Self {
        let decides = way.light.eye_dome != EyeDome::Auto;
        let light = if decides { way } else { self };
        Self {
            colors: self.colors,
            surfels: SurfelStyle {
                back_faces: self.surfels.back_faces,
                ..way.surfels
            },
            light: LightStyle {
                eye_dome: light.light.eye_dome,
                eye_dome_strength: light.light.eye_dome_strength,
                ..way.light
            },
            backdrop: self.backdrop,
            of_sequence: self.of_sequence,
            ..*way
        }
    }

    /// These settings, with what was guessed in place of every choice that is left open.
    #[must_use]
    pub fn resolved(&self, look: &FirstLook) -> Self {
        let primitive = match self.primitive {
            Primitive::Auto => look.primitive,
            Primitive::Mesh if !look.has_faces => look.primitive,
            chosen => chosen,
        };
        let back_faces = match self.surfels.back_faces {
            BackFaces::Auto if look.is_closed => BackFaces::Culled,
            BackFaces::Auto if look.knows_outside => BackFaces::Darker,
            BackFaces::Auto => BackFaces::Drawn,
            chosen => chosen,
        };
        // Of points that sample no surface, normals are noise.
        let shows_shape = match primitive {
            Primitive::Mesh => true,
            Primitive::Point if !(Self { primitive, ..*self }).lights_points() => false,
            _ => look.has_surface(),
        };
        let eye_dome = match self.light.eye_dome {
            EyeDome::Auto if shows_shape => EyeDome::Off,
            EyeDome::Auto => EyeDome::On,
            chosen => chosen,
        };
        let lighting = match self.light.lighting {
            Lighting::Auto if self.shows_light_of(look, primitive) => Lighting::Unlit,
            Lighting::Auto => Lighting::PerFragment,
            chosen => chosen,
        };
        // Whoever has chosen points has chosen their size.
        let size_px = if self.primitive == Primitive::Auto {
            self.points.size_px.max(look.point_size_px)
        } else {
            self.points.size_px
        };
        let is_lost = look.is_dark && self.backdrop.background == Background::default();
        let background = if is_lost {
            Background::BEHIND_DARK
        } else {
            self.backdrop.background
        };
        self.with(|style| {
            style.primitive = primitive;
            style.surfels.back_faces = back_faces;
            style.points.size_px = size_px;
            style.light.eye_dome = eye_dome;
            style.light.lighting = lighting;
            style.backdrop.background = background;
            style.of_sequence.color_hints = look.color_hints();
            style.of_sequence.ground_box = Some(look.trimmed);
            style.of_sequence.has_photographs = look.has_photographs();
        })
    }

    /// Whether surfaces have colours with light in them, drawn as `primitive` is. Voxels would have no edges without
    /// light, and whoever asks for light on points or for photographs to be lit anew wants it.
    fn shows_light_of(&self, look: &FirstLook, primitive: Primitive) -> bool {
        let is_surface = !matches!(primitive, Primitive::Voxel | Primitive::Point);
        let is_lit_anew = look.has_photographs() && self.photos.relight != PhotoRelight::Off;
        let shows_colors = matches!(self.colors.source, ColorSource::Auto | ColorSource::File);
        is_surface && look.colors_have_light && shows_colors && !is_lit_anew
    }
}
