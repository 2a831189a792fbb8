//! Offsets along the normal from the centre of a cell to the surface (Botsch et al. 2002 §5.1), in a few bits.

use super::normal_grid::NormalGrid;

/// Offsets are within this part of a cell's edge to both sides, in 1024ths: half the diagonal, rounded up.
pub(in crate::reel) const LARGEST_OFFSET: i32 = 896;

/// The offset that a code of `bits` bits stands for, in 1024ths of the cell's edge.
pub(in crate::reel) fn offset_of_code(code: u8, bits: u8) -> i32 {
    (((2 * i32::from(code) + 1) * LARGEST_OFFSET) >> bits) - LARGEST_OFFSET
}

/// The offset that a code of `bits` bits stands for, in edges of the cell.
pub(in crate::reel) fn offset_edges(code: u8, bits: u8) -> f64 {
    f64::from(offset_of_code(code, bits)) / 1024.0
}

/// Returns the displacement from the centre of a cell for an offset along a normal, in parts of the cell, 2ᵇⁱᵗˢ to its
/// edge.
pub(in crate::reel) fn offset_parts(
    grid: &NormalGrid,
    normal: [i16; 2],
    code: u8,
    bits: u8,
    part_bits: u32,
) -> [i32; 3] {
    let offset = i64::from(offset_of_code(code, bits));
    // Both are in 1024ths.
    grid.direction(normal)
        .map(|along| ((((offset * i64::from(along)) << part_bits) + (1 << 19)) >> 20) as i32)
}

/// The code of an offset in edges of the cell.
pub(in crate::reel) fn offset_of(edges: f64, bits: u8) -> u8 {
    let steps = f64::from(1u32 << bits);
    let largest = f64::from(LARGEST_OFFSET) / 1024.0;
    ((edges / largest + 1.0) * 0.5 * steps).floor().clamp(0.0, steps - 1.0) as u8
}
