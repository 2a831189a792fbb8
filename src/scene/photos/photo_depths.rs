//! Depth maps of the posed images (Yang et al. 2006 §3.3).

use rayon::prelude::*;

/// Maximum distance to a depth discontinuity for it to count, texels.
const STEP_TEXELS: usize = 3;

/// Depth maps of the surface of a frame as the posed images see it, regardless of the eye's view: one for each image,
/// in their order.
#[derive(Debug, Default)]
pub struct PhotoDepths {
    pub(crate) maps: Vec<DepthMap>,
}

impl PhotoDepths {
    /// Bytes of all maps.
    pub(crate) fn byte_size(&self) -> usize {
        let maps = self.maps.iter().map(|map| size_of_val(map.distances.as_slice()));
        maps.sum()
    }
}

/// Distances along the axis of an input image's camera.
#[derive(Debug)]
pub(crate) struct DepthMap {
    pub(crate) size: [u32; 2],
    /// 0 if unknown; negative near steps.
    pub(crate) distances: Vec<f32>,
    /// Places this far behind the surface there are hidden by it.
    pub(crate) tolerance: f32,
    /// True if the depth map was measured rather than drawn of the surface itself: it may contradict that.
    pub(crate) is_measured: bool,
}

/// Depth relation of a position to the surface an image shows there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DepthRelation {
    /// It is on the surface in the image, as far as is known.
    There,
    /// Something before it hides it.
    Hidden,
    /// The image shows a surface behind it.
    Through,
}

impl DepthMap {
    /// Depth tolerance: distance that a position may be behind the visible surface, as a fraction of the surface's
    /// depth (Yang et al. 2006 §4.1).
    const TOLERANCE: f32 = 0.05;

    /// Minimum depth tolerance as a fraction of the surface's size: a wall has no depth.
    const MIN_TOLERANCE: f32 = 0.01;

    /// Maximum depth tolerance as a fraction of the distance to the visible surface: outliers make any surface large.
    const MAX_OF_DISTANCE: f32 = 0.03;

    /// A map of these distances. Precondition: one per pixel of `size`, which is not empty. `max_extent` is the size of
    /// the whole surface.
    pub(crate) fn new(size: [u32; 2], mut distances: Vec<f32>, max_extent: f32, is_measured: bool) -> Self {
        debug_assert_eq!(distances.len(), size[0] as usize * size[1] as usize);
        for distance in &mut distances {
            if !(distance.is_finite() && *distance > 0.0) {
                *distance = 0.0;
            }
        }
        let (extent, center) = extent(&distances);
        let of_depths = Self::TOLERANCE * extent.min(max_extent);
        let of_surface = Self::MIN_TOLERANCE * max_extent;
        let tolerance = of_depths.max(of_surface.min(Self::MAX_OF_DISTANCE * center));
        mark_steps(&mut distances, size[0] as usize, tolerance);
        Self {
            size,
            distances,
            tolerance,
            is_measured,
        }
    }

    /// Returns the depth relation at `share` of the map's width and height, 0 to 1, to a position at `distance`; and
    /// true if a discontinuity is near.
    #[inline(always)]
    pub(crate) fn seen(&self, share: [f32; 2], distance: f32) -> (DepthRelation, bool) {
        let texel = |axis: usize| ((share[axis] * self.size[axis] as f32) as usize).min(self.size[axis] as usize - 1);
        let (column, row) = (texel(0), texel(1));
        let there = self.distances[self.size[0] as usize * row + column];
        let behind = distance - there.abs();
        let seen = if there == 0.0 {
            DepthRelation::There
        } else if behind > self.tolerance {
            DepthRelation::Hidden
        } else if self.is_measured && behind < -self.tolerance {
            DepthRelation::Through
        } else {
            DepthRelation::There
        };
        (seen, there < 0.0)
    }
}

/// Marks depth discontinuities by negating depths within [`STEP_TEXELS`] of a step larger than `tolerance`, or of a
/// hole: slightly next to there, an image shows something else. Least and largest are found along lines, then across
/// them.
fn mark_steps(distances: &mut [f32], width: usize, tolerance: f32) {
    let height = distances.len() / width.max(1);
    let window = |at: usize, end: usize| at.saturating_sub(STEP_TEXELS)..(at + STEP_TEXELS + 1).min(end);
    let both = |values: &mut dyn Iterator<Item = [f32; 2]>| {
        values.fold([f32::INFINITY, 0.0_f32], |[min, max], [low, high]| {
            [min.min(low), max.max(high)]
        })
    };
    let along: Vec<[f32; 2]> = (0..distances.len())
        .into_par_iter()
        .map(|at| {
            let (row, column) = (at / width, at % width);
            let line = &distances[width * row..width * (row + 1)];
            both(&mut line[window(column, width)].iter().map(|&distance| [distance; 2]))
        })
        .collect();
    distances.par_iter_mut().enumerate().for_each(|(at, distance)| {
        let (row, column) = (at / width, at % width);
        let [min, max] = both(&mut window(row, height).map(|row| along[width * row + column]));
        // Small holes count as depth discontinuities, too: exempting them made no difference to within 0.001 dB
        // (Redwood's frames).
        if min == 0.0 || max - min > tolerance {
            *distance = -*distance;
        }
    });
}

