//! Space of a sequence: the origin that is subtracted from f64 file coordinates so that f32 keeps the detail, and the
//! cells that octrees of all frames share.
//!
//! **How it works.** An f32 has 24 significant bits. A cloud of extent e around a centre c spends log2(|c| / e) of them
//! on encoding where it is. Up to two bits are given away for the sake of coordinates that read like those of the file;
//! beyond that the origin becomes the centre, rounded to a grid whose step is a power of two near the extent. Rounding
//! keeps the origin short in binary, so that subtracting it from f32 coordinates is exact.
//!
//! **Cells.** The cube around the frame that decides the origin is one cell of the lattice ([`Lattice`]).
//!
//! **By some points.** Of a large frame some points are shown before all are read: they decide the origin then. The
//! grid's step and the centre match those of all points, or are so near that f32 from there keep the same precision.
//! The cells wait for all points, which have another cube around them.
//!
//! **Alongside another sequence** its origin is used if that preserves enough: the same coordinates of two files are
//! then the same f32, and equal clouds have no distance. Its cells are used with it.
//!
//! **Once.** The first caller decodes frames from the start until one is readable, others wait for it. Its decoded
//! frame is cached until it is loaded, and errors it met are cached as well: nothing is decoded twice, except cancelled
//! frames.

use super::error::FrameError;
use crate::cloud::{MissingPoints, NoData, RawCloud, Space, ValueSample};
use crate::locks::lock;
use crate::math::{Aabb, Cube, Lattice};
use crate::progress::Progress;
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

/// The centre may be this many extents away from zero before the origin moves.
const FAR_IN_EXTENTS: f64 = 4.0;

/// Maximum distance of the centre from the origin of another sequence, in extents: 18 bits are left, finer than the
/// point spacing, and a part of a cloud has the same f32 as the whole.
const FAR_COMPANION_IN_EXTENTS: f64 = 64.0;

/// A decoded frame with its time in milliseconds, or the reason why there is none.
type Cached = Result<(RawCloud, f32), FrameError>;

/// Provenance of a space: how it was decided.
enum Decided {
    ByFrame(Space),
    /// No frame has a point.
    ByNone,
}

/// The frames that a space is for.
pub(super) trait SpaceFrames: Send + Sync {
    fn frame_count(&self) -> usize;

    /// Returns true if frames may arrive or be read again.
    fn may_grow(&self) -> bool;

    /// Decodes a frame in file coordinates; with the time that it took in milliseconds.
    fn decode_timed(&self, index: usize, progress: &Progress) -> Result<(RawCloud, f32), FrameError>;

    /// Handling of points that stand for no measurement.
    fn no_data(&self) -> NoData;

    /// Some points of a few frames after `index`, where they can be read without the others.
    fn further_samples(&self, index: usize) -> Vec<RawCloud>;

    /// Their space; `None` if deciding it was cancelled.
    fn space_observed(&self, progress: &Progress) -> Option<Space>;
}

/// Decides the space once, on demand.
#[derive(Default)]
pub(super) struct SpaceFinder {
    origin: OnceLock<DVec3>,
    /// Decided with the origin, or later if some points decided that; `None` if no frame has a point.
    lattice: OnceLock<Option<Lattice>>,
    /// Held by the deciding thread, with the number of cancellations.
    deciding: Mutex<()>,
    given_up: AtomicUsize,
    /// The sequence whose space is taken if possible.
    companion: OnceLock<Arc<dyn SpaceFrames>>,
    cached: Mutex<BTreeMap<usize, Cached>>,
    /// Points of the frame that decided it.
    sample: Mutex<SharedSample>,
}

/// Points of one frame that represent the value ranges of all.
#[derive(Default)]
struct SharedSample {
    /// With the index of the frame.
    of: Option<(usize, Arc<ValueSample>)>,
    /// The file of that frame has changed since, as it was half-written.
    is_outdated: bool,
}

