//! Occlusion culling: removal of points that others hide.
//!
//! **How it works.** Every point writes its depth to the pixel of its centre, if it is the nearest there. A point is a
//! square of pixels around that one; the deeper it is the smaller, so the nearest point in a pixel covers all that the
//! others cover, and it is enough to test whether the pixels around a point reach it. Those that could are in seven
//! rows of eight floats: a row is one comparison, with thresholds that are the same for all points. Drawing whole
//! squares instead would write up to 49 pixels per point.
//!
//! Of points that are smaller than a pixel, the nearest in each pixel survives, as the index buffer of a GPU has one
//! per pixel: however dense a cloud is, no more is visible than the image has pixels.
//!
//! A larger point survives if nothing that covers its pixel is nearer by more than the neighbourhood search radius; or
//! if it lies on the plane of the nearer points, which are then the same surface (`ramp.rs`). With less than that
//! radius a surface would hide itself at 45 degrees already, and planes would be fitted to most of the points.

use super::compact::compact;
use super::constants::{BORDER_PX, MAX_REACH_PX, RADIUS_SPACINGS};
use super::lanes::LANES;
use super::ramp::Around;
use super::view::{ScreenPoint, ScreenView, Visible};
use crate::cloud::PointRecord;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat, dispatch, f32x8};
use rayon::prelude::*;
use std::f32::consts::FRAC_1_SQRT_2;
use std::sync::atomic::{AtomicU32, Ordering};

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 13;

/// Number of sampled points that determine how far splats outside the image may reach into it.
const MARGIN_SAMPLES: usize = 1 << 10;

/// No splat is thought to reach farther.
const MAX_MARGIN_PX: f32 = 256.0;

/// Depths of the nearest points.
#[derive(Debug, Default)]
pub(super) struct DepthPicture {
    /// The drawn view, of an image with a margin.
    view: Option<ScreenView>,
    /// Depth buffer of the nearest points, as they are found.
    nearest: Vec<AtomicU32>,
    /// Depth buffer with a border, infinite where nothing is.
    depths: Vec<f32>,
    stride: usize,
    spacing: f32,
    radius: f32,
    /// Points at larger depths are smaller than a pixel.
    small_beyond: f32,
    /// Reach of the squares of points.
    reach_px: usize,
    /// Cover thresholds of the pixels in eight lanes, by row: anything nearer than this covers the central pixel.
    covers_below: [[f32; LANES]; MAX_REACH_PX + 1],
}

/// The visible ones of the points of a task.
#[derive(Default)]
struct VisibleOfTask {
    slots: Vec<u32>,
    seen: Vec<ScreenPoint>,
}

impl DepthPicture {
    /// The view whose pixels [`ScreenPoint::place_px`] are of.
    pub(super) fn view(&self) -> Option<&ScreenView> {
        self.view.as_ref()
    }

    /// Size of the image with its margin.
    pub(super) fn size_px(&self) -> [usize; 2] {
        let size = self.view.as_ref().map_or([0; 2], |view| view.size_px);
        size.map(|edge| edge as usize)
    }

    /// Draws the centres of points that are `spacing` apart into the depth image.
    pub(super) fn draw(&mut self, view: &ScreenView, points: &[PointRecord], spacing: f32) {
        let spacing = spacing.max(0.0);
        (self.spacing, self.radius) = (spacing, RADIUS_SPACINGS * spacing);
        let view = with_margin_of_splats(view, points, spacing);
        self.view = Some(view);
        let [width, height] = self.size_px();
        self.nearest.resize_with(width * height, AtomicU32::default);
        self.nearest
            .par_iter_mut()
            .with_min_len(1 << 16)
            .for_each(|pixel| *pixel.get_mut() = f32::INFINITY.to_bits());
        let nearest = &self.nearest;
        // Hofer et al. 2018 draw footprints. One write per point gives the same result, as the nearest of all points in
        // a pixel covers the most: whether it reaches another pixel is tested from there (`is_covered`).
        points.par_chunks(POINTS_PER_TASK).for_each(|points| {
            for point in points {
                let Some((seen, [column, row])) = in_picture(&view, point) else {
                    continue;
                };
                // Positive f32 have the same order as their bits.
                let depth = seen.depth.to_bits();
                let pixel = &nearest[row * width + column];
                if depth < pixel.load(Ordering::Relaxed) {
                    pixel.fetch_min(depth, Ordering::Relaxed);
                }
            }
        });
        self.stride = width + BORDER_PX + LANES;
        self.depths.clear();
        self.depths
            .resize(self.stride * (height + 2 * BORDER_PX), f32::INFINITY);
        let rows = self.depths.par_chunks_mut(self.stride).skip(BORDER_PX);
        rows.zip(nearest.par_chunks(width.max(1))).for_each(|(row, nearest)| {
            for (depth, nearest) in row[BORDER_PX..].iter_mut().zip(nearest) {
                *depth = f32::from_bits(nearest.load(Ordering::Relaxed));
            }
        });
        self.measure_reach(spacing * FRAC_1_SQRT_2);
    }

