//! Every choice a person has about a picture, in groups. Each is described beside its field (`describe.rs`).
//!
//! A new setting is one row in the file of its group, and its use: panel, command line, files, undo and labels of
//! benchmarks read the row.

mod backdrop;
mod background;
mod choices;
mod codes;
pub mod coloring;
pub mod describe;
mod drawing;
mod levels;
mod light;
mod of_sequence;
mod parse_error;
mod photos;
mod points;
mod resolved;
mod shorthands;
mod surfels;
#[cfg(test)]
mod tests;
mod voxels;

pub use backdrop::Backdrop;
pub use background::Background;
pub(super) use background::luma;
pub(crate) use choices::choices;
pub use codes::{CodeStyle, Footprint, NormalBits, OffsetBits};
pub use drawing::{Antialiasing, DrawingStyle, Primitive, RendererChoice, Strategy};
pub use levels::{LevelStructure, LevelStyle};
pub use light::{EyeDome, LightRig, LightStyle, Lighting, OnOff};
pub use of_sequence::OfSequence;
pub use parse_error::ParseChoiceError;
pub use photos::{PhotoClipping, PhotoGains, PhotoHoles, PhotoMode, PhotoRelight, PhotoStyle};
pub use points::{PointLight, PointShape, PointSizing, PointStyle};
pub use surfels::{BackFaces, Kernel, NormalSource, SplatFilter, SplatGeometry, Splatting, SurfelColors, SurfelStyle};
pub use voxels::{VoxelLight, VoxelStyle};

use self::describe::{Described, Label, Place, Section, Setting as _, Shorthand, Value, Values, When, Word};
use crate::levels::LevelsKind;
use crate::levels::octree::StopCriterion;
use crate::sequence::Coloring;

/// All choices about a picture but where the camera stands.
///
/// They are kept in files of people, which outlive versions: what a file does not have is as by default, and what is
/// not known here is passed over. Files know no groups.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Style {
    /// What points become.
    pub primitive: Primitive,
    /// Where colours come from, and how numbers become colours.
    pub colors: Coloring,
    /// Who draws, and how many pixels.
    #[serde(flatten)]
    pub drawing: DrawingStyle,
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
    /// Light that falls on surfaces, and light from depths.
    #[serde(flatten)]
    pub light: LightStyle,
    /// How photographs are put on surfaces.
    #[serde(flatten)]
    pub photos: PhotoStyle,
    /// What is shown beside the cloud.
    #[serde(flatten)]
    pub backdrop: Backdrop,
    /// What belongs to one sequence.
    #[serde(skip)]
    pub of_sequence: OfSequence,
}

impl Style {
    /// The description of `primitive`.
    pub const PRIMITIVE: Described = Described {
        key: "primitive",
        flag: "primitive",
        value_name: "PRIMITIVE",
        help: "What points become",
        title: "Primitive",
        hint: "What points become",
        section: Section::Own,
        label: Label::Always(Place::What, "{}"),
        values: Values::Words(Primitive::WORDS),
        shorthands: &[Shorthand {
            word: Word {
                word: "ewa",
                title: "EWA",
                hint: "Surfels that are filtered to the pixels: far surfaces are smooth and still",
            },
            given: &[
                ("primitive", Value::Word(Primitive::Surfel as usize)),
                (SurfelStyle::FILTER.key, Value::Word(SplatFilter::Ewa as usize)),
            ],
        }],
        ..Described::USUAL
    };

