//! Render settings in groups, and the style that they resolve to with nothing left open.
//!
//! [`Settings`] are the user's choices: they are persisted, and may be left open. [`Settings::resolved`] resolves them
//! to a [`Style`], which leaves nothing open: packets and renderers know no other. Values derived for a single image
//! are in [`PacketParams`](crate::scene::PacketParams).
//!
//!  Each is described next to its field (`describe.rs`).
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
mod estimation;
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
pub use estimation::{EstimationStyle, NormalFit};
pub use levels::{LevelStructure, LevelStyle};
pub use light::{EyeDome, LightRig, LightSettings, LightStyle, Lighting, OnOff};
pub use of_sequence::OfSequence;
pub use parse_error::ParseChoiceError;
pub use photos::{PhotoClipping, PhotoGains, PhotoHoles, PhotoMode, PhotoRelight, PhotoStyle};
pub use points::{PointLight, PointShape, PointSizing, PointStyle};
pub use settings::Settings;
pub use surfels::{
    BackFaces, Kernel, NormalSource, SplatFilter, SplatGeometry, Splatting, SurfelColors, SurfelSettings, SurfelStyle,
    VisibilityShape,
};
pub use voxels::{VoxelLight, VoxelStyle};

use crate::levels::LevelsKind;
use crate::levels::octree::StopCriterion;
use crate::sequence::Coloring;
use describe::Conditions as _;

/// Resolved render style of an image: the [`Settings`] with nothing left open. Frames are queried with [`Coloring`],
/// which defines the fallback where they lack colours; packets have [`DrawSettings`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style<C = Coloring> {
    /// Primitive that points are rendered as.
    pub primitive: Primitive,
    /// Colours requested from frames; [`Paint`](crate::sequence::Paint) reports which each of them has.
    pub colors: C,
    /// Drawing style: the renderer, and the number of pixels.
    pub drawing: DrawingStyle,
    /// Surfel style.
    pub surfels: SurfelStyle,
    /// Style of points that stay points.
    pub points: PointStyle,
    /// Voxel style.
    pub voxels: VoxelStyle,
    /// Level-of-detail style: the octree depth, and the selection of its cells that are drawn.
    pub levels: LevelStyle,
    /// Rendering style of surfels from byte codes of the octree.
    pub codes: CodeStyle,
    /// Light that falls on surfaces, and light from depths.
    pub light: LightStyle,
    /// View-dependent texturing style.
    pub photos: PhotoStyle,
    /// Estimation style: how normals are estimated, and whether points are smoothed.
    pub estimation: EstimationStyle,
    /// Backdrop: the surroundings of the cloud.
    pub backdrop: Backdrop,
    /// Style data that belongs to one sequence.
    pub of_sequence: OfSequence,
}

/// The style of a packet, whose records have their colours. Renderers know no other.
pub type DrawSettings = Style<Painted>;

