//! Points of photographs soon enough for a film: each photograph is matched with one beside it (paper 004, §5 and Figs. 11
//! and 12, has 128 × 128 pixels of a pair).
//!
//! *How it works.* Photographs are made small. Each gets the neighbour whose angle tells most, both are rectified, and
//! what lies between the nearest and the farthest depth is matched semi-globally. Depths that no other view shares are
//! dropped. What photographs are put on may be coarse: they bring the details themselves.
//!
//! *When it wins.* Eight photographs of 160 × 120 pixels take a fiftieth of what a plane sweep of 320 × 240 takes; the
//! sweep ([`Dense`](super::Dense)) has finer depths, and wins where there is time.

use super::dense::{Small, of_pair, read_small};
use super::{
    Consistency, DenseError, DisparityRange, Matching, Rectified, SharedMatcher, StereoError, View, cloud, consistent,
    depths_of_pair,
};
use crate::cloud::RawCloud;
use crate::photos::ViewSet;
use crate::progress::Progress;
use crate::rgbd::DepthImage;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// How points are made of photographs in pairs.
#[derive(Debug, Clone)]
pub struct Pairwise {
    /// Photographs are halved until no side is longer.
    pub most_side_px: u32,
    /// How pairs are matched.
    pub matching: Matching,
    /// Who matches them.
    pub matcher: SharedMatcher,
    /// Which depths are kept.
    pub consistency: Consistency,
}

impl Default for Pairwise {
    fn default() -> Self {
        Self {
            // 160 × 120 of VGA: as many pixels as the paper has, nearly.
            most_side_px: 160,
            matching: Matching {
                least_area_px: 20,
                ..Matching::default()
            },
            matcher: SharedMatcher::default(),
            // Depths of a hundred pixels a side are coarse, and there is one map for two photographs.
            consistency: Consistency {
                least_views: 2,
                tolerance: 0.02,
            },
        }
    }
}

/// Angles between neighbours of which depths can be told: smaller ones tell little, larger ones show other sides.
const ANGLES_DEG: RangeInclusive<f64> = 1.5..=40.0;

/// The angle that tells most: depths are as fine as it is wide, and what both see differs the more.
const BEST_ANGLE_DEG: f64 = 10.0;

/// How near and far the surface may be, in depths of the place that all cameras look at.
const AROUND_MIDDLE: [f64; 2] = [0.4, 8.0];

