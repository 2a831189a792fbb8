//! Plane sweep: the depths of one view from any number of others.
//!
//! Collins (1996): planes at right angles to the axis of the view are swept through space, each other view is laid on
//! the plane as the view sees it, and where a surface is on the plane all show the same. Planes are spaced evenly in
//! inverse depth, for so are their pixels in the other views: a pixel p of the view is K₂(R K₁⁻¹ p + t / z) in another
//! one, which is linear in 1 / z.
//!
//! Costs come from the census of the images projected onto a plane; each view is projected once, and shifted from plane
//! to plane (`turned.rs`). Of the costs of all views that see the place, the mean of the better half counts
//! (`better_half.rs`): an occluder hides a surface from one side. They are gathered as for pairs. It wins over pairs
//! where many views are near each other, and needs no rectification; a pair takes less time.

mod better_half;
mod turned;

use crate::progress::Progress;
use crate::rgbd::DepthImage;
use crate::stereo::Gathering;
use crate::stereo::GrayImage;
use crate::stereo::StereoError;
use crate::stereo::View;
use crate::stereo::matching::census::census;
use crate::stereo::matching::contrast::remove_even;
use crate::stereo::matching::costs::{LANES, MAX_COST, Volume};
use crate::stereo::matching::filters::{median, remove_specks};
use crate::stereo::matching::local::local;
use crate::stereo::matching::refine::refine;
use crate::stereo::matching::semi_global::{Penalties, semi_global};
use crate::stereo::matching::winner::{Between, Choice};
use better_half::BetterHalf;
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use turned::{Other, Turned};

/// Maximum number of planes.
const MAX_PLANES: usize = 1024;

/// Lines of a task.
const LINES: usize = 4;

/// Steps of progress while costs are worked out.
const COST_STEPS: usize = 15;

/// Maximum bytes of all costs, and of all other views.
const MAX_BYTES: u64 = 2 << 30;

/// Maximum number of other views: more would add nothing to the nearest.
const MAX_OTHERS: usize = 64;

/// Planes by which neighbours on one surface differ at most.
const SPECK_STEP: f32 = 1.0;

/// Plane sweep settings.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneSweep {
    /// Depth of the nearest plane, in the unit of the poses.
    pub near: f64,
    /// Depth of the farthest plane.
    pub far: f64,
    /// Number of planes, which is rounded up to a multiple of 32. Without one, enough that no view shifts by more than
    /// a pixel from plane to plane: between finer ones the costs hardly differ.
    pub planes: Option<usize>,
    /// Cost aggregation method.
    pub gathering: Gathering,
    /// Margin by which all other planes have to cost more than the chosen one, in percent.
    pub unique_percent: u16,
    /// Connected areas of fewer pixels are taken out.
    pub min_area_px: usize,
}

impl PlaneSweep {
    /// Steps by which progress advances: costs, then the steps after them.
    pub const STEPS: usize = COST_STEPS + 1;

    /// Between two depths.
    pub fn between(near: f64, far: f64) -> Self {
        Self {
            near,
            far,
            planes: None,
            gathering: Gathering::SemiGlobal(Penalties::default()),
            unique_percent: 3,
            min_area_px: 30,
        }
    }

    /// Depths of the pixels of `view`, along the axis of its camera, in the unit of the poses; 0 where none was found.
    /// Of others the first 64 are looked at.
    ///
    /// # Errors
    /// [`StereoError`] of views (the first is number 0, others follow), depths, penalties and sizes.
    pub fn depths(&self, view: &View<'_>, others: &[View<'_>]) -> Result<DepthImage, StereoError> {
        self.depths_observed(view, others, &Progress::default())
    }

    /// Computes depths as [`PlaneSweep::depths`] does, reporting progress: `progress` advances by [`PlaneSweep::STEPS`]
    /// in all, and may be cancelled.
    ///
    /// # Errors
    /// The errors of [`PlaneSweep::depths`], and [`StereoError::Cancelled`].
    pub fn depths_observed(
        &self,
        view: &View<'_>,
        others: &[View<'_>],
        progress: &Progress,
    ) -> Result<DepthImage, StereoError> {
        self.check_depths()?;
        if others.is_empty() {
            return Err(StereoError::TooFewViews(1));
        }
        let others = &others[..others.len().min(MAX_OTHERS)];
        for (index, view) in std::iter::once(view).chain(others).enumerate() {
            view.check(index)?;
        }
        let image = GrayImage::of_colors(view.image);
        let size = [image.width(), image.height()];
        let others: Vec<_> = others.iter().map(|other| Other::new(other, view)).collect();
        let planes = self.inverse_depths(size, &others);
        let volume = costs(&image, &others, &planes, progress)?;
        let choice = Choice {
            unique_percent: self.unique_percent,
            between: Between::Lines,
            left_right: None,
        };
        let mut labels = vec![f32::NAN; size[0] * size[1]];
        let winners = |sums: &mut [u16], labels: &mut [f32]| choice.winners(sums, labels);
        match self.gathering {
            Gathering::SemiGlobal(penalties) => semi_global(&volume, &image, penalties, &mut labels, winners)?,
            Gathering::Local { radius_px } => local(&volume, radius_px, &mut labels, winners)?,
        }
        remove_even(&image, &mut labels);
        if progress.is_cancelled() {
            return Err(StereoError::Cancelled);
        }
        let labels = refine(&labels, size[0], |at, label| volume.around(at, label));
        let mut labels = median(&labels, size[0]);
        remove_specks(&mut labels, size[0], self.min_area_px, |a, b| {
            (a - b).abs() <= SPECK_STEP
        });
        let step = planes[1] - planes[0];
        let depth = |label: f32| {
            let inverse = planes[0] + step * label;
            if inverse > 0.0 { 1.0 / inverse } else { 0.0 }
        };
        let depths = labels.into_iter().map(depth).collect();
        progress.advance(1);
        Ok(DepthImage::new(view.image.size_px(), depths).expect("one depth per pixel of the image"))
    }

    fn check_depths(&self) -> Result<(), StereoError> {
        let (near, far) = (self.near, self.far);
        let planes = self.planes.unwrap_or(LANES);
        if near > 0.0 && near < far && far.is_finite() && (2..=MAX_PLANES).contains(&planes) {
            return Ok(());
        }
        Err(StereoError::NoDepths {
            near,
            far,
            planes,
            most: MAX_PLANES,
        })
    }

    /// From the farthest plane on, evenly.
    fn inverse_depths(&self, size: [usize; 2], others: &[Other]) -> Vec<f32> {
        let range = [1.0 / self.far, 1.0 / self.near];
        // One pixel per plane: finer planes doubled the error, as costs of neighbouring planes hardly differ.
        let count = self.planes.unwrap_or_else(|| {
            let shifts = others.iter().map(|other| other.shift(size, range));
            (shifts.fold(0.0, f32::max) as usize + 1).min(MAX_PLANES)
        });
        let count = count.next_multiple_of(LANES);
        let step = (range[1] - range[0]) / (count - 1) as f64;
        (0..count)
            .map(|plane| (range[0] + step * plane as f64) as f32)
            .collect()
    }
}

