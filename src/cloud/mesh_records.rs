//! Draw records of a mesh.

use super::{Textures, TriangleRecord, VertexRecord};
use glam::Vec3;
use std::sync::Arc;

/// Triangles, and the vertices that they name.
#[derive(Debug, Clone)]
pub struct MeshRecords {
    /// One a vertex.
    pub vertices: Arc<Vec<VertexRecord>>,
    /// One a triangle, or a vertex that belongs to none. Every corner is below the number of vertices.
    pub triangles: Arc<Vec<TriangleRecord>>,
    /// Textures that vertices name; none is needed where none is named.
    pub textures: Arc<Textures>,
    has_points: bool,
}

impl MeshRecords {
    /// Records of a mesh without textures. Precondition: every corner is below the number of vertices.
    pub fn new(vertices: Arc<Vec<VertexRecord>>, triangles: Arc<Vec<TriangleRecord>>) -> Self {
        Self {
            has_points: triangles.iter().any(TriangleRecord::is_point),
            vertices,
            triangles,
            textures: Arc::default(),
        }
    }

    /// Adds textures. Precondition: every vertex names one of them, or none.
    #[must_use]
    pub fn with_textures(self, textures: Arc<Textures>) -> Self {
        Self { textures, ..self }
    }

    /// Returns records of the same vertices with other triangles. Precondition: every corner is below the number of
    /// vertices.
    #[must_use]
    pub fn with_triangles(&self, triangles: Vec<TriangleRecord>) -> Self {
        Self::new(Arc::clone(&self.vertices), Arc::new(triangles)).with_textures(Arc::clone(&self.textures))
    }

    /// Returns true if any vertex belongs to no triangle.
    pub fn has_points(&self) -> bool {
        self.has_points
    }

    /// The corners of a triangle, relative to the sequence origin.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        let corners = self.triangles[triangle].corners;
        corners.map(|corner| Vec3::from_array(self.vertices[corner as usize].position))
    }

    /// Returns the centroid of a triangle.
    pub fn center(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        // Relative to the first corner: nothing overflows, and a point stays exactly where it is.
        a + ((b - a) + (c - a)) / 3.0
    }

    /// Bytes of all arrays.
    pub fn byte_size(&self) -> usize {
        size_of_val(self.vertices.as_slice()) + size_of_val(self.triangles.as_slice())
    }
}
