//! Morton codes: the three coordinates of a cell with their bits interleaved, so that sorting codes sorts cells in the
//! order in which an octree visits them.
//!
//! A code has three bits per level, the coarsest level in the highest: bit `3i` is bit `i` of x, bit `3i + 1` of y, bit
//! `3i + 2` of z. Three bits read as a number are the *octant* of a cell in its parent. Two codes share exactly the
//! cells above the level at which their highest different bit lies ([`PackedCell`] says which); the 4D media paper
//! §VI-A needs no more than that to count the occupied cells of every level.

/// Levels below the root: 21 × 3 bits fill 63 of 64.
pub const LEVELS: u32 = 21;

/// Cells along an edge at the finest level.
pub const FINEST_CELLS: u32 = 1 << LEVELS;

/// The parting level of two equal cells: below the finest level.
pub const NEVER_PART: u8 = LEVELS as u8 + 1;

/// The code of a cell. Precondition: every coordinate is below [`FINEST_CELLS`] (higher bits are dropped).
pub const fn encode(cell: [u32; 3]) -> u64 {
    spread(cell[0] as u64) | spread(cell[1] as u64) << 1 | spread(cell[2] as u64) << 2
}

/// The cell of a code: the inverse of [`encode`].
pub const fn decode(code: u64) -> [u32; 3] {
    [gather(code), gather(code >> 1), gather(code >> 2)]
}

/// The coordinates of a finest cell in one number: x in bits 0 to 20, y in 21 to 41, z in 42 to 62.
///
/// It has the bits of a code, and cells are compared as fast, but a coordinate is extracted by a shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PackedCell(u64);

/// The lowest bit of every field.
const LOWEST: u64 = 1 | 1 << LEVELS | 1 << (2 * LEVELS);

impl PackedCell {
    /// Precondition: every coordinate is below [`FINEST_CELLS`].
    pub const fn new([x, y, z]: [u32; 3]) -> Self {
        Self(x as u64 | (y as u64) << LEVELS | (z as u64) << (2 * LEVELS))
    }

    /// The cell of a code.
    pub const fn from_code(code: u64) -> Self {
        Self::new(decode(code))
    }

    /// The coordinate along an axis of the cell of `level` that this one is in.
    #[inline(always)]
    pub(crate) const fn coordinate(self, axis: usize, level: u32) -> u32 {
        ((self.0 >> (LEVELS as usize * axis)) as u32 % FINEST_CELLS) >> (LEVELS - level)
    }

    /// The coordinates.
    pub const fn coordinates(self) -> [u32; 3] {
        [
            self.coordinate(0, LEVELS),
            self.coordinate(1, LEVELS),
            self.coordinate(2, LEVELS),
        ]
    }

    /// The Morton code.
    #[inline(always)]
    pub const fn code(self) -> u64 {
        spread(self.0) | spread(self.0 >> LEVELS) << 1 | spread(self.0 >> (2 * LEVELS)) << 2
    }

    /// The octant, in its parent, of the cell of `level` (at least 1) that this one is in.
    #[inline(always)]
    pub(crate) const fn octant(self, level: u32) -> u32 {
        let bits = self.0 >> (LEVELS - level) & LOWEST;
        (bits | bits >> (LEVELS - 1) | bits >> (2 * LEVELS - 2)) as u32 & 7
    }

    /// Returns true if two cells are in the same cell of `level`.
    #[inline(always)]
    pub(crate) const fn share_cell(self, other: Self, level: u32) -> bool {
        let below = (1 << (LEVELS - level)) - 1;
        (self.0 ^ other.0) & !(below * LOWEST) == 0
    }

    /// The first level (1 to 21) at which two finest cells are in different cells, or [`NEVER_PART`]; and whether their
    /// codes are in ascending order, or equal.
    #[inline(always)]
    pub(crate) fn parting(self, next: Self) -> (u8, bool) {
        let different = self.0 ^ next.0;
        let along_any = (different | different >> LEVELS | different >> (2 * LEVELS)) as u32 % FINEST_CELLS;
        // The exponent of a 21-bit number, which is exact as an f32, is the index of its highest bit; this is one SIMD
        // instruction. The exponent of 0 is −127.
        let exponent = ((along_any as i32 as f32).to_bits() >> 23) as i32 - 127;
        let parting = (LEVELS as i32 - exponent).min(i32::from(NEVER_PART));
        let octants = LOWEST.wrapping_shl(exponent as u32);
        let ascends = (self.0 & octants) as i64 <= (next.0 & octants) as i64;
        (parting as u8, ascends)
    }
}

