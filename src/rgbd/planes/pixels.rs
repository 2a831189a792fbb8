//! Depth images as rays and inverse depths.

use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Rays and inverse depths are no larger than this, so that sums of their squares are numbers.
const MAX: f32 = 1e6;

/// The pixels of an image: x and y of the ray at a depth of 1, and the inverse of the depth, 0 in holes.
pub(super) struct Pixels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) rays: Vec<[f32; 3]>,
}

impl Pixels {
    pub(super) fn of([width, height]: [usize; 2], points: &[Vec3]) -> Self {
        assert_eq!(points.len(), width * height, "a point for each pixel");
        let ray = |point: &Vec3| {
            if point.is_finite() && point.z > 0.0 {
                let inverse = point.z.recip().clamp(MAX.recip(), MAX);
                let [x, y] = [point.x, point.y].map(|at| (at * inverse).clamp(-MAX, MAX));
                [x, y, inverse]
            } else {
                [0.0; 3]
            }
        };
        Self {
            width,
            height,
            rays: points.par_iter().map(ray).collect(),
        }
    }

    /// Lines `lines`, and the given number above and below as far as the image has them.
    pub(super) fn around(&self, lines: &Range<usize>, more: usize) -> Range<usize> {
        lines.start.saturating_sub(more)..(lines.end + more).min(self.height)
    }
}
