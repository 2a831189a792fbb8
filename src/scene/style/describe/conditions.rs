//! Conditions of the rows of settings on the style.

/// Answers of a style to the rows of its own settings. A trait, as rows are parts of the style: naming its type there
/// would be a circle of imports.
pub trait Conditions {
    /// True if surfels are drawn, from byte codes where the style allows.
    fn asks_for_codes(&self) -> bool;
    /// See `Style::has_visibility_squares`.
    fn has_visibility_squares(&self) -> bool;

    /// See `Style::blends_surfels`.
    fn blends_surfels(&self) -> bool;
    /// Returns true if the GPU draws surfels on their planes, and pixels outside their disks are not seen.
    fn draws_disks_on_gpu(&self) -> bool;
    /// See `Style::draws_photos`.
    fn draws_photos(&self) -> bool;
    /// See `Style::draws_points`.
    fn draws_points(&self) -> bool;
    /// See `Style::draws_surfels`.
    fn draws_surfels(&self) -> bool;
    /// True if voxels are drawn.
    fn draws_voxels(&self) -> bool;
    /// See `Style::draws_whole_surfels`.
    fn draws_whole_surfels(&self) -> bool;
    /// True if the first of the lights that fall on the blended surface is far away.
    fn has_key_light(&self) -> bool;
    /// True if surfels are drawn, and fall off towards their edges by a setting.
    fn has_masks(&self) -> bool;
    /// True if points are drawn whose size is one in pixels.
    fn has_points_of_pixels(&self) -> bool;
    /// True if that light casts shadows.
    fn has_shadows(&self) -> bool;
    /// True if it has, and one of them stands for others.
    fn has_surfel_levels(&self) -> bool;
    /// True if the content has the radii of surfels: surfels or adaptive points.
    fn has_surfel_radii(&self) -> bool;
    /// Returns true if a GPU draws.
    fn is_drawn_on_gpu(&self) -> bool;
    /// True if the content can be lit: surfels, voxels, triangles, or points with normals.
    fn is_lit(&self) -> bool;
    /// True if the blended surface is lit.
    fn is_lit_deferred(&self) -> bool;
    /// True if it falls on a material, and from an environment.
    fn is_lit_physically(&self) -> bool;
    /// True if surfaces near a position of the blended surface occlude it.
    fn is_occluded(&self) -> bool;
    /// True if all points are drawn as points.
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
    /// Returns true if the sequence has posed images.
    fn has_photos(&self) -> bool;
    /// Returns true if posed images are blended by the view direction (view-dependent texturing).
    fn draws_view_dependent_textures(&self) -> bool;
    /// Points are drawn whose size is a length in the scene.
    fn has_points_of_lengths(&self) -> bool;
    /// Surfels are drawn by a splatting that enlarges them.
    fn enlarges_surfels(&self) -> bool;
}
