//! Every choice a person has about a picture, with the words the command line and the window use for it.

mod backdrop;
mod background;
mod choices;
mod codes;
mod drawing;
mod levels;
mod light;
mod of_sequence;
mod points;
mod surfels;
mod voxels;

pub use backdrop::Backdrop;
pub use background::Background;
pub(super) use background::luma;
pub use choices::ParseChoiceError;
pub(crate) use choices::choices;
pub use codes::{CodeStyle, Footprint, NormalBits, OffsetBits};
pub use drawing::{Primitive, RendererChoice, Strategy};
pub use levels::LevelStyle;
pub use light::{EyeDome, LightStyle, Lighting};
pub use of_sequence::OfSequence;
pub use points::PointStyle;
pub use surfels::{BackFaces, Splatting, SurfelStyle};
pub use voxels::{VoxelLight, VoxelStyle};

use super::FirstLook;
use crate::levels::LevelsKind;
use crate::levels::octree::StopCriterion;
use crate::sequence::{ColorHints, Coloring};

/// All choices about a picture but where the camera stands.
///
/// They are kept in files of people, which outlive versions: what a file does not have is as by default, and what is
/// not known here is passed over.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Style {
    /// What points become.
    pub primitive: Primitive,
    /// Who draws.
    pub renderer: RendererChoice,
    /// How instances reach the GPU.
    pub strategy: Strategy,
    /// Edge of the picture that is drawn, as a share of the one that is shown: below 1 fewer pixels are drawn and
    /// scaled up.
    pub resolution: f32,
    /// Where colours come from, and how numbers become colours.
    pub colors: Coloring,
    /// How surfels are drawn.
    #[serde(flatten)]
    pub surfels: SurfelStyle,
    /// How points are drawn that stay points.
    #[serde(flatten)]
    pub points: PointStyle,
    /// How voxels are drawn.
    #[serde(flatten)]
    pub voxels: VoxelStyle,
    /// How deep the octree goes, and which of its cells are drawn.
    #[serde(flatten)]
    pub levels: LevelStyle,
    /// How surfels are drawn from byte codes of the octree.
    #[serde(flatten)]
    pub codes: CodeStyle,
    /// Light.
    #[serde(flatten)]
    pub light: LightStyle,
    /// What is shown beside the cloud.
    #[serde(flatten)]
    pub backdrop: Backdrop,
    /// What belongs to one sequence.
    #[serde(skip)]
    pub of_sequence: OfSequence,
}

impl Style {
    /// Largest δ offered.
    pub const MAX_DELTA: f32 = 0.6;
    /// Values of [`LightStyle::eye_dome_strength`] that are offered.
    pub const EYE_DOME_STRENGTHS: std::ops::RangeInclusive<f32> = 0.0..=4.0;
    /// Values of [`Style::resolution`] that are offered.
    pub const RESOLUTIONS: std::ops::RangeInclusive<f32> = 0.25..=1.0;

