//! Plane sweep: the depths of one view from any number of others.
//!
//! Collins (1996): planes at right angles to the axis of the view are swept through space, each other view is laid on
//! the plane as the view sees it, and where a surface is on the plane all show the same. Planes are spaced evenly in
//! inverse depth, for so are their pixels in the other views: a pixel p of the view is K₂(R K₁⁻¹ p + t / z) in another
//! one, which is linear in 1 / z.
//!
//! Costs are those of the census of what was laid on the plane. Of the costs of all views that see the place, the mean
//! of the better half counts (Kang et al. 2001): what hides a surface from some views hides it from one
//! side. They are gathered as those of pairs are. It wins over pairs where many views are near each other, and needs no
//! rectification; a pair takes less time.

use super::census::{HALF_HEIGHT, census, census_of_row};
use super::contrast::remove_even;
use super::costs::{LANES, Volume};
use super::filters::{median, remove_specks};
use super::local::local;
use super::refine::refine;
use super::semi_global::{Penalties, semi_global};
use super::view::pixels_from_rays;
use super::winner::{Between, Choice};
use super::{Gathering, GrayImage, StereoError, View};
use crate::rgbd::DepthImage;
use glam::{Mat3, Vec3};
use rayon::prelude::*;

/// Most planes.
const MOST_PLANES: usize = 1024;

/// Lines of a task.
const LINES: usize = 16;

/// Most bytes of all costs.
const MOST_BYTES: u64 = 2 << 30;

/// Most other views: more would tell nothing that the nearest do not.
const MOST_OTHERS: usize = 64;

/// Planes by which neighbours on one surface differ at most.
const SPECK_STEP: f32 = 1.0;

/// How planes are swept.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneSweep {
    /// Depth of the nearest plane, in the unit of the poses.
    pub near: f64,
    /// Depth of the farthest plane.
    pub far: f64,
    /// Number of planes, which is rounded up to a multiple of 32. Without one, so many that no view shifts by more than
    /// a pixel from plane to plane: between finer ones the costs hardly differ.
    pub planes: Option<usize>,
    /// How costs are gathered.
    pub gathering: Gathering,
    /// By how much all other planes have to cost more than the one that is taken, in percent.
    pub unique_percent: u16,
    /// Connected areas of fewer pixels are taken out.
    pub least_area_px: usize,
}

impl PlaneSweep {
    /// Between two depths.
    pub fn between(near: f64, far: f64) -> Self {
        Self {
            near,
            far,
            planes: None,
            gathering: Gathering::SemiGlobal(Penalties::default()),
            unique_percent: 3,
            least_area_px: 30,
        }
    }

    /// Depths of the pixels of `view`, along the axis of its camera, in the unit of the poses; 0 where none was found.
    /// Of others the first 64 are looked at.
    ///
    /// # Errors
    /// [`StereoError`] of views (the first is number 0, others follow), depths, penalties and sizes.
    pub fn depths(&self, view: &View<'_>, others: &[View<'_>]) -> Result<DepthImage, StereoError> {
        self.check_depths()?;
        if others.is_empty() {
            return Err(StereoError::TooFewViews(1));
        }
        let others = &others[..others.len().min(MOST_OTHERS)];
        for (index, view) in std::iter::once(view).chain(others).enumerate() {
            view.check(index)?;
        }
        let image = GrayImage::of_colors(view.image);
        let size = [image.width(), image.height()];
        let others: Vec<_> = others.iter().map(|other| Other::new(other, view)).collect();
        let planes = self.inverse_depths(size, &others);
        let volume = costs(&image, &others, &planes)?;
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
        let labels = refine(&labels, size[0], |at, label| volume.around(at, label));
        let mut labels = median(&labels, size[0]);
        remove_specks(&mut labels, size[0], self.least_area_px, |a, b| {
            (a - b).abs() <= SPECK_STEP
        });
        let step = planes[1] - planes[0];
        let depth = |label: f32| {
            let inverse = planes[0] + step * label;
            if inverse > 0.0 { 1.0 / inverse } else { 0.0 }
        };
        let depths = labels.into_iter().map(depth).collect();
        Ok(DepthImage::new(view.image.size_px(), depths).expect("as many as the image has pixels"))
    }

    fn check_depths(&self) -> Result<(), StereoError> {
        let (near, far) = (self.near, self.far);
        let planes = self.planes.unwrap_or(LANES);
        if near > 0.0 && near < far && far.is_finite() && (2..=MOST_PLANES).contains(&planes) {
            return Ok(());
        }
        Err(StereoError::NoDepths {
            near,
            far,
            planes,
            most: MOST_PLANES,
        })
    }

    /// From the farthest plane on, evenly.
    fn inverse_depths(&self, size: [usize; 2], others: &[Other]) -> Vec<f32> {
        let range = [1.0 / self.far, 1.0 / self.near];
        let count = self.planes.unwrap_or_else(|| {
            let shifts = others.iter().map(|other| other.shift(size, range));
            (shifts.fold(0.0, f32::max) as usize + 1).min(MOST_PLANES)
        });
        let count = count.next_multiple_of(LANES);
        let step = (range[1] - range[0]) / (count - 1) as f64;
        (0..count)
            .map(|plane| (range[0] + step * plane as f64) as f32)
            .collect()
    }
}

