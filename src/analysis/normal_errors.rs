//! Error of estimated normals against ground truth, in numbers and as colours (Hofer et al. 2018, Figs. 5 and 6).

use crate::cloud::{ShapeRecord, oct_decode};
use rayon::prelude::*;

/// Errors beyond are red, degrees.
const LARGE_DEG: f32 = 22.5;

/// Below, a normal counts as right, degrees.
const SMALL_DEG: f32 = 1.0;

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 13;

/// Errors of normals in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct NormalErrors {
    /// Number of normals.
    pub points: usize,
    /// Share of errors of at most one degree.
    pub below_1_deg: f64,
    /// Share of larger ones of at most 22.5 degrees.
    pub below_22_5_deg: f64,
    /// Share of larger errors.
    pub above_22_5_deg: f64,
    /// Their mean, degrees.
    pub mean_deg: f64,
    /// 95 of 100 are smaller, degrees.
    pub p95_deg: f64,
}

impl NormalErrors {
    /// The colours of no error, of one of 22.5 degrees, and of larger ones: red, green, blue, alpha.
    pub const COLORS: [[u8; 4]; 3] = [[38, 84, 235, 255], [64, 190, 84, 255], [222, 45, 38, 255]];

    /// Errors of the normals of `shapes`, and their colours; `truth` has the shapes of all points, and `slots` the
    /// index of each in it. Signs do not count: the outer side is decided elsewhere.
    pub fn of(shapes: &[ShapeRecord], truth: &[ShapeRecord], slots: &[u32]) -> (Self, Vec<[u8; 4]>) {
        let pairs = shapes.par_iter().zip(slots).with_min_len(POINTS_PER_TASK);
        let errors = pairs.map(|(shape, &slot)| {
            let [normal, known] = [shape.normal, truth[slot as usize].normal].map(oct_decode);
            // Unlike the arc cosine, this is exact for small angles.
            normal.cross(known).length().atan2(normal.dot(known).abs()).to_degrees()
        });
        let mut errors: Vec<f32> = errors.collect();
        let colors = errors.iter().map(|&error| color(error)).collect();
        (Self::of_angles(&mut errors), colors)
    }

    /// Precondition: numbers. They are put in another order.
    fn of_angles(errors: &mut [f32]) -> Self {
        if errors.is_empty() {
            return Self::default();
        }
        let count = errors.len() as f64;
        let share = |is_counted: &dyn Fn(f32) -> bool| {
            let counted = errors.iter().filter(|&&error| is_counted(error)).count();
            counted as f64 / count
        };
        let (below_1_deg, above_22_5_deg) = (share(&|error| error <= SMALL_DEG), share(&|error| error > LARGE_DEG));
        let below_22_5_deg = share(&|error| error > SMALL_DEG && error <= LARGE_DEG);
        let sum: f64 = errors.iter().map(|&error| f64::from(error)).sum();
        let place = (0.95 * (count - 1.0)) as usize;
        let (_, p95, _) = errors.select_nth_unstable_by(place, f32::total_cmp);
        Self {
            points: count as usize,
            below_1_deg,
            below_22_5_deg,
            above_22_5_deg,
            mean_deg: sum / count,
            p95_deg: f64::from(*p95),
        }
    }
}

/// From blue to green up to 22.5 degrees, then red.
fn color(error_deg: f32) -> [u8; 4] {
    let [none, max, large] = NormalErrors::COLORS;
    if error_deg > LARGE_DEG {
        return large;
    }
    let share = error_deg / LARGE_DEG;
    let mut mixed = none;
    for (mixed, max) in mixed.iter_mut().zip(max) {
        *mixed = (f32::from(*mixed) + share * (f32::from(max) - f32::from(*mixed))).round() as u8;
    }
    mixed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::oct_encode;
    use glam::Vec3;

    fn tilted(degrees: f32) -> ShapeRecord {
        let (sin, cos) = degrees.to_radians().sin_cos();
        ShapeRecord {
            normal: oct_encode(Vec3::new(sin, 0.0, cos)),
            radius: 1.0,
            ellipse: 0,
            scalar: 0.0,
        }
    }

    #[test]
    fn errors_have_the_expected_shares_and_colors() {
        let truth = [tilted(0.0), tilted(180.0), tilted(90.0)];
        let shapes = [tilted(0.0), tilted(10.0), tilted(190.0), tilted(60.0)];
        let (errors, colors) = NormalErrors::of(&shapes, &truth, &[0, 0, 1, 2]);
        assert_eq!(errors.points, 4);
        let shares = [errors.below_1_deg, errors.below_22_5_deg, errors.above_22_5_deg];
        assert_eq!(shares, [0.25, 0.5, 0.25]);
        assert!((errors.mean_deg - 12.5).abs() < 0.01, "{}", errors.mean_deg);
        assert!((errors.p95_deg - 10.0).abs() < 0.01, "{}", errors.p95_deg);
        assert_eq!(
            [colors[0], colors[3]],
            [NormalErrors::COLORS[0], NormalErrors::COLORS[2]]
        );
        assert_eq!(colors[1], colors[2]);
        assert!(colors[1][1] > colors[0][1] && colors[1][2] < colors[0][2]);
    }

    #[test]
    fn empty_input_has_no_errors() {
        let (errors, colors) = NormalErrors::of(&[], &[], &[]);
        assert_eq!((errors, colors.len()), (NormalErrors::default(), 0));
    }
}
