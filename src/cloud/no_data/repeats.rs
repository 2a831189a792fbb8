//! Places, and distances from 0 0 0, that many points share exactly: a value that a program writes where there was no
//! return, whatever number it is.
//!
//! **How it works.** Points a few diagonals away from the bulk are sorted by their bits, then by their distances. Runs
//! of equal ones are missing if they are many, and a share of the far points: a real object out there has a different
//! place for each point. Equal distances are the maximum range of a sensor without a return, if they lie in many
//! directions. A place near the bulk is missing if it is by far the most frequent one and alone in a void.

use super::bulk::{Bulk, Extent, key};
use crate::cloud::Positions;
use glam::DVec3;
use rayon::prelude::*;

/// A place is far from this many diagonals of the bulk on.
const FAR_DIAGONALS: f64 = 3.0;
/// Something is repeated from this count on, or from a lower one and this share of all points.
const MANY: usize = 20;
const SOME: usize = 5;
const SOME_SHARE: f64 = 2e-3;
/// Minimum share of the points that are far away.
const MIN_FAR_SHARE: f64 = 0.01;
const MIN_FAR_SHARE_OF_RANGES: f64 = 0.1;
/// Equal distances differ by no more than this share: coordinates are of single precision.
const RANGE_ROUNDING: f64 = 1e-6;

/// Repeated positions and coordinates.
#[derive(Debug, Default)]
pub(super) struct Repeats {
    /// Bits of positions, ascending.
    places: Vec<[u64; 3]>,
    /// Smallest and largest distance from 0 0 0.
    ranges: Vec<[f64; 2]>,
}

impl Repeats {
    pub(super) fn find(positions: &Positions, bulk: &Bulk, all: &Extent) -> Self {
        let mut places = Vec::new();
        for &place in &bulk.repeated {
            if is_far(place, bulk) || bulk.misses(place) {
                continue;
            }
            let count = (0..positions.len())
                .into_par_iter()
                .filter(|&index| positions.get(index) == place)
                .count();
            if is_many(count, all.count) && bulk.is_in_void(place, count, positions, all) {
                places.push(key(place));
            }
        }
        let mut ranges = Vec::new();
        let has_far = [all.min, all.max].iter().any(|&corner| is_far(corner, bulk));
        if has_far && !bulk.has_faces() {
            let mut far = far_points(positions, bulk);
            let count = far.len();
            far.sort_unstable_by_key(|&position| key(position));
            let is_repeated =
                |run: &&[DVec3]| is_many(run.len(), all.count) && run.len() as f64 >= MIN_FAR_SHARE * count as f64;
            let runs = far.chunk_by(|&a, &b| key(a) == key(b)).filter(is_repeated);
            places.extend(runs.map(|run| key(run[0])));
            places.sort_unstable();
            far.retain(|&position| places.binary_search(&key(position)).is_err());
            ranges = equal_ranges(far, count, all.count);
        }
        places.sort_unstable();
        Self { places, ranges }
    }

    pub(super) fn contain(&self, position: DVec3, bulk: &Bulk) -> bool {
        self.is_place(position) || (self.range(position).is_some() && is_far(position, bulk))
    }

    /// Returns true if many points are at this position.
    pub(super) fn is_place(&self, position: DVec3) -> bool {
        !self.places.is_empty() && self.places.binary_search(&key(position)).is_ok()
    }

    /// The distance from 0 0 0 that many points have, if this one does.
    pub(super) fn range(&self, position: DVec3) -> Option<f64> {
        let length = position.length();
        let range = self.ranges.iter().find(|[from, to]| (*from..=*to).contains(&length));
        range.map(|[from, to]| f64::midpoint(*from, *to))
    }
}

fn is_far(position: DVec3, bulk: &Bulk) -> bool {
    bulk.distance(position) > FAR_DIAGONALS * bulk.diagonal
}

fn far_points(positions: &Positions, bulk: &Bulk) -> Vec<DVec3> {
    (0..positions.len())
        .into_par_iter()
        .map(|index| positions.get(index))
        .filter(|&position| position.is_finite() && is_far(position, bulk) && !bulk.misses(position))
        .collect()
}

fn is_many(count: usize, all: usize) -> bool {
    count >= MANY || (count >= SOME && count as f64 >= SOME_SHARE * all as f64)
}

/// Distances that many of these points have, which lie in many directions.
fn equal_ranges(far: Vec<DVec3>, far_count: usize, all_count: usize) -> Vec<[f64; 2]> {
    let mut far: Vec<(f64, DVec3)> = far.into_iter().map(|position| (position.length(), position)).collect();
    far.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut ranges = Vec::new();
    let mut rest = far.as_slice();
    while let Some(&(from, _)) = rest.first() {
        let run = rest.partition_point(|(range, _)| *range <= from * (1.0 + RANGE_ROUNDING));
        let (equal, further) = rest.split_at(run.max(1));
        let count = equal.len() as f64;
        let is_repeated = equal.len() >= MANY
            && count >= SOME_SHARE * all_count as f64
            && count >= MIN_FAR_SHARE_OF_RANGES * far_count as f64;
        if is_repeated && is_around(equal) {
            ranges.push([from, equal[equal.len() - 1].0]);
        }
        rest = further;
    }
    ranges
}

/// Returns true if points at one distance lie in many directions: half of it apart along two axes.
fn is_around(equal: &[(f64, DVec3)]) -> bool {
    let min = equal
        .iter()
        .fold(DVec3::INFINITY, |min, (_, position)| min.min(*position));
    let max = equal
        .iter()
        .fold(DVec3::NEG_INFINITY, |max, (_, position)| max.max(*position));
    let range = equal.first().map_or(0.0, |(range, _)| *range);
    (max - min)
        .to_array()
        .into_iter()
        .filter(|&extent| extent >= 0.5 * range)
        .count()
        >= 2
}
