//! A frame made ready for a picture: completed, coloured, packed into records, indexed; each only if it is needed.
//!
//! **How it works.** [`complete`] takes what is there and adds what [`Needs`] ask for beyond it. Every part is shared
//! by an [`Arc`], and stays the same one as long as it is right:
//!
//! | changed | decoded | estimated | rewritten |
//! |---|---|---|---|
//! | nothing | – | – | – |
//! | stop criterion | – | – | octree, its points not sorted again |
//! | colours | – | – | points; octree if one is needed |
//! | shapes wanted now | – | normals and radii the file has not | shapes |
//! | ellipses wanted now | – | ellipses, where radii are estimated | shapes |
//!
//! **Who changed.** [`PreparedFrame::id`] names the content of `points`: equal ids mean equal points, so a renderer
//! that holds the points of an id need not upload them again. For shapes and octree the `Arc` itself tells:
//! `Arc::ptr_eq`.
//!
//! Fake colours are always taken from the packed normals, so that they do not depend on the order in which shapes and
//! colours were asked for.

use super::records::{self, SurfaceWork};
use super::{ColorHints, ColorSource, Coloring, Needs, Paint, milliseconds_since};
use crate::analysis::{
    Orientation, Surface, estimate_surface_fast, estimate_surface_observed, surface_steps,
};
use crate::cloud::{CloudError, Frame, PointRecord, ShapeRecord, radius_factor};
use crate::levels::octree::{CodedCloud, LodSurfels, Octree, StopCriterion};
use crate::progress::Progress;
use glam::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Wall time of the stages that made a frame, in milliseconds; 0 for what was not done or was reused.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timings {
    /// Reading, decoding and validating the file.
    pub decode_ms: f32,
    /// Normals and radii.
    pub analysis_ms: f32,
    /// Packing points and shapes.
    pub records_ms: f32,
    /// Building the octree.
    pub octree_ms: f32,
}

impl Timings {
    /// All stages together.
    pub fn total_ms(&self) -> f32 {
        self.decode_ms + self.analysis_ms + self.records_ms + self.octree_ms
    }
}

/// How much work was done; the proof that nothing is done twice. Shared between threads.
#[derive(Debug, Default)]
pub struct PrepareCounters {
    pub(super) surfaces_estimated: AtomicU64,
    pub(super) radii_estimated: AtomicU64,
    pub(super) octrees_built: AtomicU64,
    pub(super) records_written: AtomicU64,
}

impl PrepareCounters {
    /// Frames whose normals (and radii) were estimated.
    pub fn surfaces_estimated(&self) -> u64 {
        self.surfaces_estimated.load(Ordering::Relaxed)
    }

    /// Frames with normals whose radii were estimated.
    pub fn radii_estimated(&self) -> u64 {
        self.radii_estimated.load(Ordering::Relaxed)
    }

    /// Octrees built.
    pub fn octrees_built(&self) -> u64 {
        self.octrees_built.load(Ordering::Relaxed)
    }

    /// Point and shape records written.
    pub fn records_written(&self) -> u64 {
        self.records_written.load(Ordering::Relaxed)
    }
}

/// A frame with everything some [`Needs`] asked for. Immutable; parts are shared with the frames it was completed from.
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
    /// One record a point, if asked for, or if estimating normals for colours brought them anyway.
    pub shapes: Option<Arc<Vec<ShapeRecord>>>,
    /// By what the signs of the normals in `shapes` were decided: the back of a surfel says nothing unless they are
    /// right. `None` without shapes.
    pub orientation: Option<Orientation>,
    /// The index of the points in the colours of `points`, if it was asked for.
    pub octree: Option<Arc<Octree>>,
    /// The surfels of the octree's nodes, if both surfels and an octree were asked for; worked out when they are drawn.
    pub lod_surfels: Option<Arc<LodSurfels>>,
    /// The octree's byte code with attributes, if it was asked for.
    pub coded: Option<Arc<CodedCloud>>,
    /// What the last completion took; decoding included if it happened then.
    pub timings: Timings,
    /// What was asked for, and what that is for this frame.
    asked: (Coloring, ColorHints),
    paint: Paint,
    has_ellipses: bool,
    octree_stop: Option<StopCriterion>,
}

