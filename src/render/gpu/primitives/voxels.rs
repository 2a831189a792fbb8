//! Cells as cubes: the three faces of each that can face the eye.

use super::amplification::{Amplification, QUAD_VARYINGS};
use super::drawable::{Drawable, Passes};
use crate::render::gpu::passes::ScreenPass;
use crate::render::gpu::passes::geometry::{DEPTH, SOLID, SURFACE_SOLID};
use crate::render::gpu::passes::screen::RESOLVE;
use crate::render::gpu::residency::RecordSource;
use crate::render::gpu::wgsl::shader_file;
use crate::scene::{DrawSettings, Voxels};

/// The faces are lit.
pub(super) const LIT_BY_FACES: Amplification = Amplification {
    name: "voxel",
    files: &[shader_file!("primitives/voxels_lit_by_faces.wgsl")],
    varyings: QUAD_VARYINGS,
    vertices_per_record: 12,
    reads_shapes: false,
    is_indexed: false,
    writes_depths: false,
    compute_amplifies: true,
    passes: &[&SOLID, &SURFACE_SOLID, &DEPTH],
};

/// The surface in a cell is lit.
pub(super) const LIT_BY_NORMALS: Amplification = Amplification {
    name: "voxel with normal",
    files: &[shader_file!("primitives/voxels_lit_by_normals.wgsl")],
    reads_shapes: true,
    ..LIT_BY_FACES
};

pub(super) fn drawable<'a>(voxels: &'a Voxels, style: &DrawSettings) -> Drawable<'a> {
    let (passes, resolve): (Passes, Option<&'static ScreenPass>) = if style.light.lighting.is_deferred() {
        (&[&SURFACE_SOLID], Some(&RESOLVE))
    } else {
        (&[&SOLID], None)
    };
    let normals = voxels.normals.as_ref();
    // Lit by the mean normal of its points, the three faces of a cube have the same shade, and the image shows the
    // surface. Lighting the faces is for frames whose voxel normals are not ready.
    let amplification = match normals {
        Some(_) => &LIT_BY_NORMALS,
        None => &LIT_BY_FACES,
    };
    Drawable {
        amplification,
        streams: [Some(RecordSource::of(&voxels.records)), normals.map(RecordSource::of)]
            .into_iter()
            .flatten()
            .collect(),
        selection: None,
        visible: None,
        code: None,
        chunked_for: amplification,
        // It is never right to draw the faces of a cube that face away from the eye.
        cull_back_faces: true,
        passes,
        depth_pass: Some((amplification, &DEPTH)),
        resolve,
    }
}