    /// Computes the depth thresholds by pixels covered: a point is as wide as the diagonal of a square of the spacing,
    /// so that points on a grid leave no gap.
    fn measure_reach(&mut self, half_width: f32) {
        let Some(view) = self.view else { return };
        // A square reaches n pixels away if half its width is n - 1/2.
        let below = |axis: usize, steps: usize| match steps {
            0 => f32::INFINITY,
            steps => half_width * view.px_per_slope[axis].abs() / (steps as f32 - 0.5),
        };
        for (row, lanes) in self.covers_below.iter_mut().enumerate() {
            for (lane, covers_below) in lanes.iter_mut().enumerate() {
                let column = lane.abs_diff(MAX_REACH_PX);
                *covers_below = if column > MAX_REACH_PX {
                    0.0
                } else {
                    below(0, column).min(below(1, row))
                };
            }
        }
        self.small_beyond = below(0, 1).min(below(1, 1));
        let nearest = self.depths.par_iter().with_min_len(1 << 16).copied();
        let nearest = nearest.reduce(|| f32::INFINITY, f32::min);
        let reaches = |&steps: &usize| nearest < below(0, steps).max(below(1, steps));
        self.reach_px = (1..=MAX_REACH_PX).rev().find(reaches).unwrap_or(0);
    }

    /// The points that survive, in their order.
    pub(super) fn visible(&self, points: &[PointRecord]) -> Visible {
        let Some(view) = &self.view else {
            return Visible::default();
        };
        let level = Level::new();
        let tasks: Vec<VisibleOfTask> = points
            .par_chunks(POINTS_PER_TASK)
            .enumerate()
            .map(|(task, points)| {
                let first = (task * POINTS_PER_TASK) as u32;
                let mut visible = VisibleOfTask::default();
                dispatch!(level, simd => self.keep_visible(simd, view, first, points, &mut visible));
                visible
            })
            .collect();
        let lists = tasks.into_iter().map(|task| (task.slots, task.seen));
        let (slots, seen): (Vec<_>, Vec<_>) = lists.unzip();
        Visible {
            slots: compact(&slots),
            seen: compact(&seen),
        }
    }

    #[inline(always)]
    fn keep_visible<S: Simd>(
        &self,
        simd: S,
        view: &ScreenView,
        first: u32,
        points: &[PointRecord],
        visible: &mut VisibleOfTask,
    ) {
        for (slot, point) in (first..).zip(points) {
            if let Some((seen, place)) = in_picture(view, point)
                && !self.is_hidden(simd, place, &seen)
            {
                visible.slots.push(slot);
                visible.seen.push(seen);
            }
        }
    }

    /// Visibility test: returns true if a point at a pixel is hidden.
    #[inline(always)]
    fn is_hidden<S: Simd>(&self, simd: S, pixel: [usize; 2], seen: &ScreenPoint) -> bool {
        // Not the radius of a point's own splat: all of a floor seen at more than 45° would be hidden by the row in
        // front. With the neighbourhood radius this begins at 77°, where `ramp.rs` decides.
        let (depth, limit) = (seen.depth, seen.depth - self.radius);
        // Index of the first row and column that are examined; the border is as wide as that.
        let corner = pixel[1] * self.stride + pixel[0];
        let own = self.depths[corner + BORDER_PX * self.stride + BORDER_PX];
        // Guarantees that an image never has more of these points than pixels.
        if own < depth && depth > self.small_beyond {
            return true;
        }
        let is_covered = own < limit || self.is_covered(simd, corner, limit);
        is_covered && {
            let around = Around {
                depths: &self.depths[corner..],
                stride: self.stride,
                place_px: [0, 1].map(|axis| seen.place_px[axis] - pixel[axis] as f32 - 0.5),
                depth,
            };
            !around.is_on_plane_of_nearer(simd, self.spacing, self.radius)
        }
    }

    /// Returns true if anything nearer than `limit` covers the central pixel of those from `corner` on.
    #[inline(always)]
    fn is_covered<S: Simd>(&self, simd: S, corner: usize, limit: f32) -> bool {
        if self.reach_px == 0 {
            return false;
        }
        let limits = f32x8::splat(simd, limit);
        let mut hides = None;
        for row in BORDER_PX - self.reach_px..=BORDER_PX + self.reach_px {
            let start = corner + row * self.stride + (BORDER_PX - MAX_REACH_PX);
            let depths = f32x8::from_slice(simd, &self.depths[start..start + LANES]);
            let covers_below = f32x8::from_slice(simd, &self.covers_below[row.abs_diff(BORDER_PX)]);
            let hidden = depths.simd_lt(covers_below.min(limits));
            hides = Some(hides.map_or(hidden, |others| others | hidden));
        }
        hides.is_some_and(|hides| simd.any_true_mask32x8(hides))
    }
}

/// Projects a point and returns it with the pixel of its centre, if that is in the image.
#[inline(always)]
fn in_picture(view: &ScreenView, point: &PointRecord) -> Option<(ScreenPoint, [usize; 2])> {
    let seen = view.see(point.position)?;
    let [x, y] = seen.place_px;
    let [width, height] = view.size_px;
    let is_inside = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32;
    is_inside.then_some((seen, [x as usize, y as usize]))
}

/// Returns this view with a margin around the image, whose splats may reach into it.
pub(crate) fn with_margin_of_splats(view: &ScreenView, points: &[PointRecord], spacing: f32) -> ScreenView {
    view.with_margin(margin_px(view, points, RADIUS_SPACINGS * spacing.max(0.0)))
}

/// Computes the margin, in pixels, from which splats outside the image may reach into it: the projected neighbourhood
/// radius at the nearest of some points.
fn margin_px(view: &ScreenView, points: &[PointRecord], radius: f32) -> u32 {
    let step = points.len().div_ceil(MARGIN_SAMPLES).max(1);
    let samples = points.iter().step_by(step);
    let nearest = samples
        .filter_map(|point| in_picture(view, point))
        .map(|(seen, _)| seen.depth)
        .fold(f32::INFINITY, f32::min);
    let margin = radius * view.px_per_unit() / nearest;
    margin.clamp(MAX_REACH_PX as f32, MAX_MARGIN_PX).ceil() as u32
}
