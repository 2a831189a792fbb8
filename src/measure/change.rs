//! Change between frames: the distance of the points of one frame from another frame, point by point.
//!
//! How it works: each point is matched with the nearest of the other frame (D1 of [`super::GeometryError`], in one
//! direction), in f64. Anything that was there before and no longer exists is far from everything that does; anything
//! that only slid along a surface is near to its other points, so this is a change of shape and not a motion. Positions
//! of both frames are relative to the same origin.

use crate::analysis::{ColorMap, NearestPoint};
use glam::Vec3;
use rayon::prelude::*;

/// Points between two looks at whether the answer is still wanted.
const POINTS_PER_TASK: usize = 1 << 12;

/// The distances of the points of one pose to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// From each point to the nearest of the other pose, in the order of the points, scene units.
    pub distances: Vec<f32>,
    /// Their mean, scene units; 0 without points.
    pub mean: f64,
    sorted: Vec<f32>,
}

impl Change {
    /// Measures from each of `places` to the nearest of `other`, both finite; `None` if there is no other, or once
    /// `is_wanted` says no.
    pub fn between(places: &[Vec3], other: &[Vec3], is_wanted: impl Fn() -> bool + Sync) -> Option<Self> {
        if other.is_empty() || !is_wanted() {
            return None;
        }
        let tree = NearestPoint::new(other);
        let parts: Option<Vec<Vec<f64>>> = places
            .par_chunks(POINTS_PER_TASK)
            .map(|places| {
                if !is_wanted() {
                    return None;
                }
                let distance = |&place: &Vec3| {
                    let nearest = other[tree.of(place)? as usize];
                    Some(place.as_dvec3().distance(nearest.as_dvec3()))
                };
                places.iter().map(distance).collect()
            })
            .collect();
        // Summed in the order of the points: any number of threads gives the same bits.
        let distances = parts?.concat();
        let sum: f64 = distances.iter().sum();
        let mean = sum / distances.len().max(1) as f64;
        let distances: Vec<f32> = distances.into_iter().map(|value| value as f32).collect();
        let mut sorted = distances.clone();
        sorted.par_sort_unstable_by(f32::total_cmp);
        Some(Self {
            distances,
            mean,
            sorted,
        })
    }

    /// The distance that so large a share of the points do not exceed, scene units: the nearest rank; 0 without points.
    pub fn quantile(&self, share: f64) -> f32 {
        let rank = (share * self.sorted.len() as f64).ceil() as usize;
        self.sorted.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
    }

    /// The largest distance (one-sided Hausdorff distance), scene units; 0 without points.
    pub fn largest(&self) -> f32 {
        self.sorted.last().copied().unwrap_or(0.0)
    }

    /// Root of the mean of the squares, scene units; 0 without points.
    pub fn root_mean_squared(&self) -> f64 {
        let squares = self.distances.iter().map(|&d| f64::from(d) * f64::from(d));
        (squares.sum::<f64>() / self.distances.len().max(1) as f64).sqrt()
    }

    /// The share of the points that are farther away than `threshold`, scene units; 0 without points.
    pub fn share_above(&self, threshold: f64) -> f64 {
        let within = self
            .sorted
            .partition_point(|&distance| f64::from(distance) <= threshold);
        (self.sorted.len() - within) as f64 / self.sorted.len().max(1) as f64
    }
}

impl Change {
    /// The distance that 99 % of the points do not exceed, scene units: the end of a colour map that a few outliers do
    /// not stretch.
    pub fn usual_range(&self) -> f64 {
        f64::from(self.quantile(0.99))
    }

    /// The colours of the points, from distance 0 in the first colour of `map` to `range` and beyond in the last.
    pub fn colors(&self, range: f64, map: ColorMap) -> Vec<[u8; 4]> {
        let share = |&distance: &f32| match f64::from(distance) / range {
            share if share.is_finite() => share as f32,
            // With an empty range, anything that has changed is beyond it.
            _ => f32::from(u8::from(distance > 0.0)),
        };
        self.distances
            .par_iter()
            .with_min_len(POINTS_PER_TASK)
            .map(|distance| map.color(share(distance)))
            .collect()
    }

