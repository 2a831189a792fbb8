//! FLIP for images of low dynamic range: the difference noticed when flipping between two images.
//!
//! How it works (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: *FLIP: A Difference Evaluator for
//! Alternating Images*, HPG 2020):
//! 1. *Colour* (§4.1). Both images are blurred as the eye blurs them at their viewing distance, luminance, red-green
//!    and blue-yellow each by its contrast sensitivity; the rest is compared by `HyAB` in Hunt-adjusted L*a*b*, and the
//!    distances are compressed into 0 to 1.
//! 2. *Features* (§4.2). Edges and points of the luminance, by first and second derivatives of a Gaussian, are compared
//!    by their strength: an eye is drawn to them.
//! 3. The error of a pixel is its colour error to the power of one minus its feature error (§4.3): features amplify.
//!
//! When it wins: over mean squares, which see neither that noise of a pixel blurs away nor that a missing edge does
//! not.
//!
//! Written from the paper; the one crate for it, `nv-flip`, wraps C++ and has had no release since 2023. Held in tests
//! against values of the authors' own evaluator, version 1.7.

mod color;
mod heatmap;
mod kernel;

use super::{SizeMismatch, check_sizes, size_px};
use color::{hunt_lab_from_linear, hyab, linear_from_stored, linear_from_ycxcz, ycxcz_from_linear};
use glam::Vec3;
use image::RgbaImage;
use kernel::{Kernel, Plane};
use rayon::prelude::*;
use std::f64::consts::PI;

/// The paper's viewing conditions: 0.7 m away from a monitor 0.7 m wide with 3840 pixels.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// Terms `a`, `b` of the contrast sensitivities, Σ a √(π/b) exp(−π² x²/b) with x in degrees (Table 1 of the paper):
/// luminance, red-green, blue-yellow.
const SENSITIVITIES: [&[[f64; 2]]; 3] = [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];

/// The largest `b` of [`SENSITIVITIES`].
const WIDEST: f64 = 0.04;

/// Standard deviations at which Gaussians are cut off.
const CUT_OFF: f64 = 3.0;

/// Width of a feature that is seen best, degrees.
const FEATURE_WIDTH_DEG: f64 = 0.082;

/// Exponents that compress distances of colours and of features.
const COLOR_EXPONENT: f32 = 0.7;
const FEATURE_EXPONENT: f32 = 0.5;

/// This part of the largest distance of colours is mapped to [`KNEE_ERROR`]; larger ones share the rest of 0 to 1.
const KNEE: f32 = 0.4;
const KNEE_ERROR: f32 = 0.95;

/// The FLIP error of each pixel of `test` at [`PIXELS_PER_DEGREE`].
pub fn flip(reference: &RgbaImage, test: &RgbaImage) -> Result<ErrorMap, SizeMismatch> {
    check_sizes(size_px(reference), size_px(test))?;
    Perceived::of(reference, PIXELS_PER_DEGREE).flip(&Perceived::of(test, PIXELS_PER_DEGREE))
}

/// One number a pixel, 0 (no difference) to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    /// Width and height.
    pub size_px: [u32; 2],
    /// Row by row from the top left.
    pub errors: Vec<f32>,
}

impl ErrorMap {
    /// Mean over all pixels; 0 without any.
    pub fn mean(&self) -> f64 {
        self.mean_where(|_| true)
    }

    /// Mean over the pixels (by their place in [`ErrorMap::errors`]) that `counts` chooses; 0 when it chooses none.
    pub fn mean_where(&self, counts: impl Fn(usize) -> bool) -> f64 {
        let (mut sum, mut count) = (0.0, 0u64);
        for (pixel, &error) in self.errors.iter().enumerate() {
            if counts(pixel) {
                sum += f64::from(error);
                count += 1;
            }
        }
        sum / count.max(1) as f64
    }

    /// Largest; 0 without pixels.
    pub fn max(&self) -> f32 {
        self.errors.iter().copied().fold(0.0, f32::max)
    }
}

/// Perceived image: the response of an observer to one image; computed once for an image that is compared with several.
#[derive(Debug, Clone, PartialEq)]
pub struct Perceived {
    size_px: [u32; 2],
    pixels_per_degree: f64,
    /// Filtered colours in Hunt-adjusted L*a*b*.
    colors: Vec<Vec3>,
    /// Strength of the edge and of the point at each pixel.
    features: Vec<[f32; 2]>,
}

impl Perceived {
    /// Looks at `image`, whose field of view has `pixels_per_degree` (positive) pixels per degree. Alpha is ignored.
    pub fn of(image: &RgbaImage, pixels_per_degree: f64) -> Self {
        let width = image.width() as usize;
        let pixels: Vec<Vec3> = image
            .pixels()
            .map(|pixel| ycxcz_from_linear(linear_from_stored([pixel[0], pixel[1], pixel[2]])))
            .collect();
        let channel = |index: usize| Plane {
            width,
            values: pixels.iter().map(|pixel| pixel[index]).collect(),
        };
        let planes: [Plane; 3] = std::array::from_fn(channel);
        Self {
            size_px: size_px(image),
            pixels_per_degree,
            colors: blurred_colors(&planes, pixels_per_degree),
            features: features(&planes[0], pixels_per_degree),
        }
    }

