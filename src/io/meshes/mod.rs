//! Triangles of files: triangulated polygons, broken faces, textures, samples of their surface.

pub(super) mod broken_faces;
pub(super) mod mesh;
pub(super) mod picture;
