//! Colour slopes within the children of a parent, as far as the parent and its siblings show.
//!
//! How it works: along each axis the mean of the siblings on the upper side is compared with the mean on the lower
//! side. A child is a quarter of that distance from the centre of its parent; an eighth of the difference is taken for
//! each axis, as siblings that stand diagonally show the same slope along two. All children of one grandparent have the
//! same eight sums, by their octant. A sixth of the time that nodes across faces take, and half of their saving.

use crate::reel::tree::OCTANTS;

/// Expected difference of the children in each octant from their parent, as red, green, blue and nothing.
pub(super) type Slopes = [[i16; 4]; 8];

/// None.
pub(super) const FLAT: Slopes = [[0; 4]; 8];

/// For each axis the octants on its upper side.
const UPPER: [u8; 3] = [0xaa, 0xcc, 0xf0];

/// For each number of siblings, how often one counts.
const SHARES: [i16; 5] = [0, 12, 6, 4, 3];

/// 2¹⁵ / (8 · 12): a twelfth and an eighth.
const EIGHTH: i32 = 341;

/// The slopes of each parent of a level, in their order.
#[derive(Debug)]
pub(super) struct OfParents<'a> {
    /// The masks of the level above.
    masks: std::slice::Iter<'a, u8>,
    /// Parents already requested, and the number of siblings of the last one that are left.
    next: usize,
    left: u32,
    slopes: Slopes,
}

impl<'a> OfParents<'a> {
    /// Creates the slopes of parents below nodes with these masks.
    pub(super) fn below(masks: &'a [u8]) -> Self {
        Self {
            masks: masks.iter(),
            next: 0,
            left: 0,
            slopes: FLAT,
        }
    }

    /// Returns the slopes of the next parent; no slopes behind the last one.
    #[inline(always)]
    pub(super) fn next(&mut self, parents: &[[u8; 4]]) -> &Slopes {
        if self.left == 0 {
            let mask = self.masks.next().copied().unwrap_or(0);
            self.left = mask.count_ones().max(1);
            self.slopes = between(mask, parents.get(self.next..).unwrap_or_default());
        }
        self.left -= 1;
        self.next += 1;
        &self.slopes
    }
}

/// The slopes between siblings, the first of which are given.
#[inline(always)]
fn between(mask: u8, siblings: &[[u8; 4]]) -> Slopes {
    let mut at = FLAT;
    for (sibling, &octant) in siblings
        .iter()
        .zip(&OCTANTS[usize::from(mask)][..mask.count_ones() as usize])
    {
        at[usize::from(octant & 7)] = sibling.map(i16::from);
    }
    // Slopes from face neighbours take 3.5 instead of 4.2 bits for the torus, but finding these took 6 ms of 84.
    let mut along = [[0; 4]; 3];
    for axis in 0..3 {
        let counts = [!UPPER[axis], UPPER[axis]].map(|side| (mask & side).count_ones() as usize);
        let is_known = counts[0] > 0 && counts[1] > 0;
        let [lower, upper] = counts.map(|count| if is_known { SHARES[count.min(4)] } else { 0 });
        let mut sums = [[0i16; 4]; 2];
        for octant in 0..8 {
            for lane in 0..4 {
                sums[octant >> axis & 1][lane] += at[octant][lane];
            }
        }
        for lane in 0..4 {
            along[axis][lane] = sums[1][lane] * upper - sums[0][lane] * lower;
        }
    }
    let mut slopes = FLAT;
    for (octant, slope) in slopes.iter_mut().enumerate() {
        for lane in 0..4 {
            let mut sum = 0;
            for (axis, along) in along.iter().enumerate() {
                let of_axis = i32::from(along[lane]);
                sum += if octant >> axis & 1 == 0 { -of_axis } else { of_axis };
            }
            slope[lane] = ((sum * EIGHTH + (1 << 14)) >> 15) as i16;
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For a plane, the slope is the plane's where siblings are on all sides.
    #[test]
    fn a_plane_has_the_expected_slope() {
        let value = |octant: usize| {
            [
                100 + 8 * (octant & 1),
                100 + 16 * (octant >> 1 & 1),
                100 - 24 * (octant >> 2),
                255,
            ]
        };
        let siblings: Vec<[u8; 4]> = (0..8)
            .map(|octant| value(octant).map(|channel| channel as u8))
            .collect();
        for (octant, slope) in between(255, &siblings).into_iter().enumerate() {
            let sign = |axis: usize| if octant >> axis & 1 == 0 { -1 } else { 1 };
            assert_eq!(slope, [sign(0), 2 * sign(1), -3 * sign(2), 0]);
        }
    }

    /// A node without a sibling across an axis has no slope along it.
    #[test]
    fn cells_without_an_opposite_neighbour_have_no_slope() {
        assert_eq!(between(0b100, &[[9; 4]]), FLAT);
        let two = between(0b11, &[[10, 10, 10, 255], [50, 26, 10, 255]]);
        assert!(two.iter().all(|slope| slope[2] == 0 && slope[3] == 0));
        assert_eq!([two[0], two[2], two[5]].map(|slope| slope[0]), [-5, -5, 5]);
        assert_eq!([two[0], two[2], two[5]].map(|slope| slope[1]), [-2, -2, 2]);
    }
}