/// Moves bit `i` of the low 21 bits to bit `3i`: each step halves the blocks that travel together.
///
/// ```text
/// 16 | 5 bits      --------- 20..16 ----------------------------- 15..0 ------
/// blocks of 8, then 4, then 2, then 1: every bit with two empty bits above it
/// ```
// Compiled for the SIMD level of the caller.
#[inline(always)]
pub(crate) const fn spread(coordinate: u64) -> u64 {
    let mut bits = coordinate & 0x001f_ffff;
    bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}

/// The inverse of [`spread`], ignoring the bits between.
#[inline(always)]
pub(crate) const fn gather(code: u64) -> u32 {
    let mut bits = code & 0x1249_2492_4924_9249;
    bits = (bits | bits >> 2) & 0x10c3_0c30_c30c_30c3;
    bits = (bits | bits >> 4) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits >> 8) & 0x001f_0000_ff00_00ff;
    bits = (bits | bits >> 16) & 0x001f_0000_0000_ffff;
    (bits | bits >> 32) as u32 & 0x001f_ffff
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Bit by bit, as defined.
    fn encode_slowly(cell: [u32; 3]) -> u64 {
        let mut code = 0;
        for bit in 0..LEVELS {
            for (axis, coordinate) in cell.iter().enumerate() {
                code |= u64::from(coordinate >> bit & 1) << (3 * bit + axis as u32);
            }
        }
        code
    }

    #[test]
    fn codes_of_corners() {
        assert_eq!(encode([1, 0, 0]), 1);
        assert_eq!(encode([0, 1, 0]), 2);
        assert_eq!(encode([0, 0, 1]), 4);
        assert_eq!(encode([FINEST_CELLS - 1; 3]), (1 << 63) - 1);
    }

    proptest! {
        #[test]
        fn interleaving_is_correct_and_reversible(cell in [0..FINEST_CELLS, 0..FINEST_CELLS, 0..FINEST_CELLS]) {
            prop_assert_eq!(encode(cell), encode_slowly(cell));
            prop_assert_eq!(decode(encode(cell)), cell);
            prop_assert_eq!(PackedCell::new(cell).code(), encode(cell));
            prop_assert_eq!(PackedCell::from_code(encode(cell)), PackedCell::new(cell));
        }

        #[test]
        fn packed_cells_diverge_where_their_coordinates_do(
            a in [0..FINEST_CELLS, 0..FINEST_CELLS, 0..FINEST_CELLS],
            shared_levels in 0..=LEVELS,
            low in [0..FINEST_CELLS, 0..FINEST_CELLS, 0..FINEST_CELLS],
        ) {
            // b agrees with a at least down to `shared_levels`.
            let below = LEVELS - shared_levels;
            let b: [u32; 3] = std::array::from_fn(|axis| a[axis] >> below << below | low[axis] & ((1 << below) - 1));
            let expected = (1..=LEVELS)
                .find(|level| (0..3).any(|axis| a[axis] >> (LEVELS - level) != b[axis] >> (LEVELS - level)))
                .map_or(NEVER_PART, |level| level as u8);
            let (packed_a, packed_b) = (PackedCell::new(a), PackedCell::new(b));
            let ascends = encode_slowly(a) <= encode_slowly(b);
            prop_assert_eq!(packed_a.parting(packed_b), (expected, ascends));
            for level in 0..=LEVELS {
                prop_assert_eq!(packed_a.share_cell(packed_b, level), level < u32::from(expected));
                prop_assert_eq!((0..3).map(|axis| packed_a.coordinate(axis, level)).collect::<Vec<_>>(),
                    a.map(|index| index >> (LEVELS - level)));
                if level > 0 {
                    prop_assert_eq!(packed_a.octant(level), (encode_slowly(a) >> (3 * (LEVELS - level))) as u32 & 7);
                }
            }
        }
    }
}
