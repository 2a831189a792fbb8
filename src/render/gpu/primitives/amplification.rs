//! Amplifications of records to vertices: the row type of their table.

use crate::render::gpu::constants::{self, INDICES_PER_QUAD, VERTICES_PER_QUAD};
use crate::render::gpu::passes::GeometryPass;
use crate::render::gpu::wgsl::{ShaderFile, shader_file};
use crate::scene::Strategy;

/// Amplification of one record to vertices.
#[derive(Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "a row of a table, whose columns have nothing to do with each other"
)]
pub struct Amplification {
    /// No other has the same.
    pub name: &'static str,
    /// WGSL files of `shaders/primitives/` that expand a record, in addition to their imports.
    pub(in crate::render::gpu) files: &'static [ShaderFile],
    /// The file that hands vertices on to fragments.
    pub(in crate::render::gpu) varyings: ShaderFile,
    /// Vertices that the vertex stage runs for a record: 1, 3 of a triangle, or 4 for each quad.
    pub vertices_per_record: u32,
    /// True if [`ShapeRecord`](crate::cloud::ShapeRecord)s are read in addition to the records.
    pub reads_shapes: bool,
    /// True if records are triangles, which index vertices: then they reach the vertex stage by a single path, whatever
    /// the strategy.
    pub is_indexed: bool,
    /// True if depths are computed at each fragment. Their quads are at the nearest.
    pub writes_depths: bool,
    /// True if the compute strategy writes the vertices. Plain points gain nothing from a pass that would write values
    /// that the vertex stage computes once anyway.
    pub compute_amplifies: bool,
    /// Every pass that may draw it.
    pub passes: &'static [&'static GeometryPass],
}

/// Vertex outputs (varyings) of single-colour quads.
pub(super) const QUAD_VARYINGS: ShaderFile = shader_file!("common/varyings.wgsl");

impl Amplification {
    /// Returns true if records are vertices of a point list, not of triangles.
    pub(in crate::render::gpu) fn is_point_list(&self) -> bool {
        self.vertices_per_record == 1
    }

    /// Returns the generated WGSL for the shaders of the amplification, with the name that they import it by.
    pub(in crate::render::gpu) fn given(&self) -> (&'static str, String) {
        let constants = constants::of_amplification(self.vertices_per_record, self.drawn_per_record());
        ("generated/amplification", constants)
    }

    /// The strategy by which it is drawn where this one is chosen: see [`Amplification::is_indexed`].
    pub(in crate::render::gpu) fn strategy(&self, chosen: Strategy) -> Strategy {
        if self.is_indexed { Strategy::Storage } else { chosen }
    }

    /// Quads that one record becomes; 0 for points and triangles, whose vertices are drawn as they come.
    pub(in crate::render::gpu) fn quads_per_record(&self) -> u32 {
        self.vertices_per_record / VERTICES_PER_QUAD
    }

    /// Returns the count per record in a draw call: indices of its quads, or its vertices.
    pub(in crate::render::gpu) fn drawn_per_record(&self) -> u32 {
        match self.quads_per_record() {
            0 => self.vertices_per_record,
            quads => quads * INDICES_PER_QUAD,
        }
    }
}