    /// The error of each pixel of `test` where this is the reference. Both must be seen from the same distance.
    pub fn flip(&self, test: &Self) -> Result<ErrorMap, SizeMismatch> {
        debug_assert_eq!(self.pixels_per_degree, test.pixels_per_degree);
        check_sizes(self.size_px, test.size_px)?;
        let largest = largest_color_distance();
        let errors = (0..self.colors.len())
            .into_par_iter()
            .with_min_len(1 << 12)
            .map(|pixel| {
                let color = color_error(self.colors[pixel], test.colors[pixel], largest);
                let feature = feature_error(self.features[pixel], test.features[pixel]);
                color.powf(1.0 - feature)
            })
            .collect();
        Ok(ErrorMap {
            size_px: self.size_px,
            errors,
        })
    }
}

/// Blurs each channel by its contrast sensitivity; colours that no monitor shows are moved to the nearest that it does.
fn blurred_colors(ycxcz: &[Plane; 3], pixels_per_degree: f64) -> Vec<Vec3> {
    let radius_px = (CUT_OFF * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
    let blurred: Vec<Plane> = ycxcz
        .iter()
        .zip(SENSITIVITIES)
        .map(|(plane, terms)| blurred(plane, terms, radius_px, pixels_per_degree))
        .collect();
    (0..ycxcz[0].values.len())
        .into_par_iter()
        .with_min_len(1 << 12)
        .map(|pixel| {
            let ycxcz = Vec3::new(
                blurred[0].values[pixel],
                blurred[1].values[pixel],
                blurred[2].values[pixel],
            );
            hunt_lab_from_linear(linear_from_ycxcz(ycxcz).clamp(Vec3::ZERO, Vec3::ONE))
        })
        .collect()
}

/// A sum of Gaussians is not separable, each of them is: the weighted sum of their answers.
fn blurred(plane: &Plane, terms: &[[f64; 2]], radius_px: usize, pixels_per_degree: f64) -> Plane {
    let gaussian = |b: f64| move |x: f64| (-(PI * x / pixels_per_degree).powi(2) / b).exp();
    // The sum of each term over all pixels of its square.
    let totals: Vec<f64> = terms
        .iter()
        .map(|&[a, b]| {
            let radius = radius_px as i32;
            let along: f64 = (-radius..=radius).map(|x| gaussian(b)(f64::from(x))).sum();
            a * (PI / b).sqrt() * along * along
        })
        .collect();
    let total: f64 = totals.iter().sum();
    let mut sum = Plane {
        width: plane.width,
        values: vec![0.0; plane.values.len()],
    };
    for (&[_, b], term_total) in terms.iter().zip(&totals) {
        let kernel = Kernel::normalized(radius_px, gaussian(b));
        let share = (term_total / total) as f32;
        let filtered = plane.filtered(&kernel, &kernel);
        for (sum, value) in sum.values.iter_mut().zip(&filtered.values) {
            *sum += share * value;
        }
    }
    sum
}

/// Strength of edges and points of a luminance plane, each 0 to √2.
fn features(luminance: &Plane, pixels_per_degree: f64) -> Vec<[f32; 2]> {
    let sigma_px = 0.5 * FEATURE_WIDTH_DEG * pixels_per_degree;
    let radius_px = (CUT_OFF * sigma_px).ceil() as usize;
    let gaussian = |x: f64| (-0.5 * (x / sigma_px).powi(2)).exp();
    let smooth = Kernel::normalized(radius_px, gaussian);
    let edge = Kernel::normalized(radius_px, |x| -x * gaussian(x));
    let point = Kernel::normalized(radius_px, |x| ((x / sigma_px).powi(2) - 1.0) * gaussian(x));
    let luminance = Plane {
        width: luminance.width,
        values: luminance.values.iter().map(|y| (y + 16.0) / 116.0).collect(),
    };
    let strength = |kernel: &Kernel| {
        let along_x = luminance.filtered(kernel, &smooth);
        let along_y = luminance.filtered(&smooth, kernel);
        along_x.values.into_iter().zip(along_y.values).map(|(x, y)| x.hypot(y))
    };
    strength(&edge).zip(strength(&point)).map(<[f32; 2]>::from).collect()
}

/// The distance of green and blue, which no two other colours of a monitor exceed.
fn largest_color_distance() -> f32 {
    hyab(hunt_lab_from_linear(Vec3::Y), hunt_lab_from_linear(Vec3::Z)).powf(COLOR_EXPONENT)
}

fn color_error(reference: Vec3, test: Vec3, largest: f32) -> f32 {
    let distance = hyab(reference, test).powf(COLOR_EXPONENT);
    let knee = KNEE * largest;
    if distance < knee {
        distance * (KNEE_ERROR / knee)
    } else {
        KNEE_ERROR + (distance - knee) / (largest - knee) * (1.0 - KNEE_ERROR)
    }
}

fn feature_error(reference: [f32; 2], test: [f32; 2]) -> f32 {
    let [edge, point] = [0, 1].map(|feature| (reference[feature] - test[feature]).abs());
    (edge.max(point) / 2f32.sqrt()).powf(FEATURE_EXPONENT).min(1.0)
}

#[cfg(test)]
mod tests;
