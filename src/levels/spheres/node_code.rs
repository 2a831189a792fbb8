//! A node of QSplat in 48 bits (Rusinkiewicz and Levoy 2000, §3.1).
//!
//! | bits | what |
//! |---|---|
//! | 0–12 | sphere, see `sphere_code.rs` |
//! | 13–26 | normal: octahedral coordinates of 7 bits each |
//! | 27–28 | half angle of the normal cone: sines of 1/16, 4/16 and 9/16; 3 is a cone of all directions |
//! | 29–44 | colour: 5 bits of red, 6 of green, 5 of blue |
//! | 45–47 | children: 0 for a leaf; 1 to 4 for that many leaves; 5 to 7 for 2 to 4 children, some of which have
//! children |

use super::cone::Cone;
use super::sphere_code::SPHERE_BITS;
use crate::cloud::oct_decode;

/// Numbers of 16 bits that a node takes.
pub(super) const NODE_WORDS: usize = 3;

const NORMAL_SHIFT: u32 = SPHERE_BITS;
const CONE_SHIFT: u32 = NORMAL_SHIFT + 2 * NORMAL_BITS;
const COLOR_SHIFT: u32 = CONE_SHIFT + 2;
const CHILDREN_SHIFT: u32 = COLOR_SHIFT + 16;

/// Bits of an octahedral coordinate.
const NORMAL_BITS: u32 = 7;

/// Steps of octahedral coordinates to either side of zero.
const NORMAL_STEPS: i32 = (1 << (NORMAL_BITS - 1)) - 1;

/// Squares of the sines of the half angles of cones.
const CONE_SINES_SQUARED: [f32; 3] = [1.0 / 256.0, 16.0 / 256.0, 81.0 / 256.0];

/// The number of children where none of them has children; with this added where some have.
const HAS_GRANDCHILDREN: u64 = 3;

/// A node in 48 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct NodeCode(u64);

impl NodeCode {
    /// Packs the code of a sphere, an octahedral normal and an 8-bit colour.
    pub(super) fn new(sphere: u16, normal: [i16; 2], [red, green, blue, _]: [u8; 4]) -> Self {
        let [x, y] = normal_steps(normal).map(|steps| (steps + NORMAL_STEPS) as u64);
        // Rounds to nearest; decoding repeats the highest bits in the lowest, so that white stays white.
        let nearest = |channel: u8, max: u64| (u64::from(channel) * max + 127) / 255;
        let color = nearest(red, 31) | nearest(green, 63) << 5 | nearest(blue, 31) << 11;
        Self(u64::from(sphere) | (x | y << NORMAL_BITS) << NORMAL_SHIFT | color << COLOR_SHIFT)
    }

    /// Returns the node code with a cone added.
    pub(super) fn with_cone(self, code: u8) -> Self {
        Self(self.0 | u64::from(code) << CONE_SHIFT)
    }

    /// Returns the node code with one to four children, which are leaves alone or some of which have children.
    /// Precondition: a single child is a leaf.
    pub(super) fn with_children(self, count: usize, have_children: bool) -> Self {
        let children = count as u64 + if have_children { HAS_GRANDCHILDREN } else { 0 };
        Self(self.0 | children << CHILDREN_SHIFT)
    }

    #[inline(always)]
    pub(super) fn sphere(self) -> u16 {
        self.0 as u16 & ((1 << SPHERE_BITS) - 1)
    }

    /// Octahedral coordinates, as in a [`crate::cloud::ShapeRecord`].
    #[inline(always)]
    pub(super) fn normal(self) -> [i16; 2] {
        let bits = (self.0 >> NORMAL_SHIFT) as i32;
        normal_of_steps([bits, bits >> NORMAL_BITS].map(|bits| (bits & ((1 << NORMAL_BITS) - 1)) - NORMAL_STEPS))
    }

    #[inline(always)]
    pub(super) fn cone(self) -> Cone {
        Cone {
            axis: oct_decode(self.normal()),
            cosine: cone_cosine((self.0 >> CONE_SHIFT) as usize & 3),
        }
    }

    /// 8-bit red, green, blue and alpha, which is opaque.
    #[inline(always)]
    pub(super) fn color(self) -> [u8; 4] {
        let bits = (self.0 >> COLOR_SHIFT) as u32;
        let widened = |bits: u32, max: u32| ((bits & max) * 255 / max) as u8;
        [widened(bits, 31), widened(bits >> 5, 63), widened(bits >> 11, 31), 255]
    }

