//! Diffuse light of an environment: spherical harmonics of order 2 (Ramamoorthi and Hanrahan 2001).
//!
//! A matt surface blurs its surroundings over half of the sphere; nine numbers for each colour hold the result. As a
//! polynomial of the normal they cost both renderers a few products per pixel.

use super::octahedral::Octahedral;
use glam::Vec3;

/// The light that a matt white surface sends back, as a polynomial of its normal: the coefficients of
/// `1, y, z, x, xy, yz, 3z² − 1, xz, x² − y²`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonics(pub [Vec3; 9]);

impl Harmonics {
    /// Computes the spherical harmonics of an environment.
    pub(super) fn of(map: &Octahedral) -> Self {
        let mut sums = [[0.0f64; 3]; 9];
        for (direction, light, share) in map.shares() {
            for (sum, value) in sums.iter_mut().zip(basis(direction)) {
                for (sum, light) in sum.iter_mut().zip(light.to_array()) {
                    *sum += f64::from(light) * f64::from(value) * f64::from(share);
                }
            }
        }
        let mut polynomial = [Vec3::ZERO; 9];
        for (place, coefficient) in polynomial.iter_mut().enumerate() {
            // For the basis without its constants: their squares, 4π for the sphere, and the cosine convolution factor
            // of each order (π, 2π/3, π/4), divided by π.
            let factor = match place {
                0 => 1.0,
                1..=3 => 3.0 * 2.0 / 3.0,
                6 => 5.0 / 4.0 * 0.25,
                8 => 15.0 / 4.0 * 0.25,
                _ => 15.0 * 0.25,
            };
            *coefficient = Vec3::from_array(sums[place].map(|sum| (factor * sum) as f32));
        }
        Self(polynomial)
    }

    /// The light of a matt white surface with this normal; of unit length.
    pub fn at(&self, normal: Vec3) -> Vec3 {
        let products = self.0.iter().zip(basis(normal));
        let light: Vec3 = products.map(|(&coefficient, value)| coefficient * value).sum();
        light.max(Vec3::ZERO)
    }

    /// Returns the light multiplied by `factor`.
    #[must_use]
    pub(in crate::scene) fn times(mut self, factor: f32) -> Self {
        for coefficient in &mut self.0 {
            *coefficient *= factor;
        }
        self
    }
}

/// The harmonics up to order 2 without their constants.
fn basis(Vec3 { x, y, z }: Vec3) -> [f32; 9] {
    [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For a light of order 2 they are exact: over the half sphere, the mean of `d` by its cosine is 2/3 of the normal,
    /// and the mean of `d.y²` is a quarter of `1 + n.y²`.
    #[test]
    fn light_up_to_order_two_is_exact() {
        let map = Octahedral::new(128, |d| Vec3::new(1.0, 1.0 + d.x, 0.5 + d.y * d.y));
        let harmonics = Harmonics::of(&map);
        for normal in [Vec3::X, -Vec3::X, Vec3::Y, Vec3::new(0.48, 0.6, 0.64)] {
            let expected = Vec3::new(1.0, 1.0 + 2.0 / 3.0 * normal.x, 0.75 + 0.25 * normal.y * normal.y);
            let found = harmonics.at(normal);
            assert!(found.distance(expected) < 1e-3, "{normal}: {found}, not {expected}");
        }
    }
}
