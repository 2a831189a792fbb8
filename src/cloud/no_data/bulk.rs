//! The box that most points are in, and the points away from it.
//!
//! **How it works.** The box lies between quantiles of a sample, from which candidates, places of many points and
//! coordinates that are missing as 0 are removed. Where it is many times as wide as the shortest intervals with half of
//! the points, a minority is elsewhere (local coordinates among those of a map, outliers, points at the end of the
//! range): the box is then the one around the points of the half, if these are the clear majority.

use super::known::{Known, is_near};
use crate::cloud::{Positions, even_places};
use glam::DVec3;
use rayon::prelude::*;

/// Magnitudes that programs write for a missing coordinate: elevation models, grids of simulations, depth cameras (16
/// bits of millimetres), smallest and largest integers (also of millimetres), largest floats.
const CONSTANTS: [f64; 16] = [
    999.0,
    999.9,
    9_999.0,
    9_999.9,
    99_999.0,
    999_999.0,
    32_767.0,
    32_768.0,
    65.535,
    65_535.0,
    2_147_483.648,
    2_147_483.647,
    2_147_483_648.0,
    2_147_483_647.0,
    1e20,
    1e30,
];
/// From here on a number is not a coordinate in any unit: 1e30, the largest float and their kin.
const ABSURD: f64 = 1e18;
/// A constant is away from the bulk from this share of the bulk's diagonal on.
const AWAY_DIAGONALS: f64 = 0.5;
/// Points this many diagonals away from the bulk are missing in any case.
const FAR_DIAGONALS: f64 = 1000.0;
/// Points that the bulk is measured by.
const SAMPLE_POINTS: usize = 1 << 13;
/// Fewer points have no bulk.
const MIN_POINTS: usize = 16;
/// Share of the sample outside the bulk at each end of an axis.
const TAIL: f64 = 0.02;
/// Zeros are repeated from this count and this share of the points on.
const MIN_ZEROS: usize = 10;
const MIN_ZERO_SHARE: f64 = 1e-3;
/// A void has no other point within this many times the point spacing of a surface; around a place with this share of
/// all points a smaller void suffices.
const VOID_SPACINGS: f64 = 3.0;
const SMALL_VOID_SPACINGS: f64 = 0.5;
const LARGE_SHARE: f64 = 0.05;
/// Something is repeated in the sample from this count and this share on.
const MIN_REPEATED: usize = 8;
const MIN_REPEATED_SHARE: f64 = 2e-3;
/// The box is the one around half of the points if it would be wider than this many diagonals of that half.
const WIDE_CORES: f64 = 30.0;
/// Points within this many diagonals of the half around it belong to it.
const CORE_MARGIN: f64 = 5.0;
/// They are most points if they have this share.
const MAJORITY: f64 = 0.6;

