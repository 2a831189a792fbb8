//! Triangles, and the vertices between them as points.

use super::amplification::Amplification;
use super::drawable::{Drawable, Passes};
use crate::cloud::MeshRecords;
use crate::render::gpu::passes::ScreenPass;
use crate::render::gpu::passes::geometry::{DEPTH, ROUND_SOLID, SOLID, SURFACE_ROUND_SOLID, SURFACE_SOLID};
use crate::render::gpu::passes::screen::RESOLVE;
use crate::render::gpu::residency::RecordSource;
use crate::render::gpu::wgsl::shader_file;
use crate::scene::{DrawSettings, PointShape};
use std::sync::Arc;

/// Half a quad, or the square of a point.
pub(super) const TRIANGLE: Amplification = Amplification {
    name: "triangle",
    files: &[],
    varyings: shader_file!("primitives/mesh.wgsl"),
    vertices_per_record: 4,
    reads_shapes: false,
    is_indexed: true,
    writes_depths: false,
    compute_amplifies: false,
    passes: &[&SOLID, &ROUND_SOLID, &SURFACE_SOLID, &SURFACE_ROUND_SOLID, &DEPTH],
};

pub(super) fn drawable<'a>(mesh: &'a Arc<MeshRecords>, style: &DrawSettings) -> Drawable<'a> {
    // If fragments may be discarded, all of them are depth-tested late.
    let has_disks = mesh.has_points() && style.drawn_points().shape == PointShape::Disk;
    let (passes, resolve): (Passes, Option<&'static ScreenPass>) = match (style.light.lighting.is_deferred(), has_disks)
    {
        (false, false) => (&[&SOLID], None),
        (false, true) => (&[&ROUND_SOLID], None),
        (true, false) => (&[&SURFACE_SOLID], Some(&RESOLVE)),
        (true, true) => (&[&SURFACE_ROUND_SOLID], Some(&RESOLVE)),
    };
    Drawable {
        amplification: &TRIANGLE,
        streams: vec![RecordSource::of_mesh(mesh)],
        selection: None,
        visible: None,
        code: None,
        chunked_for: &TRIANGLE,
        // Files have either winding order.
        cull_back_faces: false,
        passes,
        depth_pass: Some((&TRIANGLE, &DEPTH)),
        resolve,
    }
}
