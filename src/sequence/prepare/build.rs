//! Frame preparation: the steps from a validated frame to a prepared one, each skipped if its result is known or not
//! requested.

use super::counters::{PrepareCounters, Timings};
use super::frame::{PreparedFrame, next_id};
use super::mesh::PreparedMesh;
use crate::analysis::{Orientation, Surface, SurfaceOptions, estimate_surface_observed, surface_steps};
use crate::cloud::{Frame, Mesh, PointRecord, ShapeRecord};
use crate::levels::{CloudRecords, LevelsSet, LevelsWork};
use crate::progress::Progress;
use crate::sequence::records::{self, SurfaceWork};
use crate::sequence::{Needs, Paint};
use crate::stopwatch::milliseconds_since;
use glam::Vec3;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// The shapes of all points, and the criterion that decided the signs of their normals.
pub(super) type Shapes = (Arc<Vec<ShapeRecord>>, Orientation);

/// A frame that is being prepared.
pub(super) struct Build<'a> {
    pub(super) index: usize,
    pub(super) frame: Arc<Frame>,
    /// The prepared frame that it was before, of the same points.
    pub(super) existing: Option<&'a PreparedFrame>,
    /// Its triangles, if they were read.
    pub(super) loaded_mesh: Option<Mesh>,
    /// The frame whose triangles it has otherwise.
    pub(super) mesh_of: Option<&'a PreparedFrame>,
    /// Shapes that are known.
    pub(super) shapes: Option<Shapes>,
    /// Options by which their normals were estimated, where they were.
    pub(super) surface: SurfaceOptions,
    /// Radius of the neighbourhoods by which the points of `frame` were moved; 0 if they were not.
    pub(super) smoothing: f32,
    /// The frame before that.
    pub(super) unsmoothed: Option<Arc<Frame>>,
    /// True if they have ellipses.
    pub(super) has_ellipses: bool,
    pub(super) timings: Timings,
    pub(super) counters: &'a PrepareCounters,
    pub(super) progress: &'a Progress,
}

