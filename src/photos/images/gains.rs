//! Exposure compensation: gains that make images of different exposures and white balances agree where they show the
//! same points.
//!
//! *How it works.* For images i that show point p with colours c, a gain g each should make all g·c one colour m. In
//! logarithms that is linear: least squares of ln g + ln c − ln m over all observations, each channel by itself, with
//! the colour of each point taken out, and a few observations' worth of *gain 1* for each image, so that groups that
//! share nothing stay where they are. Conjugate gradients solve it without a matrix: a thousand images cost no more
//! than their observations. Highlights and wrong tracks are outliers: each round weighs an observation less the further
//! it was off in the round before (Cauchy's weights, Holland and Welsch 1977).
//!
//! Gains are of display values, as drawing multiplies these: they undo an exposure for a curve that is a power, which
//! curves of cameras nearly are between the dark and the bright end. Both ends are excluded.

use super::prepared::PreparedPhoto;
use crate::photos::sets::points::SparsePoints;
use rayon::prelude::*;

/// Pixels around an observation whose mean is compared: features are corners, where half a pixel matters.
const RADIUS_PX: u32 = 2;

/// Display values that say something of an exposure: below is noise, above the sensor was full.
const USABLE: std::ops::RangeInclusive<f32> = 8.0..=247.0;

/// Observations that *gain 1* counts for.
const REGULARISER: f64 = 4.0;

/// Difference of logarithms at which an observation counts half: a tenth is more than noise.
const HALF_WEIGHT: f64 = 0.1;

const ROUNDS: usize = 10;

/// Maximum number of conjugate gradient steps: clusters of images that agree converge in a few dozen.
const MAX_STEPS: usize = 300;

/// Convergence tolerance: the fraction of the first residual at which the solution is accepted.
const DONE: f64 = 1e-10;

/// No exposure series is wider.
const MAX_GAIN: f64 = 16.0;

/// A colour sample of a point in an image, as logarithms.
#[derive(Debug, Clone, Copy)]
struct Sample {
    photo: usize,
    logs: [f64; 3],
}

/// Samples of all points, one after the other.
#[derive(Debug, Default)]
struct Samples {
    all: Vec<Sample>,
    /// End index of the samples of each point.
    ends: Vec<usize>,
}

/// Computes a gain for red, green and blue of each image, to be multiplied with its display values. Their mean is 1.
/// Images that share no points with others keep 1.
///
/// `photos` are the images of the set of `points`, in its order; `None` for unused ones.
pub fn gains(points: &SparsePoints, photos: &[Option<PreparedPhoto>]) -> Vec<[f32; 3]> {
    let samples = Samples::of(points, photos);
    let mut has_samples = vec![false; photos.len()];
    for sample in &samples.all {
        has_samples[sample.photo] = true;
    }
    let channels: Vec<Vec<f64>> = (0..3)
        .into_par_iter()
        .map(|channel| samples.gains(channel, &has_samples))
        .collect();
    let of_photo = |photo: usize| std::array::from_fn(|channel| channels[channel][photo] as f32);
    (0..photos.len()).map(of_photo).collect()
}

impl Samples {
    fn of(points: &SparsePoints, photos: &[Option<PreparedPhoto>]) -> Self {
        let of_point = |point: usize| -> Vec<Sample> {
            let position = points.positions()[point];
            let seen = points.track(point).iter().filter_map(|seen| {
                let photo = seen.photo as usize;
                let color = photos.get(photo)?.as_ref()?.color_around(position, RADIUS_PX)?;
                let is_usable = color.iter().all(|value| USABLE.contains(value));
                is_usable.then(|| Sample {
                    photo,
                    // Linear factors would have their optimum at zero, prevented only by the regulariser.
                    logs: color.map(|value| f64::from(value).ln()),
                })
            });
            let mut samples: Vec<Sample> = seen.collect();
            samples.sort_unstable_by_key(|sample| sample.photo);
            samples.dedup_by_key(|sample| sample.photo);
            samples
        };
        let by_point: Vec<Vec<Sample>> = (0..points.len()).into_par_iter().map(of_point).collect();
        let mut samples = Self::default();
        for of_point in by_point.into_iter().filter(|samples| samples.len() > 1) {
            samples.all.extend(of_point);
            samples.ends.push(samples.all.len());
        }
        samples
    }

