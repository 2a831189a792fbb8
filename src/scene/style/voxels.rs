//! How voxels are drawn.

use super::choices::choices;

choices! {
    /// What the light of voxels falls on.
    VoxelLight, "light of voxels" {
        /// The mean normals of the points of cells, from either side; the faces of cubes where normals are not known
        /// yet.
        Normals = "normals",
        /// The faces of cubes (paper 000 §VI).
        Faces = "faces",
    }
}

/// How voxels are drawn.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct VoxelStyle {
    /// What light falls on.
    #[serde(rename = "voxel_light")]
    pub light: VoxelLight,
}

impl Default for VoxelStyle {
    fn default() -> Self {
        Self {
            light: VoxelLight::Normals,
        }
    }
}
