//! A frame made ready for an image: completed, coloured, packed into records, indexed; each only if it is needed.
//!
//! **How it works.** [`complete`] takes the existing parts and adds the missing ones that [`Needs`] require. Every part
//! is shared by an [`Arc`], and stays the same one as long as it is right:
//!
//! | changed | decoded | estimated | rewritten |
//! |---|---|---|---|
//! | nothing | – | – | – |
//! | stop criterion | – | – | octree, its points not sorted again |
//! | colours | – | – | points; octree if one is needed |
//! | shapes wanted now | – | normals and radii the file has not | shapes |
//! | options of normals | – | normals and radii the file has not | shapes; points in their colours; levels made of them |
//! | smoothing | – | positions, and all that is made of them | all |
//! | ellipses wanted now | – | ellipses | shapes; levels that are made of them |
//! | triangles wanted now | the file once more, by the loader | – | triangles |
//!
//! **Change tracking.** [`PreparedFrame::id`] names the content of `points`: equal ids mean equal points, so a renderer
//! that holds the points of an id need not upload them again. For shapes and octree the `Arc` itself identifies them:
//! `Arc::ptr_eq`.
//!
//! Fake colours are always taken from the packed normals, so that they do not depend on the order in which shapes and
//! colours were requested.

mod build;
mod counters;
mod frame;
mod mesh;
mod textured;

pub use counters::{PrepareCounters, Timings};
pub use frame::PreparedFrame;
pub use mesh::PreparedMesh;

use super::Needs;
use crate::analysis::{estimate_surface_fast, smooth};
use crate::cloud::{CloudError, Frame, Mesh, ShapeRecord, radius_factor};
use crate::progress::Progress;
use crate::stopwatch::milliseconds_since;
use build::{Build, estimated_shapes};
use glam::Vec3;
use std::sync::Arc;
use std::time::Instant;

/// Prepares `frame` for `needs`. `decode_ms` is carried into the timings.
pub fn prepare(
    index: usize,
    frame: Arc<Frame>,
    decode_ms: f32,
    needs: &Needs,
    counters: &PrepareCounters,
) -> PreparedFrame {
    let never = Progress::default();
    prepare_observed(index, frame, None, decode_ms, needs, counters, &never)
}

/// Performs [`prepare`] with the triangles of the frame, where they are wanted. It reports in `progress` how much of
/// the normal estimation is done: the rest takes little compared with it. Once that is cancelled, the result is of no
/// use.
pub(super) fn prepare_observed(
    index: usize,
    frame: Arc<Frame>,
    mesh: Option<Mesh>,
    decode_ms: f32,
    needs: &Needs,
    counters: &PrepareCounters,
    progress: &Progress,
) -> PreparedFrame {
    let mut timings = Timings {
        decode_ms,
        ..Timings::default()
    };
    let (frame, unsmoothed) = smoothed(frame, needs.smoothing, &mut timings, progress);
    let build = Build {
        index,
        frame,
        existing: None,
        loaded_mesh: mesh,
        mesh_of: None,
        shapes: None,
        surface: needs.surface,
        smoothing: needs.smoothing,
        unsmoothed,
        has_ellipses: false,
        timings,
        counters,
        progress,
    };
    build.finish(needs)
}

/// Prepares at most `max_points` of the points of `existing`, taken evenly, with all triangles. Normals and radii that
/// are known are not estimated again.
pub(super) fn prepare_sample(
    existing: &PreparedFrame,
    mesh: Option<Mesh>,
    max_points: usize,
    needs: &Needs,
    counters: &PrepareCounters,
) -> Result<PreparedFrame, CloudError> {
    let start = Instant::now();
    // Fewer points are moved by their neighbours then, and not twice.
    let (frame, slots) = existing.original().sample(max_points)?;
    let factor = radius_factor(existing.frame.len(), slots.len());
    let is_smoothed = existing.unsmoothed.is_some() || needs.smoothing > 0.0;
    let known = existing.shapes.as_ref().filter(|_| !is_smoothed);
    let shapes = known.map(|shapes| {
        let shape = |&slot: &u32| ShapeRecord {
            radius: factor * shapes[slot as usize].radius,
            ..shapes[slot as usize]
        };
        Arc::new(slots.iter().map(shape).collect::<Vec<_>>())
    });
    let mut timings = Timings {
        records_ms: milliseconds_since(start) as f32,
        ..Timings::default()
    };
    let never = Progress::default();
    let (frame, unsmoothed) = smoothed(Arc::new(frame), needs.smoothing, &mut timings, &never);
    let build = Build {
        index: existing.index,
        frame,
        existing: None,
        loaded_mesh: mesh,
        mesh_of: needs.mesh.then_some(existing),
        has_ellipses: existing.has_ellipses && shapes.is_some(),
        shapes: shapes.zip(existing.orientation),
        surface: existing.surface,
        smoothing: needs.smoothing,
        unsmoothed,
        timings,
        counters,
        progress: &never,
    };
    Ok(build.finish(needs))
}