impl PreparedFrame {
    /// True when completing it for `needs` would change nothing.
    pub fn satisfies(&self, needs: &Needs) -> bool {
        self.is_painted_for(needs)
            && (!needs.shapes || self.shapes.is_some())
            && (!needs.ellipses || self.has_ellipses)
            && (needs.octree.is_none() || needs.octree == self.octree_stop)
            && (!needs.asks_for_codes() || self.coded.is_some())
    }

    fn is_painted_for(&self, needs: &Needs) -> bool {
        self.asked == (needs.colors, needs.hints)
            || self.paint == needs.colors.paint(&needs.hints, &self.frame)
    }

    /// Where the colours of the points come from: see [`Paint::source`].
    pub fn colors(&self) -> ColorSource {
        self.paint.source()
    }

    /// What the points are painted with.
    pub fn paint(&self) -> &Paint {
        &self.paint
    }

    /// What the octree was built for.
    pub fn octree_stop(&self) -> Option<StopCriterion> {
        self.octree_stop
    }

    /// Whether it has fewer points than the file.
    pub fn is_sample(&self) -> bool {
        self.frame.is_sample()
    }

    /// The same points in `colors`, one a point, which `paint` says, under an id of their own: octree, byte code and
    /// surfels of its nodes are made anew if there are any. To be drawn, not to be completed: what is added later would
    /// have the colours of the file again.
    #[must_use]
    pub fn in_colors(&self, colors: &[[u8; 4]], paint: Paint) -> Self {
        let points = self.points.iter().zip(colors);
        let points = points.map(|(&point, &color)| PointRecord { color, ..point });
        let points = Arc::new(points.collect::<Vec<_>>());
        let stop = self.octree_stop.filter(|_| self.octree.is_some());
        let octree = stop.map(|stop| Octree::build(self.frame.positions(), colors, stop));
        let octree = octree.map(Arc::new);
        let surfels = octree.as_ref().zip(self.shapes.as_ref());
        let lod_surfels = surfels.filter(|_| self.lod_surfels.is_some());
        let lod_surfels = lod_surfels.map(|(octree, shapes)| {
            let points = Arc::clone(&points);
            Arc::new(LodSurfels::new(
                Arc::clone(octree),
                points,
                Arc::clone(shapes),
            ))
        });
        let coded = surfels.filter(|_| self.coded.is_some());
        let coded =
            coded.map(|(octree, shapes)| Arc::new(CodedCloud::new(octree, &points, shapes)));
        Self {
            id: next_id(),
            points,
            octree,
            lod_surfels,
            coded,
            paint,
            ..self.clone()
        }
    }

    /// The same, said to be painted as another frame: its points are among these.
    pub(super) fn painted_as(mut self, other: &Self) -> Self {
        self.frame
            .share_sample(Arc::clone(other.frame.value_sample()));
        self.paint = other.paint;
        self
    }

    /// Bytes of all parts.
    pub fn byte_size(&self) -> usize {
        self.frame.byte_size()
            + size_of_val(self.points.as_slice())
            + self
                .shapes
                .as_ref()
                .map_or(0, |shapes| size_of_val(shapes.as_slice()))
            + self.octree.as_ref().map_or(0, |octree| octree.byte_size())
            + self
                .lod_surfels
                .as_ref()
                .map_or(0, |surfels| surfels.most_bytes())
            + self.coded.as_ref().map_or(0, |coded| coded.byte_size())
    }
}

/// Prepares `frame` for `needs`. `decode_ms` is carried into the timings.
pub fn prepare(
    index: usize,
    frame: Arc<Frame>,
    decode_ms: f32,
    needs: &Needs,
    counters: &PrepareCounters,
) -> PreparedFrame {
    let never = Progress::default();
    prepare_observed(index, frame, decode_ms, needs, counters, &never)
}

/// [`prepare`], which says in `progress` how much of the estimation of normals is done: the rest takes little beside
/// it. Once that is cancelled, the answer is of no use.
pub(super) fn prepare_observed(
    index: usize,
    frame: Arc<Frame>,
    decode_ms: f32,
    needs: &Needs,
    counters: &PrepareCounters,
    progress: &Progress,
) -> PreparedFrame {
    let timings = Timings {
        decode_ms,
        ..Timings::default()
    };
    let observers = (counters, progress);
    build((index, frame), None, None, needs, timings, observers)
}

