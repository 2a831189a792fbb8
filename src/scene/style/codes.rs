//! Rendering of surfels from byte codes of the octree.

use super::choices::choices;
use super::describe::{Label, Numbers, Place, Section, Typed, Values, group};

choices! {
    /// Footprint shape of surfels, and what they are drawn from. Effective in the splatting modes that begin with a
    /// visibility pass. GPUs decode the nodes of the byte code, and draw exact disks of them instead of masks.
    Footprint, "footprint" {
        Disks = "disks", "Exact disks", "Pixel by pixel, from the records of the points";
        /// Masks are worked out once for quantised normals (Botsch et al. 2002 §5.2).
        Masks = "masks", "Masks", "Looked up by normal, place and size, from the octree's byte code; disks on a GPU";
        /// Botsch et al. 2002 §4.
        Pixels = "pixels", "Pixels", "One for each cell, from the byte code of the octree";
    }
}

choices! {
    /// Bits of the normals that are drawn from byte codes (Botsch et al. 2002 §4.1).
    NormalBits, "number of bits of normals" {
        /// Up to 2.3° off: the paper's.
        Thirteen = "13", "13 bits", "8192 directions";
        Fifteen = "15", "15 bits", "32,768 directions";
        Seventeen = "17", "17 bits", "131,072 directions";
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
    /// Bits of the offsets along normals with which byte codes are drawn (Botsch et al. 2002 §5.1).
    OffsetBits, "number of bits of offsets" {
        None = "0", "None", "Splats are at the centres of cells: gaps at grazing angles";
        /// The paper's.
        Two = "2", "2 bits", "A quarter of the cell's diagonal";
        /// All there are.
        Three = "3", "3 bits", "An eighth of the cell's diagonal";
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

group! {
    /// Rendering settings of surfels from byte codes of the octree.
    CodeStyle {
        /// Footprint that surfels are drawn with.
        footprint: Footprint = Footprint::Disks, "footprint" FOOTPRINT {
            flag: "footprint",
            value_name: "FOOTPRINT",
            help: "Footprint of surfels: exact disks, or masks or pixels from byte codes",
            title: "Footprint",
            hint: "Exact disks of all points, or masks or pixels of the nodes of the octree's byte code. A GPU draws \
                   disks instead of masks",
            section: Section::Footprints,
            when: |drawn| drawn.draws_surfels(),
            label: Label::Unusual(Place::What, "of {}"),
            values: Values::Words(Footprint::WORDS),
        }
        /// Precision of normals.
        normal_bits: NormalBits = NormalBits::Thirteen, "normal_bits" NORMAL_BITS {
            flag: "normal-bits",
            value_name: "BITS",
            help: "Bits per normal in byte codes",
            title: "Normals",
            hint: "Bits of a normal of the byte code; light is worked out once for each direction",
            section: Section::Footprints,
            when: |drawn| drawn.asks_for_codes(),
            full_name: "Normal bits",
            also: &["quantization"],
            values: Values::Words(NormalBits::WORDS),
        }
        /// Precision of offsets along normals.
        offset_bits: OffsetBits = OffsetBits::Three, "offset_bits" OFFSET_BITS {
            flag: "offset-bits",
            value_name: "BITS",
            help: "Bits per offset along the normal in byte codes",
            title: "Offsets",
            hint: "Bits of the offset from the centre of a cell to the surface, along the normal",
            section: Section::Footprints,
            when: |drawn| drawn.asks_for_codes(),
            full_name: "Offset bits",
            also: &["quantization"],
            values: Values::Words(OffsetBits::WORDS),
        }
        /// Nodes that are culled and decoded together, on average.
        // Enough to pay for finding a block, few enough to be in one tile.
        block_nodes: f32 = 48.0, "block_nodes" BLOCK_NODES {
            flag: "block-nodes",
            value_name: "N",
            help: "Nodes of a byte code that are culled and decoded together (CPU)",
            title: "Block size",
            hint: "Nodes of the byte code that the CPU renderer culls and decodes together, on average. A block is \
                   drawn on one level, that of its nearest corner",
            section: Section::Footprints,
            when: |drawn| drawn.asks_for_codes() && !drawn.is_drawn_on_gpu(),
            label: Label::Unusual(Place::What, "blocks of {}"),
            also: &["culling granularity"],
            values: Values::Number(Numbers {
                retained: [1.0, 1_000_000.0],
                offered: [1.0, 4096.0],
                typed: Typed::WholePositive,
                is_logarithmic: true,
                ..Numbers::USUAL
            }),
        }
    }
}