    /// Number of children, and whether any of them has children.
    #[inline(always)]
    pub(super) fn children(self) -> (usize, bool) {
        match self.0 >> CHILDREN_SHIFT {
            children @ ..=4 => (children as usize, false),
            children => ((children - HAS_GRANDCHILDREN) as usize, true),
        }
    }

    pub(super) fn to_words(self) -> [u16; NODE_WORDS] {
        [self.0, self.0 >> 16, self.0 >> 32].map(|bits| bits as u16)
    }

    #[inline(always)]
    pub(super) fn from_words([low, center, high]: [u16; NODE_WORDS]) -> Self {
        Self(u64::from(low) | u64::from(center) << 16 | u64::from(high) << 32)
    }
}

/// Maximum error in degrees of a normal of a code. A step of a coordinate is 1/63, so both are off by at most 1/126. On
/// the octahedron that is a length of √6/126, which is the widest angle where the octahedron is nearest to its centre,
/// at 1/√3: √18/126. The rest is for the rounding of [`crate::cloud::ShapeRecord`].
#[cfg(test)]
pub(super) const NORMAL_ERROR_DEG: f32 = 1.95;

fn normal_steps(normal: [i16; 2]) -> [i32; 2] {
    normal.map(|coordinate| (f32::from(coordinate) * NORMAL_STEPS as f32 / f32::from(i16::MAX)).round() as i32)
}

#[inline(always)]
fn normal_of_steps(steps: [i32; 2]) -> [i16; 2] {
    steps.map(|steps| (steps * i32::from(i16::MAX) / NORMAL_STEPS) as i16)
}

/// The code of the narrowest cone around a packed normal with at least this half angle around another axis, by its
/// cosine.
pub(super) fn cone_code(cosine: f32) -> u8 {
    let narrowest = (0..CONE_SINES_SQUARED.len()).find(|&code| cone_cosine(code) <= cosine);
    narrowest.unwrap_or(CONE_SINES_SQUARED.len()) as u8
}

fn cone_cosine(code: usize) -> f32 {
    CONE_SINES_SQUARED
        .get(code)
        .map_or(-1.0, |sine_squared| (1.0 - sine_squared).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::oct_encode;
    use glam::Vec3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn nodes_round_trip_through_48_bits(
            sphere in 0u16..1 << 13,
            direction in prop::array::uniform3(-1f32..1.0),
            color: [u8; 4],
            cone in 0u8..4,
            (count, have_children) in (1usize..=4).prop_flat_map(|count| (Just(count), 0..=u8::from(count > 1))),
        ) {
            let normal = Vec3::from_array(direction).normalize_or(Vec3::Z);
            let have_children = have_children == 1;
            let node = NodeCode::new(sphere, oct_encode(normal), color)
                .with_cone(cone)
                .with_children(count, have_children);
            let words = node.to_words();
            let node = NodeCode::from_words(words);
            prop_assert_eq!(node.sphere(), sphere);
            prop_assert!(node.cone().axis.dot(normal) > NORMAL_ERROR_DEG.to_radians().cos());
            prop_assert_eq!(node.cone().cosine, cone_cosine(cone.into()));
            prop_assert_eq!(node.children(), (count, have_children));
            for (found, expected) in node.color().into_iter().zip(color).take(3) {
                prop_assert!(found.abs_diff(expected) <= 5, "{found} for {expected}");
            }
        }
    }

    #[test]
    fn a_leaf_has_no_children_and_black_and_white_are_exact() {
        for color in [[0, 0, 0, 255], [255; 4]] {
            let leaf = NodeCode::new(0, [0, 0], color);
            assert_eq!((leaf.color(), leaf.children()), (color, (0, false)));
        }
    }

    #[test]
    fn cones_are_rounded_outwards() {
        let of_degrees = |half_deg: f32| cone_code(half_deg.to_radians().cos());
        assert_eq!(
            [0.0, 3.5, 3.7, 14.0, 15.0, 34.0, 35.0, 120.0].map(of_degrees),
            [0, 0, 1, 1, 2, 2, 3, 3]
        );
    }
}
