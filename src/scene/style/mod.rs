//! Every choice a person has about a picture, in groups, and how it is drawn with nothing left open.
//!
//! [`Settings`] are what a person chooses: they are kept, and may be left open. [`Settings::resolved`] makes a
//! [`Style`] of them, which leaves nothing open: packets and renderers know no other. What is derived for one picture
//! alone is in [`PacketParams`](crate::scene::PacketParams).
//!
//!  Each is described beside its field (`describe.rs`).
//!
//! A new setting is one row in the file of its group, and its use: panel, command line, files, undo and labels of
//! benchmarks read the row.

mod backdrop;
mod background;
mod choice;
mod choices;
mod codes;
pub mod coloring;
mod conditions;
pub mod describe;
mod drawing;
mod levels;
mod light;
mod of_sequence;
mod parse_error;
mod photos;
mod points;
mod resolved;
mod settings;
mod shorthands;
mod surfels;
#[cfg(test)]
mod tests;
mod voxels;

pub use backdrop::Backdrop;
pub use background::Background;
pub(super) use background::luma;
pub use choice::{Automatic, Choice};
pub(crate) use choices::choices;
pub use codes::{CodeStyle, Footprint, NormalBits, OffsetBits};
pub use drawing::{Antialiasing, DrawingSettings, DrawingStyle, Primitive, RendererChoice, Strategy};
pub use levels::{LevelStructure, LevelStyle};
pub use light::{EyeDome, LightRig, LightSettings, LightStyle, Lighting, OnOff};
pub use of_sequence::OfSequence;
pub use parse_error::ParseChoiceError;
pub use photos::{PhotoClipping, PhotoGains, PhotoHoles, PhotoMode, PhotoRelight, PhotoStyle};
pub use points::{PointLight, PointShape, PointSizing, PointStyle};
pub use settings::Settings;
pub use surfels::{
    BackFaces, Kernel, NormalSource, SplatFilter, SplatGeometry, Splatting, SurfelColors, SurfelSettings, SurfelStyle,
};
pub use voxels::{VoxelLight, VoxelStyle};

use crate::levels::LevelsKind;
use crate::levels::octree::StopCriterion;
use crate::sequence::Coloring;
use describe::Conditions as _;

/// How a picture is drawn: the [`Settings`] with nothing left open. Frames are asked for [`Coloring`], which says what
/// to do where they lack colours; packets have [`DrawSettings`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style<C = Coloring> {
    /// What points become.
    pub primitive: Primitive,
    /// Which colours are asked of frames; which they have, [`Paint`](crate::sequence::Paint) says of each.
    pub colors: C,
    /// Who draws, and how many pixels.
    pub drawing: DrawingStyle,
    /// How surfels are drawn.
    pub surfels: SurfelStyle,
    /// How points are drawn that stay points.
    pub points: PointStyle,
    /// How voxels are drawn.
    pub voxels: VoxelStyle,
    /// How deep the octree goes, and which of its cells are drawn.
    pub levels: LevelStyle,
    /// How surfels are drawn from byte codes of the octree.
    pub codes: CodeStyle,
    /// Light that falls on surfaces, and light from depths.
    pub light: LightStyle,
    /// How photographs are put on surfaces.
    pub photos: PhotoStyle,
    /// What is shown beside the cloud.
    pub backdrop: Backdrop,
    /// What belongs to one sequence.
    pub of_sequence: OfSequence,
}

/// The style of a packet, whose records have their colours. Renderers know no other.
pub type DrawSettings = Style<Painted>;

/// Colours that are in the records of a packet, so that nothing is asked of frames any more.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Painted;

impl Style {
    /// This style for records that have their colours.
    pub fn painted(&self) -> DrawSettings {
        let Self {
            primitive,
            colors: _,
            drawing,
            surfels,
            points,
            voxels,
            levels,
            codes,
            light,
            photos,
            backdrop,
            of_sequence,
        } = *self;
        Style {
            primitive,
            colors: Painted,
            drawing,
            surfels,
            points,
            voxels,
            levels,
            codes,
            light,
            photos,
            backdrop,
            of_sequence,
        }
    }
}

impl<C: Copy> Style<C> {
    /// This style with a change.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
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
    pub fn draws_whole_surfels(&self) -> bool {
        matches!(self.primitive, Primitive::Surfel | Primitive::Sprite)
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
        if self.has_masks() {
            self.surfels.kernel
        } else {
            Kernel::Gaussian
        }
    }

    /// Whether surfels are left out that face away. Points have no back.
    pub fn culls_back_faces(&self) -> bool {
        self.primitive != Primitive::Point && self.surfels.back_faces == BackFaces::Culled
    }

    /// Whether the light shows which side of a surfel is seen.
    pub fn darkens_back_faces(&self) -> bool {
        self.surfels.back_faces == BackFaces::Darker && self.light.lighting != Lighting::Unlit
    }

    /// Whether points are drawn as surfels, round or not.
    pub fn draws_surfels(&self) -> bool {
        matches!(
            self.primitive,
            Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite
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
            Primitive::Surfel if self.draws_codes() => Some(LevelsKind::Codes),
            Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite | Primitive::Point => {
                self.has_surfel_levels().then_some(of_surfels)
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
        self.is_lit_deferred() && self.leaves_depths() && !shows_depths
    }

    /// The same, and there are depths that say how its surroundings are: points are steps of the surface.
    pub fn is_shaded_with_depths(&self) -> bool {
        self.is_shaded_with_distances() && self.primitive != Primitive::Point
    }

    /// Whether what is drawn are cells of an octree.
    pub fn draws_cells(&self) -> bool {
        self.levels_kind().is_some_and(|kind| kind != LevelsKind::Codes)
    }

    /// This style where the processor draws, or a graphics card.
    #[must_use]
    pub fn drawn_by(&self, is_processor: bool) -> Self {
        self.with(|style| style.drawing.renderer = RendererChoice::of(is_processor))
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
            Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite | Primitive::Point => {
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

    /// Whether [`CodeStyle::footprint`] has an effect: the processor alone draws byte codes. Where shading is deferred
    /// there are none, as a code is lit by a table of normals, nor of ellipses, sprites, filtered splats or other
    /// kernels.
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
