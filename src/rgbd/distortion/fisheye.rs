//! A polynomial of the angle from the axis (Kannala and Brandt 2006).

use super::turn::{BEFORE_TURN, WIDEST, first_beyond};
use glam::DVec2;

/// Newton steps; the bracket alone is exact after this many.
const MAX_STEPS: usize = 60;

/// Distance from the centre at which the angle `theta` is shown, and how fast that grows.
fn radius(k: &[f64; 4], theta: f64) -> (f64, f64) {
    let square = theta * theta;
    let (mut value, mut slope) = (0.0, 0.0);
    for (power, &k) in k.iter().enumerate().rev() {
        value = (value + k) * square;
        slope = (slope + (2 * power + 3) as f64 * k) * square;
    }
    (theta * (1.0 + value), 1.0 + slope)
}

/// The angle up to which the polynomial grows.
pub(super) fn widest_angle(k: &[f64; 4]) -> f64 {
    let end = WIDEST.atan();
    let turn = first_beyond(end, 890, |theta| radius(k, theta).1 <= 0.0);
    if turn < end { BEFORE_TURN * turn } else { end }
}

pub(super) fn distort(k: &[f64; 4], at: DVec2) -> DVec2 {
    let length = at.length();
    if length == 0.0 {
        return at;
    }
    at * (radius(k, length.atan()).0 / length)
}

/// The direction that is shown at `distorted`, up to the angle `widest`.
pub(super) fn undistort(k: &[f64; 4], distorted: DVec2, widest: f64) -> Option<DVec2> {
    let length = distorted.length();
    if length == 0.0 {
        return Some(distorted);
    }
    if length.is_nan() || length > radius(k, widest).0 {
        return None;
    }
    let (mut low, mut high) = (0.0, widest);
    let mut theta = length.min(widest);
    for _ in 0..MAX_STEPS {
        let (value, slope) = radius(k, theta);
        let error = value - length;
        if error.abs() <= 1e-15 {
            break;
        }
        if error > 0.0 {
            high = theta;
        } else {
            low = theta;
        }
        let next = theta - error / slope;
        theta = if next > low && next < high {
            next
        } else {
            f64::midpoint(low, high)
        };
    }
    Some(distorted * (theta.tan() / length))
}
