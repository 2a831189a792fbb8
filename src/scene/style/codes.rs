//! How surfels are drawn from byte codes of the octree.

use super::choices::choices;

choices! {
    /// What the software renderer draws surfels from, and as what. Effective in the splatting modes that begin with a
    /// visibility pass; the GPU draws exact disks whatever it says.
    Footprint, "footprint" {
        /// Exact disks, pixel by pixel, of the records of points.
        Disks = "disks",
        /// Masks worked out once for quantised normals, from the byte code of the octree (paper 001 §5.2).
        Masks = "masks",
        /// A pixel for each cell, from the byte code of the octree (paper 001 §4).
        Pixels = "pixels",
    }
}

choices! {
    /// Bits of the normals that are drawn from byte codes (paper 001 §4.1).
    NormalBits, "number of bits of normals" {
        /// 8192 directions, up to 2.3° off: the paper's.
        Thirteen = "13",
        /// 32,768 directions.
        Fifteen = "15",
        /// 131,072 directions.
        Seventeen = "17",
    }
}

impl NormalBits {
    /// The number.
    pub fn bits(self) -> u32 {
        match self {
            Self::Thirteen => 13,
            Self::Fifteen => 15,
            Self::Seventeen => 17,
        }
    }
}

choices! {
    /// Bits of the offsets along normals with which byte codes are drawn (paper 001 §5.1).
    OffsetBits, "number of bits of offsets" {
        /// Splats stand in the middles of cells: gaps at grazing angles.
        None = "0",
        /// The paper's.
        Two = "2",
        /// All there are.
        Three = "3",
    }
}

impl OffsetBits {
    /// The number.
    pub fn bits(self) -> u32 {
        match self {
            Self::None => 0,
            Self::Two => 2,
            Self::Three => 3,
        }
    }
}

/// How surfels are drawn from byte codes of the octree.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct CodeStyle {
    /// What the software renderer draws surfels from.
    pub footprint: Footprint,
    /// Precision of normals.
    pub normal_bits: NormalBits,
    /// Precision of offsets along normals.
    pub offset_bits: OffsetBits,
}

impl Default for CodeStyle {
    fn default() -> Self {
        Self {
            footprint: Footprint::Disks,
            normal_bits: NormalBits::Thirteen,
            offset_bits: OffsetBits::Three,
        }
    }
}
