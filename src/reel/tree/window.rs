//! Neighbourhoods as bits of one word.
//!
//! A *window* is 4 × 4 × 4 cells around the 2 × 2 × 2 of a node: bit `x + 4 y + 16 z`, the node's own at 1 and 2 along
//! each axis. The 27 cells around any of the eight are in it, found by one shift. Directions are numbered `x + 3 y + 9
//! z` from 0 to 26, each coordinate 0 (below), 1 (same) or 2 (above).

/// Number of directions, including the centre.
pub(in crate::reel) const DIRECTIONS: usize = 27;

/// The direction of no step.
pub(in crate::reel) const CENTER: usize = 13;

/// The cells around the one at (1, 1, 1), itself included, shifted to the corner.
pub(in crate::reel) const CUBE_OF_27: u64 = 0x0777_0777_0777;

/// Cells of [`CUBE_OF_27`] that share a face with the centre.
pub(in crate::reel) const FACES: u64 = 1 << 5 | 1 << 17 | 1 << 20 | 1 << 22 | 1 << 25 | 1 << 37;

/// Cells that share only a corner.
pub(in crate::reel) const CORNERS: u64 = 0x0505_0000_0505;

/// Centre cell itself.
pub(in crate::reel) const SELF: u64 = 1 << 21;

/// Cells that share only an edge.
pub(in crate::reel) const EDGES: u64 = CUBE_OF_27 & !(FACES | CORNERS | SELF);

/// `PLACED[d][m]`: the cells of a mask of the node in direction `d` that are in the window.
pub(in crate::reel) static PLACED: [[u64; 256]; DIRECTIONS] = placed();

#[expect(clippy::large_stack_arrays, reason = "made by the compiler")]
const fn placed() -> [[u64; 256]; DIRECTIONS] {
    let mut table = [[0; 256]; DIRECTIONS];
    let mut direction = 0;
    while direction < DIRECTIONS {
        let mut mask = 0;
        while mask < 256 {
            let mut octant = 0;
            while octant < 8 {
                if mask >> octant & 1 != 0 {
                    // Along each axis the first cell of the node is at −1, 1 or 3.
                    let x = 2 * (direction % 3) + (octant & 1);
                    let y = 2 * (direction / 3 % 3) + (octant >> 1 & 1);
                    let z = 2 * (direction / 9) + (octant >> 2);
                    let is_inside = 1 <= x && x <= 4 && 1 <= y && y <= 4 && 1 <= z && z <= 4;
                    if is_inside {
                        table[direction][mask] |= 1 << ((x - 1) + 4 * (y - 1) + 16 * (z - 1));
                    }
                }
                octant += 1;
            }
            mask += 1;
        }
        direction += 1;
    }
    table
}

/// For each cell of a window the direction of the node that it is in, and its octant there.
pub(in crate::reel) static OWNERS: [(u8, u8); 64] = owners();

const fn owners() -> [(u8, u8); 64] {
    let mut table = [(0, 0); 64];
    let mut cell = 0;
    while cell < 64 {
        let coordinates = [cell % 4, cell / 4 % 4, cell / 16];
        let mut direction = 0;
        let mut octant = 0;
        let mut axis = 0;
        let mut place = 1;
        while axis < 3 {
            let along = coordinates[axis] + 1;
            direction += place * (along / 2);
            octant |= (along % 2) << axis;
            place *= 3;
            axis += 1;
        }
        table[cell] = (direction as u8, octant as u8);
        cell += 1;
    }
    table
}

/// Returns the bit shift of the cells around an octant in the window of its parent.
#[inline(always)]
pub(in crate::reel) const fn shift_of(octant: usize) -> u32 {
    (octant & 1 | (octant & 2) << 1 | (octant & 4) << 2) as u32
}

/// Returns the index of the cell in a direction among 27 around a cell.
#[inline(always)]
pub(in crate::reel) const fn cell_of(direction: u8) -> u32 {
    (direction % 3 + 4 * (direction / 3 % 3) + 16 * (direction / 9)) as u32
}

/// The 27 cells around an octant of the node that a window is around.
#[inline(always)]
pub(in crate::reel) const fn around(window: u64, octant: usize) -> u64 {
    window >> shift_of(octant) & CUBE_OF_27
}

/// The window of the level below around a node; a cell is set if its node is among the 27 around.
#[inline(always)]
pub(in crate::reel) const fn refined(around: u64) -> u64 {
    // Columns 0, 1, 2 become 0, 1 and 2, 3; then rows, then planes.
    let x = (around & 0x0111_0111_0111) | ((around & 0x0222_0222_0222) * 3) | (around & 0x0444_0444_0444) << 1;
    let y = (x & 0x000f_000f_000f) | ((x & 0x00f0_00f0_00f0) * 0x11) | (x & 0x0f00_0f00_0f00) << 4;
    let center = y & 0xffff_0000;
    y & 0xffff | center | center << 16 | (y & 0xffff_0000_0000) << 16
}