/// Prepares at most `most_points` of the points of `existing`, taken evenly. Normals and radii that are known are not
/// estimated again.
pub(super) fn prepare_sample(
    existing: &PreparedFrame,
    most_points: usize,
    needs: &Needs,
    counters: &PrepareCounters,
) -> Result<PreparedFrame, CloudError> {
    let start = Instant::now();
    let (frame, slots) = existing.frame.sample(most_points)?;
    let factor = radius_factor(existing.frame.len(), slots.len());
    let shapes = existing.shapes.as_ref().map(|shapes| {
        let shape = |&slot: &u32| ShapeRecord {
            radius: factor * shapes[slot as usize].radius,
            ..shapes[slot as usize]
        };
        Arc::new(slots.iter().map(shape).collect::<Vec<_>>())
    });
    let timings = Timings {
        records_ms: milliseconds_since(start),
        ..Timings::default()
    };
    let frame = Arc::new(frame);
    Ok(build(
        (existing.index, frame),
        None,
        shapes.zip(existing.orientation),
        needs,
        timings,
        (counters, &Progress::default()),
    ))
}

/// Prepares the points of `existing` at `slots` alone, for a picture that is soon replaced: where nobody knows a
/// sensor, normals agree with those of representatives. Radii are those that close the surface of these points,
/// whatever the file says.
pub fn prepare_part(
    existing: &PreparedFrame,
    slots: &[u32],
    needs: &Needs,
    counters: &PrepareCounters,
) -> Result<PreparedFrame, CloudError> {
    let mut timings = Timings::default();
    let (frame, _) = existing.frame.part(slots, None)?;
    let (shapes, orientation) =
        estimated_shapes(&frame, &mut timings, counters, estimate_surface_fast);
    Ok(build(
        (existing.index, Arc::new(frame)),
        None,
        Some((Arc::new(shapes), orientation)),
        needs,
        timings,
        (counters, &Progress::default()),
    ))
}

/// Adds to `existing` what `needs` ask for beyond it; parts that are still right are the same `Arc`s.
pub fn complete(
    existing: &PreparedFrame,
    needs: &Needs,
    counters: &PrepareCounters,
) -> PreparedFrame {
    complete_observed(existing, needs, counters, &Progress::default())
}

/// [`complete`], observed as [`prepare_observed`].
pub(super) fn complete_observed(
    existing: &PreparedFrame,
    needs: &Needs,
    counters: &PrepareCounters,
    progress: &Progress,
) -> PreparedFrame {
    if existing.satisfies(needs) {
        return existing.clone();
    }
    build(
        (existing.index, Arc::clone(&existing.frame)),
        Some(existing),
        existing.shapes.clone().zip(existing.orientation),
        needs,
        Timings::default(),
        (counters, progress),
    )
}

