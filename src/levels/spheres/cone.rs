//! Cones around normals, by the cosine of their half angle.

use glam::Vec3;

/// All normals within an angle of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cone {
    /// A unit vector.
    pub(super) axis: Vec3,
    /// Cosine of the cone angle, below 90°; or −1 for all directions.
    pub(super) cosine: f32,
}

/// Margin by which a cone must be narrower than another to lie within it despite rounding, in cosines.
const MARGIN: f32 = 1e-4;

impl Cone {
    /// Returns true if nothing is known of the normals.
    pub(super) fn is_everything(&self) -> bool {
        self.cosine == -1.0
    }

    /// Returns true if the whole cone is inside `other`, beyond rounding.
    pub(super) fn is_within(&self, other: &Self) -> bool {
        other.is_everything() || cosine_of_sum(self.axis.dot(other.axis), self.cosine) >= other.cosine + MARGIN
    }
}

/// `cos(a + b)` of two angles of at most 180° by their cosines; −1 where their sum is more.
pub(super) fn cosine_of_sum(a: f32, b: f32) -> f32 {
    let (a, b) = (a.clamp(-1.0, 1.0), b.clamp(-1.0, 1.0));
    // cos b < cos(180° − a)
    if b < -a {
        return -1.0;
    }
    let sines = (1.0 - a * a).sqrt() * (1.0 - b * b).sqrt();
    (a * b - sines).clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn cosine_of_sum_matches_the_cosine_of_summed_angles(a in 0f64..180.0, b in 0f64..180.0) {
            let [cosine_a, cosine_b] = [a, b].map(|angle_deg| angle_deg.to_radians().cos() as f32);
            let expected = (a + b).min(180.0).to_radians().cos();
            // Near 1, a cosine determines its angle poorly.
            prop_assert!((f64::from(cosine_of_sum(cosine_a, cosine_b)) - expected).abs() < 1e-3);
        }
    }

    #[test]
    fn a_cone_is_within_one_wider_by_the_angle_between_their_axes() {
        let cone = |axis_deg: f32, half_deg: f32| Cone {
            axis: Vec3::new(axis_deg.to_radians().sin(), 0.0, axis_deg.to_radians().cos()),
            cosine: half_deg.to_radians().cos(),
        };
        assert!(cone(10.0, 5.0).is_within(&cone(0.0, 15.1)));
        assert!(!cone(10.0, 5.0).is_within(&cone(0.0, 14.9)));
        assert!(!cone(0.0, 5.0).is_within(&cone(0.0, 5.0)));
        let everything = Cone {
            axis: Vec3::Z,
            cosine: -1.0,
        };
        assert!(cone(90.0, 30.0).is_within(&everything) && !everything.is_within(&cone(0.0, 80.0)));
    }
}
