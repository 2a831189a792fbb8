//! Conditions on a render mode: when settings have an effect, and queries of passes.

use super::describe::Conditions;
use super::{
    EyeDome, Footprint, Lighting, OnOff, PhotoMode, PointLight, PointSizing, Primitive, RendererChoice, Splatting,
    Style,
};

/// For the rows of settings.
impl<C: Copy> Conditions for Style<C> {
    fn has_eye_dome(&self) -> bool {
        self.leaves_depths() && self.light.eye_dome == EyeDome::On
    }

    fn has_photos(&self) -> bool {
        self.of_sequence.has_photos
    }

    fn draws_view_dependent_textures(&self) -> bool {
        self.draws_photos() && self.photos.mode == PhotoMode::Vdts
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
        self.draws_surfels() && self.codes.footprint != Footprint::Disks
    }

    fn has_visibility_squares(&self) -> bool {
        self.has_visibility_squares()
    }

    fn blends_surfels(&self) -> bool {
        self.blends_surfels()
    }

    fn draws_disks_on_gpu(&self) -> bool {
        self.is_drawn_on_gpu()
            && self.draws_surfels()
            && !self.draws_sprites()
            && self.surfels.splatting != Splatting::Regular
    }

    fn draws_photos(&self) -> bool {
        self.draws_photos()
    }

    fn draws_points(&self) -> bool {
        self.draws_points()
    }

    fn draws_surfels(&self) -> bool {
        self.draws_surfels()
    }

    fn draws_voxels(&self) -> bool {
        self.primitive == Primitive::Voxel
    }

    fn draws_whole_surfels(&self) -> bool {
        self.draws_whole_surfels()
    }

    fn has_key_light(&self) -> bool {
        self.is_shaded_with_distances() && self.light.rig.has_far_key()
    }

    fn has_masks(&self) -> bool {
        self.draws_surfels() && self.surfels.splatting.has_masks() && !self.filters_splats()
    }

    fn has_points_of_pixels(&self) -> bool {
        self.primitive == Primitive::Mesh || self.is_of_points() && self.points.sizing == PointSizing::Pixels
    }

    fn has_shadows(&self) -> bool {
        self.has_key_light() && self.light.shadows == OnOff::On
    }

    fn has_surfel_levels(&self) -> bool {
        self.has_surfel_radii() && self.levels.surfel_lod
    }

    fn has_surfel_radii(&self) -> bool {
        self.draws_surfels() || self.has_adaptive_points()
    }

    fn is_drawn_on_gpu(&self) -> bool {
        self.drawing.renderer == RendererChoice::Gpu
    }

    fn is_lit(&self) -> bool {
        self.primitive != Primitive::Point || self.points.light == PointLight::Normals
    }

    fn is_lit_deferred(&self) -> bool {
        self.is_lit() && self.light.lighting.is_deferred()
    }

    fn is_lit_physically(&self) -> bool {
        self.is_lit() && self.light.lighting == Lighting::Physical
    }

    fn is_occluded(&self) -> bool {
        self.is_shaded_with_depths() && self.light.ao == OnOff::On
    }

    fn is_of_points(&self) -> bool {
        self.primitive == Primitive::Point
    }

    fn is_shaded_with_depths(&self) -> bool {
        self.is_shaded_with_depths()
    }

    fn leaves_depths(&self) -> bool {
        self.leaves_depths()
    }
}
