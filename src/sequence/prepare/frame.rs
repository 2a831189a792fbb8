//! A frame with everything that an image needs.

use super::counters::Timings;
use super::mesh::PreparedMesh;
use super::textured::{curved_surface, is_outlier, without_outliers};
use crate::analysis::{Orientation, SurfaceOptions};
use crate::cloud::{Frame, MeshRecords, PointRecord, ShapeRecord};
use crate::levels::{CloudRecords, LevelsSet};
use crate::photos::{PhotoSurface, PosedImages};
use crate::sequence::{ColorHints, ColorSource, Coloring, Needs, Paint};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A frame with everything required by some [`Needs`]. Immutable; parts are shared with the frames it was completed
/// from.
#[derive(Debug, Clone)]
pub struct PreparedFrame {
    /// Index in the sequence.
    pub index: usize,
    /// Names the content of `points` within this run of the program.
    pub id: u64,
    /// The validated frame.
    pub frame: Arc<Frame>,
    /// One record a point.
    pub points: Arc<Vec<PointRecord>>,
    /// One record per point, if requested, or if estimating normals for colours brought them anyway.
    pub shapes: Option<Arc<Vec<ShapeRecord>>>,
    /// Options by which the normals in `shapes` were estimated, where the file has none.
    pub surface: SurfaceOptions,
    /// Radius in point spacings of the neighbourhoods by which the points were moved; 0 if they are where the file has
    /// them.
    pub smoothing: f32,
    /// The frame before its points were moved, if they were.
    pub(super) unsmoothed: Option<Arc<Frame>>,
    /// True if `shapes` contain ellipses, which define how much longer than wide splats are; otherwise all are disks.
    pub has_ellipses: bool,
    /// The criterion that decided the signs of the normals in `shapes`: the back of a surfel says nothing unless they
    /// are right. `None` without shapes.
    pub orientation: Option<Orientation>,
    /// Its triangles, if requested; empty for a frame without any.
    pub mesh: Option<PreparedMesh>,
    /// Posed images of its scene, if they were loaded: see [`PreparedFrame::with_photos`].
    pub posed_images: Option<Arc<PosedImages>>,
    /// Surface that posed images are projected onto, if that is finer than one disk per point.
    pub curved: Option<PhotoSurface>,
    /// The requested levels of detail, in the colours of `points`.
    pub levels: LevelsSet,
    /// Timings of the last completion; decoding included if it happened then.
    pub timings: Timings,
    /// Requested colouring, and the result of resolving it for this frame.
    pub(super) asked: (Coloring, ColorHints),
    pub(super) paint: Paint,
}

impl PreparedFrame {
    /// True when completing it for `needs` would change nothing.
    pub fn satisfies(&self, needs: &Needs) -> bool {
        self.is_painted_for(needs)
            && self.smoothing == needs.smoothing
            && (!needs.shapes || self.has_shapes_for(needs))
            && !self.lacks_mesh_for(needs)
            && needs.levels.is_none_or(|key| self.levels.has(key, needs.shapes))
    }

    /// Returns true if the file has triangles that are needed and were not read.
    pub(in crate::sequence) fn lacks_mesh_for(&self, needs: &Needs) -> bool {
        needs.mesh && self.mesh.is_none() && self.frame.has_faces()
    }

    /// The triangles in a paint; the same allocations if it is the points' paint.
    pub(super) fn mesh_in(&self, paint: &Paint) -> Option<PreparedMesh> {
        let mesh = self.mesh.as_ref()?;
        let is_painted = self.paint == *paint;
        Some(if is_painted {
            mesh.clone()
        } else {
            mesh.repainted(paint)
        })
    }

    /// Estimated ellipses have the radii of disks, a file's have not.
    fn has_shapes_for(&self, needs: &Needs) -> bool {
        let are_disks = !self.has_ellipses || self.frame.ellipses().is_none();
        self.shapes.is_some()
            && self.has_surface_of(needs)
            && if needs.ellipses { self.has_ellipses } else { are_disks }
    }

    /// Returns true if the normals of shapes are the needed ones: the file's, or estimated by that method.
    fn has_surface_of(&self, needs: &Needs) -> bool {
        self.surface == needs.surface || self.frame.all_normals().is_some()
    }

    /// The frame as the file has it.
    pub(super) fn original(&self) -> &Arc<Frame> {
        self.unsmoothed.as_ref().unwrap_or(&self.frame)
    }

