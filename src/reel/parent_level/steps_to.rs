//! Directions to the cells that touch a cell, as far as its parent and the three nodes behind its faces show.
//!
//! A sum of directions is four bytes: of x, y and z, one more for each cell, and the number of cells.

/// The cells of a family that touch the one in an octant, by that octant and the mask.
pub(super) static WITHIN: [[u32; 256]; 8] = within();

/// Touching cells of the node beyond a face, by the octant, the axis and the mask of that node.
pub(super) static BEYOND: [[[u32; 256]; 3]; 8] = beyond();

/// One cell, in steps from 0 to 2 along each axis.
const fn cell(x: usize, y: usize, z: usize) -> u32 {
    (x | y << 8 | z << 16 | 1 << 24) as u32
}

const fn within() -> [[u32; 256]; 8] {
    let mut table = [[0; 256]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut mask = 1usize;
        while mask < 256 {
            let other = mask.trailing_zeros() as usize;
            let rest = table[octant][mask & (mask - 1)];
            table[octant][mask] = if other == octant {
                rest
            } else {
                let along = [
                    1 + (other & 1) - (octant & 1),
                    1 + (other >> 1 & 1) - (octant >> 1 & 1),
                    1 + (other >> 2) - (octant >> 2),
                ];
                rest + cell(along[0], along[1], along[2])
            };
            mask += 1;
        }
        octant += 1;
    }
    table
}

#[expect(clippy::large_stack_arrays, reason = "made by the compiler")]
const fn beyond() -> [[[u32; 256]; 3]; 8] {
    let mut table = [[[0; 256]; 3]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut axis = 0;
        while axis < 3 {
            let upper = octant >> axis & 1;
            let mut mask = 1usize;
            while mask < 256 {
                let other = mask.trailing_zeros() as usize;
                let rest = table[octant][axis][mask & (mask - 1)];
                // The cells of the layer adjacent to the face.
                table[octant][axis][mask] = if other >> axis & 1 == upper {
                    rest
                } else {
                    let mut along = [
                        1 + (other & 1) - (octant & 1),
                        1 + (other >> 1 & 1) - (octant >> 1 & 1),
                        1 + (other >> 2) - (octant >> 2),
                    ];
                    along[axis] = 2 * upper;
                    rest + cell(along[0], along[1], along[2])
                };
                mask += 1;
            }
            axis += 1;
        }
        octant += 1;
    }
    table
}

/// The sum of steps along each axis, and the number of these cells.
#[inline(always)]
pub(super) fn sums(steps_to: u32) -> ([i32; 3], i32) {
    let [x, y, z, count] = steps_to.to_le_bytes().map(i32::from);
    ([x - count, y - count, z - count], count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against cells one by one.
    #[test]
    fn steps_lead_to_the_touching_cells() {
        for octant in 0..8usize {
            let own = [0, 1, 2].map(|axis| (octant >> axis & 1) as i32);
            for mask in 0..256usize {
                let way = |other: usize, from: [i32; 3]| {
                    let way = [0, 1, 2].map(|axis| from[axis] + (other >> axis & 1) as i32 - own[axis]);
                    (mask >> other & 1 != 0 && way != [0; 3] && way.iter().all(|along| along.abs() <= 1)).then_some(way)
                };
                let check = |from: [i32; 3], found: u32| {
                    let steps_to: Vec<[i32; 3]> = (0..8).filter_map(|other| way(other, from)).collect();
                    let sum = [0, 1, 2].map(|axis| steps_to.iter().map(|way| way[axis]).sum::<i32>());
                    assert_eq!(sums(found), (sum, steps_to.len() as i32), "{octant} {mask} {from:?}");
                };
                check([0; 3], WITHIN[octant][mask]);
                for axis in 0..3 {
                    let mut from = [0; 3];
                    from[axis] = if own[axis] == 0 { -2 } else { 2 };
                    check(from, BEYOND[octant][axis][mask]);
                }
            }
        }
    }
}
