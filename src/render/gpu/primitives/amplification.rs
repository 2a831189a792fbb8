//! What a row of the table of amplifications is.

use crate::render::gpu::constants::{self, INDICES_PER_QUAD, VERTICES_PER_QUAD};
use crate::render::gpu::passes::GeometryPass;
use crate::render::gpu::wgsl::{ShaderFile, shader_file};
use crate::scene::Strategy;

/// What one record becomes.
#[derive(Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "a row of a table, whose columns have nothing to do with each other"
)]
pub struct Amplification {
    /// No other has the same.
    pub name: &'static str,
    /// Of `shaders/primitives/`: what a record becomes, beside what these import.
    pub(in crate::render::gpu) files: &'static [ShaderFile],
    /// The file that hands vertices on to fragments.
    pub(in crate::render::gpu) varyings: ShaderFile,
    /// Vertices that the vertex stage runs for a record: 1, 3 of a triangle, or 4 for each quad.
    pub vertices_per_record: u32,
    /// Whether [`ShapeRecord`](crate::cloud::ShapeRecord)s are read beside the records.
    pub reads_shapes: bool,
    /// Whether records are triangles, which name vertices: then they reach the vertex stage in one way, whatever the
    /// strategy.
    pub is_indexed: bool,
    /// Whether depths are worked out at each fragment. Their quads are at the nearest.
    pub writes_depths: bool,
    /// Whether the compute strategy writes the vertices. Plain points gain nothing from a pass that would write what
    /// the vertex stage computes once anyway.
    pub compute_amplifies: bool,
    /// Every pass that may draw it.
    pub passes: &'static [&'static GeometryPass],
}

/// What vertices of quads of one colour hand on.
pub(super) const QUAD_VARYINGS: ShaderFile = shader_file!("common/varyings.wgsl");

impl Amplification {
    /// Whether records are vertices of a list of points, not of triangles.
    pub(in crate::render::gpu) fn is_point_list(&self) -> bool {
        self.vertices_per_record == 1
    }

    /// What shaders of it have from Rust, by the name that they import it by.
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

    /// What a draw call counts for a record: indices of its quads, or its vertices.
    pub(in crate::render::gpu) fn drawn_per_record(&self) -> u32 {
        match self.quads_per_record() {
            0 => self.vertices_per_record,
            quads => quads * INDICES_PER_QUAD,
        }
    }
}
