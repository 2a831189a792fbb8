//! Trails: the trajectories of points over time, following one index in the file through every frame where that index
//! can be trusted.
//!
//! **How it works.** Frames are visited one after the other, in memory where all their points are resident, else in
//! their files; only the positions of the followed points are stored. An index means the same point in two frames if
//! these have the same number of points and appear to have them in the same order. That is a heuristic: 256 points of
//! evenly spread indices, relative to their common centroid, have to lie less than half as far from themselves in the
//! previous frame as from the others ([`keeps_order`]). A trail ends where that fails, starting from the frame in which
//! its point was chosen. Sensors with the same scan directions in every revolution pass, although their measurements
//! are not the same point of the scene.

mod breaks;
mod order;
mod stage;
mod tube;

pub use breaks::{BreakReason, TrailBreak};
pub(super) use stage::STAGE;

use crate::cloud::even_places;
use crate::progress::Progress;
use crate::sequence::{FrameError, PreparedFrame, Sequence};
use glam::{DVec3, Vec3};
use order::{WITNESSES, keeps_order};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Max stored bytes of positions.
const MAX_BYTES: usize = 64 << 20;

/// Request for trails: the points to follow, and the frames to follow them through.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrailRequest {
    /// Point indices in the file. If their positions would exceed 64 MiB, the last ones are omitted.
    pub indices: Vec<u32>,
    /// The frame in which they were chosen.
    pub chosen_in: usize,
    /// Points that its file has.
    pub points_in_file: usize,
    /// The frames, of those that there are.
    pub frames: Range<usize>,
}

/// The length of a trail and how fast its point is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrailMeasure {
    /// Path length, scene units, excluding breaks.
    pub length: f64,
    /// Path length over time, scene units per second.
    pub mean_speed: f64,
    /// The largest speed from one frame to the next, scene units per second.
    pub max_speed: f64,
}

/// Trails: the positions of the followed points, frame by frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Trails {
    frames: Range<usize>,
    trail_count: usize,
    /// Positions, one row per frame, relative to the sequence's origin; NaN where there is none.
    places: Vec<Vec3>,
    breaks: Vec<TrailBreak>,
}

/// Positions evaluated in a frame.
struct FramePlaces {
    witnesses: Vec<Vec3>,
    followed: Vec<Vec3>,
}

impl Trails {
    /// Follows points through `sequence`. `resident` gives frames that are in memory; `progress` counts the visited
    /// ones. There is no result once it is cancelled.
    pub fn trace(
        request: &TrailRequest,
        sequence: &Sequence,
        resident: impl Fn(usize) -> Option<Arc<PreparedFrame>>,
        progress: &Progress,
    ) -> Option<Self> {
        let frame_count = sequence.len();
        let frames = request.frames.start.min(frame_count)..request.frames.end.min(frame_count);
        // 12 bytes per point and frame.
        let max = MAX_BYTES / size_of::<Vec3>() / frames.len().max(1);
        let followed = &request.indices[..request.indices.len().min(max)];
        let witnesses = even_places(request.points_in_file, WITNESSES);
        let witnesses: Vec<u32> = witnesses.into_iter().map(|index| index as u32).collect();
        let mut visited: Vec<usize> = frames.clone().collect();
        if request.chosen_in < frame_count && !frames.contains(&request.chosen_in) {
            visited.push(request.chosen_in);
            visited.sort_unstable();
        }

        let mut walk = Walk::new(request);
        for (done, &index) in visited.iter().enumerate() {
            progress.set(done, visited.len());
            if progress.is_cancelled() {
                return None;
            }
            let resident = resident(index);
            let looked = look(sequence, index, resident, request.points_in_file, |at| {
                let places = |indices: &[u32]| indices.iter().map(|&index| at(index)).collect();
                FramePlaces {
                    witnesses: places(&witnesses),
                    followed: places(followed),
                }
            });
            match looked {
                Ok(seen) => walk.go_through(index, seen),
                Err(points) => walk.stumble(index, points),
            }
        }
        Some(walk.into_trails(frames, followed.len()))
    }

    /// The frames that were looked at.
    pub fn frames(&self) -> Range<usize> {
        self.frames.clone()
    }

    /// Number of points that were followed, in the order of the request.
    pub fn trail_count(&self) -> usize {
        self.trail_count
    }

    /// Returns the position of a point in a frame, relative to the sequence's origin; `None` if it is not known.
    pub fn place(&self, trail: usize, frame: usize) -> Option<Vec3> {
        if !self.frames.contains(&frame) || trail >= self.trail_count {
            return None;
        }
        let place = self.places[(frame - self.frames.start) * self.trail_count + trail];
        place.is_finite().then_some(place)
    }

    /// Returns the trail breaks, in order.
    pub fn breaks(&self) -> &[TrailBreak] {
        &self.breaks
    }