/// Another view, as the first one sees it on a plane.
struct Other {
    image: GrayImage,
    /// From pixels of the first view to those of this one on the plane at infinity.
    linear: Mat3,
    /// Times inverse depth, what is added.
    offset: Vec3,
}

impl Other {
    fn new(view: &View<'_>, first: &View<'_>) -> Self {
        let second_from_first = view.camera_from_world * first.camera_from_world.inverse();
        let pixels = pixels_from_rays(view.camera);
        Self {
            image: GrayImage::of_colors(view.image),
            linear: (pixels * second_from_first.matrix3 * pixels_from_rays(first.camera).inverse()).as_mat3(),
            offset: (pixels * second_from_first.translation).as_vec3(),
        }
    }

    /// By how many pixels what the first view has in its middle or in a corner moves between two inverse depths.
    fn shift(&self, [width, height]: [usize; 2], range: [f64; 2]) -> f32 {
        let (width, height) = (width as f32 - 1.0, height as f32 - 1.0);
        let places = [[0.5, 0.5], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let shifts = places.map(|[x, y]| {
            let ends = range.map(|inverse| {
                let to = self.linear * Vec3::new(x * width, y * height, 1.0) + self.offset * inverse as f32;
                (to.z > 0.0).then(|| to.truncate() / to.z)
            });
            let [Some(far), Some(near)] = ends else { return 0.0 };
            far.distance(near)
        });
        shifts.into_iter().fold(0.0, f32::max)
    }

    /// Writes the lines from `from` on of what is seen on a plane, and of which pixels there is something.
    fn lay(&self, inverse_depth: f32, from: usize, width: usize, pixels: &mut [u8], is_seen: &mut [bool]) {
        let offset = self.offset * inverse_depth;
        let most = [self.image.width() as f32 - 0.5, self.image.height() as f32 - 0.5];
        let lines = pixels.chunks_exact_mut(width).zip(is_seen.chunks_exact_mut(width));
        for (y, (pixels, is_seen)) in (from..).zip(lines) {
            let line = self.linear * Vec3::new(0.0, y as f32, 1.0) + offset;
            for (x, (pixel, is_seen)) in pixels.iter_mut().zip(is_seen).enumerate() {
                let to = line + self.linear.x_axis * x as f32;
                let (u, v) = (to.x / to.z, to.y / to.z);
                *is_seen = to.z > 0.0 && u >= -0.5 && v >= -0.5 && u <= most[0] && v <= most[1];
                // Beyond the border is the border: where all is even, no plane costs more than others.
                *pixel = self.image.bilinear(u, v);
            }
        }
    }
}

fn costs(image: &GrayImage, others: &[Other], planes: &[f32]) -> Result<Volume, StereoError> {
    let [width, height] = [image.width(), image.height()];
    let line = width * planes.len();
    let needed = line as u64 * height as u64;
    if needed > MOST_BYTES {
        return Err(StereoError::TooLarge {
            needed_mib: needed >> 20,
            most_mib: MOST_BYTES >> 20,
        });
    }
    let bits = census(image);
    let mut costs = vec![0; line * height];
    costs
        .par_chunks_mut(LINES * line)
        .enumerate()
        .for_each(|(task, costs)| {
            let from = task * LINES;
            let lines = from..from + costs.len() / line;
            let mut slab = Slab::new(others, lines, [width, height]);
            for (plane, &inverse_depth) in planes.iter().enumerate() {
                slab.sweep(inverse_depth, &bits);
                for (costs, cost) in costs.chunks_exact_mut(planes.len()).zip(slab.best_halves()) {
                    costs[plane] = cost;
                }
            }
        });
    Ok(Volume {
        size: [width, height],
        count: planes.len(),
        costs,
    })
}

/// Some lines of the view, and memory for what is laid on them.
struct Slab<'a> {
    others: &'a [Other],
    width: usize,
    lines: std::ops::Range<usize>,
    /// First of the lines that are laid: those above and below are compared with.
    first: usize,
    laid: GrayImage,
    is_seen: Vec<bool>,
    bits: Vec<u64>,
    /// Costs of the others of each pixel, and how many of them see it.
    costs: Vec<u8>,
    counts: Vec<u8>,
    /// The least cost of each pixel beyond all borders, where no view sees it.
    beyond: Vec<u8>,
}