/// Prepares the points of `existing` at `slots` alone, for an image that is soon replaced: without a known sensor,
/// normals agree with those of representatives. Radii close the surface of these points, whatever the file says.
pub fn prepare_part(
    existing: &PreparedFrame,
    slots: &[u32],
    needs: &Needs,
    counters: &PrepareCounters,
) -> Result<PreparedFrame, CloudError> {
    let mut timings = Timings::default();
    let frame = existing.frame.part_without_splats(slots)?;
    let estimate = |positions: &[Vec3], sensor| estimate_surface_fast(positions, sensor, needs.surface);
    let (shapes, orientation) = estimated_shapes(&frame, &mut timings, counters, estimate);
    let build = Build {
        index: existing.index,
        frame: Arc::new(frame),
        existing: None,
        loaded_mesh: None,
        mesh_of: None,
        shapes: Some((Arc::new(shapes), orientation)),
        surface: needs.surface,
        smoothing: existing.smoothing,
        unsmoothed: None,
        has_ellipses: false,
        timings,
        counters,
        progress: &Progress::default(),
    };
    Ok(build.finish(needs))
}

/// Adds to `existing` the missing parts that `needs` require; parts that are still right are the same `Arc`s.
pub fn complete(existing: &PreparedFrame, needs: &Needs, counters: &PrepareCounters) -> PreparedFrame {
    complete_observed(existing, None, needs, counters, &Progress::default())
}

/// [`complete`] with the triangles of the frame, where they are wanted and not there, observed as [`prepare_observed`].
pub(super) fn complete_observed(
    existing: &PreparedFrame,
    mesh: Option<Mesh>,
    needs: &Needs,
    counters: &PrepareCounters,
    progress: &Progress,
) -> PreparedFrame {
    if existing.satisfies(needs) {
        return existing.clone();
    }
    if existing.smoothing != needs.smoothing {
        let mut timings = Timings::default();
        let (frame, unsmoothed) = smoothed(Arc::clone(existing.original()), needs.smoothing, &mut timings, progress);
        let build = Build {
            index: existing.index,
            frame,
            existing: None,
            loaded_mesh: mesh,
            mesh_of: Some(existing),
            shapes: None,
            surface: needs.surface,
            smoothing: needs.smoothing,
            unsmoothed,
            has_ellipses: false,
            timings,
            counters,
            progress,
        };
        return build.finish(needs);
    }
    let build = Build {
        index: existing.index,
        frame: Arc::clone(&existing.frame),
        existing: Some(existing),
        loaded_mesh: mesh,
        mesh_of: Some(existing),
        shapes: existing.shapes.clone().zip(existing.orientation),
        surface: existing.surface,
        smoothing: existing.smoothing,
        unsmoothed: existing.unsmoothed.clone(),
        has_ellipses: existing.has_ellipses,
        timings: Timings::default(),
        counters,
        progress,
    };
    build.finish(needs)
}

/// Moves the points of a frame onto the surface around them, from neighbourhoods of a radius in point spacings. Returns
/// the frame as it was in addition, unless that is the same.
fn smoothed(
    frame: Arc<Frame>,
    radius_spacings: f32,
    timings: &mut Timings,
    progress: &Progress,
) -> (Arc<Frame>, Option<Arc<Frame>>) {
    if radius_spacings <= 0.0 {
        return (frame, None);
    }
    let start = Instant::now();
    progress.set(0, frame.len());
    let smoothed = smooth(frame.positions(), radius_spacings, progress);
    let moved = frame.moved(&smoothed.positions, smoothed.told(radius_spacings));
    timings.analysis_ms += milliseconds_since(start) as f32;
    match moved {
        Ok(moved) => (Arc::new(moved), Some(frame)),
        // A frame of these points exists.
        Err(_) => (frame, None),
    }
}
