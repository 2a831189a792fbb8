//! Key of the requested levels of detail.

use super::octree::StopCriterion;
use super::spheres::SphereKind;

/// Key of the requested levels of detail: the structure, and its stop criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelsKey {
    /// The structure, and the primitive drawn for its nodes.
    pub kind: LevelsKind,
    /// Stop criterion of the octree that it is made from, if it is made from one.
    pub stop: StopCriterion,
}

/// A structure of levels of detail, and the primitive drawn for its nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LevelsKind {
    /// All points as surfels, or every second, fourth, eighth of them.
    List,
    /// Nodes of a tree of spheres as surfels.
    Spheres(SphereKind),
    /// Cells of an octree as cubes whose light falls on faces.
    Cubes,
    /// Cells of an octree as cubes whose light falls on the normals of their points.
    LitCubes,
    /// Nodes of an octree as surfels.
    Surfels,
    /// The byte code of an octree with the surfels of its nodes, which the renderer cuts itself.
    Codes,
}

impl LevelsKind {
    /// Returns true if it is made of normals and radii.
    pub fn needs_shapes(self) -> bool {
        self != Self::Cubes
    }

    /// Returns true if it is made from an octree.
    pub fn needs_octree(self) -> bool {
        !matches!(self, Self::List | Self::Spheres(_))
    }
}