/// Makes what `needs` ask for and is not known: of the frame `existing` was made from, or `shapes`, if they are known.
fn build(
    (index, frame): (usize, Arc<Frame>),
    existing: Option<&PreparedFrame>,
    known: Option<(Arc<Vec<ShapeRecord>>, Orientation)>,
    needs: &Needs,
    mut timings: Timings,
    (counters, progress): (&PrepareCounters, &Progress),
) -> PreparedFrame {
    let (mut shapes, mut orientation) = known.unzip();
    let same_colors = existing.filter(|existing| existing.is_painted_for(needs));
    let paint = match same_colors {
        Some(existing) => existing.paint,
        None => needs.colors.paint(&needs.hints, &frame),
    };

    let colors_need_shapes =
        paint == Paint::Normal && same_colors.is_none() && records::file_normals(&frame).is_none();
    if shapes.is_none() && (needs.shapes || needs.ellipses || colors_need_shapes) {
        let estimate = |positions: &[Vec3], sensor| {
            progress.set(0, surface_steps(positions.len(), sensor));
            estimate_surface_observed(positions, sensor, progress)
        };
        let (estimated, by) = estimated_shapes(&frame, &mut timings, counters, estimate);
        (shapes, orientation) = (Some(Arc::new(estimated)), Some(by));
    }

    let mut has_ellipses = existing.is_some_and(|existing| existing.has_ellipses);
    if let (Some(circles), true) = (&shapes, needs.ellipses && !has_ellipses) {
        let start = Instant::now();
        shapes = records::with_ellipses(&frame, circles)
            .map(Arc::new)
            .or(shapes);
        timings.analysis_ms += milliseconds_since(start);
        has_ellipses = true;
    }

    let (id, points) = if let Some(existing) = same_colors {
        (existing.id, Arc::clone(&existing.points))
    } else {
        let start = Instant::now();
        let shapes = shapes.as_deref().map(Vec::as_slice);
        let points = records::painted_points(&frame, &paint, shapes);
        timings.records_ms += milliseconds_since(start);
        counters
            .records_written
            .fetch_add(points.len() as u64, Ordering::Relaxed);
        (next_id(), Arc::new(points))
    };

    let reusable = same_colors
        .and_then(|existing| existing.octree_stop.zip(existing.octree.clone()))
        .filter(|&(stop, _)| needs.octree.is_none_or(|needed| needed == stop));
    let octree = reusable.or_else(|| {
        let stop = needs.octree?;
        let start = Instant::now();
        let octree = match same_colors.and_then(|existing| existing.octree.as_ref()) {
            Some(octree) => octree.with_stop(stop),
            None => build_octree(&frame, &paint, &points, stop),
        };
        timings.octree_ms = milliseconds_since(start);
        counters.octrees_built.fetch_add(1, Ordering::Relaxed);
        Some((stop, Arc::new(octree)))
    });
    let (octree_stop, octree) = octree.unzip();
    let is_asked_for = needs.shapes && needs.octree.is_some();
    let lod_surfels = octree
        .as_ref()
        .zip(shapes.as_ref())
        .filter(|_| is_asked_for);
    let lod_surfels = lod_surfels.map(|(octree, shapes)| {
        let known = existing.and_then(|existing| existing.lod_surfels.clone());
        known
            .filter(|known| known.is_of(octree, &points, shapes))
            .unwrap_or_else(|| {
                Arc::new(LodSurfels::new(
                    Arc::clone(octree),
                    Arc::clone(&points),
                    Arc::clone(shapes),
                ))
            })
    });
    let coded = octree.as_ref().zip(shapes.as_ref());
    let coded = coded.filter(|_| needs.asks_for_codes());
    let coded = coded.map(|(octree, shapes)| {
        let known = existing.and_then(|existing| existing.coded.clone());
        known
            .filter(|known| known.is_of(octree, &points, shapes))
            .unwrap_or_else(|| {
                let start = Instant::now();
                let coded = CodedCloud::new(octree, &points, shapes);
                timings.octree_ms += milliseconds_since(start);
                Arc::new(coded)
            })
    });
    PreparedFrame {
        index,
        id,
        frame,
        points,
        shapes,
        orientation,
        octree,
        lod_surfels,
        coded,
        timings,
        asked: (needs.colors, needs.hints),
        paint,
        has_ellipses,
        octree_stop,
    }
}

/// The shapes of all points, of which `estimate` estimates the missing normals: see [`records::complete_surface`].
fn estimated_shapes(
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
    timings.analysis_ms = milliseconds_since(start);
    let start = Instant::now();
    let shapes = records::shape_records(frame, &surface);
    timings.records_ms += milliseconds_since(start);
    counters
        .records_written
        .fetch_add(shapes.len() as u64, Ordering::Relaxed);
    (shapes, surface.orientation)
}

fn build_octree(
    frame: &Frame,
    paint: &Paint,
    points: &[PointRecord],
    stop: StopCriterion,
) -> Octree {
    match frame.colors() {
        Some(file_colors) if *paint == Paint::File => {
            Octree::build(frame.positions(), file_colors, stop)
        }
        _ => {
            let colors: Vec<[u8; 4]> = points.iter().map(|point| point.color).collect();
            Octree::build(frame.positions(), &colors, stop)
        }
    }
}

fn next_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
