//! Points: pixels, or squares or disks that face the screen.

use super::amplification::Amplification;
use super::drawable::Drawable;
use super::surfels;
use crate::cloud::PointRecord;
use crate::render::gpu::passes::geometry::{POINT, ROUND_POINT};
use crate::render::gpu::residency::RecordSource;
use crate::scene::{PointShape, Style};
use std::sync::Arc;

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
    wgsl: &[include_str!("../../../../shaders/primitives/points.wgsl")],
    vertices_per_record: 4,
    reads_shapes: false,
    is_indexed: false,
    compute_amplifies: false,
    passes: &[&POINT, &ROUND_POINT],
};

pub(super) fn drawable<'a>(points: Option<&'a Arc<Vec<PointRecord>>>, style: &Style) -> Drawable<'a> {
    let is_pixel = style.points.size_px <= 1.0;
    Drawable {
        amplification: if is_pixel { &PIXEL } else { &SQUARE },
        streams: points.map(RecordSource::of).into_iter().collect(),
        // Of all that is drawn from a cloud, surfels have the smallest chunks: switching the primitive uploads nothing
        // again.
        chunked_for: &surfels::DISK,
        cull_back_faces: style.culls_back_faces(),
        passes: match style.points.shape {
            PointShape::Disk if !is_pixel => &[&ROUND_POINT],
            PointShape::Disk | PointShape::Square => &[&POINT],
        },
        depth_pass: None,
        resolve: None,
    }
}
