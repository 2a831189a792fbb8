//! Voxel settings.

use super::choices::choices;
use super::describe::{Label, Place, Section, Values, group};

choices! {
    /// Voxel lighting mode: the lit geometry.
    VoxelLight, "light of voxels" {
        /// From either side; the faces of cubes where normals are not known yet.
        Normals = "normals", "Normals", "The surface in a voxel: the mean normal of its points";
        /// The 4D media paper §VI.
        Faces = "faces", "Faces", "The faces of the cubes";
    }
}

group! {
    /// Voxel settings.
    VoxelStyle {
        /// Voxel lighting mode: the lit geometry.
        light: VoxelLight = VoxelLight::Normals, "voxel_light" LIGHT {
            flag: "voxel-light",
            value_name: "WHAT",
            help: "Light voxels by the normals of their points, or by the faces of the cubes",
            title: "Light on",
            hint: "What the light of voxels falls on",
            section: Section::Shading,
            when: |drawn| drawn.draws_voxels(),
            label: Label::Unusual(Place::What, "lit by {}"),
            full_name: "Light on voxels",
            also: &["voxel shading"],
            values: Values::Words(VoxelLight::WORDS),
        }
    }
}
