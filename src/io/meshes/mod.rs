//! Triangles of files: polygons cut into them, broken faces, pictures on them, samples of their surface.

pub(super) mod broken_faces;
pub(super) mod mesh;
pub(super) mod picture;
