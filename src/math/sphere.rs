//! Spheres.

use glam::Vec3;

/// A ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Centre of the sphere.
    pub center: Vec3,
    /// Not negative.
    pub radius: f32,
}

impl Sphere {
    /// Returns a bounding sphere of the given spheres, not much larger than the smallest one; a point at the origin
    /// around none.
    ///
    /// Its centre is the box's.
    pub fn around(spheres: impl Iterator<Item = Self> + Clone) -> Self {
        let (min, max) = spheres.clone().fold(
            (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY)),
            |(min, max), sphere| {
                (
                    min.min(sphere.center - sphere.radius),
                    max.max(sphere.center + sphere.radius),
                )
            },
        );
        if min.x > max.x {
            return Self {
                center: Vec3::ZERO,
                radius: 0.0,
            };
        }
        let center = min.midpoint(max);
        let reach = spheres.fold(0.0, |reach: f64, sphere| reach.max(sphere.reach_from(center)));
        Self {
            center,
            radius: rounded_up(reach),
        }
    }

    /// Returns the distance from a position to the farthest point of the sphere.
    pub fn reach_from(&self, place: Vec3) -> f64 {
        self.center.as_dvec3().distance(place.as_dvec3()) + f64::from(self.radius)
    }

    /// Returns true if all of `other` is inside.
    pub fn holds(&self, other: &Self) -> bool {
        other.reach_from(self.center) <= f64::from(self.radius)
    }
}

/// The next f32 that is not smaller.
fn rounded_up(number: f64) -> f32 {
    let nearest = number as f32;
    if f64::from(nearest) < number {
        nearest.next_up()
    } else {
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sphere(center: [f32; 3], radius: f32) -> Sphere {
        Sphere {
            center: Vec3::from_array(center),
            radius,
        }
    }

    #[test]
    fn two_touching_spheres_fit_in_one_spanning_both() {
        let two = [sphere([-1.0, 0.0, 0.0], 1.0), sphere([1.0, 0.0, 0.0], 1.0)];
        assert_eq!(Sphere::around(two.into_iter()), sphere([0.0; 3], 2.0));
        assert_eq!(Sphere::around(std::iter::empty()), sphere([0.0; 3], 0.0));
    }

    proptest! {
        #[test]
        fn a_bounding_sphere_contains_its_spheres(
            others in prop::collection::vec((prop::array::uniform3(-1e3f32..1e3), 0f32..10.0), 1..6),
        ) {
            let others = others.into_iter().map(|(center, radius)| sphere(center, radius));
            let around = Sphere::around(others.clone());
            prop_assert!(others.clone().all(|other| around.holds(&other)));
            // A box around them is no longer than the cube around the sphere.
            let reach = others.map(|other| other.reach_from(around.center)).fold(0.0, f64::max);
            prop_assert!(f64::from(around.radius) <= reach * (1.0 + 1e-6));
        }
    }
}