impl SpaceFinder {
    /// The space; `None` if that took decoding, which was cancelled.
    pub(super) fn space(&self, frames: &dyn SpaceFrames, progress: &Progress) -> Option<Space> {
        self.known().or_else(|| {
            let given_up = || self.given_up.load(Ordering::Relaxed);
            let before = given_up();
            let _turn = lock(&self.deciding);
            // Another thread may have determined it in the meantime; after a cancellation not every waiting thread
            // tries again.
            self.known().or_else(|| {
                if given_up() != before {
                    return None;
                }
                match self.decide(frames, progress) {
                    None => {
                        self.given_up.fetch_add(1, Ordering::Relaxed);
                        None
                    }
                    // The first frame of a folder may still be being written: then a later one decides.
                    Some(Decided::ByNone) if frames.may_grow() => Some(Space::default()),
                    Some(Decided::ByNone) => Some(self.keep(Space::default())),
                    Some(Decided::ByFrame(space)) => Some(self.keep(space)),
                }
            })
        })
    }

    /// Takes the space of `other` if that keeps the detail. Has no effect once the space is decided, or for the
    /// second time.
    pub(super) fn share(&self, other: Arc<dyn SpaceFrames>) {
        if self.companion.set(other).is_err() {
            log::debug!("a space is shared with one other sequence");
        }
    }

    /// The space, if it is decided.
    fn known(&self) -> Option<Space> {
        Some(Space {
            origin: *self.origin.get()?,
            lattice: *self.lattice.get()?,
        })
    }

    /// The origin, if it is decided.
    pub(super) fn known_origin(&self) -> Option<DVec3> {
        self.origin.get().copied()
    }

    /// Sets what is not decided yet.
    fn keep(&self, space: Space) -> Space {
        Space {
            origin: *self.origin.get_or_init(|| space.origin),
            lattice: *self.lattice.get_or_init(|| space.lattice),
        }
    }

    /// The space of some points of a frame, as far as it is decided: its cells may not be.
    pub(super) fn known_of_sample(&self) -> Option<Space> {
        Some(Space {
            origin: *self.origin.get()?,
            lattice: self.lattice.get().copied().flatten(),
        })
    }

    /// [`SpaceFinder::known_of_sample`], whose origin is decided by the box around some points of the first frame if it
    /// is not known; `None` where it depends on another sequence.
    pub(super) fn decided_by(&self, present: Option<(DVec3, DVec3)>) -> Option<Space> {
        self.known_of_sample().or_else(|| {
            let _turn = lock(&self.deciding);
            if self.origin.get().is_none() {
                let (min, max) = present.filter(|_| self.companion.get().is_none())?;
                self.origin.get_or_init(|| origin_of_bounds(min, max));
            }
            self.known_of_sample()
        })
    }

    fn decide(&self, frames: &dyn SpaceFrames, progress: &Progress) -> Option<Decided> {
        for index in 0..frames.frame_count() {
            if progress.is_cancelled() {
                return None;
            }
            if lock(&self.cached).get(&index).is_some_and(Result::is_err) {
                continue;
            }
            let decoded = frames.decode_timed(index, progress);
            let missing = decoded
                .as_ref()
                .map(|(raw, _)| MissingPoints::of(raw, frames.no_data()));
            match missing.as_ref().map(|missing| (missing.bounds, &missing.indices)) {
                Ok((Some((min, max)), missing)) => {
                    let companion = match self.companion.get() {
                        Some(other) => Some(other.space_observed(progress)?),
                        None => None,
                    };
                    let is_near = |space: &Space| is_near(space.origin, min, max, FAR_COMPANION_IN_EXTENTS);
                    let shared = companion.filter(is_near);
                    let origin = self.origin.get().copied().or(shared.map(|space| space.origin));
                    let origin = origin.unwrap_or_else(|| origin_of_bounds(min, max));
                    // Another sequence without a point has none.
                    let lattice = shared
                        .filter(|space| space.origin == origin)
                        .and_then(|space| space.lattice);
                    let lattice = lattice.or_else(|| lattice_of_bounds(origin, min, max));
                    let space = Space { origin, lattice };
                    if let Ok((raw, _)) = &decoded {
                        let mut sample = ValueSample::of_raw(raw, missing, space.origin);
                        for further in frames.further_samples(index) {
                            sample.add_scalars_of(&further);
                        }
                        let sample = Arc::new(sample);
                        lock(&self.sample).of.get_or_insert((index, sample));
                    }
                    lock(&self.cached).insert(index, decoded);
                    return Some(Decided::ByFrame(space));
                }
                // A frame without a finite point decides nothing; retaining many of them could fill the memory.
                Ok((None, _)) => {}
                Err(FrameError::Cancelled { .. }) => return None,
                Err(_) => {
                    lock(&self.cached).insert(index, decoded);
                }
            }
        }
        Some(Decided::ByNone)
    }

