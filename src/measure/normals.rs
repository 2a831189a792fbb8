//! Angular error of estimated normals relative to true ones.

use glam::Vec3;

/// Orientation mode: determines if a normal that points to the other side of the surface counts as wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Orientation {
    /// It is: angles are 0 to 180 degrees.
    Matters,
    /// Only the plane counts: angles are 0 to 90 degrees. For estimates whose sign is arbitrary.
    Ignored,
}

/// Angles between found and true directions, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngularError {
    /// Arithmetic mean.
    pub mean_deg: f64,
    /// The smallest angle that 95 % of the directions do not exceed.
    pub p95_deg: f64,
    /// Largest.
    pub max_deg: f64,
}

/// The part of the directions that [`AngularError::p95_deg`] is about, percent.
const QUANTILE_PERCENT: usize = 95;

impl AngularError {
    /// Compares each of `found` with its `truth`; `None` without any.
    ///
    /// # Panics
    /// Precondition: one found direction per true one, none of length zero.
    pub fn of(found: &[Vec3], truth: &[Vec3], orientation: Orientation) -> Option<Self> {
        assert_eq!(found.len(), truth.len(), "one truth for each direction");
        let mut angles: Vec<f64> = found
            .iter()
            .zip(truth)
            .map(|(&found, &truth)| angle_deg(found, truth, orientation))
            .collect();
        angles.sort_by(f64::total_cmp);
        let at_least = (angles.len() * QUANTILE_PERCENT).div_ceil(100);
        Some(Self {
            mean_deg: angles.iter().sum::<f64>() / angles.len() as f64,
            p95_deg: *angles.get(at_least.checked_sub(1)?)?,
            max_deg: *angles.last()?,
        })
    }
}

/// The angle between two directions of any length, degrees.
///
/// From sine and cosine: the arc cosine alone of a dot product in f32 is off by up to 0.03° where directions agree.
pub fn angle_deg(a: Vec3, b: Vec3, orientation: Orientation) -> f64 {
    let [a, b] = [a, b].map(Vec3::as_dvec3);
    let cosine = match orientation {
        Orientation::Matters => a.dot(b),
        Orientation::Ignored => a.dot(b).abs(),
    };
    a.cross(b).length().atan2(cosine).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_plane(degrees: f32) -> Vec3 {
        Vec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0)
    }

    #[test]
    fn angles_match_the_construction() {
        for (degrees, plane) in [
            (0.0f32, 0.0),
            (0.001, 0.001),
            (30.0, 30.0),
            (90.0, 90.0),
            (135.0, 45.0),
            (180.0, 0.0),
        ] {
            let found = in_plane(degrees) * 3.0;
            let sided = angle_deg(found, Vec3::X, Orientation::Matters);
            assert!((sided - f64::from(degrees)).abs() < 1e-4, "{sided} for {degrees}");
            let unsided = angle_deg(found, Vec3::X, Orientation::Ignored);
            assert!((unsided - plane).abs() < 1e-4, "{unsided} for {degrees}");
        }
    }

    #[test]
    fn mean_quantile_and_maximum_are_known() {
        // 0, 1 … 99 degrees: 95 of the 100 do not exceed 94.
        let found: Vec<Vec3> = (0..100).map(|degrees| in_plane(degrees as f32)).collect();
        let error = AngularError::of(&found, &[Vec3::X; 100], Orientation::Matters).unwrap();
        for (found, expected) in [(error.mean_deg, 49.5), (error.p95_deg, 94.0), (error.max_deg, 99.0)] {
            assert!((found - expected).abs() < 1e-4, "{found} for {expected}");
        }
        // 91 … 99 fold to 89 … 81.
        let folded = AngularError::of(&found, &[Vec3::X; 100], Orientation::Ignored).unwrap();
        assert!((folded.max_deg - 90.0).abs() < 1e-4, "{folded:?}");
        assert!(
            (folded.mean_deg - (49.5 - 2.0 * 45.0 / 100.0)).abs() < 1e-4,
            "{folded:?}"
        );
        assert_eq!(AngularError::of(&[], &[], Orientation::Ignored), None);
        let one = AngularError::of(&[Vec3::Y], &[Vec3::X], Orientation::Ignored).unwrap();
        assert_eq!(one.p95_deg, one.max_deg);
    }
}