/// Assembles the window around a node from blocks of 4 × 4 × 4 cells: the one that it is in, and the adjacent ones at
/// its octant's sides. `block(d)` is the block in direction `d`.
#[inline(always)]
pub(in crate::reel) fn of_blocks(octant: usize, block: impl Fn(usize) -> u64) -> u64 {
    let (x, y, z) = (octant & 1, octant >> 1 & 1, octant >> 2);
    let side = |upper: usize, step: usize| if upper == 0 { CENTER - step } else { CENTER + step };
    let (dx, dy, dz) = (side(x, 1), side(y, 3), side(z, 9));
    let row = |base: usize| along_x(x, block(base), block(base + dx - CENTER));
    let plane = |base: usize| along_y(y, row(base), row(base + dy - CENTER));
    along_z(z, plane(CENTER), plane(dz))
}

#[inline(always)]
fn along_x(upper: usize, own: u64, side: u64) -> u64 {
    if upper == 0 {
        own << 1 & 0xeeee_eeee_eeee_eeee | side >> 3 & 0x1111_1111_1111_1111
    } else {
        own >> 1 & 0x7777_7777_7777_7777 | side << 3 & 0x8888_8888_8888_8888
    }
}

#[inline(always)]
fn along_y(upper: usize, own: u64, side: u64) -> u64 {
    if upper == 0 {
        own << 4 & 0xfff0_fff0_fff0_fff0 | side >> 12 & 0x000f_000f_000f_000f
    } else {
        own >> 4 & 0x0fff_0fff_0fff_0fff | side << 12 & 0xf000_f000_f000_f000
    }
}

#[inline(always)]
fn along_z(upper: usize, own: u64, side: u64) -> u64 {
    if upper == 0 {
        own << 16 | side >> 48
    } else {
        own >> 16 | side << 48
    }
}

/// The cells of a child's mask within the block of its parent: bit `x + 4 y + 16 z`.
#[inline(always)]
pub(in crate::reel) const fn in_block(octant: usize, mask: u8) -> u64 {
    let mask = mask as u64;
    let cells = mask & 0x03 | (mask & 0x0c) << 2 | (mask & 0x30) << 12 | (mask & 0xc0) << 14;
    cells << (2 * shift_of(octant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_are_placed_where_their_cells_are() {
        for mask in 0..=255u8 {
            let window = PLACED[CENTER][mask as usize];
            assert!((0..8).all(|octant| (around(window, octant) & SELF != 0) == (mask >> octant & 1 != 0)));
        }
        for (cell, (direction, octant)) in OWNERS.into_iter().enumerate() {
            assert_eq!(PLACED[direction as usize][1 << octant], 1 << cell);
        }
        assert_eq!(CUBE_OF_27.count_ones(), 27);
        assert_eq!(
            (FACES.count_ones(), EDGES.count_ones(), CORNERS.count_ones()),
            (6, 12, 8)
        );
    }

    /// Against cells looked up one by one in 12 × 12 × 12.
    #[test]
    fn windows_from_blocks_contain_the_cells_around_the_node() {
        let is_set = |x: usize, y: usize, z: usize| (x * 7 + y * 11 + z * 13 + x * y * z) % 5 < 2;
        let block = |direction: usize| {
            let base = [direction % 3, direction / 3 % 3, direction / 9].map(|along| 4 * along);
            let cells = (0..64).filter(|cell| is_set(base[0] + cell % 4, base[1] + cell / 4 % 4, base[2] + cell / 16));
            cells.map(|cell| 1u64 << cell).sum::<u64>()
        };
        for octant in 0..8 {
            let window = of_blocks(octant, block);
            let start = [octant & 1, octant >> 1 & 1, octant >> 2].map(|upper| 3 + 2 * upper);
            for cell in 0..64 {
                let expected = is_set(start[0] + cell % 4, start[1] + cell / 4 % 4, start[2] + cell / 16);
                assert_eq!(window >> cell & 1 != 0, expected, "{octant} {cell}");
            }
        }
    }

    #[test]
    fn cells_are_refined_to_the_windows_around_them() {
        for (direction, of_masks) in PLACED.iter().enumerate() {
            let around = 1 << (direction % 3 + 4 * (direction / 3 % 3) + 16 * (direction / 9));
            assert_eq!(refined(around), of_masks[255]);
        }
    }

    #[test]
    fn masks_are_placed_in_blocks_by_octant() {
        for octant in 0..8 {
            for bit in 0..8 {
                let [x, y, z] = [0, 1, 2].map(|axis| 2 * (octant >> axis & 1) + (bit >> axis & 1));
                assert_eq!(in_block(octant, 1 << bit), 1 << (x + 4 * y + 16 * z));
            }
        }
    }
}
