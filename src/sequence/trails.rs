//! Where points go through time: those with one index in the file, in every frame of which that can be said.
//!
//! **How it works.** Frames are looked at one after the other, in memory where all their points are, else in their files; of each only
//! the places of the followed points are kept. An index means one point in two frames if these have as many points and seem to
//! have them in one order. Whether they do is guessed: 256 points of evenly spread indices, seen from their common middle, have to lie
//! nearer to themselves in the frame before than half as far as to others of them ([`keeps_order`]). A trail ends where that fails,
//! seen from the frame in which its point was chosen. Scanners that look the same way in every turn pass, although what they see is
//! not the same point of the scene.

use super::{FrameError, PreparedFrame, Sequence};
use crate::cloud::even_places;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Points by which the order of two frames is compared, and fewest that say something.
const WITNESSES: usize = 256;
const FEWEST_WITNESSES: usize = 16;

/// As a share of the median distance between different points, how far points may have moved where the order has stayed.
const FARTHEST_MOVE: f32 = 0.5;

/// Bytes of places that are kept at most.
const MAX_BYTES: usize = 64 << 20;

/// Which points are followed through which frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrailRequest {
    /// Their indices in the file. Of too many for 64 MiB of places the last are left out.
    pub indices: Vec<u32>,
    /// The frame in which they were chosen.
    pub chosen_in: usize,
    /// Points that its file has.
    pub points_in_file: usize,
    /// The frames, of those that there are.
    pub frames: Range<usize>,
}

/// A frame through which points cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrailBreak {
    /// The frame; of several in a row the first.
    pub frame: usize,
    /// Why not.
    pub reason: BreakReason,
}

/// Why points cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BreakReason {
    /// There are more points, or fewer.
    OtherCount {
        /// How many.
        points: usize,
        /// A frame in which points are followed.
        other: usize,
        /// How many that one has.
        other_points: usize,
    },
    /// The points seem to be in another order than in this frame before.
    OtherOrder {
        /// The last frame before.
        before: usize,
    },
    /// The frame cannot be read.
    Unreadable,
}

impl TrailBreak {
    /// What to tell a person who calls the first frame `first`.
    pub fn text(&self, first: usize) -> String {
        let frame = self.frame + first;
        match self.reason {
            BreakReason::OtherCount {
                points,
                other,
                other_points,
            } => format!(
                "frame {frame} has {points} points, frame {} has {other_points}: indices do not stay with the points",
                other + first
            ),
            BreakReason::OtherOrder { before } => format!(
                "the points of frame {frame} seem to be in another order than those of frame {}: indices do not stay with the points",
                before + first
            ),
            BreakReason::Unreadable => format!("frame {frame} cannot be read"),
        }
    }
}

/// The length of a trail and how fast its point is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrailMeasure {
    /// The way travelled, scene units, without what lies across breaks.
    pub length: f64,
    /// The way by its time, scene units a second.
    pub mean_speed: f64,
    /// The largest speed from one frame to the next, scene units a second.
    pub max_speed: f64,
}

/// Where points are, frame by frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Trails {
    frames: Range<usize>,
    trail_count: usize,
    /// A row a frame, relative to the sequence's origin; NaN where there is none.
    places: Vec<Vec3>,
    breaks: Vec<TrailBreak>,
}

/// What is looked at in a frame.
struct Seen {
    witnesses: Vec<Vec3>,
    followed: Vec<Vec3>,
}