    /// Discards the error of frame `index`, or the data read of it.
    pub(super) fn forget(&self, index: usize) {
        lock(&self.cached).remove(&index);
        let mut sample = lock(&self.sample);
        sample.is_outdated |= sample.of.as_ref().is_some_and(|(decided, _)| *decided == index);
    }

    /// Returns true if the points of [`SpaceFinder::sample`] belong to a file that has changed since.
    pub(super) fn is_sample_outdated(&self) -> bool {
        lock(&self.sample).is_outdated
    }

    /// Replaces outdated sample points by those of frame `index`. The origin stays: frames are relative to it.
    pub(super) fn renew_sample(&self, index: usize, sample: impl FnOnce() -> ValueSample) {
        if !self.is_sample_outdated() {
            return;
        }
        let renewed = Arc::new(sample());
        let mut sample = lock(&self.sample);
        sample.of = Some((index, renewed));
        sample.is_outdated = false;
    }

    /// Returns the result cached for frame `index` since the origin was decided; a decoded frame is handed out once,
    /// errors stay.
    pub(super) fn take_cached(&self, index: usize) -> Option<Cached> {
        let mut cached = lock(&self.cached);
        match cached.get(&index)? {
            Ok(_) => cached.remove(&index),
            Err(error) => Some(Err(error.clone())),
        }
    }

    /// Points of the frame that decided the origin; `None` before, and where no frame has a point.
    pub(super) fn sample(&self) -> Option<Arc<ValueSample>> {
        lock(&self.sample).of.as_ref().map(|(_, sample)| Arc::clone(sample))
    }

    pub(super) fn cached_bytes(&self) -> usize {
        lock(&self.cached)
            .values()
            .filter_map(|cached| cached.as_ref().ok())
            .map(|(raw, _)| raw.byte_size())
            .sum()
    }

    pub(super) fn drop_cached(&self) {
        lock(&self.cached).retain(|_, cached| cached.is_err());
    }
}

/// Returns the centre and diagonal of finite coordinates between `min` and `max`.
fn center_and_extent(min: DVec3, max: DVec3) -> (DVec3, f64) {
    let extent = (max * 0.5 - min * 0.5).length() * 2.0;
    (min * 0.5 + max * 0.5, extent)
}

/// Returns true if coordinates between `min` and `max` are no more than the given number of extents away from `origin`,
/// so that f32 keep their detail.
fn is_near(origin: DVec3, min: DVec3, max: DVec3, far_in_extents: f64) -> bool {
    let (center, extent) = center_and_extent(min, max);
    let away = center - origin;
    if extent == 0.0 {
        // All points coincide: f32 can represent the position, or not.
        return away.as_vec3().as_dvec3() == away;
    }
    away.length() <= far_in_extents * extent
}

/// The cells for finite coordinates between `min` and `max`, relative to an origin.
fn lattice_of_bounds(origin: DVec3, min: DVec3, max: DVec3) -> Option<Lattice> {
    // As a frame has them: rounding keeps their order.
    let bounds = Aabb {
        min: (min - origin).as_vec3(),
        max: (max - origin).as_vec3(),
    };
    let is_finite = bounds.min.is_finite() && bounds.max.is_finite();
    Cube::around_box(&bounds).filter(|_| is_finite).map(Lattice::of)
}

