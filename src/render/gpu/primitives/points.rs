//! Points: pixels, or squares or disks that face the screen. Where they are lit or blended, the passes of surfels and
//! voxels draw them.

use super::amplification::{Amplification, QUAD_VARYINGS};
use super::drawable::{Drawable, Passes};
use super::surfels;
use crate::render::gpu::passes::ScreenPass;
use crate::render::gpu::passes::geometry::{
    ATTRIBUTE, OPAQUE, POINT, ROUND_POINT, SOLID, SURFACE_ATTRIBUTE, SURFACE_OPAQUE, SURFACE_SOLID, VISIBILITY,
};
use crate::render::gpu::passes::screen::RESOLVE;
use crate::render::gpu::residency::RecordSource;
use crate::render::gpu::wgsl::shader_file;
use crate::scene::{Lighting, PointShape, PointSize, ScenePacket};

/// One vertex of a point list.
pub(super) const PIXEL: Amplification = Amplification {
    name: "pixel",
    vertices_per_record: 1,
    passes: &[&POINT],
    ..SQUARE
};

/// One quad that faces the screen.
pub(super) const SQUARE: Amplification = Amplification {
    name: "square",
    files: &[
        shader_file!("primitives/points_alike.wgsl"),
        shader_file!("primitives/points.wgsl"),
    ],
    varyings: QUAD_VARYINGS,
    vertices_per_record: 4,
    reads_shapes: false,
    is_indexed: false,
    writes_depths: false,
    compute_amplifies: false,
    passes: &[&POINT, &ROUND_POINT, &VISIBILITY, &ATTRIBUTE],
};

/// Square with a radius and a normal.
pub(super) const SQUARE_WITH_SHAPE: Amplification = Amplification {
    name: "square with shape",
    files: &[
        shader_file!("primitives/points_with_shapes.wgsl"),
        shader_file!("primitives/points.wgsl"),
    ],
    reads_shapes: true,
    passes: &[
        &POINT,
        &ROUND_POINT,
        &SOLID,
        &OPAQUE,
        &VISIBILITY,
        &ATTRIBUTE,
        &SURFACE_SOLID,
        &SURFACE_OPAQUE,
        &SURFACE_ATTRIBUTE,
    ],
    ..SQUARE
};

pub(super) fn drawable(packet: &ScenePacket) -> Drawable<'_> {
    let is_pixel = PointSize::of(packet).is_pixel();
    let lighting = packet.lighting();
    let (passes, resolve): (Passes, Option<&'static ScreenPass>) = match packet.style.drawn_points().shape {
        PointShape::Gaussian if lighting.is_deferred() => (&[&VISIBILITY, &SURFACE_ATTRIBUTE], Some(&RESOLVE)),
        PointShape::Gaussian => (&[&VISIBILITY, &ATTRIBUTE], Some(&RESOLVE)),
        PointShape::Disk if lighting.is_deferred() => (&[&SURFACE_OPAQUE], Some(&RESOLVE)),
        PointShape::Disk if lighting != Lighting::Unlit => (&[&OPAQUE], None),
        PointShape::Disk if !is_pixel => (&[&ROUND_POINT], None),
        PointShape::Square if lighting.is_deferred() => (&[&SURFACE_SOLID], Some(&RESOLVE)),
        PointShape::Square if lighting != Lighting::Unlit => (&[&SOLID], None),
        PointShape::Disk | PointShape::Square => (&[&POINT], None),
    };
    let points = packet.content.points().map(RecordSource::of);
    let shapes = packet.content.shapes().map(RecordSource::of);
    let has_shapes = packet.content.has_shapes();
    Drawable {
        amplification: if has_shapes {
            &SQUARE_WITH_SHAPE
        } else if is_pixel {
            &PIXEL
        } else {
            &SQUARE
        },
        streams: points.into_iter().chain(shapes).collect(),
        selection: None,
        visible: None,
        code: None,
        // Of everything drawn from a cloud, surfels have the smallest chunks: switching the primitive does not upload
        // again.
        chunked_for: &surfels::DISK,
        cull_back_faces: packet.style.culls_back_faces(),
        passes,
        // Their surfels cast shadows.
        depth_pass: has_shapes.then_some((&surfels::DISK, &VISIBILITY)),
        resolve,
    }
}
