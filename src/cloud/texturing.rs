//! Texture mapping of images onto the vertices of a mesh.

use super::Textures;
use super::attributes::gather;
use std::sync::Arc;

/// Texture mapping: the texture image of each vertex, and its texture coordinates there.
#[derive(Debug, Clone, PartialEq)]
pub struct Texturing {
    /// The textures.
    pub textures: Arc<Textures>,
    /// Index of the texture of each vertex; `None` for one without.
    pub texture_of_vertex: Vec<Option<u32>>,
    /// Texture coordinates of each vertex in its image, 0 to 1 from left to right and from top to bottom.
    pub places: Vec<[f32; 2]>,
}

impl Texturing {
    /// Returns the texture mapping of the vertices at `indices`, in their order. Precondition: each is below the number
    /// of vertices.
    pub(super) fn gathered(&self, indices: &[u32]) -> Self {
        Self {
            textures: Arc::clone(&self.textures),
            texture_of_vertex: gather(&self.texture_of_vertex, indices),
            places: gather(&self.places, indices),
        }
    }

    /// Bytes of all arrays.
    pub(super) fn byte_size(&self) -> usize {
        let of_vertices = size_of_val(self.texture_of_vertex.as_slice()) + size_of_val(self.places.as_slice());
        of_vertices + self.textures.byte_size()
    }
}
