//! Points: pixels, or squares or disks that face the screen.

use super::amplification::Amplification;
use super::drawable::Drawable;
use super::surfels;
use crate::render::gpu::passes::geometry::{POINT, ROUND_POINT};
use crate::render::gpu::residency::RecordSource;
use crate::scene::{PointShape, PointSize, ScenePacket};

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
    wgsl: &[
        include_str!("../../../../shaders/primitives/points_alike.wgsl"),
        include_str!("../../../../shaders/primitives/points.wgsl"),
    ],
    vertices_per_record: 4,
    reads_shapes: false,
    compute_amplifies: false,
    passes: &[&POINT, &ROUND_POINT],
};

/// The same, as large as the radius of the point says.
pub(super) const SQUARE_WITH_SHAPE: Amplification = Amplification {
    name: "square with shape",
    wgsl: &[
        include_str!("../../../../shaders/primitives/points_with_shapes.wgsl"),
        include_str!("../../../../shaders/primitives/points.wgsl"),
    ],
    reads_shapes: true,
    ..SQUARE
};

pub(super) fn drawable(packet: &ScenePacket) -> Drawable<'_> {
    let is_pixel = PointSize::of(packet).is_pixel();
    let points = packet.content.points().map(RecordSource::of);
    let shapes = packet.content.shapes().map(RecordSource::of);
    Drawable {
        amplification: match shapes {
            Some(_) => &SQUARE_WITH_SHAPE,
            None if is_pixel => &PIXEL,
            None => &SQUARE,
        },
        streams: points.into_iter().chain(shapes).collect(),
        // Of all that is drawn from a cloud, surfels have the smallest chunks: switching the primitive uploads nothing
        // again.
        chunked_for: &surfels::DISK,
        cull_back_faces: packet.style.culls_back_faces(),
        passes: match packet.style.points.shape {
            PointShape::Disk if !is_pixel => &[&ROUND_POINT],
            PointShape::Disk | PointShape::Square => &[&POINT],
        },
        resolve: None,
    }
}
