//! A tree, as in the paper (Table 2): leaves, which images show and points do not.
//!
//! How it works: branches are cones that split into thinner ones, each turned from its parent by angles from a random
//! number generator; the last ones carry leaves, small disks in all directions. Points are spread by area, half of them
//! on bark.

use crate::cloud::{Attributes, Positions, RawCloud};
use crate::sequence::{FrameEntry, Sequence};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::TAU;

/// Points of it.
const POINTS: usize = 300_000;

/// Number of times that branches split.
const GENERATIONS: u32 = 6;

/// Leaves of the thinnest branches.
const LEAVES: usize = 40;

/// A cone.
struct Branch {
    start: DVec3,
    way: DVec3,
    radii: [f64; 2],
}

struct Leaf {
    center: DVec3,
    normal: DVec3,
    radius: f64,
    color: DVec3,
}

/// Numbers that look like chance and are not (splitmix64).
struct Numbers(u64);

impl Numbers {
    /// From 0 to less than 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (sin, cos) = (TAU * self.next()).sin_cos();
        let aside = (1.0 - z * z).sqrt();
        DVec3::new(aside * cos, aside * sin, z)
    }
}

/// A sequence of it alone.
pub(super) fn tree() -> Sequence {
    Sequence::with_decoder(vec![FrameEntry::file("tree")], |_| Ok(cloud(POINTS)))
}

fn cloud(points: usize) -> RawCloud {
    let mut numbers = Numbers(4);
    let (mut branches, mut leaves) = (Vec::new(), Vec::new());
    let trunk = Branch {
        start: DVec3::ZERO,
        way: 1.6 * DVec3::Z,
        radii: [0.14, 0.1],
    };
    grow(trunk, GENERATIONS, &mut numbers, &mut branches, &mut leaves);
    let mut raw = Points::default();
    let areas: Vec<f64> = branches
        .iter()
        .map(|branch| branch.way.length() * branch.radii[0])
        .collect();
    let all: f64 = areas.iter().sum();
    for (branch, area) in branches.iter().zip(&areas) {
        let count = (0.5 * points as f64 * area / all).round() as usize;
        (0..count).for_each(|_| raw.on_branch(branch, &mut numbers));
    }
    let per_leaf = points.saturating_sub(raw.places.len()).div_ceil(leaves.len().max(1));
    for leaf in &leaves {
        (0..per_leaf).for_each(|_| raw.on_leaf(leaf, &mut numbers));
    }
    RawCloud {
        attributes: Attributes {
            colors: Some(raw.colors),
            normals: Some(raw.normals),
            ..Attributes::default()
        },
        ..RawCloud::from_positions(Positions::F64(raw.places))
    }
}

fn grow(branch: Branch, left: u32, numbers: &mut Numbers, branches: &mut Vec<Branch>, leaves: &mut Vec<Leaf>) {
    let end = branch.start + branch.way;
    if left == 0 {
        for _ in 0..LEAVES {
            let green = 0.35 + 0.35 * numbers.next();
            leaves.push(Leaf {
                center: branch.start + numbers.next() * branch.way + 0.12 * numbers.direction(),
                normal: numbers.direction(),
                radius: 0.025 + 0.02 * numbers.next(),
                color: DVec3::new(0.7 * green * numbers.next(), green, 0.15 * green),
            });
        }
    } else {
        let turn = TAU * numbers.next();
        for child in 0..3 {
            let around = DQuat::from_axis_angle(branch.way.normalize(), turn + TAU * f64::from(child) / 3.0);
            let aside = around * branch.way.normalize().any_orthonormal_vector();
            let spread = 0.4 + 0.4 * numbers.next();
            let way = branch.way.normalize() + spread * aside + 0.1 * DVec3::Z;
            let length = branch.way.length() * (0.6 + 0.2 * numbers.next());
            let thick = branch.radii[1];
            let child = Branch {
                start: end,
                way: length * way.normalize(),
                radii: [0.8 * thick, 0.55 * thick],
            };
            grow(child, left - 1, numbers, branches, leaves);
        }
    }
    branches.push(branch);
}

#[derive(Default)]
struct Points {
    places: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    colors: Vec<[u8; 4]>,
}

impl Points {
    fn push(&mut self, place: DVec3, normal: DVec3, color: DVec3) {
        let [red, green, blue] = (255.0 * color).to_array().map(|channel| channel as u8);
        self.places.push(place.to_array());
        self.normals.push(normal.as_vec3().to_array());
        self.colors.push([red, green, blue, 255]);
    }

    fn on_branch(&mut self, branch: &Branch, numbers: &mut Numbers) {
        let (along, turn) = (numbers.next(), TAU * numbers.next());
        let across = branch.way.normalize().any_orthonormal_vector();
        let normal = DQuat::from_axis_angle(branch.way.normalize(), turn) * across;
        let radius = branch.radii[0] + along * (branch.radii[1] - branch.radii[0]);
        let place = branch.start + along * branch.way + radius * normal;
        let bark = 0.5 + 0.25 * (60.0 * turn).sin() * (9.0 * place.z).sin();
        self.push(place, normal, bark * DVec3::new(0.7, 0.5, 0.35));
    }

    fn on_leaf(&mut self, leaf: &Leaf, numbers: &mut Numbers) {
        let across = leaf.normal.any_orthonormal_vector();
        let other = leaf.normal.cross(across);
        let radius = leaf.radius * numbers.next().sqrt();
        let at = radius * DVec2::from_angle(TAU * numbers.next());
        // Lighter along the centre line.
        let light = if at.x.abs() < 0.15 * leaf.radius { 1.3 } else { 1.0 };
        self.push(
            leaf.center + at.x * across + at.y * other,
            leaf.normal,
            light * leaf.color,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_has_the_requested_point_count_and_is_reproducible() {
        let tree = cloud(50_000);
        let count = tree.positions.len();
        assert!((50_000..90_000).contains(&count), "{count}");
        let normals = tree.attributes.normals.unwrap();
        assert_eq!(normals.len(), count);
        assert!(
            normals
                .iter()
                .all(|normal| (DVec3::from_array(normal.map(f64::from)).length() - 1.0).abs() < 1e-5)
        );
        assert_eq!(tree.positions, cloud(50_000).positions);
    }
}