/// Finite points and the box around them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub(super) count: usize,
    zero_count: usize,
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl Extent {
    const EMPTY: Self = Self {
        count: 0,
        zero_count: 0,
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };
    const POINTS_PER_TASK: usize = 1 << 16;

    pub(super) fn of(positions: &Positions, is_taken: impl Fn(DVec3) -> bool + Sync) -> Self {
        let count = positions.len();
        let starts = (0..count).into_par_iter().step_by(Self::POINTS_PER_TASK);
        let of_part = |start: usize| {
            let end = (start + Self::POINTS_PER_TASK).min(count);
            let taken = (start..end).map(|index| positions.get(index));
            let taken = taken.filter(|position| position.is_finite() && is_taken(*position));
            taken.fold(Self::EMPTY, Self::with)
        };
        starts.map(of_part).reduce(|| Self::EMPTY, Self::union)
    }

    fn with(self, position: DVec3) -> Self {
        Self {
            count: self.count + 1,
            zero_count: self.zero_count + usize::from(position == DVec3::ZERO),
            min: self.min.min(position),
            max: self.max.max(position),
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            zero_count: self.zero_count + other.zero_count,
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    pub(super) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        (self.count > 0).then_some((self.min, self.max))
    }
}

/// The box that most points are in.
#[derive(Debug, Clone)]
pub(super) struct Bulk {
    min: DVec3,
    max: DVec3,
    pub(super) diagonal: f64,
    known: Known,
    /// Axes along which a coordinate of exactly 0 is missing.
    zero_axes: [bool; 3],
    /// True if the position 0 0 0 is repeated in a void.
    zeros_are_apart: bool,
    /// Places that many points of the sample are at, the most frequent first.
    pub(super) repeated: Vec<DVec3>,
}

impl Bulk {
    /// Measured by a sample without candidates; `None` where too few points are left.
    pub(super) fn of(positions: &Positions, all: &Extent, known: Known) -> Option<Self> {
        if all.count < MIN_POINTS {
            return None;
        }
        let mut sample = sample(positions);
        sample.retain(|&position| !is_candidate(position, known));
        if sample.len() < MIN_POINTS / 2 {
            return None;
        }
        let mut repeated = Vec::new();
        let mut zero_axes = [false; 3];
        // Vertices of meshes are naturally repeated.
        if !known.has_faces {
            repeated = remove_repeated(&mut sample);
            zero_axes = std::array::from_fn(|axis| zeros_are_missing(&sample, axis));
            let is_missing = |position: &DVec3| (0..3).any(|axis| zero_axes[axis] && position[axis] == 0.0);
            sample.retain(|position| !is_missing(position));
        }
        let (min, max) = box_of_max(&sample)?;
        let mut bulk = Self {
            min,
            max,
            diagonal: (max * 0.5 - min * 0.5).length() * 2.0,
            known,
            zero_axes,
            zeros_are_apart: false,
            repeated,
        };
        if bulk.diagonal <= 0.0 || !bulk.diagonal.is_finite() {
            return None;
        }
        let zeros_are_repeated = all.zero_count >= MIN_ZEROS && share(all.zero_count, all.count) >= MIN_ZERO_SHARE;
        bulk.zeros_are_apart = zeros_are_repeated && bulk.is_in_void(DVec3::ZERO, all.zero_count, positions, all);
        Some(bulk)
    }

    /// False where no point can be missing: zeros are not there, none is far away along any axis, and none repeated.
    pub(super) fn may_miss(&self, all: &Extent) -> bool {
        let is_far = |axis: usize| self.outside(all.min, axis).max(self.outside(all.max, axis)) > self.far(axis);
        all.zero_count > 0
            || (0..3).any(is_far)
            || self.zero_axes.iter().any(|&is_missing| is_missing)
            || !self.repeated.is_empty()
    }

    /// Distance from the box along an axis; negative inside.
    fn outside(&self, position: DVec3, axis: usize) -> f64 {
        (self.min[axis] - position[axis]).max(position[axis] - self.max[axis])
    }

    /// Constants are missing from this distance along an axis on. Along a flat axis the least step away is far.
    fn far(&self, axis: usize) -> f64 {
        (self.max[axis] - self.min[axis]).max(1e-3 * self.diagonal)
    }

    /// Returns true if points are vertices of triangles.
    pub(super) fn has_faces(&self) -> bool {
        self.known.has_faces
    }

    /// Distance from the box.
    pub(super) fn distance(&self, position: DVec3) -> f64 {
        (self.min - position).max(position - self.max).max(DVec3::ZERO).length()
    }

    /// Returns true if a point is missing regardless of the other points.
    pub(super) fn misses(&self, position: DVec3) -> bool {
        let distance = self.distance(position);
        if position == DVec3::ZERO {
            return self.zeros_are_apart || distance > AWAY_DIAGONALS * self.diagonal;
        }
        if distance > FAR_DIAGONALS * self.diagonal {
            return true;
        }
        (0..3).any(|axis| {
            let is_zero = self.zero_axes[axis] && position[axis] == 0.0;
            let is_known = || is_constant(position[axis]) || is_limit(position, axis, self.known);
            is_zero || (is_known() && self.outside(position, axis) > self.far(axis))
        })
    }

    /// True where nothing else is near a place that `count` points are at.
    pub(super) fn is_in_void(&self, place: DVec3, count: usize, positions: &Positions, all: &Extent) -> bool {
        let others = all.count.saturating_sub(count).max(1) as f64;
        let is_large = share(count, all.count) >= LARGE_SHARE;
        let spacings = if is_large { SMALL_VOID_SPACINGS } else { VOID_SPACINGS };
        let void = spacings * self.diagonal / others.sqrt();
        (0..positions.len()).into_par_iter().all(|index| {
            let position = positions.get(index);
            !position.is_finite() || position == place || position.distance(place) > void
        })
    }
}

/// Axes along which a user may mean 0 as a missing coordinate: all other coordinates are elsewhere.
pub(super) fn axes_without_zero(positions: &Positions) -> [bool; 3] {
    /// Minimum gap, as a fraction of the extent of the others along the axis.
    const MIN_GAP: f64 = 0.25;
    let sample = sample(positions);
    std::array::from_fn(|axis| {
        let others: Vec<DVec3> = sample
            .iter()
            .copied()
            .filter(|position| position[axis] != 0.0)
            .collect();
        box_of_max(&others).is_some_and(|(min, max)| min[axis].max(-max[axis]) > MIN_GAP * (max[axis] - min[axis]))
    })
}

/// Finite points, evenly.
fn sample(positions: &Positions) -> Vec<DVec3> {
    let places = even_places(positions.len(), SAMPLE_POINTS).into_iter();
    places
        .map(|place| positions.get(place))
        .filter(|position| position.is_finite())
        .collect()
}

fn share(count: usize, all: usize) -> f64 {
    count as f64 / all.max(1) as f64
}

/// Removes places that many points are at, far more than at most places, and tells them, the most frequent first.
/// Nothing is removed where nothing would be left.
fn remove_repeated(sample: &mut Vec<DVec3>) -> Vec<DVec3> {
    /// Places of constants that one file has.
    const MAX_PLACES: usize = 4;
    let mut keys: Vec<[u64; 3]> = sample.iter().map(|&position| key(position)).collect();
    keys.sort_unstable();
    let mut groups: Vec<(usize, [u64; 3])> = keys.chunk_by(PartialEq::eq).map(|run| (run.len(), run[0])).collect();
    let center = groups.len() / 2;
    let usual = groups.select_nth_unstable(center).1.0;
    let least = MIN_REPEATED * usual;
    groups.retain(|&(count, _)| count >= least && share(count, keys.len()) >= MIN_REPEATED_SHARE);
    groups.sort_unstable_by(|a, b| b.cmp(a));
    groups.truncate(MAX_PLACES);
    let removed: usize = groups.iter().map(|(count, _)| count).sum();
    if sample.len() - removed < MIN_POINTS / 2 {
        return Vec::new();
    }
    let repeated: Vec<DVec3> = groups.iter().map(|&(_, key)| place(key)).collect();
    sample.retain(|position| !repeated.contains(position));
    repeated
}

/// The bits of a position; both zeros of floating point have the same.
pub(super) fn key(position: DVec3) -> [u64; 3] {
    position.to_array().map(|coordinate| (coordinate + 0.0).to_bits())
}

fn place(key: [u64; 3]) -> DVec3 {
    DVec3::from_array(key.map(f64::from_bits))
}

/// Returns true if coordinates along `axis` that are exactly 0 are missing: many are, the others are elsewhere along
/// that axis, and their points are among these along both other axes. A floor far below objects is wider than they are.
fn zeros_are_missing(sample: &[DVec3], axis: usize) -> bool {
    /// Fewer of the points have a coordinate.
    const MAX_ZEROS: f64 = 0.6;
    /// Minimum gap as a fraction of the extent of the others along the axis, and minimum height as a fraction of their
    /// extent across, for objects that are not thin layers.
    const MIN_GAP: f64 = 0.9;
    const MIN_HEIGHT: f64 = 0.2;
    /// Certain gap as a multiple of both extents, that is of the larger one, for everything.
    const SURE_GAP: f64 = 3.0;
    /// Margin as a fraction of the extent along another axis: points within it are among the others.
    const MARGIN: f64 = 0.5;
    const AMONG: f64 = 0.9;
    let (zeros, others): (Vec<DVec3>, Vec<DVec3>) = sample.iter().partition(|position| position[axis] == 0.0);
    let zero_share = share(zeros.len(), sample.len());
    if zeros.len() < MIN_REPEATED || !(MIN_REPEATED_SHARE..MAX_ZEROS).contains(&zero_share) {
        return false;
    }
    let Some((min, max)) = box_of_max(&others) else {
        return false;
    };
    let extent = max - min;
    let gap = min[axis].max(-max[axis]);
    let mut across = extent;
    across[axis] = 0.0;
    let (height, across) = (extent[axis], across.length());
    let is_elsewhere =
        (gap >= MIN_GAP * height && height >= MIN_HEIGHT * across) || gap >= SURE_GAP * height.max(across);
    let is_among = |position: &&DVec3| {
        (0..3).filter(|&other| other != axis).all(|other| {
            let outside = (min[other] - position[other]).max(position[other] - max[other]);
            outside <= MARGIN * extent[other]
        })
    };
    gap > 0.0 && is_elsewhere && share(zeros.iter().filter(is_among).count(), zeros.len()) >= AMONG
}

/// The box that most of these points are in; `None` where they are too few.
fn box_of_max(sample: &[DVec3]) -> Option<(DVec3, DVec3)> {
    if sample.len() < MIN_POINTS / 2 {
        return None;
    }
    let axes = sorted_axes(sample);
    let wide = quantile_box(&axes);
    let (mut core_min, mut core_max) = (DVec3::ZERO, DVec3::ZERO);
    for (axis, values) in axes.iter().enumerate() {
        [core_min[axis], core_max[axis]] = shortest_half(values);
    }
    let core = (core_max * 0.5 - core_min * 0.5).length() * 2.0;
    let is_wide = (0..3).any(|axis| wide.1[axis] * 0.5 - wide.0[axis] * 0.5 > 0.5 * WIDE_CORES * core);
    if core <= 0.0 || !is_wide {
        return Some(wide);
    }
    let margin = DVec3::splat(CORE_MARGIN * core);
    let (min, max) = (core_min - margin, core_max + margin);
    let is_near_core = |position: &DVec3| position.cmpge(min).all() && position.cmple(max).all();
    let near: Vec<DVec3> = sample.iter().copied().filter(is_near_core).collect();
    if share(near.len(), sample.len()) < MAJORITY {
        return Some(wide);
    }
    Some(quantile_box(&sorted_axes(&near)))
}

fn sorted_axes(sample: &[DVec3]) -> [Vec<f64>; 3] {
    std::array::from_fn(|axis| {
        let mut values: Vec<f64> = sample.iter().map(|position| position[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values
    })
}

/// Between the tails of each axis. Precondition: there are values.
fn quantile_box(axes: &[Vec<f64>; 3]) -> (DVec3, DVec3) {
    let (mut min, mut max) = (DVec3::ZERO, DVec3::ZERO);
    for (axis, values) in axes.iter().enumerate() {
        let last = values.len() - 1;
        let tail = ((TAIL * last as f64).ceil() as usize).min(last);
        (min[axis], max[axis]) = (values[tail], values[last - tail]);
    }
    (min, max)
}

/// The shortest interval with half of the values. Precondition: there are values, in order.
fn shortest_half(values: &[f64]) -> [f64; 2] {
    let half = values.len().div_ceil(2);
    let intervals = values.windows(half).map(|window| [window[0], window[half - 1]]);
    let length = |[from, to]: &[f64; 2]| to - from;
    intervals
        .min_by(|a, b| length(a).total_cmp(&length(b)))
        .unwrap_or([values[0], values[values.len() - 1]])
}

fn is_constant(coordinate: f64) -> bool {
    coordinate.abs() >= ABSURD || is_listed(coordinate)
}

/// Returns true if programs are known to write this number.
pub(super) fn is_listed(coordinate: f64) -> bool {
    let magnitude = coordinate.abs();
    CONSTANTS.iter().any(|&constant| is_near(magnitude, constant))
}

/// Returns true if a coordinate is the smallest or largest that the integers of the file can represent.
fn is_limit(position: DVec3, axis: usize, known: Known) -> bool {
    known
        .limits
        .is_some_and(|limits| limits[axis].contains(&position[axis]))
}

fn is_candidate(position: DVec3, known: Known) -> bool {
    let is_known = |axis: usize| is_constant(position[axis]) || is_limit(position, axis, known);
    position == DVec3::ZERO || (0..3).any(is_known)
}
