//! Noise estimation: deviation of the inverse depths of an image from planes where it shows planes.

use super::pixels::Pixels;
use super::windows::plane_around;
use rayon::prelude::*;

/// Half widths of the windows, pixels between the centre and the border: as wide as steps of depths are, and half of
/// that.
const HALF_WIDTHS_PX: [usize; 2] = [8, 4];

/// Noise of the wider windows is at most this many times the noise of the others. On curved surfaces, it is four times
/// as much.
const BENDS: f32 = 1.5;

/// Pixels from one window to the next, in either direction.
const STEP_PX: usize = 8;

/// Divisor for the fraction of windows that are on planes: of the windows of some depths, the flattest quarter.
const ON_PLANES: usize = 4;

/// Minimum number of windows of a range of depths; with fewer, it has the noise of all.
const MIN_WINDOWS: usize = 16;

/// Ranges of depths to an octave: errors of time-of-flight cameras are not those of inverse depths.
const PER_OCTAVE: f32 = 2.0;

/// Relative to the inverse depth. Less is rounding, and more is not noise.
const LIMITS: [f32; 2] = [1e-5, 1e-2];

pub(super) struct Noise {
    of_all: f32,
    /// Noise of each range of inverse depths that has enough windows, ascending.
    of_ranges: Vec<(i32, f32)>,
}

impl Noise {
    pub(super) fn of(pixels: &Pixels) -> Self {
        let [wide, narrow] = HALF_WIDTHS_PX.map(|half| errors(pixels, half));
        let of_windows = |range: Option<i32>| {
            let [wide, narrow] = [&wide, &narrow].map(|errors| flattest(errors, range));
            wide.zip(narrow).map(|(wide, narrow)| wide.min(BENDS * narrow))
        };
        let mut ranges: Vec<i32> = wide.iter().map(|&(range, _)| range).collect();
        ranges.dedup();
        let of_ranges = ranges
            .into_iter()
            .filter_map(|range| Some((range, of_windows(Some(range))?)));
        Self {
            of_all: of_windows(None).unwrap_or_default(),
            of_ranges: of_ranges.collect(),
        }
    }

    /// Root of the mean square, per metre, at an inverse depth above 0.
    pub(super) fn at(&self, inverse: f32) -> f32 {
        let range = range_of(inverse);
        let found = self.of_ranges.iter().find(|of_range| of_range.0 == range);
        let noise = found.map_or(self.of_all, |&(_, error)| error);
        let [min, max] = LIMITS.map(|limit| limit * inverse);
        noise.clamp(min, max)
    }
}

/// Ranges of depths and errors of windows of `half` pixels around some pixels, in the order of ranges. Those without an
/// error are between two steps of the sensor, and carry no information.
fn errors(pixels: &Pixels, half: usize) -> Vec<(i32, f32)> {
    let centers = |edge: usize| (STEP_PX / 2..edge).step_by(STEP_PX);
    let lines: Vec<usize> = centers(pixels.height).collect();
    let of_line = |line: usize| {
        centers(pixels.width).filter_map(move |column| {
            let inverse = pixels.rays[line * pixels.width + column][2];
            let error = plane_around(pixels, half, [column, line]).error;
            // Windows without any error lie between two steps and carry no information. With exact depths no window is
            // left, so their noise is zero and they stay unchanged.
            (error.is_finite() && error > LIMITS[0] * inverse).then(|| (range_of(inverse), error))
        })
    };
    let mut errors: Vec<(i32, f32)> = lines.into_par_iter().flat_map_iter(of_line).collect();
    errors.sort_by_key(|&(range, _)| range);
    errors
}

/// The largest error of the flattest quarter of the windows of a range of depths, or of all.
fn flattest(errors: &[(i32, f32)], range: Option<i32>) -> Option<f32> {
    let of_range = errors.iter().filter(|of| range.is_none_or(|range| of.0 == range));
    let mut errors: Vec<f32> = of_range.map(|&(_, error)| error).collect();
    errors.sort_by(f32::total_cmp);
    (errors.len() >= MIN_WINDOWS).then(|| errors[errors.len() / ON_PLANES])
}

fn range_of(inverse: f32) -> i32 {
    (PER_OCTAVE * inverse.log2()).floor() as i32
}