impl Pairwise {
    /// The points of a set, in its coordinates, with colours. Stops soon after `progress` was cancelled.
    ///
    /// # Errors
    /// [`DenseError`].
    pub fn cloud(&self, set: &ViewSet, progress: &Progress) -> Result<RawCloud, DenseError> {
        let (small, reasons) = read_small(set, self.most_side_px)?;
        let views: Vec<View<'_>> = small.iter().map(Small::view).collect();
        if let Some(mut pair) = of_pair(&small, &views, (&*self.matcher.0, &self.matching))? {
            progress.set(2, 2);
            pair.warnings = reasons;
            return Ok(pair);
        }
        let crossing = set.crossing_of_axes();
        let pairs = pairs(small.len(), |first, second| {
            doubt(
                [first, second].map(|at| set.photos[small[at].number].center()),
                crossing,
            )
        });
        progress.set(0, pairs.len());
        let matched = |&[first, second]: &[usize; 2]| -> Result<Option<DepthImage>, DenseError> {
            if progress.is_cancelled() {
                return Err(StereoError::Cancelled.into());
            }
            let of_one = &small[first];
            let found = self.depths([views[first], views[second]], depths_before(of_one, crossing));
            progress.advance(1);
            Ok(found.and_then(|found| DepthImage::new(of_one.image.size_px(), of_one.masked(&found))))
        };
        let maps: Result<Vec<Option<DepthImage>>, DenseError> = pairs.par_iter().map(matched).collect();
        let maps = maps?.into_iter().zip(&pairs);
        let (maps, views): (Vec<DepthImage>, Vec<View<'_>>) =
            maps.filter_map(|(map, &[first, _])| Some((map?, views[first]))).unzip();
        let kept = consistent(&maps, &views, self.consistency)?;
        let mut cloud = cloud(&kept, &views)?;
        if cloud.positions.is_empty() {
            return Err(DenseError::Nothing { photos: small.len() });
        }
        cloud.warnings = reasons;
        Ok(cloud)
    }

    /// Depths of the first of a pair; `None` of two that cannot be rectified or matched. Where nobody knows between which
    /// depths the surface is, that is found.
    fn depths(&self, pair: [View<'_>; 2], depths: Option<[f64; 2]>) -> Option<DepthImage> {
        let range = match depths {
            Some(depths) => Some(range_of(&pair, depths)?),
            None => None,
        };
        depths_of_pair(pair, (&*self.matcher.0, &self.matching), range).ok()
    }
}

/// Which of `count` photographs are matched: each with the one that leaves least `doubt`, each once as far as there are
/// as many.
fn pairs(count: usize, doubt: impl Fn(usize, usize) -> Option<f64>) -> Vec<[usize; 2]> {
    let mut is_open = vec![true; count];
    let mut pairs = Vec::new();
    for first in 0..count {
        if !is_open[first] {
            continue;
        }
        is_open[first] = false;
        let others = (0..count).filter(|&other| other != first);
        let told = others.filter_map(|other| Some((other, doubt(first, other)?)));
        let best = told.min_by(|a, b| is_open[b.0].cmp(&is_open[a.0]).then(a.1.total_cmp(&b.1)));
        if let Some((second, _)) = best {
            pairs.push([first, second]);
            is_open[second] = false;
        }
    }
    pairs
}

/// How little two photographs tell of depths: by their angle, or, where nobody knows at what they look, by their distance.
/// `None` where they tell nothing.
fn doubt([first, second]: [DVec3; 2], crossing: Option<DVec3>) -> Option<f64> {
    match crossing {
        Some(crossing) => {
            let angle_deg = (first - crossing).angle_between(second - crossing).to_degrees();
            let is_told = ANGLES_DEG.contains(&angle_deg);
            is_told.then(|| (angle_deg / BEST_ANGLE_DEG).ln().abs())
        }
        None => Some(first.distance(second)).filter(|&distance| distance > 0.0),
    }
}

/// Between which depths the surface before a photograph is, as far as anybody knows.
fn depths_before(of_one: &Small, crossing: Option<DVec3>) -> Option<[f64; 2]> {
    let depth = of_one.view().camera_from_world.transform_point3(crossing?).z;
    (depth > 0.0).then(|| AROUND_MIDDLE.map(|share| share * depth))
}

/// The disparities of what is between two depths before the first view.
fn range_of([first, second]: &[View<'_>; 2], depths: [f64; 2]) -> Option<DisparityRange> {
    let rectified = Rectified::new(
        [first.camera, second.camera],
        [first.camera_from_world, second.camera_from_world],
    );
    let rectified = rectified.ok()?;
    let world_from_first = first.camera_from_world.inverse();
    let [width, height] = first.camera.size_px().map(|edge| f64::from(edge - 1));
    let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]];
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for [across, down] in places {
        let Some(ray) = first.camera.ray(DVec2::new(across * width, down * height)) else {
            continue;
        };
        for depth in depths {
            let place = world_from_first.transform_point3(ray * depth);
            let columns = [0, 1].map(|index| {
                let seen = rectified.camera_from_world()[index].transform_point3(place);
                let camera = &rectified.cameras()[index];
                (seen.z > 0.0).then(|| camera.focal_px().x * seen.x / seen.z + camera.principal_px().x)
            });
            let [Some(left), Some(right)] = columns else {
                continue;
            };
            least = least.min(left - right);
            most = most.max(left - right);
        }
    }
    (least <= most).then(|| DisparityRange::new(least.floor() as i32 - 1, most.ceil() as i32 + 1).ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places on an arc around the origin, so many degrees apart.
    fn arc(count: usize, step_deg: f64) -> Vec<DVec3> {
        let at = |number: usize| (number as f64 * step_deg).to_radians();
        (0..count)
            .map(|number| 3.0 * DVec3::new(at(number).sin(), 0.0, at(number).cos()))
            .collect()
    }

    fn pairs_of(places: &[DVec3], crossing: Option<DVec3>) -> Vec<[usize; 2]> {
        pairs(places.len(), |first, second| {
            doubt([places[first], places[second]], crossing)
        })
    }

    #[test]
    fn photographs_are_matched_once_at_the_angle_that_tells_most() {
        let middle = Some(DVec3::ZERO);
        assert_eq!(pairs_of(&arc(4, 10.0), middle), [[0, 1], [2, 3]]);
        assert_eq!(pairs_of(&arc(6, 5.0), middle), [[0, 2], [1, 3], [4, 5]]);
        // Nobody is left for the last one: it is matched with one that was.
        assert_eq!(pairs_of(&arc(3, 10.0), middle), [[0, 1], [2, 1]]);
    }

    #[test]
    fn photographs_that_tell_nothing_of_one_another_are_not_matched() {
        assert_eq!(pairs_of(&arc(5, 60.0), Some(DVec3::ZERO)), [[0; 2]; 0]);
        assert_eq!(pairs_of(&arc(3, 0.5), Some(DVec3::ZERO)), [[0; 2]; 0]);
        // From one place there is no depth, whatever they look at.
        assert_eq!(pairs_of(&[DVec3::ONE; 2], None), [[0; 2]; 0]);
    }

    #[test]
    fn photographs_that_look_parallel_are_matched_with_the_nearest() {
        let places = [0.0, 3.0, 0.5, 3.2].map(|x| DVec3::new(x, 0.0, 0.0));
        assert_eq!(pairs_of(&places, None), [[0, 2], [1, 3]]);
    }
}
