//! Attributes of a node of a coded cloud, in eight bytes.
//!
//! | bits | attribute |
//! |---|---|
//! | 0–16 | normal, see [`crate::cloud::quantise_normal`] |
//! | 17–19 | offset along the normal, in eighths of −√3/2 to √3/2 cell edges |
//! | 20–27 | radius, in twelfths of an octave from a quarter of the cell edge up |
//! | 32–55 | red, green, blue |
//! | 56–63 | half angle of the cone around the normals below, in 255ths of 180° |

use bytemuck::{Pod, Zeroable};
use std::f32::consts::PI;
use std::sync::LazyLock;

/// Maximum distance of the surface in a cell from the cell centre, in cell edges: √(3/4), half a diagonal (Botsch et
/// al. 2002 §5.1).
pub const LARGEST_OFFSET: f32 = 0.866_025_4;

pub(crate) const NORMAL_MASK: u32 = (1 << crate::cloud::FINEST_NORMAL_BITS) - 1;
pub(crate) const OFFSET_SHIFT: u32 = 17;
// With 0 bits, 438 to 822 pixels of a sphere show the background between terraces (five views); with 3 none do (splat
// scale 1.4).
const OFFSET_BITS: u32 = 3;
pub(crate) const RADIUS_SHIFT: u32 = 20;

/// Steps of radii in an octave; the smallest is 2^−2 cell edges, the largest 2^19.25.
const RADIUS_STEPS: f32 = 12.0;
const SMALLEST_RADIUS_LOG2: f32 = -2.0;

/// Steps of half angles in 180°.
const CONE_STEPS: f32 = 255.0;

/// The attributes of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct NodeAttributes {
    shape: u32,
    /// Mean red, green and blue of the points.
    pub color: [u8; 3],
    cone: u8,
}

impl NodeAttributes {
    /// Packs attributes: the finest index of the normal, the offset in cell edges (the nearest of eight), a radius in
    /// cell edges (rounded up, as far as there are codes) and the half angle of the normal cone in radians (rounded
    /// up).
    pub(super) fn new(normal: u32, offset_edges: f32, radius_edges: f32, color: [u8; 3], cone: f32) -> Self {
        let steps = (1 << OFFSET_BITS) as f32;
        let offset = (0.5 * (offset_edges / LARGEST_OFFSET + 1.0) * steps).clamp(0.0, steps - 1.0);
        let radius = (radius_edges.log2() - SMALLEST_RADIUS_LOG2) * RADIUS_STEPS;
        let radius = radius.ceil().clamp(0.0, 255.0) as u32;
        let cone = (cone / PI * CONE_STEPS).ceil().clamp(0.0, CONE_STEPS) as u8;
        Self {
            shape: normal & NORMAL_MASK | (offset as u32) << OFFSET_SHIFT | radius << RADIUS_SHIFT,
            color,
            cone,
        }
    }

    /// The finest index of the normal.
    #[inline(always)]
    pub fn normal(self) -> u32 {
        self.shape & NORMAL_MASK
    }

    /// The index of the offset, 0 to 7; [`offset_of_code`] says which it is.
    #[inline(always)]
    pub(crate) fn offset_code(self) -> usize {
        (self.shape >> OFFSET_SHIFT) as usize % (1 << OFFSET_BITS)
    }

    /// The offset in cell edges, with 3 bits.
    pub fn offset_edges(self) -> f32 {
        offset_of_code(self.offset_code(), OFFSET_BITS)
    }

    #[inline(always)]
    pub(crate) fn radius_code(self) -> u8 {
        (self.shape >> RADIUS_SHIFT) as u8
    }

    /// The radius in cell edges.
    #[inline(always)]
    pub fn radius_edges(self) -> f32 {
        radius_of_code(self.radius_code())
    }

    /// The half angle of the normal cone in steps.
    pub(crate) fn cone_code(self) -> u8 {
        self.cone
    }

    /// Half angle of a cone around the normal that holds the normals of all nodes below, in radians.
    pub fn cone(self) -> f32 {
        cone_of_code(self.cone)
    }
}

/// The half angle that a code means, in radians.
pub(super) fn cone_of_code(code: u8) -> f32 {
    f32::from(code) * (PI / CONE_STEPS)
}

/// The offset in cell edges that a 3-bit code means when this many of its bits are used, 0 to 3.
pub(crate) fn offset_of_code(code: usize, bits: u32) -> f32 {
    let bits = bits.min(OFFSET_BITS);
    let step = (code >> (OFFSET_BITS - bits)) as f32 + 0.5;
    LARGEST_OFFSET * (2.0 * step / (1 << bits) as f32 - 1.0)
}

static RADII: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| (code as f32 / RADIUS_STEPS + SMALLEST_RADIUS_LOG2).exp2()));

/// The radius in cell edges that a code means.
#[inline(always)]
pub(crate) fn radius_of_code(code: u8) -> f32 {
    RADII[code as usize]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn offsets_decode_with_all_and_with_fewer_bits() {
        let edges = |code, bits| offset_of_code(code, bits) / LARGEST_OFFSET;
        assert_eq!([0, 3, 4, 7].map(|code| edges(code, 3)), [-0.875, -0.125, 0.125, 0.875]);
        assert_eq!([0, 1, 5, 7].map(|code| edges(code, 2)), [-0.75, -0.75, 0.25, 0.75]);
        assert_eq!([0, 7].map(|code| edges(code, 0)), [0.0, 0.0]);
    }

    proptest! {
        #[test]
        fn attributes_round_trip_through_packing(
            normal in 0u32..1 << 17,
            offset in -LARGEST_OFFSET..LARGEST_OFFSET,
            radius in 0.26f32..500_000.0,
            color: [u8; 3],
            cone in 0f32..PI,
        ) {
            let node = NodeAttributes::new(normal, offset, radius, color, cone);
            prop_assert_eq!(node.normal(), normal);
            prop_assert!((node.offset_edges() - offset).abs() <= LARGEST_OFFSET / 8.0 + 1e-6);
            let two_bits = offset_of_code(node.offset_code(), 2);
            prop_assert!((two_bits - offset).abs() <= LARGEST_OFFSET / 4.0 + 1e-6);
            let ratio = node.radius_edges() / radius;
            prop_assert!((0.9999..1.0596).contains(&ratio), "{}", ratio);
            prop_assert_eq!(node.color, color);
            prop_assert!(node.cone() >= cone - 1e-6 && node.cone() <= cone + 0.0124);
        }

        #[test]
        fn extreme_values_can_be_packed(offset: f32, radius: f32, cone: f32) {
            let node = NodeAttributes::new(u32::MAX, offset, radius, [0; 3], cone);
            prop_assert!(node.radius_edges() >= 0.25);
            prop_assert!(node.offset_edges().abs() <= LARGEST_OFFSET);
        }
    }
}