    /// The samples of each point, by their places in the list of all.
    fn tracks(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| start..end)
    }

    /// Gains of a channel.
    fn gains(&self, channel: usize, has_samples: &[bool]) -> Vec<f64> {
        let logs: Vec<f64> = self.all.iter().map(|sample| sample.logs[channel]).collect();
        let mut weights = vec![1.0; logs.len()];
        let mut gains = vec![0.0; has_samples.len()];
        for _ in 0..ROUNDS {
            gains = self.solve(&logs, &weights, gains);
            self.weigh(&logs, &gains, &mut weights);
        }
        let count = has_samples.iter().filter(|&&has| has).count();
        let of = |(&log, &has): (&f64, &bool)| if has { log.exp() } else { 1.0 };
        let gains: Vec<f64> = gains.iter().zip(has_samples).map(of).collect();
        let used = gains.iter().zip(has_samples).filter(|(_, has)| **has);
        let mean = used.map(|(gain, _)| gain).sum::<f64>() / count.max(1) as f64;
        let scaled = |(gain, &has): (f64, &bool)| {
            let gain = if has { gain / mean } else { 1.0 };
            gain.clamp(MAX_GAIN.recip(), MAX_GAIN)
        };
        gains.into_iter().zip(has_samples).map(scaled).collect()
    }

    /// For each sample the weighted mean of `values` of its point, taken from its own.
    fn differences(&self, weights: &[f64], values: impl Fn(usize) -> f64, mut each: impl FnMut(usize, f64)) {
        for track in self.tracks() {
            let total: f64 = weights[track.clone()].iter().sum();
            let sum: f64 = track.clone().map(|at| weights[at] * values(at)).sum();
            for at in track {
                each(at, values(at) - sum / total);
            }
        }
    }

    /// Logarithms of gains that minimise the weighted squares, from `start`.
    fn solve(&self, logs: &[f64], weights: &[f64], start: Vec<f64>) -> Vec<f64> {
        let photo = |at: usize| self.all[at].photo;
        // Matrix-free: 100 images with 500,000 observations take half a second.
        let normal = |gains: &[f64]| {
            let mut result: Vec<f64> = gains.iter().map(|gain| REGULARISER * gain).collect();
            let add = |at: usize, difference: f64| result[photo(at)] += weights[at] * difference;
            self.differences(weights, |at| gains[photo(at)], add);
            result
        };
        let mut residual = vec![0.0; start.len()];
        self.differences(
            weights,
            |at| -logs[at],
            |at, difference| residual[photo(at)] += weights[at] * difference,
        );
        let first = dot(&residual, &residual);
        for (residual, product) in residual.iter_mut().zip(normal(&start)) {
            *residual -= product;
        }
        let mut gains = start;
        let mut direction = residual.clone();
        let mut square = dot(&residual, &residual);
        for _ in 0..MAX_STEPS {
            if square <= DONE * DONE * first || square == 0.0 {
                break;
            }
            let product = normal(&direction);
            let step = square / dot(&direction, &product);
            for at in 0..gains.len() {
                gains[at] += step * direction[at];
                residual[at] -= step * product[at];
            }
            let next = dot(&residual, &residual);
            for (direction, residual) in direction.iter_mut().zip(&residual) {
                *direction = residual + next / square * *direction;
            }
            square = next;
        }
        gains
    }

    /// Weights for the next round.
    fn weigh(&self, logs: &[f64], gains: &[f64], weights: &mut [f64]) {
        let mut next = weights.to_vec();
        let value = |at: usize| logs[at] + gains[self.all[at].photo];
        self.differences(weights, value, |at, difference| {
            next[at] = (1.0 + (difference / HALF_WEIGHT).powi(2)).recip();
        });
        weights.copy_from_slice(&next);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::super::photo_image::PhotoImage;
    use super::*;
    use crate::photos::sets::points::Observation;
    use crate::rgbd::{Camera, Distortion};
    use glam::{DAffine3, DVec2, DVec3, Vec2};

    const SIDE: usize = 120;

    /// An image of the plane z = 1, of coloured squares, times `gain`.
    fn photo(gain: [f32; 3], outliers: bool) -> PreparedPhoto {
        let camera = Camera::new(
            [SIDE as u32; 2],
            DVec2::splat(120.0),
            DVec2::splat(59.5),
            Distortion::None,
        );
        let pixel = |at: usize| {
            let square = (at / SIDE / 12 * 10 + at % SIDE / 12) as f32;
            // A wrong colour for one in ten squares.
            let is_wrong = outliers && square as usize % 10 == 3;
            let color = [60.0 + square, 140.0 - square, 80.0 + 0.5 * square];
            let [r, g, b] = std::array::from_fn(|channel| {
                let value = if is_wrong {
                    200.0
                } else {
                    color[channel] * gain[channel]
                };
                value.round() as u8
            });
            [r, g, b, 255]
        };
        PreparedPhoto {
            camera: camera.unwrap(),
            camera_from_world: DAffine3::IDENTITY,
            image: PhotoImage::new([SIDE as u32; 2], (0..SIDE * SIDE).map(pixel).collect()).unwrap(),
        }
    }

    /// The centre of each square, seen by these images.
    fn points(photos: &[u32]) -> SparsePoints {
        let mut points = SparsePoints::default();
        for square in 0..100 {
            let center = |at: u32| (f64::from(at * 12) + 5.5 - 59.5) / 120.0;
            let track = photos.iter().map(|&photo| Observation {
                photo,
                pixel: Vec2::ZERO,
            });
            points.push(DVec3::new(center(square % 10), center(square / 10), 1.0), [0; 3], track);
        }
        points
    }

    #[test]
    fn exposures_are_estimated_with_a_mean_of_one() {
        let exposures = [[1.0, 1.0, 1.0], [0.6, 0.7, 0.8], [1.3, 1.1, 0.9], [1.0, 1.2, 1.4]];
        for outliers in [false, true] {
            let mut photos: Vec<_> = exposures
                .iter()
                .enumerate()
                .map(|(at, &gain)| Some(photo(gain, outliers && at == 1)))
                .collect();
            photos.push(None);
            photos.push(Some(photo([0.5; 3], false)));
            let gains = gains(&points(&[0, 1, 2, 3, 4]), &photos);
            for channel in 0..3 {
                let mean: f32 = gains[..4].iter().map(|gain| gain[channel]).sum::<f32>() / 4.0;
                assert!((mean - 1.0).abs() < 1e-3, "{mean}");
                for (gain, exposure) in gains.iter().zip(exposures) {
                    let relative = gain[channel] * exposure[channel] / gains[0][channel];
                    assert!(
                        (relative - 1.0).abs() < 0.03,
                        "{relative}: {gains:?}, outliers: {outliers}"
                    );
                }
            }
            // Neither the missing image nor the one that shares nothing is changed.
            assert_eq!(gains[4..], [[1.0; 3]; 2]);
        }
    }

    #[test]
    fn images_that_agree_have_unit_exposure() {
        let photos = vec![Some(photo([1.0; 3], false)); 3];
        for gain in gains(&points(&[0, 1, 2]), &photos).as_flattened() {
            assert!((gain - 1.0).abs() < 1e-6);
        }
        assert_eq!(gains(&SparsePoints::default(), &photos), [[1.0; 3]; 3]);
        assert!(gains(&points(&[0, 1, 2]), &[]).is_empty());
    }

    /// Conjugate gradients against Gauss and Jordan, with weights.
    #[test]
    fn the_solution_satisfies_the_normal_equations() {
        let mut random = 1_u64;
        let mut next = || {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let count = 7;
        let mut samples = Samples::default();
        for _ in 0..60 {
            for photo in 0..count {
                if next() < 0.5 || photo == 0 {
                    samples.all.push(Sample {
                        photo,
                        logs: [next(); 3],
                    });
                }
            }
            samples.ends.push(samples.all.len());
        }
        let logs: Vec<f64> = samples.all.iter().map(|sample| sample.logs[0]).collect();
        let weights: Vec<f64> = logs.iter().map(|_| 0.1 + next()).collect();
        let found = samples.solve(&logs, &weights, vec![0.0; count]);
        // Σ w (x_i + l − m)² + λ Σ x², written out.
        let mut matrix = vec![vec![0.0; count + 1]; count];
        for (at, row) in matrix.iter_mut().enumerate() {
            row[at] = REGULARISER;
        }
        for track in samples.tracks() {
            let total: f64 = weights[track.clone()].iter().sum();
            for a in track.clone() {
                for b in track.clone() {
                    let across = f64::from(u8::from(a == b)) * weights[a] - weights[a] * weights[b] / total;
                    matrix[samples.all[a].photo][samples.all[b].photo] += across;
                    matrix[samples.all[a].photo][count] -= across * logs[b];
                }
            }
        }
        for pivot in 0..count {
            let scale = matrix[pivot][pivot].recip();
            let row: Vec<f64> = matrix[pivot].iter().map(|value| value * scale).collect();
            for (at, other) in matrix.iter_mut().enumerate() {
                let factor = if at == pivot { 0.0 } else { other[pivot] };
                for (value, &of_row) in other.iter_mut().zip(&row) {
                    *value -= factor * of_row;
                }
            }
            matrix[pivot] = row;
        }
        for (found, row) in found.iter().zip(&matrix) {
            assert!((found - row[count]).abs() < 1e-9, "{found}, expected {}", row[count]);
        }
    }
}
