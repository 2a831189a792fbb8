//! Pairwise stereo, fast enough for multi-view video: each image is matched with a neighbouring one (Yang et al. 2006,
//! §5 and Figs. 11 and 12, has 128 × 128 pixels of a pair).
//!
//! *How it works.* Images are downscaled. Each is matched once, with the one whose angle gives the most depth
//! information: both are rectified, and the range between the nearest and the farthest depth is matched semi-globally.
//! Depths that no other view shares are dropped. Geometry for view-dependent texturing may be coarse: the images bring
//! the details themselves.
//!
//! *When it wins.* Eight images of 160 × 120 pixels take a thirtieth of the time of a plane sweep of 320 × 240; the
//! sweep ([`Dense`](crate::stereo::Dense)) has finer depths, and wins where there is time.

use super::all_views::{ANGLES_DEG, Small, depth_range, of_pair, read_small};
use super::cloud::cloud;
use crate::cloud::RawCloud;
use crate::photos::ViewSet;
use crate::progress::Progress;
use crate::rgbd::DepthImage;
use crate::stereo::Consistency;
use crate::stereo::DenseError;
use crate::stereo::Matching;
use crate::stereo::SharedMatcher;
use crate::stereo::StereoError;
use crate::stereo::View;
use crate::stereo::consistent;
use crate::stereo::depths_of_pair;
use glam::DVec3;
use rayon::prelude::*;

/// Settings for computing points from pairs of images.
#[derive(Debug, Clone)]
pub struct Pairwise {
    /// Maximum side length in pixels: images are halved until no side is longer.
    pub max_side_px: u32,
    /// Settings for pair matching.
    pub matching: Matching,
    /// Stereo matcher of the pairs.
    pub matcher: SharedMatcher,
    /// Consistency criterion for keeping depths.
    pub consistency: Consistency,
}

impl Default for Pairwise {
    fn default() -> Self {
        Self {
            // 160 × 120 for VGA: nearly as many pixels as in the paper. A plane sweep of 320 pixels has eight times the
            // points at a third of the error, and takes 34 times as long: 4.48 s against 0.13 s for eight ray-traced
            // VGA cameras (one busy core).
            max_side_px: 160,
            matching: Matching {
                min_area_px: 20,
                ..Matching::default()
            },
            matcher: SharedMatcher::default(),
            // Depth maps of a hundred pixels per side are coarse, and there is one map per two images.
            consistency: Consistency {
                min_views: 2,
                tolerance: 0.02,
            },
        }
    }
}

/// The best angle: a wider one gives finer depths, but the two views differ more.
const BEST_ANGLE_DEG: f64 = 10.0;

/// Near and far limits of the surface, in depths of the point that all cameras look at.
const AROUND_CROSSING: [f64; 2] = [0.4, 8.0];

impl Pairwise {
    /// The points of a set, in its coordinates, with colours. Stops soon after `progress` was cancelled.
    ///
    /// # Errors
    /// [`DenseError`].
    pub fn cloud(&self, set: &ViewSet, progress: &Progress) -> Result<RawCloud, DenseError> {
        let (small, reasons) = read_small(set, self.max_side_px)?;
        let views: Vec<View<'_>> = small.iter().map(Small::view).collect();
        if let Some(mut pair) = of_pair(&small, &views, &*self.matcher.0, &self.matching)? {
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
            let between = depth_range(set, of_one.number, crossing, AROUND_CROSSING);
            // A pair that cannot be rectified or matched has none.
            let found = depths_of_pair([views[first], views[second]], &*self.matcher.0, &self.matching, between);
            progress.advance(1);
            Ok(found
                .ok()
                .and_then(|found| DepthImage::new(of_one.image.size_px(), of_one.masked(&found))))
        };
        let maps: Result<Vec<Option<DepthImage>>, DenseError> = pairs.par_iter().map(matched).collect();
        let maps = maps?.into_iter().zip(&pairs);
        let (maps, views): (Vec<DepthImage>, Vec<View<'_>>) =
            maps.filter_map(|(map, &[first, _])| Some((map?, views[first]))).unzip();
        let retained = consistent(&maps, &views, self.consistency)?;
        let mut cloud = cloud(&retained, &views)?;
        if cloud.positions.is_empty() {
            return Err(DenseError::Nothing { photos: small.len() });
        }
        cloud.warnings = reasons;
        Ok(cloud)
    }
}

/// Returns the pairs of images to match among `count`: each image with the one of least `doubt`, each used once as far
/// as there are enough.
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

/// Returns the depth uncertainty of an image pair: from its angle, or from its distance if the point looked at is
/// unknown. `None` if the pair yields no depths.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Places on an arc around the origin, this many degrees apart.
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
    fn images_are_matched_once_at_the_best_angle() {
        let center = Some(DVec3::ZERO);
        assert_eq!(pairs_of(&arc(4, 10.0), center), [[0, 1], [2, 3]]);
        assert_eq!(pairs_of(&arc(6, 5.0), center), [[0, 2], [1, 3], [4, 5]]);
        // No partner is left for the last one: it is matched with one that has been used.
        assert_eq!(pairs_of(&arc(3, 10.0), center), [[0, 1], [2, 1]]);
    }

    #[test]
    fn images_at_unsuitable_angles_are_not_matched() {
        assert_eq!(pairs_of(&arc(5, 60.0), Some(DVec3::ZERO)), [[0; 2]; 0]);
        assert_eq!(pairs_of(&arc(3, 0.5), Some(DVec3::ZERO)), [[0; 2]; 0]);
        // Two views from the same position give no depth, whatever they look at.
        assert_eq!(pairs_of(&[DVec3::ONE; 2], None), [[0; 2]; 0]);
    }

    #[test]
    fn parallel_images_are_matched_with_the_nearest() {
        let places = [0.0, 3.0, 0.5, 3.2].map(|x| DVec3::new(x, 0.0, 0.0));
        assert_eq!(pairs_of(&places, None), [[0, 2], [1, 3]]);
    }
}
