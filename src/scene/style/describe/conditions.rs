//! Questions that the rows of settings ask of what is drawn.

/// Answers of a style to the rows of its own settings. A trait, as rows are parts of the style: naming its type there
/// would be a circle of imports.
pub trait Conditions {
    /// See `Style::asks_for_codes`.
    fn asks_for_codes(&self) -> bool;
    /// See `Style::blends_surfels`.
    fn blends_surfels(&self) -> bool;
    /// See `Style::draws_disks_on_gpu`.
    fn draws_disks_on_gpu(&self) -> bool;
    /// See `Style::draws_photographs`.
    fn draws_photographs(&self) -> bool;
    /// See `Style::draws_points`.
    fn draws_points(&self) -> bool;
    /// See `Style::draws_surfels`.
    fn draws_surfels(&self) -> bool;
    /// See `Style::draws_voxels`.
    fn draws_voxels(&self) -> bool;
    /// See `Style::draws_whole_surfels`.
    fn draws_whole_surfels(&self) -> bool;
    /// See `Style::has_key_light`.
    fn has_key_light(&self) -> bool;
    /// See `Style::has_masks`.
    fn has_masks(&self) -> bool;
    /// See `Style::has_points_of_pixels`.
    fn has_points_of_pixels(&self) -> bool;
    /// See `Style::has_shadows`.
    fn has_shadows(&self) -> bool;
    /// See `Style::has_surfel_levels`.
    fn has_surfel_levels(&self) -> bool;
    /// See `Style::has_surfel_radii`.
    fn has_surfel_radii(&self) -> bool;
    /// See `Style::is_drawn_on_gpu`.
    fn is_drawn_on_gpu(&self) -> bool;
    /// See `Style::is_lit`.
    fn is_lit(&self) -> bool;
    /// See `Style::is_lit_deferred`.
    fn is_lit_deferred(&self) -> bool;
    /// See `Style::is_lit_physically`.
    fn is_lit_physically(&self) -> bool;
    /// See `Style::is_occluded`.
    fn is_occluded(&self) -> bool;
    /// See `Style::is_of_points`.
    fn is_of_points(&self) -> bool;
    /// See `Style::is_shaded_with_depths`.
    fn is_shaded_with_depths(&self) -> bool;
    /// See `Style::leaves_depths`.
    fn leaves_depths(&self) -> bool;
    /// See `Style::draws_cells`.
    fn draws_cells(&self) -> bool;
    /// See `Style::draws_codes`.
    fn draws_codes(&self) -> bool;
    /// Eye-dome lighting is on, and there are depths for it.
    fn has_eye_dome(&self) -> bool;
    /// The sequence has photographs.
    fn has_photographs(&self) -> bool;
    /// Photographs are blended by the direction of the view.
    fn draws_view_dependent_textures(&self) -> bool;
    /// Points are drawn whose size is a length in the scene.
    fn has_points_of_lengths(&self) -> bool;
    /// Surfels are drawn by a splatting that enlarges them.
    fn enlarges_surfels(&self) -> bool;
}
