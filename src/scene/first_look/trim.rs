//! Bounding box that is robust to a few outliers.
//!
//! **How it works.** An outlier is far from everything: its spacing is many times the cloud's. The most isolated
//! points, one in twenty at most, are excluded; dense parts stay, however thin or far away it is, so that an antenna, a
//! second object or the end of a line is never cut off. Points that are hundreds of times as far from one another as
//! those of the cloud, in all directions, sample nothing: up to a quarter may be such.

use super::sample::CloudSample;
use crate::math::Aabb;

/// Largest fraction of the points that is excluded as outliers.
const MAX_OUTLIERS: f64 = 0.05;
/// At most this share if they sample nothing, which they do from this many times the median spacing on.
const MAX_UNSAMPLED: f64 = 0.25;
const UNSAMPLED_SPACINGS: f32 = 300.0;
/// A point is isolated from this many times the median spacing on.
const ISOLATED_SPACINGS: f32 = 8.0;

/// Indices of the points that are not outliers, ascending.
pub(super) fn inliers(sample: &CloudSample) -> Vec<usize> {
    let isolated_from = ISOLATED_SPACINGS * sample.median_spacing();
    // By isolation, not by the distance from the rest: dense parts stay, however thin or far away.
    let is_isolated = |&index: &usize| sample.spacing[index] > isolated_from;
    let mut isolated: Vec<usize> = (0..sample.spacing.len()).filter(is_isolated).collect();
    isolated.sort_by(|&a, &b| sample.spacing[b].total_cmp(&sample.spacing[a]));
    let max = |share: f64| (share * sample.spacing.len() as f64) as usize;
    let outlier_from = UNSAMPLED_SPACINGS * sample.median_spacing();
    let outliers = isolated.partition_point(|&index| sample.spacing[index] > outlier_from);
    // If there are more outliers than that, they are part of the cloud.
    let outliers = if outliers <= max(MAX_OUTLIERS) { outliers } else { 0 };
    isolated.truncate(outliers.max(max(MAX_UNSAMPLED)));
    isolated.sort_unstable();
    let is_inlier = |index: &usize| isolated.binary_search(index).is_err();
    (0..sample.spacing.len()).filter(is_inlier).collect()
}

/// The box around points of a sample.
pub(super) fn bounds(sample: &CloudSample) -> Aabb {
    Aabb::from_points(&sample.positions)
}