fn costs(image: &GrayImage, others: &[Other], planes: &[f32], progress: &Progress) -> Result<Volume, StereoError> {
    let size = [image.width(), image.height()];
    let line = size[0] * planes.len();
    let needed = line as u64 * size[1] as u64 + others.len() as u64 * Other::byte_size(size);
    if needed > MAX_BYTES {
        return Err(StereoError::TooLarge {
            needed_mib: needed >> 20,
            max_mib: MAX_BYTES >> 20,
        });
    }
    let range = [planes[0], planes[planes.len() - 1]];
    let turned: Vec<Turned> = others.par_iter().map(|other| other.turned(size, range)).collect();
    let bits = census(image);
    let mut costs = vec![0; line * size[1]];
    let done = AtomicUsize::new(0);
    let lines = costs.par_chunks_mut(LINES * line).zip(bits.par_chunks(LINES * size[0]));
    lines.enumerate().for_each(|(task, (costs, bits))| {
        if progress.is_cancelled() {
            return;
        }
        let mut costs_of_lines = LineCosts::new(&turned, size[0]);
        let lines = costs.chunks_exact_mut(line).zip(bits.chunks_exact(size[0]));
        for (y, (costs, bits)) in (task * LINES..).zip(lines) {
            costs_of_lines.fill(y, bits, planes, costs);
        }
        let lines = LINES.min(size[1] - task * LINES);
        let before = done.fetch_add(lines, Ordering::Relaxed);
        let steps = |lines: usize| COST_STEPS * lines / size[1];
        let steps = steps(before + lines) - steps(before);
        if steps > 0 {
            progress.advance(steps);
        }
    });
    if progress.is_cancelled() {
        return Err(StereoError::Cancelled);
    }
    Ok(Volume {
        size,
        count: planes.len(),
        costs,
    })
}

/// Memory for the costs of a line.
struct LineCosts<'a> {
    others: &'a [Turned],
    half: BetterHalf,
    /// Matching costs of one other view, for one plane.
    costs: Vec<u8>,
    /// The smallest cost of each pixel beyond all borders, where no view sees it.
    beyond: Vec<u8>,
    means: Vec<u8>,
}

impl<'a> LineCosts<'a> {
    fn new(others: &'a [Turned], width: usize) -> Self {
        Self {
            others,
            half: BetterHalf::new(width, others.len()),
            costs: vec![0; width],
            beyond: vec![0; width],
            means: vec![0; width],
        }
    }

    /// Writes the costs of line `y`, pixel by pixel, plane by plane. `bits` are its pixels'.
    fn fill(&mut self, y: usize, bits: &[u64], planes: &[f32], costs: &mut [u8]) {
        for (plane, &inverse_depth) in planes.iter().enumerate() {
            self.half.clear();
            for other in self.others {
                dispatch!(Level::new(), _simd => other.costs(inverse_depth, y, bits, &mut self.costs));
                self.half.take(&mut self.costs);
            }
            if self.half.lacks_views() {
                self.beyond.fill(MAX_COST);
                for other in self.others {
                    other.beyond(inverse_depth, y, bits, &mut self.beyond);
                }
            }
            self.half.means(&self.beyond, &mut self.means);
            for (costs, &mean) in costs.chunks_exact_mut(planes.len()).zip(&self.means) {
                costs[plane] = mean;
            }
        }
    }
}

#[cfg(test)]
mod tests;