impl Build<'_> {
    /// Makes the missing parts that `needs` require.
    pub(super) fn finish(mut self, needs: &Needs) -> PreparedFrame {
        let same_colors = self.existing.filter(|existing| existing.is_painted_for(needs));
        let paint = match same_colors {
            Some(existing) => existing.paint,
            None => needs.colors.paint(&needs.hints, &self.frame),
        };
        let colors_need_shapes = paint == Paint::Normal && same_colors.is_none() && self.frame.all_normals().is_none();
        if !needs.ellipses && self.has_ellipses && self.frame.ellipses().is_some() {
            // Disks have different radii from the ellipses of the file.
            (self.shapes, self.has_ellipses) = (None, false);
        }
        if needs.shapes || colors_need_shapes {
            if self.surface != needs.surface && self.frame.all_normals().is_none() {
                (self.shapes, self.has_ellipses) = (None, false);
            }
            self.surface = needs.surface;
            self.complete_shapes();
        }
        if needs.shapes && needs.ellipses {
            self.complete_ellipses();
        }
        let (id, points) = match same_colors {
            Some(existing) => (existing.id, Arc::clone(&existing.points)),
            None => (next_id(), self.painted_points(&paint)),
        };
        let levels = self.levels(needs, &paint, &points, same_colors);
        let mesh = match self.loaded_mesh.take() {
            Some(mesh) => Some(PreparedMesh::new(Arc::new(mesh), &paint)),
            None => self.mesh_of.and_then(|other| other.mesh_in(&paint)),
        };
        let (shapes, orientation) = self.shapes.unzip();
        PreparedFrame {
            index: self.index,
            id,
            frame: self.frame,
            points,
            shapes,
            surface: self.surface,
            smoothing: self.smoothing,
            unsmoothed: self.unsmoothed,
            has_ellipses: self.has_ellipses,
            orientation,
            mesh,
            posed_images: None,
            curved: None,
            levels,
            timings: self.timings,
            asked: (needs.colors, needs.hints),
            paint,
        }
    }

    fn complete_shapes(&mut self) {
        if self.shapes.is_some() {
            return;
        }
        let estimate = |positions: &[Vec3], sensor| {
            self.progress.set(0, surface_steps(positions.len(), sensor));
            estimate_surface_observed(positions, sensor, self.surface, self.progress)
        };
        let frame = &self.frame;
        let (shapes, by) = estimated_shapes(frame, &mut self.timings, self.counters, estimate);
        self.shapes = Some((Arc::new(shapes), by));
    }

    /// Adds ellipses to the shapes that are known.
    fn complete_ellipses(&mut self) {
        let Some((shapes, _)) = self.shapes.as_mut().filter(|_| !self.has_ellipses) else {
            return;
        };
        let start = Instant::now();
        *shapes = Arc::new(records::with_ellipses(&self.frame, shapes));
        self.has_ellipses = true;
        self.timings.analysis_ms += milliseconds_since(start) as f32;
        let estimated = u64::from(self.frame.ellipses().is_none());
        self.counters.ellipses_estimated.fetch_add(estimated, Ordering::Relaxed);
    }

    fn painted_points(&mut self, paint: &Paint) -> Arc<Vec<PointRecord>> {
        let start = Instant::now();
        let shapes = self.shapes.as_ref().map(|(shapes, _)| shapes.as_slice());
        let points = records::painted_points(&self.frame, paint, shapes);
        self.timings.records_ms += milliseconds_since(start) as f32;
        let written = &self.counters.records_written;
        written.fetch_add(points.len() as u64, Ordering::Relaxed);
        Arc::new(points)
    }

    /// The levels of detail of `points`. The levels of `same_colors`, which has the same points, are reused.
    fn levels(
        &mut self,
        needs: &Needs,
        paint: &Paint,
        points: &Arc<Vec<PointRecord>>,
        same_colors: Option<&PreparedFrame>,
    ) -> LevelsSet {
        let shapes = self.shapes.as_ref().map(|(shapes, _)| shapes);
        let cloud = CloudRecords {
            frame: &self.frame,
            colors: self.frame.colors().filter(|_| *paint == Paint::File),
            points,
            shapes: shapes.filter(|_| needs.shapes),
        };
        let none = LevelsSet::default();
        let known = same_colors.map_or(&none, |existing| &existing.levels);
        let start = Instant::now();
        // Decoded clouds contain no octree: one for a million points in Morton order is built in 3.4 ms.
        let (levels, work) = known.completed(needs.levels, &cloud);
        if work != LevelsWork::default() {
            self.timings.octree_ms = milliseconds_since(start) as f32;
        }
        let built = &self.counters.octrees_built;
        built.fetch_add(work.octrees.into(), Ordering::Relaxed);
        levels
    }
}

/// The shapes of all points; `estimate` estimates missing normals: see [`records::complete_surface`].
pub(super) fn estimated_shapes(
    frame: &Frame,
    timings: &mut Timings,
    counters: &PrepareCounters,
    estimate: impl FnOnce(&[Vec3], Option<Vec3>) -> Surface,
) -> (Vec<ShapeRecord>, Orientation) {
    let start = Instant::now();
    let (surface, work) = records::complete_surface(frame, estimate);
    match work {
        SurfaceWork::None => {}
        SurfaceWork::Radii => {
            counters.radii_estimated.fetch_add(1, Ordering::Relaxed);
        }
        SurfaceWork::Surface => {
            counters.surfaces_estimated.fetch_add(1, Ordering::Relaxed);
        }
    }
    timings.analysis_ms += milliseconds_since(start) as f32;
    let start = Instant::now();
    let shapes = records::shape_records(frame, &surface);
    timings.records_ms += milliseconds_since(start) as f32;
    counters
        .records_written
        .fetch_add(shapes.len() as u64, Ordering::Relaxed);
    (shapes, surface.orientation)
}
