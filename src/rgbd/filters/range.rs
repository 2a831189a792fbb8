//! Distances at which the sensor is reliable.

use crate::rgbd::DepthImage;
use rayon::prelude::*;

/// Range of distances retained, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthRange {
    /// The nearest, in metres.
    pub near_m: f32,
    /// The furthest, in metres.
    pub far_m: f32,
}

impl DepthRange {
    /// Default depth range, which depth cameras measure: nearer is glass and dust, further is steps of decimetres.
    pub const USUAL: Self = Self {
        near_m: 0.1,
        far_m: 10.0,
    };

    /// Drops pixels outside this range.
    pub fn apply(&self, depth: &mut DepthImage) {
        depth.metres_mut().par_iter_mut().for_each(|depth| {
            if !(self.near_m..=self.far_m).contains(depth) {
                *depth = 0.0;
            }
        });
    }
}