impl<'a> Slab<'a> {
    fn new(others: &'a [Other], lines: std::ops::Range<usize>, [width, height]: [usize; 2]) -> Self {
        let first = lines.start.saturating_sub(HALF_HEIGHT);
        let last = (lines.end + HALF_HEIGHT).min(height);
        let pixels = width * lines.len();
        Self {
            others,
            width,
            first,
            laid: GrayImage::black([width, last - first]),
            is_seen: vec![false; width * (last - first)],
            bits: vec![0; width],
            costs: vec![0; pixels * others.len()],
            counts: vec![0; pixels],
            beyond: vec![0; pixels],
            lines,
        }
    }

    /// Costs of one plane. `bits` are those of the whole view.
    fn sweep(&mut self, inverse_depth: f32, bits: &[u64]) {
        let width = self.width;
        self.counts.fill(0);
        self.beyond.fill(u8::MAX);
        for other in self.others {
            other.lay(
                inverse_depth,
                self.first,
                width,
                self.laid.pixels_mut(),
                &mut self.is_seen,
            );
            let costs = self.costs.chunks_exact_mut(width * self.others.len());
            let counts = self
                .counts
                .chunks_exact_mut(width)
                .zip(self.beyond.chunks_exact_mut(width));
            for (y, (costs, (counts, beyond))) in self.lines.clone().zip(costs.zip(counts)) {
                let laid = y - self.first;
                self.bits.fill(0);
                census_of_row(&self.laid, laid, &mut self.bits);
                let is_seen = &self.is_seen[laid * width..(laid + 1) * width];
                let bits = &bits[y * width..(y + 1) * width];
                for (x, costs) in costs.chunks_exact_mut(self.others.len()).enumerate() {
                    let cost = (self.bits[x] ^ bits[x]).count_ones() as u8;
                    if is_seen[x] {
                        costs[usize::from(counts[x])] = cost;
                        counts[x] += 1;
                    } else {
                        beyond[x] = beyond[x].min(cost);
                    }
                }
            }
        }
    }

    /// The mean of the better half of the costs of each pixel.
    fn best_halves(&mut self) -> impl Iterator<Item = u8> {
        let pixels = self
            .costs
            .chunks_exact_mut(self.others.len())
            .zip(self.counts.iter().zip(&self.beyond));
        pixels.map(|(costs, (&count, &beyond))| best_half(&mut costs[..usize::from(count)]).unwrap_or(beyond))
    }
}

/// `None` of none.
fn best_half(costs: &mut [u8]) -> Option<u8> {
    costs.sort_unstable();
    let half = costs.len().div_ceil(2) as u32;
    let sum: u32 = costs.iter().take(half as usize).map(|&cost| u32::from(cost)).sum();
    (sum + half / 2).checked_div(half).map(|mean| mean as u8)
}

#[cfg(test)]
mod tests;