    /// Width and height that are drawn for a picture of `shown_px`; at least 1.
    pub fn drawn_px(&self, shown_px: [u32; 2]) -> [u32; 2] {
        shown_px.map(|edge| ((edge as f32 * self.resolution).round() as u32).max(1))
    }

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
            chosen => chosen,
        };
        let back_faces = match self.surfels.back_faces {
            BackFaces::Auto if look.is_closed => BackFaces::Culled,
            BackFaces::Auto if look.knows_outside => BackFaces::Darker,
            BackFaces::Auto => BackFaces::Drawn,
            chosen => chosen,
        };
        // Of points that sample no surface, normals are noise.
        let shows_shape = primitive != Primitive::Point && look.primitive == Primitive::Surfel;
        let eye_dome = match self.light.eye_dome {
            EyeDome::Auto if shows_shape => EyeDome::Off,
            EyeDome::Auto => EyeDome::On,
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
        Self {
            primitive,
            surfels: SurfelStyle {
                back_faces,
                ..self.surfels
            },
            points: PointStyle { size_px },
            light: LightStyle {
                eye_dome,
                ..self.light
            },
            backdrop: Backdrop {
                background,
                ..self.backdrop
            },
            of_sequence: OfSequence {
                color_hints: ColorHints {
                    up: Some(look.up.direction().as_vec3()),
                    prefers_height: Some(look.prefers_height()),
                },
                ground_box: Some(look.trimmed),
                ..self.of_sequence
            },
            ..*self
        }
    }

    /// Whether surfels are left out that face away.
    pub fn culls_back_faces(&self) -> bool {
        matches!(self.surfels.back_faces, BackFaces::Auto | BackFaces::Culled)
    }

    /// Whether the light shows which side of a surfel is seen.
    pub fn darkens_back_faces(&self) -> bool {
        self.surfels.back_faces == BackFaces::Darker && self.light.lighting != Lighting::Unlit
    }

    /// Whether points are drawn as surfels.
    pub fn draws_surfels(&self) -> bool {
        matches!(self.primitive, Primitive::Auto | Primitive::Surfel)
    }

    /// The levels of detail that are drawn; `None` where all points are.
    pub fn levels_kind(&self) -> Option<LevelsKind> {
        let by_octree = self.levels.surfel_lod;
        match self.primitive {
            Primitive::Auto | Primitive::Surfel if self.draws_codes() => Some(LevelsKind::Codes),
            Primitive::Auto | Primitive::Surfel => by_octree.then_some(LevelsKind::Surfels),
            Primitive::Voxel if self.lights_voxels_by_normals() => Some(LevelsKind::LitCubes),
            Primitive::Voxel => Some(LevelsKind::Cubes),
            Primitive::Point => None,
        }
    }

    /// Whether what is drawn are cells of an octree.
    pub fn draws_cells(&self) -> bool {
        self.levels_kind()
            .is_some_and(|kind| kind != LevelsKind::Codes)
    }

    /// This style with what was decided in place of who may choose: the processor draws, or a graphics card.
    #[must_use]
    pub fn drawn_by(&self, is_processor: bool) -> Self {
        Self {
            renderer: if is_processor {
                RendererChoice::Cpu
            } else {
                RendererChoice::Gpu
            },
            ..*self
        }
    }

    /// Whether voxels are drawn whose light falls on normals.
    pub fn lights_voxels_by_normals(&self) -> bool {
        self.primitive == Primitive::Voxel
            && self.voxels.light == VoxelLight::Normals
            && self.light.lighting != Lighting::Unlit
    }

    /// What the octree is to be divided for: surfels that it is drawn as have no use for leaves as large as the
    /// spacing.
    pub fn octree_stop(&self) -> StopCriterion {
        match self.primitive {
            Primitive::Auto | Primitive::Surfel => self.levels.stop.of_surfels(),
            Primitive::Voxel | Primitive::Point => self.levels.stop,
        }
    }

    /// Whether surfels are drawn from the byte code of an octree, which the processor alone can; [`LevelStyle::lod`]
    /// says how finely. Who draws has to be decided before: see [`Style::drawn_by`]. While something is clipped the
    /// same surfels are drawn as disks: a code cannot be cut.
    pub fn draws_codes(&self) -> bool {
        self.draws_surfels()
            && self.codes.footprint != Footprint::Disks
            && self.renderer == RendererChoice::Cpu
            && !matches!(
                self.surfels.splatting,
                Splatting::Regular | Splatting::NoDepth
            )
    }
}

impl Default for Style {
    fn default() -> Self {
        Self {
            primitive: Primitive::Auto,
            renderer: RendererChoice::Auto,
            strategy: Strategy::Storage,
            resolution: 1.0,
            colors: Coloring::default(),
            surfels: SurfelStyle::default(),
            points: PointStyle::default(),
            voxels: VoxelStyle::default(),
            levels: LevelStyle::default(),
            codes: CodeStyle::default(),
            light: LightStyle::default(),
            backdrop: Backdrop::default(),
            of_sequence: OfSequence::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_reads_back_from_its_name() {
        for &mode in Splatting::ALL {
            assert_eq!(mode.name().parse(), Ok(mode));
        }
        for &strategy in Strategy::ALL {
            assert_eq!(strategy.name().parse(), Ok(strategy));
        }
        let error = "cone".parse::<Primitive>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "`cone` is no primitive: expected auto, surfel, voxel, point"
        );
    }

    #[test]
    fn ways_to_draw_take_over_eye_dome_lighting_that_they_decide() {
        let settings = |eye_dome, eye_dome_strength| Style {
            light: LightStyle {
                eye_dome,
                eye_dome_strength,
                ..LightStyle::default()
            },
            ..Style::default()
        };
        let (on, auto) = (settings(EyeDome::On, 2.0), settings(EyeDome::Auto, 0.5));
        assert_eq!(on.drawn_as(&auto), on);
        assert_eq!(auto.drawn_as(&on), on);
        let grid = Style {
            backdrop: Backdrop {
                grid: true,
                ..on.backdrop
            },
            ..on
        };
        assert!(grid.drawn_as(&auto).backdrop.grid);
    }

    #[test]
    fn a_picture_is_drawn_in_whole_pixels() {
        let settings = |resolution| Style {
            resolution,
            ..Style::default()
        };
        assert_eq!(settings(1.0).drawn_px([1921, 1080]), [1921, 1080]);
        assert_eq!(settings(0.5).drawn_px([1921, 1080]), [961, 540]);
        assert_eq!(settings(0.25).drawn_px([1, 0]), [1, 1]);
    }
}
