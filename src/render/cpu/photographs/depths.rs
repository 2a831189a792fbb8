//! How far away what each photograph shows is (paper 004 §3.3).

use crate::scene::{PhotographsInFrame, SurfelStyle};

/// Distances along the axis of a photograph's camera.
#[derive(Debug)]
pub(in crate::render) struct DepthMap {
    pub(in crate::render) size: [u32; 2],
    /// 0 where nothing is known.
    pub(in crate::render) distances: Vec<f32>,
    /// Places that are so much behind what is there are hidden by it.
    pub(in crate::render) tolerance: f32,
    /// Whether it was measured, and not drawn of the surface itself: it may contradict that.
    pub(in crate::render) is_measured: bool,
}

/// Where a place is in relation to what a photograph shows there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seen {
    /// It is what the photograph shows, as far as anybody knows.
    There,
    /// Something before it hides it.
    Hidden,
    /// The photograph shows what is behind it.
    Through,
}

impl DepthMap {
    /// How much of the depth of what is seen a place may be behind it (paper 004 §4.1).
    const TOLERANCE: f32 = 0.05;

    /// A map of these distances. Precondition: they are as many as `size` has pixels, and these are some.
    pub(in crate::render) fn new(size: [u32; 2], mut distances: Vec<f32>, is_measured: bool) -> Self {
        debug_assert_eq!(distances.len(), size[0] as usize * size[1] as usize);
        for distance in &mut distances {
            if !(distance.is_finite() && *distance > 0.0) {
                *distance = 0.0;
            }
        }
        let tolerance = Self::TOLERANCE * extent(&distances);
        Self {
            size,
            distances,
            tolerance,
            is_measured,
        }
    }

    /// What is at `share` of its width and height, 0 to 1, beside a place at `distance`.
    #[inline(always)]
    pub(super) fn seen(&self, share: [f32; 2], distance: f32) -> Seen {
        let [column, row] = [0, 1].map(|axis| {
            let texel = share[axis] * self.size[axis] as f32;
            (texel as usize).min(self.size[axis] as usize - 1)
        });
        let there = self.distances[self.size[0] as usize * row + column];
        let behind = distance - there;
        if there == 0.0 {
            Seen::There
        } else if behind > self.tolerance {
            Seen::Hidden
        } else if self.is_measured && behind < -self.tolerance {
            Seen::Through
        } else {
            Seen::There
        }
    }
}

/// From the nearest to the farthest of some distances, without a fiftieth of them at both ends.
fn extent(distances: &[f32]) -> f32 {
    /// That many are looked at: every one of a small map.
    const SAMPLES: usize = 1 << 14;
    let step = distances.len().div_ceil(SAMPLES).max(1);
    let known = distances.iter().step_by(step).copied();
    let mut known: Vec<f32> = known.filter(|&distance| distance > 0.0).collect();
    known.sort_unstable_by(f32::total_cmp);
    let Some(last) = known.len().checked_sub(1) else {
        return 0.0;
    };
    let aside = known.len() / 50;
    known[last - aside] - known[aside]
}

/// The depth maps of all photographs of a frame, and what they were drawn of.
#[derive(Debug)]
pub(in crate::render) struct DepthMaps {
    pub(in crate::render) of: (PhotographsInFrame, SurfelStyle),
    pub(in crate::render) maps: Vec<DepthMap>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_behind_is_hidden_and_what_is_before_a_measured_surface_is_seen_through() {
        // Half of the map is 10 away and half 30: the tolerance is a twentieth of 20.
        let distances = || [[10.0; 50], [30.0; 50]].concat();
        let map = DepthMap::new([50, 2], distances(), true);
        assert_eq!(map.seen([0.5, 0.25], 10.9), Seen::There);
        assert_eq!(map.seen([0.5, 0.25], 11.1), Seen::Hidden);
        assert_eq!(map.seen([0.5, 0.75], 28.9), Seen::Through);
        let drawn = DepthMap::new([50, 2], distances(), false);
        assert_eq!(drawn.seen([0.5, 0.75], 28.9), Seen::There);
        // The last line and column belong to the edge itself.
        assert_eq!(map.seen([1.0, 1.0], 31.1), Seen::Hidden);
    }

    #[test]
    fn unknown_distances_hide_nothing() {
        let map = DepthMap::new([3, 1], vec![0.0, f32::INFINITY, f32::NAN], true);
        for share in [0.1, 0.5, 0.9] {
            assert_eq!(map.seen([share, 0.5], 1e6), Seen::There);
        }
    }

    #[test]
    fn few_outliers_do_not_widen_the_tolerance() {
        let mut distances = vec![1.0; 1000];
        distances[..500].fill(2.0);
        distances[3] = 1e6;
        assert_eq!(extent(&distances), 1.0);
        assert_eq!(extent(&[]), 0.0);
    }
}
