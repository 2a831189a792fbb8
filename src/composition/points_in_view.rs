//! Visibility of the points of a large cloud in a rendered image, and the number of them that the image can resolve.
//!
//! **How it works.** Points are stored in Morton order, so a run of them is a small piece of the cloud. The nearest
//! point of each pixel determines which pieces are visible. Each visible piece keeps as many points as the image can
//! resolve, evenly spaced along the Morton curve, so that they are equally dense in all directions along the surface.
//! The nearest points themselves would not be: on a floor seen at a grazing angle they lie in rows, which define no
//! plane, and of partly occluded surfaces there would be too few.
//!
//! **When it wins.** It costs one read of the positions, and later estimates depend on the image alone: estimating the
//! surfels of a view takes the same time for any number of points.

use crate::cloud::even_places;
use crate::scene::{Clip, ViewTransform};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of consecutive points that are subsampled or dropped together: few enough that most are visible when one is.
const POINTS_PER_PIECE: usize = 256;

/// Approximate max number of points: their surface is estimated in a fifth of a second on two threads.
// 0.4 s with the estimation of all 13.8 million points of a cloud running alongside.
const MAX_POINTS: f64 = (1 << 19) as f64;

/// Maximum number of pixels that are resolved: larger images are evaluated in coarser steps.
const MAX_PIXELS: usize = 1 << 20;

/// No point is seen there.
const EMPTY: u64 = u64::MAX;

/// The slots, ascending, of points for an image of `viewport_px` from `view`: of each visible piece of the cloud the
/// number that the image can resolve, about 2¹⁹ in all at most. `clip`, relative to the origin of the positions, hides
/// points from sight.
///
/// Precondition: `positions` are in Morton order; in another one more points than necessary are returned, of larger
/// pieces.
pub fn points_in_view(
    positions: &[Vec3],
    view: &ViewTransform,
    viewport_px: [u32; 2],
    clip: Option<&Clip>,
) -> Vec<u32> {
    let grid = PixelGrid::new(view, viewport_px);
    let seen_at = |position: Vec3| {
        let is_drawn = clip.is_none_or(|clip| clip.keeps(position.as_dvec3()));
        grid.pixel_of(position).filter(|_| is_drawn)
    };
    let nearest: Vec<AtomicU64> = (0..grid.len()).map(|_| AtomicU64::new(EMPTY)).collect();
    let pieces = positions.par_chunks(POINTS_PER_PIECE).enumerate();
    pieces.clone().for_each(|(piece, points)| {
        for (pixel, depth) in points.iter().filter_map(|&position| seen_at(position)) {
            // Positive f32 have the same order as their bits.
            let seen = u64::from(depth.to_bits()) << 32 | piece as u64;
            nearest[pixel].fetch_min(seen, Ordering::Relaxed);
        }
    });
    let mut is_seen = vec![false; positions.len().div_ceil(POINTS_PER_PIECE)];
    for seen in nearest.into_iter().map(AtomicU64::into_inner) {
        if seen != EMPTY {
            is_seen[seen as u32 as usize] = true;
        }
    }
    let seen = pieces.filter(|&(piece, _)| is_seen[piece]);
    let seen = seen.map(|(piece, points)| {
        let slots = (piece * POINTS_PER_PIECE) as u32..;
        let in_view = slots
            .zip(points)
            .filter_map(|(slot, &position)| seen_at(position).map(|(pixel, _)| (pixel, slot)));
        let (pixels, slots): (Vec<usize>, Vec<u32>) = in_view.unzip();
        let max = grid.detail_of(pixels).min(slots.len() as f64);
        (slots, max)
    });
    let seen: Vec<(Vec<u32>, f64)> = seen.collect();
    let in_detail: f64 = seen.iter().map(|(_, max)| max).sum();
    let share = (MAX_POINTS / in_detail).min(1.0);
    let retained = seen.iter().flat_map(|(slots, max)| {
        let places = even_places(slots.len(), (share * max).ceil() as usize);
        places.into_iter().map(move |place| slots[place])
    });
    retained.collect()
}

/// The pixels of an image, or larger squares where it has too many.
struct PixelGrid<'a> {
    view: &'a ViewTransform,
    size: [usize; 2],
}

impl<'a> PixelGrid<'a> {
    fn new(view: &'a ViewTransform, viewport_px: [u32; 2]) -> Self {
        let [width, height] = viewport_px.map(f64::from);
        let scale = (MAX_PIXELS as f64 / (width * height)).sqrt().min(1.0);
        let size = [width, height].map(|edge| (edge * scale).max(1.0) as usize);
        Self { view, size }
    }

    fn len(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Returns the number of points at which the points, spread evenly over a piece of surface covering `pixels`, are
    /// as close to each other in its longer direction as pixels are.
    fn detail_of(&self, mut pixels: Vec<usize>) -> f64 {
        let width = self.size[0];
        let steps = |place_of: fn(usize, usize) -> usize| {
            let places = || pixels.iter().map(|&pixel| place_of(pixel, width));
            let ends = places().min().zip(places().max());
            ends.map_or(0, |(first, last)| last - first)
        };
        let longest = steps(|pixel, width| pixel % width).max(steps(|pixel, width| pixel / width));
        pixels.sort_unstable();
        pixels.dedup();
        // A square crosses one more row and one more column of pixels than it is long.
        let mean_steps = (pixels.len() as f64).sqrt() - 1.0;
        (longest as f64 * mean_steps).max(1.0)
    }

    /// The pixel that a point is seen in, and its distance along the axis of the view; `None` where it is not seen.
    fn pixel_of(&self, position: Vec3) -> Option<(usize, f32)> {
        let in_view = self.view.to_view(position);
        let depth = -in_view.z;
        if depth < self.view.near {
            return None;
        }
        let ndc = [0, 1].map(|axis| in_view[axis] * self.view.focal[axis] / depth + self.view.center_ndc[axis]);
        let [column, row] = [ndc[0], -ndc[1]].map(|share| 0.5 * (share + 1.0));
        let is_inside = (0.0..1.0).contains(&column) && (0.0..1.0).contains(&row);
        is_inside.then(|| {
            let [width, height] = self.size;
            let column = ((column * width as f32) as usize).min(width - 1);
            let row = ((row * height as f32) as usize).min(height - 1);
            (row * width + column, depth)
        })
    }
}

#[cfg(test)]
#[path = "points_in_view_tests.rs"]
mod tests;
