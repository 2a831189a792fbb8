//! What a picture needs of a frame: what is not needed is not computed.

use super::{ColorHints, Coloring};
use crate::levels::LevelsKey;

/// What a picture needs of a frame beyond its points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Needs {
    /// Normals and radii: for surfels, and for light on voxels.
    pub shapes: bool,
    /// How much longer than wide splats are, and along what; nothing without `shapes`.
    pub ellipses: bool,
    /// The triangles of the file, where it has some.
    pub mesh: bool,
    /// Levels of detail; those that are made of shapes only where `shapes` are asked for as well.
    pub levels: Option<LevelsKey>,
    /// The colours of points and voxels.
    pub colors: Coloring,
    /// What is known beyond the frames that colours can depend on.
    pub hints: ColorHints,
}