/// Colours that are in the records of a packet, so that frames are no longer queried.
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
            estimation,
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
            estimation,
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

    /// Width and height drawn for an image of `shown_px`; at least 1.
    pub fn drawn_px(&self, shown_px: [u32; 2]) -> [u32; 2] {
        shown_px.map(|edge| ((edge as f32 * self.drawing.resolution).round() as u32).max(1))
    }

    /// Returns true if surfaces take their colours from posed images.
    pub fn draws_photos(&self) -> bool {
        self.of_sequence.has_photos && self.photos.blended() > 0
    }

    /// Returns this style with lighting on the finished surface: white from all sides, where lighting is off or falls
    /// on splats. Posed images are projected onto that surface, and have the light in them that they were taken in.
    /// Where they are to be relit, light that falls on splats becomes matt light.
    #[must_use]
    pub fn of_photos(mut self) -> Self {
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

    /// Returns true if surfels are drawn from back to front.
    pub fn sorts_surfels(&self) -> bool {
        self.draws_surfels() && self.surfels.splatting == Splatting::Sorted
    }

    /// Returns true if surfels are drawn, and blended at the surface that a depth pass finds.
    pub fn blends_surfels(&self) -> bool {
        self.draws_surfels() && self.surfels.splatting.sums_masks()
    }

    /// Returns true if surfels are drawn whole, round and one for each point: then normals and radii can be in screen
    /// space. Ellipses and levels of detail are built from the neighbours', and posed images see hidden surfaces.
    pub fn draws_whole_surfels(&self) -> bool {
        matches!(self.primitive, Primitive::Surfel | Primitive::Sprite)
            && self.levels_kind().is_none()
            && !self.draws_photos()
    }

    /// Returns true if surfels are drawn from the visible points, with screen-space normals and radii.
    pub fn has_screen_normals(&self) -> bool {
        let is_chosen = self.surfels.normals == NormalSource::Screen || self.shows_normal_errors();
        is_chosen && self.draws_whole_surfels()
    }

    /// Returns true if surfels are coloured by the error of screen-space normals.
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

    /// Returns the splat filter: how splats are filtered to the pixels that they are seen in.
    pub fn splat_filter(&self) -> SplatFilter {
        if self.blends_surfels() {
            self.surfels.filter
        } else {
            SplatFilter::Off
        }
    }

    /// Returns true if splats are filtered to the pixels that they are seen in.
    pub fn filters_splats(&self) -> bool {
        self.splat_filter() != SplatFilter::Off
    }

    /// Returns true if splats are drawn as screen-facing sprites: those that reach beyond their disks in pixels are, as
    /// no square on their planes would contain them.
    pub fn draws_sprites(&self) -> bool {
        self.primitive == Primitive::Sprite || self.splat_filter() == SplatFilter::Clamp
    }

    /// Returns the geometry that the GPU draws splats as: squares where the image shows these.
    pub fn splat_geometry(&self) -> SplatGeometry {
        if self.surfels.splatting == Splatting::Regular || self.visibility_shape() == VisibilityShape::Square {
            SplatGeometry::Quad
        } else {
            self.surfels.geometry
        }
    }

    /// Returns true if the visibility pass draws splats in their planes, which have squares around them.
    pub fn has_visibility_squares(&self) -> bool {
        let is_coded = self.levels_kind() == Some(LevelsKind::Codes);
        self.draws_surfels() && self.surfels.splatting.has_visibility_pass() && !self.draws_sprites() && !is_coded
    }

    /// Returns the shape of splats in the visibility pass.
    pub fn visibility_shape(&self) -> VisibilityShape {
        if self.has_visibility_squares() {
            self.surfels.visibility_shape
        } else {
            VisibilityShape::Disk
        }
    }

    /// Returns the falloff kernel of splats: the filter is a convolution of Gaussians, and so are the masks of points.
    pub fn kernel(&self) -> Kernel {
        if self.has_masks() {
            self.surfels.kernel
        } else {
            Kernel::Gaussian
        }
    }

    /// Returns true if back-face culling skips surfels that face away. Points have no back.
    pub fn culls_back_faces(&self) -> bool {
        // Points have no back: their normals shade them, and cull neither points nor nodes.
        self.primitive != Primitive::Point && self.surfels.back_faces == BackFaces::Culled
    }

    /// Returns true if the nodes of byte codes are drawn as pixels.
    pub fn has_coded_pixels(&self) -> bool {
        self.codes.footprint == Footprint::Pixels
    }

    /// Returns true if lighting shows which side of a surfel is seen.
    pub fn darkens_back_faces(&self) -> bool {
        self.surfels.back_faces == BackFaces::Darker && self.light.lighting != Lighting::Unlit
    }

    /// Returns true if points are drawn as surfels, round or not.
    pub fn draws_surfels(&self) -> bool {
        matches!(
            self.primitive,
            Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite
        )
    }

    /// Returns true if points are drawn that stay points: all of them, or those that belong to no triangle.
    pub fn draws_points(&self) -> bool {
        matches!(self.primitive, Primitive::Point | Primitive::Mesh)
    }

    /// Returns the point style in use: points between triangles have neither radii nor light nor masks.
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

    /// Returns true if points are drawn as points with adaptive size, as large as their surfels are.
    pub fn has_adaptive_points(&self) -> bool {
        self.primitive == Primitive::Point && self.points.sizing == PointSizing::Adaptive
    }

    /// Returns true if points are drawn as points that are lit by their normals.
    pub fn lights_points(&self) -> bool {
        self.primitive == Primitive::Point
            && self.points.light == PointLight::Normals
            && self.light.lighting != Lighting::Unlit
    }

    /// Returns true if points are drawn as points whose radii or normals are needed.
    pub fn has_points_with_shapes(&self) -> bool {
        self.has_adaptive_points() || self.lights_points()
    }

    /// Returns true if a depth pass is drawn first, and then splats at the depths are blended by their masks.
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

    /// Returns true if the content writes depths, by which images can be shaded.
    pub fn leaves_depths(&self) -> bool {
        !self.draws_surfels() || self.surfels.splatting.has_depths()
    }

    /// Returns true if the blended surface, which has a position, is lit.
    pub fn is_shaded_with_distances(&self) -> bool {
        let shows_depths = self.draws_surfels() && self.surfels.splatting == Splatting::Visibility;
        self.is_lit_deferred() && self.leaves_depths() && !shows_depths
    }

    /// Returns true if the blended surface is lit and there are depths that describe its surroundings: points are steps
    /// of the surface.
    pub fn is_shaded_with_depths(&self) -> bool {
        self.is_shaded_with_distances() && self.primitive != Primitive::Point
    }

    /// Returns true if octree cells are drawn.
    pub fn draws_cells(&self) -> bool {
        self.levels_kind().is_some_and(|kind| kind != LevelsKind::Codes)
    }

    /// Returns this style as drawn by the CPU or by a GPU.
    #[must_use]
    pub fn drawn_by(&self, is_processor: bool) -> Self {
        self.with(|style| style.drawing.renderer = RendererChoice::of(is_processor))
    }

    /// Returns true if voxels are drawn that are lit by normals.
    pub fn lights_voxels_by_normals(&self) -> bool {
        self.primitive == Primitive::Voxel
            && self.voxels.light == VoxelLight::Normals
            && self.light.lighting != Lighting::Unlit
    }

    /// Returns the stop criterion of the octree: surfels and points drawn from it have no use for leaves as large as
    /// the spacing.
    pub fn octree_stop(&self) -> StopCriterion {
        match self.primitive {
            Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite | Primitive::Point => {
                self.levels.stop.of_surfels()
            }
            Primitive::Voxel | Primitive::Mesh => self.levels.stop,
        }
    }

    /// Returns true if surfels are drawn from the byte code of an octree; [`LevelStyle::lod`] controls how finely.
    /// While something is clipped all points are drawn as disks: a code cannot be cut.
    pub fn draws_codes(&self) -> bool {
        self.has_footprints() && self.codes.footprint != Footprint::Disks
    }

    /// Returns true if [`CodeStyle::footprint`] has an effect. Byte codes are not drawn with deferred shading, as a
    /// code is lit by a table of normals, nor as ellipses, sprites, filtered splats or with other kernels.
    pub fn has_footprints(&self) -> bool {
        self.draws_surfels()
            && !self.filters_splats()
            && self.surfels.kernel == Kernel::Gaussian
            && !matches!(self.primitive, Primitive::Ellipse | Primitive::Sprite)
            && self.surfels.splatting.has_visibility_pass()
            && !self.light.lighting.is_deferred()
            && !self.draws_photos()
    }
}