    /// This style with a change.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Shows each setting with its description to `edit`, and takes what that makes of it. The order is that of options
    /// in a help, and of rows in a section of the panel.
    pub fn edit(&mut self, edit: &mut dyn FnMut(&'static Described, Value) -> Value) {
        self.primitive.edit(&Self::PRIMITIVE, edit);
        self.surfels.edit(edit);
        self.codes.edit(edit);
        self.photos.edit(edit);
        self.light.edit(edit);
        self.levels.edit(edit);
        self.voxels.edit(edit);
        self.points.edit(edit);
        self.drawing.edit(edit);
        self.backdrop.edit(edit);
        self.colors.edit(&coloring::COLORS, edit);
    }

    /// Each setting with its description, as [`Style::edit`] shows them.
    pub fn settings(&self) -> Vec<(&'static Described, Value)> {
        let mut settings = Vec::new();
        let mut unchanged = *self;
        unchanged.edit(&mut |described, value| {
            settings.push((described, value));
            value
        });
        settings
    }

    /// The nearest style that files may hold.
    #[must_use]
    pub fn nearest(mut self) -> Self {
        self.edit(&mut |described, value| described.nearest(value));
        self
    }

    /// Whether it is so that a setting has an effect.
    pub fn is(&self, when: When) -> bool {
        match when {
            When::Always => true,
            When::Surfels => self.draws_surfels(),
            When::BlendedSurfels => self.blends_surfels(),
            When::MaskedSurfels => self.draws_surfels() && self.surfels.splatting.has_masks() && !self.filters_splats(),
            When::EnlargedSurfels => self.draws_surfels() && self.surfels.splatting.enlarges(),
            When::WholeSurfels => self.draws_whole_surfels(),
            When::GpuDisks => {
                self.is(When::Gpu)
                    && self.draws_surfels()
                    && !self.draws_sprites()
                    && self.surfels.splatting != Splatting::Regular
            }
            When::SurfelRadii => self.draws_surfels() || self.has_adaptive_points(),
            When::SurfelLevels => self.is(When::SurfelRadii) && self.levels.surfel_lod,
            When::CodedSurfels => self.draws_surfels() && self.codes.footprint != Footprint::Disks,
            When::DrawnPoints => self.draws_points(),
            When::Points => self.primitive == Primitive::Point,
            When::PointsOfPixels => {
                self.primitive == Primitive::Mesh || self.is(When::Points) && self.points.sizing == PointSizing::Pixels
            }
            When::PointsOfScene => self.is(When::Points) && self.points.sizing != PointSizing::Pixels,
            When::Voxels => self.primitive == Primitive::Voxel,
            When::Cells => self.draws_cells() || self.draws_codes(),
            When::Lit => self.primitive != Primitive::Point || self.points.light == PointLight::Normals,
            When::Deferred => self.is(When::Lit) && self.light.lighting.is_deferred(),
            When::Physical => self.is(When::Lit) && self.light.lighting == Lighting::Physical,
            When::Depths => self.leaves_depths(),
            When::EyeDome => self.leaves_depths() && self.light.eye_dome == EyeDome::On,
            When::KeyLight => self.is_shaded_with_distances() && self.light.rig.has_far_key(),
            When::Shadows => self.is(When::KeyLight) && self.light.shadows == OnOff::On,
            When::Shaded => self.is_shaded_with_depths(),
            When::Occluded => self.is_shaded_with_depths() && self.light.ao == OnOff::On,
            When::HasPhotographs => self.of_sequence.has_photographs,
            When::DrawsPhotographs => self.draws_photographs(),
            When::BlendsPhotographs => self.draws_photographs() && self.photos.mode == PhotoMode::Vdts,
            When::Gpu => self.drawing.renderer == RendererChoice::Gpu,
        }
    }

    /// Width and height that are drawn for a picture of `shown_px`; at least 1.
    pub fn drawn_px(&self, shown_px: [u32; 2]) -> [u32; 2] {
        shown_px.map(|edge| ((edge as f32 * self.drawing.resolution).round() as u32).max(1))
    }

    /// Whether surfaces have their colours from photographs.
    pub fn draws_photographs(&self) -> bool {
        self.of_sequence.has_photographs && self.photos.blended() > 0
    }

    /// This style with light on the finished surface: white from all sides, where light is none or falls on splats.
    /// Photographs are put on that surface, and have the light in them that they were taken in. Where they are to be
    /// lit anew, light that falls on splats becomes matt light.
    #[must_use]
    pub fn of_photographs(mut self) -> Self {
        if !self.light.lighting.is_deferred() {
            if self.photos.relight == PhotoRelight::Off || self.light.lighting == Lighting::Unlit {
                self.light.rig = LightRig::None;
            }
            self.light.lighting = Lighting::Lambert;
            self.light.ao = OnOff::Off;
            self.light.shadows = OnOff::Off;
        }
        self
    }

    /// Whether surfels are drawn, and blended at the surface that a pass of their depths finds.
    pub fn blends_surfels(&self) -> bool {
        self.draws_surfels() && self.surfels.splatting.sums_masks()
    }

    /// Whether surfels are drawn, round and one for each point: then normals and radii can be those of the screen.
    /// Ellipses and levels of detail are made of those of neighbours, and photographs see what is hidden.
    fn draws_whole_surfels(&self) -> bool {
        matches!(self.primitive, Primitive::Auto | Primitive::Surfel | Primitive::Sprite)
            && self.levels_kind().is_none()
            && !self.draws_photographs()
    }

    /// Whether surfels are drawn of what the picture shows, with normals and radii of the screen.
    pub fn has_screen_normals(&self) -> bool {
        let is_chosen = self.surfels.normals == NormalSource::Screen || self.shows_normal_errors();
        is_chosen && self.draws_whole_surfels()
    }

    /// Whether surfels have the colours of errors of such normals.
    pub fn shows_normal_errors(&self) -> bool {
        self.surfels.shown == SurfelColors::NormalErrors && self.draws_whole_surfels()
    }

    /// This style without light, which would change colours that mean something.
    #[must_use]
    pub(in crate::scene) fn of_normal_errors(mut self) -> Self {
        self.light.lighting = Lighting::Unlit;
        self.light.eye_dome = EyeDome::Off;
        self
    }

    /// How splats are filtered to the pixels that they are seen in.
    pub fn splat_filter(&self) -> SplatFilter {
        if self.blends_surfels() {
            self.surfels.filter
        } else {
            SplatFilter::Off
        }
    }

    /// Whether splats are filtered to the pixels that they are seen in.
    pub fn filters_splats(&self) -> bool {
        self.splat_filter() != SplatFilter::Off
    }

    /// Whether splats are drawn on squares that face the screen: those that reach beyond their disks in pixels are, as
    /// no square on their planes would hold them.
    pub fn draws_sprites(&self) -> bool {
        self.primitive == Primitive::Sprite || self.splat_filter() == SplatFilter::Clamp
    }

    /// What the GPU draws splats as: squares where the picture shows these.
    pub fn splat_geometry(&self) -> SplatGeometry {
        if self.surfels.splatting == Splatting::Regular {
            SplatGeometry::Quad
        } else {
            self.surfels.geometry
        }
    }

    /// How splats fall off: the filter is a convolution of Gaussians, and so are the masks of points.
    pub fn kernel(&self) -> Kernel {
        if self.is(When::MaskedSurfels) {
            self.surfels.kernel
        } else {
            Kernel::Gaussian
        }
    }

    /// Whether surfels are left out that face away. Points have no back.
    pub fn culls_back_faces(&self) -> bool {
        self.primitive != Primitive::Point && matches!(self.surfels.back_faces, BackFaces::Auto | BackFaces::Culled)
    }

    /// Whether the light shows which side of a surfel is seen.
    pub fn darkens_back_faces(&self) -> bool {
        self.surfels.back_faces == BackFaces::Darker && self.light.lighting != Lighting::Unlit
    }

    /// Whether points are drawn as surfels, round or not.
    pub fn draws_surfels(&self) -> bool {
        matches!(
            self.primitive,
            Primitive::Auto | Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite
        )
    }

    /// Whether points are drawn that stay points: all of them, or those that belong to no triangle.
    pub fn draws_points(&self) -> bool {
        matches!(self.primitive, Primitive::Point | Primitive::Mesh)
    }

    /// How points are drawn: those between triangles have neither radii nor light nor masks.
    pub fn drawn_points(&self) -> PointStyle {
        if self.primitive != Primitive::Mesh {
            return self.points;
        }
        PointStyle {
            sizing: PointSizing::Pixels,
            shape: match self.points.shape {
                PointShape::Square => PointShape::Square,
                PointShape::Disk | PointShape::Gaussian => PointShape::Disk,
            },
            light: PointLight::None,
            ..self.points
        }
    }

    /// Whether points are drawn as points, as large as their surfels are.
    pub fn has_adaptive_points(&self) -> bool {
        self.primitive == Primitive::Point && self.points.sizing == PointSizing::Adaptive
    }

    /// Whether points are drawn as points on whose normals light falls.
    pub fn lights_points(&self) -> bool {
        self.primitive == Primitive::Point
            && self.points.light == PointLight::Normals
            && self.light.lighting != Lighting::Unlit
    }

    /// Whether points are drawn as points, of which radii or normals are asked for.
    pub fn has_points_with_shapes(&self) -> bool {
        self.has_adaptive_points() || self.lights_points()
    }

    /// Whether depths are drawn first, and then what lies at them is blended by its masks.
    pub fn blends_at_depths(&self) -> bool {
        if self.primitive == Primitive::Point {
            self.points.shape == PointShape::Gaussian
        } else {
            self.draws_surfels() && self.surfels.splatting.has_visibility_pass()
        }
    }

    /// The levels of detail that are drawn; `None` where all points are.
    pub fn levels_kind(&self) -> Option<LevelsKind> {
        let of_surfels = self.levels.structure.kind();
        match self.primitive {
            Primitive::Auto | Primitive::Surfel if self.draws_codes() => Some(LevelsKind::Codes),
            Primitive::Auto | Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite | Primitive::Point => {
                self.is(When::SurfelLevels).then_some(of_surfels)
            }
            Primitive::Voxel if self.lights_voxels_by_normals() => Some(LevelsKind::LitCubes),
            Primitive::Voxel => Some(LevelsKind::Cubes),
            Primitive::Mesh => None,
        }
    }

    /// Whether what is drawn leaves depths, by which pictures can be shaded.
    pub fn leaves_depths(&self) -> bool {
        !self.draws_surfels() || self.surfels.splatting != Splatting::NoDepth
    }

    /// Whether light falls on the blended surface, which is somewhere.
    pub fn is_shaded_with_distances(&self) -> bool {
        let shows_depths = self.draws_surfels() && self.surfels.splatting == Splatting::Visibility;
        self.is(When::Deferred) && self.leaves_depths() && !shows_depths
    }

    /// The same, and there are depths that say how its surroundings are: points are steps of the surface.
    pub fn is_shaded_with_depths(&self) -> bool {
        self.is_shaded_with_distances() && self.primitive != Primitive::Point
    }

    /// Whether what is drawn are cells of an octree.
    pub fn draws_cells(&self) -> bool {
        self.levels_kind().is_some_and(|kind| kind != LevelsKind::Codes)
    }

    /// This style with what was decided in place of who may choose: the processor draws, or a graphics card.
    #[must_use]
    pub fn drawn_by(&self, is_processor: bool) -> Self {
        let mut drawn = *self;
        drawn.drawing.renderer = if is_processor {
            RendererChoice::Cpu
        } else {
            RendererChoice::Gpu
        };
        drawn
    }

    /// Whether voxels are drawn whose light falls on normals.
    pub fn lights_voxels_by_normals(&self) -> bool {
        self.primitive == Primitive::Voxel
            && self.voxels.light == VoxelLight::Normals
            && self.light.lighting != Lighting::Unlit
    }

    /// What the octree is to be divided for: surfels and points that it is drawn as have no use for leaves as large as
    /// the spacing.
    pub fn octree_stop(&self) -> StopCriterion {
        match self.primitive {
            Primitive::Auto | Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite | Primitive::Point => {
                self.levels.stop.of_surfels()
            }
            Primitive::Voxel | Primitive::Mesh => self.levels.stop,
        }
    }

    /// Whether surfels are drawn from the byte code of an octree; [`LevelStyle::lod`] says how finely. While something
    /// is clipped the same surfels are drawn as disks: a code cannot be cut.
    pub fn draws_codes(&self) -> bool {
        self.has_footprints() && self.codes.footprint != Footprint::Disks
    }

    /// Whether [`CodeStyle::footprint`] has an effect: the processor alone draws byte codes. Who draws has to be
    /// decided before: see [`Style::drawn_by`]. Where shading is deferred there are none, as a code is lit by a table
    /// of normals, nor of ellipses, sprites, filtered splats or other kernels.
    pub fn has_footprints(&self) -> bool {
        self.draws_surfels()
            && !self.filters_splats()
            && self.surfels.kernel == Kernel::Gaussian
            && !matches!(self.primitive, Primitive::Ellipse | Primitive::Sprite)
            && self.drawing.renderer == RendererChoice::Cpu
            && self.surfels.splatting.has_visibility_pass()
            && !self.light.lighting.is_deferred()
            && !self.draws_photographs()
    }
}

impl Default for Style {
    fn default() -> Self {
        Self {
            primitive: Primitive::Auto,
            colors: Coloring::default(),
            drawing: DrawingStyle::default(),
            surfels: SurfelStyle::default(),
            points: PointStyle::default(),
            voxels: VoxelStyle::default(),
            levels: LevelStyle::default(),
            codes: CodeStyle::default(),
            light: LightStyle::default(),
            photos: PhotoStyle::default(),
            backdrop: Backdrop::default(),
            of_sequence: OfSequence::default(),
        }
    }
}