/// The origin for finite coordinates between `min` and `max`.
fn origin_of_bounds(min: DVec3, max: DVec3) -> DVec3 {
    let (center, extent) = center_and_extent(min, max);
    if !extent.is_finite() || is_near(DVec3::ZERO, min, max, FAR_IN_EXTENTS) {
        return DVec3::ZERO;
    }
    if extent == 0.0 {
        return center;
    }
    let step = extent.log2().ceil().exp2();
    let rounded = (center / step).round() * step;
    if rounded.is_finite() { rounded } else { center }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, even_places};
    use crate::sequence::Sequence;
    use crate::source::{FrameEntry, FrameList};
    use proptest::prelude::*;

    #[test]
    fn coordinates_around_zero_are_unchanged() {
        assert_eq!(
            origin_of_bounds(DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.0, 2.0, 3.0)),
            DVec3::ZERO
        );
    }

    #[test]
    fn samples_of_a_half_written_frame_are_refreshed() {
        let sample = |z: f32| {
            let raw = RawCloud::from_positions(Positions::F32(vec![[0.0, 0.0, z]]));
            ValueSample::of_raw(&raw, &[], DVec3::ZERO)
        };
        let finder = SpaceFinder::default();
        lock(&finder.sample).of = Some((3, Arc::new(sample(1.0))));
        finder.forget(2);
        finder.renew_sample(4, || sample(2.0));
        let height = || finder.sample().unwrap().positions[0].z;
        assert!(!finder.is_sample_outdated() && height() == 1.0);
        finder.forget(3);
        assert!(finder.is_sample_outdated());
        finder.renew_sample(4, || sample(2.0));
        assert!(!finder.is_sample_outdated() && height() == 2.0);
    }

    #[test]
    fn a_sample_of_the_first_frame_determines_the_origin() {
        let cloud = |places: Vec<usize>| {
            let far = |index: usize| [1e6 + index as f64 / 128.0, 0.0, 0.0];
            let positions = places.into_iter().map(far).collect();
            RawCloud::from_positions(Positions::F64(positions))
        };
        let sources = ["a.ply", "b.ply"].map(FrameEntry::file);
        let source = FrameList::new(sources.into(), move |_, _| Ok(cloud((0..1000).collect())));
        let sequence = Sequence::of(source.with_sample(move |_, most, fewest| {
            Ok((fewest <= 1000).then(|| (cloud(even_places(1000, most)).into(), 1000)))
        }));
        assert!(sequence.load_sample(1, 100, 0).is_none(), "the first one decides");
        assert!(sequence.load_sample(0, 100, 1001).is_none(), "too few");
        let sample = sequence.load_sample(0, 100, 1000).unwrap().frame;
        assert_eq!((sample.len(), sample.points_in_file()), (100, 1000));
        assert!((sequence.origin().x - 1e6).abs() <= 16.0);
        assert!(sequence.load_sample(1, 100, 0).is_some());
        assert_eq!(sequence.decode_count(), 0, "nothing is read whole");
        let whole = sequence.frame(0).unwrap();
        let fitted = Cube::around(whole.positions()).unwrap();
        assert_eq!(whole.cube(), fitted, "cells are decided by all points");
        assert_eq!(sequence.decode_count(), 1, "and it is read once for that");
        for (&index, at) in sample.file_index().iter().zip(sample.positions()) {
            let slot = whole.file_index().iter().position(|&i| i == index);
            assert_eq!(*at, whole.positions()[slot.unwrap()]);
        }
    }

    #[test]
    fn far_coordinates_move_to_a_short_origin() {
        // Extent √(50² + 27² + 30²) ≈ 64.2, so the step is 128.
        let origin = origin_of_bounds(DVec3::new(-75.0, -766.0, 0.0), DVec3::new(-25.0, -739.0, 30.0));
        assert_eq!(origin, DVec3::new(0.0, -768.0, 0.0));
    }

    #[test]
    fn a_single_far_point_moves_only_if_f32_loses_it() {
        let short = DVec3::splat(4_194_304.5);
        assert_eq!(origin_of_bounds(short, short), DVec3::ZERO);
        let long = DVec3::splat(4_194_304.001);
        assert_eq!(origin_of_bounds(long, long), long);
    }

    #[test]
    fn an_origin_is_shared_where_it_keeps_the_detail() {
        use crate::cloud::Positions;
        let corners = |min: DVec3, edge: f64| {
            let positions = vec![min.to_array(), (min + DVec3::splat(edge)).to_array()];
            Arc::new(Sequence::with_decoder(vec![FrameEntry::file("corners")], move |_| {
                let positions = Positions::F64(positions.clone());
                Ok(RawCloud::from_positions(positions))
            }))
        };
        let survey = DVec3::new(4.5e6, 5.0e5, 100.0);
        let a = corners(survey, 64.0);
        // A part of it has its own origin, on a finer grid, and takes the origin of the whole.
        let part = corners(survey + DVec3::splat(9.0), 10.0);
        let alone = corners(survey + DVec3::splat(9.0), 10.0);
        part.share_origin_with(&a);
        assert_ne!(alone.origin(), a.origin());
        assert_eq!(part.origin(), a.origin());
        // In f32 relative to that origin, millimetres would be lost.
        let far = corners(survey + DVec3::new(1e5, 0.0, 0.0), 10.0);
        far.share_origin_with(&a);
        assert_ne!(far.origin(), a.origin());
        // Shared with itself: does not wait for its own result.
        a.share_origin_with(&a);
        part.share_origin_with(&part);
        assert_eq!(part.origin(), a.origin());
    }

    #[test]
    fn points_at_rest_stay_in_their_cells() {
        use crate::levels::octree::{Octree, StopCriterion};
        // The first of them is on the upper face of the first cube, which has an edge of 7.
        let moving = [[7.0, 0.0, 0.0], [9.0, -20.0, 4.0], [-300.0, 6.0, 2.0]];
        let entries = (0..).zip(moving).map(|(number, _)| FrameEntry {
            number: Some(number),
            ..FrameEntry::file("a.ply")
        });
        let sequence = Sequence::with_decoder(entries.collect(), move |entry| {
            let share = |index: usize, step: f32| (index as f32 * step).fract();
            let at_rest = |index| {
                [
                    7.0 * share(index, 0.618),
                    5.0 * share(index, 0.414),
                    3.0 * share(index, 0.732),
                ]
            };
            let mut positions: Vec<_> = (0..100).map(at_rest).collect();
            positions.push(moving[entry.number.unwrap_or_default() as usize]);
            Ok(RawCloud::from_positions(Positions::F32(positions)))
        });
        let leaves_at_rest = |index: usize| {
            let frame = sequence.frame(index).unwrap();
            let depth = frame.own_level(5);
            let colors = vec![[0; 4]; frame.len()];
            let tree = Octree::build_in(frame.cube(), frame.positions(), &colors, StopCriterion::Depth(depth));
            let leaves = tree.level_voxels(depth).into_iter().map(|voxel| voxel.center);
            let mut at_rest: Vec<_> = leaves
                .filter(|center| center.iter().all(|c| (0.0..6.7).contains(c)))
                .collect();
            at_rest.sort_by(|a, b| a.partial_cmp(b).unwrap());
            (frame.cube().edge, at_rest)
        };
        let (edge, first) = leaves_at_rest(0);
        assert!(edge == 7.0 && first.len() > 60, "{edge} {}", first.len());
        for index in [1, 2] {
            let (larger, leaves) = leaves_at_rest(index);
            assert!(larger > edge && leaves.len() == first.len());
            let both = first.iter().flatten().zip(leaves.iter().flatten());
            assert!(both.into_iter().all(|(a, b)| (a - b).abs() < 1e-3), "frame {index}");
        }
    }

    #[test]
    fn the_largest_numbers_do_not_overflow() {
        assert_eq!(
            origin_of_bounds(DVec3::splat(f64::MIN), DVec3::splat(f64::MAX)),
            DVec3::ZERO
        );
        assert!(origin_of_bounds(DVec3::splat(1.7e308), DVec3::splat(1.71e308)).is_finite());
    }

    proptest! {
        /// After the shift no corner is farther than the rule allows, so f32 keeps at least 20 bits of the extent.
        #[test]
        fn shifted_clouds_are_near_zero(
            x in -1e9f64..1e9, y in -1e9f64..1e9, z in -1e9f64..1e9, edge in 1e-3f64..1e6,
        ) {
            let min = DVec3::new(x, y, z);
            let max = min + DVec3::splat(edge);
            let origin = origin_of_bounds(min, max);
            let extent = (max - min).length();
            let farthest = (min - origin).abs().max((max - origin).abs()).length();
            prop_assert!(farthest <= (FAR_IN_EXTENTS + 1.0) * extent, "{farthest} for {extent}");
        }
    }
}