impl Trails {
    /// Follows points through `sequence`. `resident` gives frames that are in memory; `goes_on` is told before each frame how many
    /// were looked at, and ends it by saying no: then there is no answer.
    pub fn trace(
        request: &TrailRequest,
        sequence: &Sequence,
        resident: impl Fn(usize) -> Option<Arc<PreparedFrame>>,
        mut goes_on: impl FnMut(usize) -> bool,
    ) -> Option<Self> {
        let frame_count = sequence.len();
        let frames = request.frames.start.min(frame_count)..request.frames.end.min(frame_count);
        let most = MAX_BYTES / size_of::<Vec3>() / frames.len().max(1);
        let followed = &request.indices[..request.indices.len().min(most)];
        let witnesses = even_places(request.points_in_file, WITNESSES);
        let witnesses: Vec<u32> = witnesses.into_iter().map(|index| index as u32).collect();
        let mut visited: Vec<usize> = frames.clone().collect();
        if request.chosen_in < frame_count && !frames.contains(&request.chosen_in) {
            visited.push(request.chosen_in);
            visited.sort_unstable();
        }

        let mut rows: BTreeMap<usize, Vec<Vec3>> = BTreeMap::new();
        let mut breaks: Vec<TrailBreak> = Vec::new();
        let mut turns: Vec<(usize, usize)> = Vec::new();
        let mut before: Option<(usize, Vec<Vec3>)> = None;
        let mut was_broken = false;
        for (done, &index) in visited.iter().enumerate() {
            if !goes_on(done) {
                return None;
            }
            let looked = look(
                sequence,
                index,
                resident(index),
                request.points_in_file,
                |at| {
                    let places = |indices: &[u32]| indices.iter().map(|&index| at(index)).collect();
                    Seen {
                        witnesses: places(&witnesses),
                        followed: places(followed),
                    }
                },
            );
            match looked {
                Ok(seen) => {
                    if let Some((last, places)) = &before
                        && !keeps_order(places, &seen.witnesses)
                    {
                        turns.push((*last, index));
                    }
                    before = Some((index, seen.witnesses));
                    rows.insert(index, seen.followed);
                    was_broken = false;
                }
                Err(look) => {
                    let other = before.as_ref().map_or(request.chosen_in, |(last, _)| *last);
                    let reason =
                        look.map_or(BreakReason::Unreadable, |points| BreakReason::OtherCount {
                            points,
                            other,
                            other_points: request.points_in_file,
                        });
                    if !was_broken {
                        breaks.push(TrailBreak {
                            frame: index,
                            reason,
                        });
                    }
                    was_broken = true;
                }
            }
        }

        // The stretch of frames around the one in which points were chosen whose points are in one order.
        let chosen = request.chosen_in;
        let begin = turns.iter().rev().find(|(_, turn)| *turn <= chosen);
        let end = turns.iter().find(|(_, turn)| *turn > chosen);
        let stretch = begin.map_or(0, |turn| turn.1)..end.map_or(frame_count, |turn| turn.1);
        breaks.retain(|broken| stretch.contains(&broken.frame));
        breaks.extend(
            begin
                .into_iter()
                .chain(end)
                .map(|&(before, frame)| TrailBreak {
                    frame,
                    reason: BreakReason::OtherOrder { before },
                }),
        );
        breaks.sort_by_key(|broken| broken.frame);
        let nowhere = vec![Vec3::NAN; followed.len()];
        let places = frames.clone().flat_map(|frame| {
            let row = rows.remove(&frame).filter(|_| stretch.contains(&frame));
            row.unwrap_or_else(|| nowhere.clone())
        });
        Some(Self {
            trail_count: followed.len(),
            places: places.collect(),
            breaks,
            frames,
        })
    }

    /// The frames that were looked at.
    pub fn frames(&self) -> Range<usize> {
        self.frames.clone()
    }

    /// Number of points that were followed, in the order of the request.
    pub fn trail_count(&self) -> usize {
        self.trail_count
    }

    /// Where a point is in a frame, relative to the sequence's origin; `None` where that is not known.
    pub fn place(&self, trail: usize, frame: usize) -> Option<Vec3> {
        if !self.frames.contains(&frame) || trail >= self.trail_count {
            return None;
        }
        let place = self.places[(frame - self.frames.start) * self.trail_count + trail];
        place.is_finite().then_some(place)
    }

    /// Where trails end, in order.
    pub fn breaks(&self) -> &[TrailBreak] {
        &self.breaks
    }

    /// Length and speeds of a trail, frames having been taken at `time_s`; `None` where no two neighbouring frames have the point.
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

/// What `take` makes of the places of points by their index in the file; NaN where the file has none. `Err` has the number of points
/// where it is another one, nothing where the frame cannot be read.
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

/// Whether points of the same indices in two frames seem to be the same points: seen from the middle of all, they are nearer to themselves than
/// half as far as to others, in the median. Too few of them say nothing against it.
fn keeps_order(before: &[Vec3], now: &[Vec3]) -> bool {
    let pairs = before.iter().zip(now);
    let pairs: Vec<(Vec3, Vec3)> = pairs
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .map(|(&a, &b)| (a, b))
        .collect();
    let count = pairs.len();
    if count < FEWEST_WITNESSES {
        return true;
    }
    let shift: Vec3 = pairs.iter().map(|(a, b)| (b - a) / count as f32).sum();
    let moved = pairs.iter().map(|(a, b)| (b - a - shift).length());
    let others = (0..count).map(|i| {
        let other = pairs[(i + count / 2) % count].1;
        (other - pairs[i].0 - shift).length()
    });
    median(moved.collect()) <= FARTHEST_MOVE * median(others.collect())
}

/// Precondition: there are some.
fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
#[path = "trails_tests.rs"]
mod tests;