    /// Length and speeds of a trail, frames having been taken at `time_s`; `None` where no two neighbouring frames have
    /// the point.
    pub fn measure(&self, trail: usize, time_s: impl Fn(usize) -> f64) -> Option<TrailMeasure> {
        let (mut length, mut seconds, mut max_speed) = (0.0, 0.0, 0.0f64);
        let mut last: Option<(usize, DVec3)> = None;
        let mut steps = 0;
        for frame in self.frames() {
            let place = self.place(trail, frame).map(Vec3::as_dvec3);
            if let (Some((before, from)), Some(to)) = (last, place) {
                let (step, lasts) = (from.distance(to), time_s(frame) - time_s(before));
                length += step;
                seconds += lasts;
                max_speed = max_speed.max(step / lasts);
                steps += 1;
            }
            last = place.map(|place| (frame, place));
        }
        (steps > 0).then_some(TrailMeasure {
            length,
            mean_speed: length / seconds,
            max_speed,
        })
    }
}

/// State of the tracing after some of the frames have been visited.
struct Walk<'a> {
    request: &'a TrailRequest,
    /// Places of the followed points, by frame.
    rows: BTreeMap<usize, Vec<Vec3>>,
    breaks: Vec<TrailBreak>,
    /// Frames with another order, each after the last frame before it.
    turns: Vec<(usize, usize)>,
    /// The last frame that points were followed through, and its witnesses.
    before: Option<(usize, Vec<Vec3>)>,
    was_broken: bool,
}

impl<'a> Walk<'a> {
    fn new(request: &'a TrailRequest) -> Self {
        Self {
            request,
            rows: BTreeMap::new(),
            breaks: Vec::new(),
            turns: Vec::new(),
            before: None,
            was_broken: false,
        }
    }

    /// Handles a frame with the same number of points.
    fn go_through(&mut self, frame: usize, seen: FramePlaces) {
        if let Some((last, witnesses)) = &self.before
            && !keeps_order(witnesses, &seen.witnesses)
        {
            self.turns.push((*last, frame));
        }
        self.before = Some((frame, seen.witnesses));
        self.rows.insert(frame, seen.followed);
        self.was_broken = false;
    }

    /// Handles a frame with another number of points, or one that cannot be read.
    fn stumble(&mut self, frame: usize, points: Option<usize>) {
        if std::mem::replace(&mut self.was_broken, true) {
            return;
        }
        let last = self.before.as_ref().map(|(last, _)| *last);
        let reason = points.map_or(BreakReason::Unreadable, |points| BreakReason::OtherCount {
            points,
            other: last.unwrap_or(self.request.chosen_in),
            other_points: self.request.points_in_file,
        });
        self.breaks.push(TrailBreak { frame, reason });
    }

    /// Returns the trails over the stretch of frames around the one in which the points were chosen, as far as all
    /// frames have the same point order.
    fn into_trails(mut self, frames: Range<usize>, trail_count: usize) -> Trails {
        let chosen = self.request.chosen_in;
        let begin = self.turns.iter().rev().find(|(_, turn)| *turn <= chosen);
        let end = self.turns.iter().find(|(_, turn)| *turn > chosen);
        let stretch = begin.map_or(0, |turn| turn.1)..end.map_or(usize::MAX, |turn| turn.1);
        let mut breaks = self.breaks;
        breaks.retain(|broken| stretch.contains(&broken.frame));
        let turns = begin.into_iter().chain(end);
        breaks.extend(turns.map(|&(before, frame)| TrailBreak {
            frame,
            reason: BreakReason::OtherOrder { before },
        }));
        breaks.sort_by_key(|broken| broken.frame);
        let nowhere = vec![Vec3::NAN; trail_count];
        let places = frames.clone().flat_map(|frame| {
            let row = self.rows.remove(&frame);
            let row = row.filter(|_| stretch.contains(&frame));
            row.unwrap_or_else(|| nowhere.clone())
        });
        Trails {
            trail_count,
            places: places.collect(),
            breaks,
            frames,
        }
    }
}

/// Returns the result of `take` on the positions of points by their index in the file; NaN where the file has no such
/// point. `Err` holds the point count if it differs, `None` if the frame cannot be read.
fn look<T>(
    sequence: &Sequence,
    index: usize,
    resident: Option<Arc<PreparedFrame>>,
    points_in_file: usize,
    take: impl FnOnce(&dyn Fn(u32) -> Vec3) -> T,
) -> Result<T, Option<usize>> {
    if let Some(prepared) = resident.filter(|frame| !frame.is_sample()) {
        let frame = &prepared.frame;
        if frame.points_in_file() != points_in_file {
            return Err(Some(frame.points_in_file()));
        }
        let mut slots = vec![u32::MAX; points_in_file];
        for (slot, &index) in frame.file_index().iter().enumerate() {
            slots[index as usize] = slot as u32;
        }
        let positions = frame.positions();
        return Ok(take(&|index| {
            let slot = slots.get(index as usize).copied().unwrap_or(u32::MAX);
            positions.get(slot as usize).copied().unwrap_or(Vec3::NAN)
        }));
    }
    let raw = sequence.decode(index).map_err(|_: FrameError| None)?;
    let positions = raw.positions;
    if positions.len() != points_in_file {
        return Err(Some(positions.len()));
    }
    let origin = sequence.origin();
    Ok(take(&|index| {
        let index = index as usize;
        if index < positions.len() {
            (positions.get(index) - origin).as_vec3()
        } else {
            Vec3::NAN
        }
    }))
}

#[cfg(test)]
mod tests;
