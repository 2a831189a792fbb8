//! Polynomials of the distance from the axis, with a tangential part (Brown 1971).

use super::turn::{BEFORE_TURN, WIDEST, first_beyond};
use glam::{DMat2, DVec2};

/// Newton converges within ten steps where it converges.
const MAX_STEPS: usize = 50;

/// Halvings of a step that leads away.
const MAX_HALVINGS: usize = 30;

/// Maximum residual error, far below the 10⁻⁶ of a pixel of any camera.
const MAX_ERROR: f64 = 1e-11;

/// x·(1 + k₁r² + k₂r⁴ + k₃r⁶) / (1 + k₄r² + k₅r⁴ + k₆r⁶), and a tangential part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Radial {
    pub(super) k: [f64; 6],
    pub(super) p: [f64; 2],
}

/// 1 + a·s + b·s² + c·s³ and its slope.
fn cubic([a, b, c]: [f64; 3], s: f64) -> (f64, f64) {
    (1.0 + s * (a + s * (b + s * c)), a + s * (2.0 * b + s * 3.0 * c))
}

impl Radial {
    fn numerator(&self, s: f64) -> (f64, f64) {
        cubic([self.k[0], self.k[1], self.k[2]], s)
    }

    fn denominator(&self, s: f64) -> (f64, f64) {
        cubic([self.k[3], self.k[4], self.k[5]], s)
    }

    /// Factor of the distance at its square `s`, and its slope by `s`.
    fn factor(&self, s: f64) -> (f64, f64) {
        let ((n, dn), (d, dd)) = (self.numerator(s), self.denominator(s));
        (n / d, (dn * d - n * dd) / (d * d))
    }

    /// Distance up to which the mapping is monotonic.
    pub(super) fn reach(&self) -> f64 {
        let turns = |radius: f64| {
            let s = radius * radius;
            let (factor, slope) = self.factor(s);
            self.denominator(s).0 <= 0.0 || factor + 2.0 * s * slope <= 0.0
        };
        // Steps of angle: fine near the axis, where lenses are used.
        let turn = first_beyond(WIDEST.atan(), 890, |angle| turns(angle.tan()));
        if turn < WIDEST.atan() {
            BEFORE_TURN * turn.tan()
        } else {
            WIDEST
        }
    }

    pub(super) fn distort(&self, at: DVec2) -> DVec2 {
        let s = at.length_squared();
        let [p1, p2] = self.p;
        let tangential = DVec2::new(
            2.0 * p1 * at.x * at.y + p2 * (s + 2.0 * at.x * at.x),
            2.0 * p2 * at.x * at.y + p1 * (s + 2.0 * at.y * at.y),
        );
        at * self.factor(s).0 + tangential
    }

    /// Computes the Jacobian of [`Self::distort`] at `at`.
    fn jacobian(&self, at: DVec2) -> DMat2 {
        let (factor, slope) = self.factor(at.length_squared());
        let [p1, p2] = self.p;
        let DVec2 { x, y } = at;
        let across = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
        DMat2::from_cols(
            DVec2::new(factor + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, across),
            DVec2::new(across, factor + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x),
        )
    }

    /// The direction within `reach` that is shown at `distorted`.
    pub(super) fn undistort(&self, distorted: DVec2, reach: f64) -> Option<DVec2> {
        let error_at = |at: DVec2| self.distort(at) - distorted;
        let start = distorted.clamp_length_max(0.9 * reach);
        let (mut at, mut error) = (start, error_at(start));
        for _ in 0..MAX_STEPS {
            if error.length_squared() <= 1e-32 {
                break;
            }
            let jacobian = self.jacobian(at);
            if jacobian.determinant() <= 0.0 || error.is_nan() {
                return None;
            }
            let step = jacobian.inverse() * error;
            let nearer = (0..MAX_HALVINGS).find_map(|halvings| {
                let next = at - step * 0.5_f64.powi(halvings as i32);
                let left = error_at(next);
                let is_nearer = left.length_squared() < error.length_squared();
                (is_nearer && next.length_squared() <= reach * reach).then_some((next, left))
            });
            let Some((next, left)) = nearer else { break };
            (at, error) = (next, left);
        }
        let is_found = error.length() <= MAX_ERROR && self.jacobian(at).determinant() > 0.0;
        is_found.then_some(at)
    }

    /// Returns true if the distortion stays regular, with directions in order, from the axis to `at` and a little
    /// further.
    #[cfg(test)]
    pub(super) fn stays_regular_to(&self, at: DVec2) -> bool {
        let is_regular = |share: f64| self.jacobian(share * at).determinant() > 1e-3;
        (0..=110).all(|percent| is_regular(f64::from(percent) / 100.0))
    }
}
