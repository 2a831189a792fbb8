//! The stages in which a large frame at rest arrives: some of its points, all of them, the estimates.
//!
//! **How it works.** Each stage is a job of its own, whose result is cached as any frame is: the sample as a coarse
//! copy, all points as the frame itself. Neither has everything requested, so the next free worker goes on where they
//! end. Meanwhile they are drawn as points ([`super::Slot::Partial`]). Other frames wait until the one being viewed is
//! complete.
//!
//! A small frame comes at once: it would only flash as points.

use crate::analysis::MAX_WIDENED;
use crate::cloud::{Frame, PointRecord, ShapeRecord};
use crate::sequence::records::lacks_surface;
use crate::sequence::{ColorSource, Needs, Paint};

/// Frames of more points come in stages. With fewer, normals take a tenth of a second.
pub(crate) const STAGED_POINTS: usize = 1 << 17;

/// Points of the first stage: the number found in 50 ms, one for each of seven pixels.
pub(crate) const SAMPLE_POINTS: usize = 1 << 17;

/// Frames of fewer points have no sample: all are read and sorted in less than a tenth of a second.
pub(crate) const MIN_SAMPLED: usize = 1 << 19;

/// Returns true if `frame` is shown with nothing but its points before `needs` are met, as these take long.
pub(super) fn comes_in_stages(frame: &Frame, needs: &Needs) -> bool {
    let wants_shapes = needs.shapes || needs_normals(frame, needs);
    let takes_long =
        needs.levels.is_some() || (wants_shapes && lacks_surface(frame)) || (needs.mesh && frame.has_faces());
    frame.len() > STAGED_POINTS && takes_long
}

/// Returns the subset of `needs` that the points of `frame` alone require.
pub(super) fn points_alone(frame: &Frame, needs: &Needs) -> Needs {
    let colors = if needs_normals(frame, needs) {
        ColorSource::Uniform.into()
    } else {
        needs.colors
    };
    Needs {
        colors,
        ..Needs::default()
    }
}

/// Bytes that completing `frame` for `needs` takes at once, itself included.
pub(super) fn completion_bytes(frame: &Frame, needs: &Needs) -> u64 {
    let wants_shapes = needs.shapes || needs_normals(frame, needs);
    let shapes = if wants_shapes { size_of::<ShapeRecord>() } else { 0 };
    let estimated = match frame.len() {
        _ if !wants_shapes || !lacks_surface(frame) => 0,
        points if points <= MAX_WIDENED => ESTIMATED_BYTES[0],
        _ => ESTIMATED_BYTES[1],
    };
    let octree = needs.levels.map_or(0, |_| OCTREE_BYTES);
    let per_point = size_of::<PointRecord>() + shapes + estimated.max(octree);
    (frame.byte_size() + per_point * frame.len()) as u64
}

/// Bytes per point for estimating a surface: up to [`MAX_WIDENED`] points, and beyond. See
/// [`estimate_surface`](crate::analysis::estimate_surface).
const ESTIMATED_BYTES: [usize; 2] = [230, 70];

/// Bytes per point for building an octree.
const OCTREE_BYTES: usize = 29;

/// Returns true if the colours show normals that have to be estimated.
fn needs_normals(frame: &Frame, needs: &Needs) -> bool {
    needs.colors.paint(&needs.hints, frame) == Paint::Normal && frame.all_normals().is_none()
}