    pub(super) fn is_painted_for(&self, needs: &Needs) -> bool {
        let is_asked = self.asked == (needs.colors, needs.hints);
        (is_asked || self.paint == needs.colors.paint(&needs.hints, &self.frame))
            && (self.paint != Paint::Normal || self.has_surface_of(needs))
    }

    /// Returns the colour source of the points: see [`Paint::source`].
    pub fn colors(&self) -> ColorSource {
        self.paint.source()
    }

    /// Returns the paint that the points are coloured with.
    pub fn paint(&self) -> &Paint {
        &self.paint
    }

    /// Returns the mesh records of its triangles to draw, if they were requested and the file has some.
    pub fn triangles(&self) -> Option<&Arc<MeshRecords>> {
        let mesh = self.mesh.as_ref().filter(|mesh| !mesh.mesh().triangles().is_empty());
        mesh.map(PreparedMesh::records)
    }

    /// Returns true if the frame is a sample: it has fewer points than the file.
    pub fn is_sample(&self) -> bool {
        self.frame.is_sample()
    }

    /// Returns a copy with the same points in `colors`, one per point, as `paint` specifies, under an id of their own,
    /// with levels of detail of the same kind. To be drawn, not to be completed: later additions would have the colours
    /// of the file again.
    #[must_use]
    pub fn in_colors(&self, colors: &[[u8; 4]], paint: Paint) -> Self {
        let points = self.points.iter().zip(colors);
        let points = points.map(|(&point, &color)| PointRecord { color, ..point });
        let points = Arc::new(points.collect::<Vec<_>>());
        let levels = self.levels.made_of(&CloudRecords {
            frame: &self.frame,
            colors: Some(colors),
            points: &points,
            shapes: self.shapes.as_ref(),
        });
        Self {
            id: next_id(),
            points,
            // Its vertices are not these points, so their colours are unknown.
            mesh: None,
            // Its disks have the previous colours.
            curved: None,
            levels,
            paint,
            ..self.clone()
        }
    }

    /// Returns a copy with posed images, which are projected onto it where it is drawn: onto the surface that was
    /// reconstructed from them, if there is one. Otherwise outliers hide nothing of them, and disks are
    /// [curved](Self::curved).
    #[must_use]
    pub fn with_photos(&self, posed_images: Arc<PosedImages>) -> Self {
        let mut textured = Self {
            posed_images: Some(posed_images),
            curved: None,
            ..self.clone()
        };
        let Some(shapes) = self.shapes.as_ref().filter(|_| !self.has_ellipses) else {
            return textured;
        };
        if let Some(surface) = textured.posed_images.as_ref().and_then(|set| set.surface()) {
            textured.curved = Some(surface.clone());
            return textured;
        }
        let is_outlier = is_outlier(&self.frame);
        let shrunk = without_outliers(&self.frame, shapes, self.surface, &is_outlier).map(Arc::new);
        let of_points = shrunk.as_ref().unwrap_or(shapes);
        textured.curved = curved_surface(&self.frame, &self.points, of_points, &is_outlier);
        if let Some(shapes) = shrunk {
            textured.levels = self.levels.made_of(&CloudRecords {
                frame: &self.frame,
                colors: self.frame.colors().filter(|_| self.paint == Paint::File),
                points: &self.points,
                shapes: Some(&shapes),
            });
            textured.shapes = Some(shapes);
        }
        textured
    }

    /// Returns this frame marked as painted like another one: its points are among these.
    pub(crate) fn painted_as(mut self, other: &Self) -> Self {
        self.frame.share_sample(Arc::clone(other.frame.value_sample()));
        self.paint = other.paint;
        self
    }

    /// Bytes of all parts.
    pub fn byte_size(&self) -> usize {
        let shapes = self.shapes.as_ref();
        self.frame.byte_size()
            + self.unsmoothed.as_ref().map_or(0, |frame| frame.byte_size())
            + size_of_val(self.points.as_slice())
            + shapes.map_or(0, |shapes| size_of_val(shapes.as_slice()))
            + self.mesh.as_ref().map_or(0, PreparedMesh::byte_size)
            + self.curved.as_ref().map_or(0, PhotoSurface::byte_size)
            + self.levels.byte_size()
    }
}

/// A name that no other points have.
pub(super) fn next_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
