//! Morton codes: the three coordinates of a cell with their bits interleaved, so that sorting codes sorts cells in the
//! order in which an octree visits them.
//!
//! A code has three bits a level, the coarsest level in the highest: bit `3i` is bit `i` of x, bit `3i + 1` of y, bit
//! `3i + 2` of z. Three bits read as a number are the *octant* of a cell in its parent. Two codes share exactly the
//! cells above the level at which their highest different bit lies ([`parting_level`]); paper 000 §VI-A needs no more
//! than that to count the occupied cells of every level.

/// Levels below the root: 21 × 3 bits fill 63 of 64.
pub const LEVELS: u32 = 21;

/// Cells along an edge at the finest level.
pub const FINEST_CELLS: u32 = 1 << LEVELS;

/// The parting level of two equal codes: below the finest level.
pub const NEVER_PART: u8 = LEVELS as u8 + 1;

/// The code of a cell. Precondition: every coordinate is below [`FINEST_CELLS`] (higher bits are dropped).
pub const fn encode(cell: [u32; 3]) -> u64 {
    spread(cell[0] as u64) | spread(cell[1] as u64) << 1 | spread(cell[2] as u64) << 2
}

/// The cell of a code: the inverse of [`encode`].
pub const fn decode(code: u64) -> [u32; 3] {
    [gather(code), gather(code >> 1), gather(code >> 2)]
}

/// The first level (1 to 21) at which two codes of the finest level lie in different cells, or [`NEVER_PART`].
pub const fn parting_level(a: u64, b: u64) -> u8 {
    match (a ^ b).checked_ilog2() {
        Some(highest_bit) => (LEVELS - highest_bit / 3) as u8,
        None => NEVER_PART,
    }
}

/// Moves bit `i` of the low 21 bits to bit `3i`: each step halves the blocks that travel together.
///
/// ```text
/// 16 | 5 bits      --------- 20..16 ----------------------------- 15..0 ------
/// blocks of 8, then 4, then 2, then 1: every bit with two empty places above it
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

    /// Bit by bit, as the definition says.
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
        fn interleaving_is_the_definition_and_reversible(cell in [0..FINEST_CELLS, 0..FINEST_CELLS, 0..FINEST_CELLS]) {
            prop_assert_eq!(encode(cell), encode_slowly(cell));
            prop_assert_eq!(decode(encode(cell)), cell);
        }

        #[test]
        fn codes_part_where_their_cells_do(
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
            prop_assert_eq!(parting_level(encode(a), encode(b)), expected);
        }
    }
}