/// From the nearest to the farthest of some distances, without a fiftieth of them at both ends; and their median.
fn extent(distances: &[f32]) -> (f32, f32) {
    /// Number of depths examined: every one of a small map.
    const SAMPLES: usize = 1 << 14;
    let step = distances.len().div_ceil(SAMPLES).max(1);
    let known = distances.iter().step_by(step).copied();
    let mut known: Vec<f32> = known.filter(|&distance| distance > 0.0).collect();
    known.sort_unstable_by(f32::total_cmp);
    let Some(last) = known.len().checked_sub(1) else {
        return (0.0, 0.0);
    };
    // Without a fiftieth at both ends: a single outlier would make the tolerance so large that nothing is occluded.
    let aside = known.len() / 50;
    (known[last - aside] - known[aside], known[known.len() / 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of it is 10 away and half 30.
    fn distances() -> Vec<f32> {
        [[10.0; 50], [30.0; 50]].concat()
    }

    #[test]
    fn points_behind_a_surface_are_hidden_and_points_in_front_are_contradicted() {
        // The tolerance is a twentieth of 20.
        let map = DepthMap::new([10, 10], distances(), 30.0, true);
        assert_eq!(map.seen([0.5, 0.05], 10.9), (DepthRelation::There, false));
        assert_eq!(map.seen([0.5, 0.05], 11.1), (DepthRelation::Hidden, false));
        assert_eq!(map.seen([0.5, 0.95], 28.9), (DepthRelation::Through, false));
        let drawn = DepthMap::new([10, 10], distances(), 30.0, false);
        assert_eq!(drawn.seen([0.5, 0.95], 28.9), (DepthRelation::There, false));
        // The last line and column belong to the edge itself.
        assert_eq!(map.seen([1.0, 1.0], 31.1), (DepthRelation::Hidden, false));
    }

    #[test]
    fn steps_are_flagged_within_three_texels() {
        let map = DepthMap::new([10, 10], [[10.0; 50], [30.0; 50]].concat(), 30.0, false);
        let is_near = |row: usize| map.seen([0.5, 0.1 * row as f32 + 0.05], 10.0).1;
        let near: Vec<usize> = (0..10).filter(|&row| is_near(row)).collect();
        assert_eq!(near, [2, 3, 4, 5, 6, 7]);
        assert_eq!(map.seen([0.5, 0.35], 10.9).0, DepthRelation::There);
        let mut hole = vec![1.0; 100];
        hole[44] = 0.0;
        let around = DepthMap::new([10, 10], hole, 30.0, false);
        assert_eq!(around.distances.iter().filter(|&&distance| distance < 0.0).count(), 48);
        // A wall far behind the surface does not widen the tolerance.
        let bounded = DepthMap::new([10, 10], distances(), 4.0, true);
        assert_eq!(bounded.seen([0.5, 0.05], 10.3).0, DepthRelation::Hidden);
    }

    #[test]
    fn unknown_distances_hide_nothing() {
        let map = DepthMap::new([3, 1], vec![0.0, f32::INFINITY, f32::NAN], 1.0, true);
        for share in [0.1, 0.5, 0.9] {
            assert_eq!(map.seen([share, 0.5], 1e6).0, DepthRelation::There);
        }
    }

    #[test]
    fn few_outliers_do_not_widen_the_tolerance() {
        let mut distances = vec![1.0; 1000];
        distances[..500].fill(2.0);
        distances[3] = 1e6;
        assert_eq!(extent(&distances), (1.0, 2.0));
        assert_eq!(extent(&[]), (0.0, 0.0));
        // Distant points in mid-air make the extent of the whole surface large.
        let map = DepthMap::new([50, 20], vec![2.0; 1000], 1e4, false);
        assert_eq!(map.seen([0.5, 0.5], 2.05).0, DepthRelation::There);
        assert_eq!(map.seen([0.5, 0.5], 2.07).0, DepthRelation::Hidden);
    }
}
