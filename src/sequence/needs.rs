//! Needs of an image from a frame: nothing else is computed.

use super::{ColorHints, Coloring};
use crate::analysis::SurfaceOptions;
use crate::levels::LevelsKey;

/// Needs of an image from a frame beyond its points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Needs {
    /// Normals and radii: for surfels, and for light on voxels.
    pub shapes: bool,
    /// Ellipses of splats: their elongation and its direction; no effect without `shapes`.
    pub ellipses: bool,
    /// The triangles of the file, where it has some.
    pub mesh: bool,
    /// Levels of detail; those that are made of shapes only if `shapes` are requested as well.
    pub levels: Option<LevelsKey>,
    /// The colours of points and voxels.
    pub colors: Coloring,
    /// Options by which missing normals are estimated.
    pub surface: SurfaceOptions,
    /// Radius in point spacings of the neighbourhoods by which points are moved onto the surface around them; 0 if they
    /// stay where they are.
    pub smoothing: f32,
    /// Colour hints: knowledge beyond the frames that colours can depend on.
    pub hints: ColorHints,
}
