//! Spheres in 13 bits, encoded relative to their parents (Rusinkiewicz and Levoy 2000, §3.1).
//!
//! How it works: the centre is on a grid of 13 × 13 × 13 positions, a thirteenth of the parent's diameter apart; the
//! radius is a number of thirteenths of the parent's, 1 to 13. Not all of the 13⁴ combinations are of use, as children
//! are inside their parents: codes are the 8,192 that reach the least beyond it. Radii are rounded up until the sphere
//! holds its contents, seen from its rounded centre, so nothing is lost from level to level. A sphere that no
//! code holds in this manner moves towards the centre of the parent, and at last becomes the parent's own sphere.

use crate::math::Sphere;
use glam::Vec3;
use std::sync::LazyLock;

/// Bits of a code.
pub(super) const SPHERE_BITS: u32 = 13;

/// Steps of radii and of coordinates.
const STEPS: usize = 13;

/// Coordinates are −6 to 6.
const MAX_STEPS_ASIDE: i8 = 6;

/// Sentinel for the absence of a code.
const NONE: u16 = u16::MAX;

/// A sphere in steps.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Steps {
    place: [i8; 3],
    radius: u8,
}

/// The sphere of the parent.
const SAME: Steps = Steps {
    place: [0; 3],
    radius: STEPS as u8,
};

struct Table {
    steps_of_code: Vec<Steps>,
    code_of_steps: Vec<u16>,
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    let aside = || -MAX_STEPS_ASIDE..=MAX_STEPS_ASIDE;
    let places = aside().flat_map(|x| aside().flat_map(move |y| aside().map(move |z| [x, y, z])));
    let mut steps_of_code: Vec<Steps> = places
        .flat_map(|place| (1..=STEPS as u8).map(move |radius| Steps { place, radius }))
        .collect();
    steps_of_code.sort_by(|a, b| reach(*a).total_cmp(&reach(*b)));
    steps_of_code.truncate(1 << SPHERE_BITS);
    let mut code_of_steps = vec![NONE; STEPS.pow(4)];
    for (&steps, code) in steps_of_code.iter().zip(0..) {
        code_of_steps[place_of(steps)] = code;
    }
    Table {
        steps_of_code,
        code_of_steps,
    }
});

/// Returns the reach of a sphere from the centre of the parent, in thirteenths of the parent's radius.
fn reach(steps: Steps) -> f64 {
    let squared: i32 = steps.place.iter().map(|&aside| i32::from(aside).pow(2)).sum();
    2.0 * f64::from(squared).sqrt() + f64::from(steps.radius)
}

/// Its index in the table of codes.
fn place_of(steps: Steps) -> usize {
    let coordinates = steps.place.map(|aside| (aside + MAX_STEPS_ASIDE) as usize);
    coordinates
        .iter()
        .fold(usize::from(steps.radius) - 1, |all, &one| STEPS * all + one)
}

/// The sphere that a code means.
#[inline(always)]
pub(super) fn decoded(parent: &Sphere, code: u16) -> Sphere {
    sphere_at(parent, TABLE.steps_of_code[usize::from(code)])
}

#[inline(always)]
fn sphere_at(parent: &Sphere, steps: Steps) -> Sphere {
    let step = parent.radius / STEPS as f32;
    Sphere {
        center: parent.center + Vec3::from_array(steps.place.map(f32::from)) * (2.0 * step),
        // 13 thirteenths are exactly one.
        radius: parent.radius * (f32::from(steps.radius) / STEPS as f32),
    }
}

/// The code of the nearest sphere that holds `child`; else the code of the parent's own sphere, which holds all of its
/// points.
pub(super) fn encoded(parent: &Sphere, child: &Sphere) -> u16 {
    let step = parent.radius / STEPS as f32;
    let max = f32::from(MAX_STEPS_ASIDE);
    let aside = (child.center - parent.center) / (2.0 * step);
    // A parent without extent is a single position that contains its children.
    let aside = if aside.is_finite() { aside } else { Vec3::ZERO };
    let mut place = aside
        .round()
        .clamp(Vec3::splat(-max), Vec3::splat(max))
        .to_array()
        .map(|aside| aside as i8);
    while place != SAME.place {
        let needed = child.reach_from(sphere_at(parent, Steps { place, radius: 1 }).center);
        let mut larger = (1..=STEPS as u8).map(|radius| Steps { place, radius });
        let holding = larger.find(|&steps| f64::from(sphere_at(parent, steps).radius) >= needed);
        let code = holding.map_or(NONE, |steps| TABLE.code_of_steps[place_of(steps)]);
        if code != NONE {
            return code;
        }
        let farthest = (0..3).max_by_key(|&axis| place[axis].abs()).unwrap_or(0);
        place[farthest] -= place[farthest].signum();
    }
    let needed = child.reach_from(parent.center);
    let mut larger = (1..STEPS as u8).map(|radius| Steps { radius, ..SAME });
    let holding = larger.find(|&steps| f64::from(sphere_at(parent, steps).radius) >= needed);
    TABLE.code_of_steps[place_of(holding.unwrap_or(SAME))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PARENT: Sphere = Sphere {
        center: Vec3::new(10.0, -20.0, 30.0),
        radius: 6.5,
    };

    #[test]
    fn thirteen_bits_encode_each_sphere_once_including_the_parent() {
        let table = &*TABLE;
        assert_eq!(table.steps_of_code.len(), 8192);
        assert_eq!(table.code_of_steps.iter().filter(|&&code| code != NONE).count(), 8192);
        let own = encoded(&PARENT, &PARENT);
        assert_eq!(decoded(&PARENT, own), PARENT);
        // All spheres that lie inside have a code.
        let inside = table
            .steps_of_code
            .iter()
            .filter(|&&steps| reach(steps) <= 13.0)
            .count();
        assert!((3000..4000).contains(&inside), "{inside}");
        assert!(reach(table.steps_of_code[8191]) > 15.0);
    }

    #[test]
    fn spheres_on_the_grid_are_encoded_exactly() {
        // One step is one unit for coordinates, half a unit for radii.
        let child = Sphere {
            center: PARENT.center + Vec3::new(3.0, 0.0, -2.0),
            radius: 1.5,
        };
        assert_eq!(decoded(&PARENT, encoded(&PARENT, &child)), child);
    }

    proptest! {
        #[test]
        fn decoded_spheres_contain_the_encoded_ones(
            direction in prop::array::uniform3(-1f32..1.0),
            radius_share in 0f32..1.0,
            distance_share in 0f32..1.0,
            parent_radius in 0f32..100.0,
        ) {
            let parent = Sphere { radius: parent_radius, ..PARENT };
            let radius = parent_radius * radius_share;
            let distance = (parent_radius - radius) * distance_share;
            let child = Sphere {
                center: parent.center + Vec3::from_array(direction).normalize_or(Vec3::X) * distance,
                radius,
            };
            let decoded = decoded(&parent, encoded(&parent, &child));
            prop_assert!(decoded == parent || decoded.holds(&child), "{decoded:?} for {child:?}");
            prop_assert!(decoded.radius <= parent.radius);
            // One step of the radius for rounding it, and two half diagonals of the grid seen from both ends.
            let step = parent_radius / 13.0;
            prop_assert!(decoded == parent || decoded.radius <= radius + 6.0 * step);
        }
    }
}