    /// Bytes held in memory.
    pub fn byte_size(&self) -> usize {
        size_of_val(self.distances.as_slice()) + size_of_val(self.sorted.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn places(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Vec3>> {
        let place = prop::array::uniform3(-1f32..1.0).prop_map(Vec3::from_array);
        prop::collection::vec(place, count)
    }

    proptest! {
        #[test]
        fn distances_match_brute_force(a in places(0..200), b in places(1..200), threshold in 0.0f64..0.5) {
            let change = Change::between(&a, &b, || true).unwrap();
            let expected: Vec<f64> = a
                .iter()
                .map(|a| b.iter().map(|b| a.as_dvec3().distance(b.as_dvec3())).fold(f64::INFINITY, f64::min))
                .collect();
            let narrow: Vec<f32> = expected.iter().map(|&distance| distance as f32).collect();
            prop_assert_eq!(&change.distances, &narrow);
            let above = narrow.iter().filter(|&&distance| f64::from(distance) > threshold).count();
            prop_assert_eq!(change.share_above(threshold), above as f64 / a.len().max(1) as f64);
            prop_assert_eq!(change.largest(), narrow.iter().copied().fold(0.0, f32::max));
            let mean = expected.iter().sum::<f64>() / a.len().max(1) as f64;
            prop_assert!((change.mean - mean).abs() <= 1e-12);
            let squares = expected.iter().map(|distance| distance * distance).sum::<f64>();
            let root = (squares / a.len().max(1) as f64).sqrt();
            prop_assert!((change.root_mean_squared() - root).abs() <= 1e-6);
            for share in [0.0, 0.5, 0.95, 1.0] {
                let quantile = change.quantile(share);
                let within = narrow.iter().filter(|&&distance| distance <= quantile).count();
                prop_assert!(within as f64 >= share * a.len() as f64 - 1e-9);
                let below = narrow.iter().filter(|&&distance| distance < quantile).count();
                prop_assert!((below as f64) < (share * a.len() as f64).max(1e-9) + 1e-9);
            }
        }
    }

    #[test]
    fn known_poses_have_known_change_maps() {
        let row = |y: f32| (0..100).map(move |x| Vec3::new(x as f32, y, 0.0));
        let a: Vec<Vec3> = row(0.0).collect();
        let mut b: Vec<Vec3> = row(0.25).collect();
        b[99].y = 4.0;
        let change = Change::between(&b, &a, || true).unwrap();
        assert_eq!(change.quantile(0.95), 0.25);
        assert_eq!(change.largest(), 4.0);
        assert_eq!(change.share_above(0.25), 0.01);
        assert!((change.mean - (99.0 * 0.25 + 4.0) / 100.0).abs() < 1e-12);
        let none = Change::between(&a, &a, || true).unwrap();
        assert_eq!((none.mean, none.largest(), none.share_above(0.0)), (0.0, 0.0, 0.0));
    }

    #[test]
    fn colors_span_the_range_and_a_zero_range_marks_all_changes() {
        let places = [0.0, 0.5, 1.0, 9.0].map(|x| Vec3::new(x, 0.0, 0.0));
        let change = Change::between(&places, &[Vec3::ZERO], || true).unwrap();
        let map = ColorMap::Turbo;
        let expected = [0.0, 0.5, 1.0, 1.0].map(|share| map.color(share));
        assert_eq!(change.colors(1.0, map), expected);
        let expected = [0.0, 1.0, 1.0, 1.0].map(|share| map.color(share));
        assert_eq!(change.colors(0.0, map), expected);
        assert_eq!(change.usual_range(), 9.0);
    }

    #[test]
    fn cancelled_or_empty_comparisons_have_no_result() {
        assert_eq!(Change::between(&[Vec3::ZERO], &[], || true), None);
        assert_eq!(Change::between(&[Vec3::ZERO], &[Vec3::ONE], || false), None);
        let empty = Change::between(&[], &[Vec3::ONE], || true).unwrap();
        assert_eq!((empty.quantile(0.5), empty.largest(), empty.mean), (0.0, 0.0, 0.0));
    }
}
