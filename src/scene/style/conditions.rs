//! What is so of a way to draw: when settings have an effect, and what passes ask.

use super::describe::Conditions;
use super::{
    EyeDome, Footprint, Lighting, OnOff, PhotoMode, PointLight, PointSizing, Primitive, RendererChoice, Splatting,
    Style,
};

impl Style {
    /// Whether surfels are drawn, and fall off towards their rims as a setting says.
    pub fn has_masks(&self) -> bool {
        self.draws_surfels() && self.surfels.splatting.has_masks() && !self.filters_splats()
    }

    /// Whether the GPU draws surfels on their planes, and what is beside their disks is not seen.
    pub fn draws_disks_on_gpu(&self) -> bool {
        self.is_drawn_on_gpu()
            && self.draws_surfels()
            && !self.draws_sprites()
            && self.surfels.splatting != Splatting::Regular
    }

    /// Whether what is drawn has the radii of surfels: these, or adaptive points.
    pub fn has_surfel_radii(&self) -> bool {
        self.draws_surfels() || self.has_adaptive_points()
    }

    /// Whether it has, and one of them stands for others.
    pub fn has_surfel_levels(&self) -> bool {
        self.has_surfel_radii() && self.levels.surfel_lod
    }

    /// Whether surfels are drawn, from byte codes if the processor draws.
    pub fn asks_for_codes(&self) -> bool {
        self.draws_surfels() && self.codes.footprint != Footprint::Disks
    }

    /// Whether all points are drawn as points.
    pub fn is_of_points(&self) -> bool {
        self.primitive == Primitive::Point
    }

    /// Whether points are drawn whose size is one in pixels.
    pub fn has_points_of_pixels(&self) -> bool {
        self.primitive == Primitive::Mesh || self.is_of_points() && self.points.sizing == PointSizing::Pixels
    }

    /// Whether voxels are drawn.
    pub fn draws_voxels(&self) -> bool {
        self.primitive == Primitive::Voxel
    }

    /// Whether light may fall on what is drawn: surfels, voxels, triangles, or points with normals.
    pub fn is_lit(&self) -> bool {
        self.primitive != Primitive::Point || self.points.light == PointLight::Normals
    }

    /// Whether light falls on the blended surface.
    pub fn is_lit_deferred(&self) -> bool {
        self.is_lit() && self.light.lighting.is_deferred()
    }

    /// Whether it falls on a material, and from an environment.
    pub fn is_lit_physically(&self) -> bool {
        self.is_lit() && self.light.lighting == Lighting::Physical
    }

    /// Whether the first of the lights that fall on the blended surface is far away.
    pub fn has_key_light(&self) -> bool {
        self.is_shaded_with_distances() && self.light.rig.has_far_key()
    }

    /// Whether that light casts shadows.
    pub fn has_shadows(&self) -> bool {
        self.has_key_light() && self.light.shadows == OnOff::On
    }

    /// Whether what is near a place of the blended surface keeps light from it.
    pub fn is_occluded(&self) -> bool {
        self.is_shaded_with_depths() && self.light.ao == OnOff::On
    }

    /// Whether a graphics card draws.
    pub fn is_drawn_on_gpu(&self) -> bool {
        self.drawing.renderer == RendererChoice::Gpu
    }
}

/// For the rows of settings.
impl Conditions for Style {
    fn has_eye_dome(&self) -> bool {
        self.leaves_depths() && self.light.eye_dome == EyeDome::On
    }

    fn has_photographs(&self) -> bool {
        self.of_sequence.has_photographs
    }

    fn draws_view_dependent_textures(&self) -> bool {
        self.draws_photographs() && self.photos.mode == PhotoMode::Vdts
    }

    fn has_points_of_lengths(&self) -> bool {
        self.is_of_points() && self.points.sizing != PointSizing::Pixels
    }

    fn enlarges_surfels(&self) -> bool {
        self.draws_surfels() && self.surfels.splatting.enlarges()
    }

    fn draws_cells(&self) -> bool {
        self.draws_cells()
    }

    fn draws_codes(&self) -> bool {
        self.draws_codes()
    }

    fn asks_for_codes(&self) -> bool {
        self.asks_for_codes()
    }

    fn blends_surfels(&self) -> bool {
        self.blends_surfels()
    }

    fn draws_disks_on_gpu(&self) -> bool {
        self.draws_disks_on_gpu()
    }

    fn draws_photographs(&self) -> bool {
        self.draws_photographs()
    }

    fn draws_points(&self) -> bool {
        self.draws_points()
    }

    fn draws_surfels(&self) -> bool {
        self.draws_surfels()
    }

    fn draws_voxels(&self) -> bool {
        self.draws_voxels()
    }

    fn draws_whole_surfels(&self) -> bool {
        self.draws_whole_surfels()
    }

    fn has_key_light(&self) -> bool {
        self.has_key_light()
    }

    fn has_masks(&self) -> bool {
        self.has_masks()
    }

    fn has_points_of_pixels(&self) -> bool {
        self.has_points_of_pixels()
    }

    fn has_shadows(&self) -> bool {
        self.has_shadows()
    }

    fn has_surfel_levels(&self) -> bool {
        self.has_surfel_levels()
    }

    fn has_surfel_radii(&self) -> bool {
        self.has_surfel_radii()
    }

    fn is_drawn_on_gpu(&self) -> bool {
        self.is_drawn_on_gpu()
    }

    fn is_lit(&self) -> bool {
        self.is_lit()
    }

    fn is_lit_deferred(&self) -> bool {
        self.is_lit_deferred()
    }

    fn is_lit_physically(&self) -> bool {
        self.is_lit_physically()
    }

    fn is_occluded(&self) -> bool {
        self.is_occluded()
    }

    fn is_of_points(&self) -> bool {
        self.is_of_points()
    }

    fn is_shaded_with_depths(&self) -> bool {
        self.is_shaded_with_depths()
    }

    fn leaves_depths(&self) -> bool {
        self.leaves_depths()
    }
}
