//! Normals as places on the unfolded octahedron, as steps from what parent and the node before say.
//!
//! How it works: along the first axis a place is counted in half cells, as the two triangles of a cell follow each
//! other there; along the second one in cells. Both go around at the border of the square, so every number is a place.

use super::families::{Families, of_counts, of_masks};
use crate::reel::attributes::MISSING;
use crate::reel::coder::SymbolCoder;

/// Classes of how far parent and node before are apart, and, along the second axis, of the step along the first.
const SPREADS: usize = 7;
const STEPS: usize = 3;

/// A node before that is so far from the parent, in half cells, says nothing.
const FAR: u32 = 16;

const ACROSS: usize = 3;
const ALONG: usize = ACROSS + SPREADS;

/// Contexts of normals: whether there is one, then the steps.
pub(in crate::reel) const NORMAL_CONTEXTS: usize = ALONG + SPREADS * STEPS;

/// A state for each step.
pub(in crate::reel) const NORMAL_LANES: usize = 2;

/// Places, or [`MISSING`], in half cells and cells.
pub(in crate::reel) fn to_halves(places: &mut [[i16; 2]]) {
    for place in places.iter_mut().filter(|place| **place != MISSING) {
        *place = halves(*place);
    }
}

fn halves([x, y]: [i16; 2]) -> [i16; 2] {
    [2 * x.div_euclid(3) + i16::from(x.rem_euclid(3) == 2), y.div_euclid(3)]
}

/// The inverse of [`to_halves`].
#[inline(always)]
pub(in crate::reel) fn to_places(halves: &mut [[i16; 2]]) {
    for place in halves {
        *place = if *place == MISSING { MISSING } else { place_of(*place) };
    }
}

#[inline(always)]
fn place_of([x, y]: [i16; 2]) -> [i16; 2] {
    let upper = x & 1;
    let u = x >> 1;
    // Quadrants have other diagonals.
    let is_mirrored = (u < 0) != (y < 0);
    [3 * u + 1 + upper, 3 * y + 1 + (upper ^ i16::from(is_mirrored))]
}

/// A number around zero that is the same after so many steps, a power of two.
#[inline(always)]
fn around(number: i32, steps: i32) -> i32 {
    ((number + steps / 2) & (steps - 1)) - steps / 2
}

/// Codes the normals of a level, in half cells and cells of a grid that has so many along half its square; or
/// [`MISSING`] if `may_miss`. Those of the level above are `parents`.
#[inline(always)]
pub(in crate::reel) fn code_normals<C: SymbolCoder>(
    coder: &mut C,
    half: i32,
    may_miss: bool,
    families: Families<'_>,
    parents: &[[i16; 2]],
    normals: &mut [[i16; 2]],
) {
    match families {
        Families::Masks(masks) => code(coder, half, may_miss, of_masks(masks), parents, normals),
        Families::Counts(counts, outside) => {
            code(coder, half, may_miss, of_counts(counts, outside), parents, normals);
        }
    }
}

#[inline(always)]
fn code<C: SymbolCoder>(
    coder: &mut C,
    half: i32,
    may_miss: bool,
    families: impl Iterator<Item = (usize, usize)>,
    parents: &[[i16; 2]],
    mut normals: &mut [[i16; 2]],
) {
    // Not behind a reference: what it keeps stays in registers.
    let mut own = std::mem::take(coder);
    let periods = [4 * half, 2 * half];
    let mut last = None;
    for (parent, count) in families {
        if parent >= parents.len() {
            break;
        }
        let spread = spread_of(parents, parent, periods);
        let parent = known(parents[parent]);
        let children;
        (children, normals) = normals.split_at_mut(count.min(normals.len()));
        for normal in children {
            let given = known(*normal);
            if may_miss {
                let context = usize::from(parent.is_some()) + usize::from(last.is_some());
                if own.symbol(0, context, u8::from(given.is_none())) != 0 {
                    *normal = MISSING;
                    last = None;
                    continue;
                }
            }
            let from = predict(parent, last, periods);
            let given = given.unwrap_or(from);
            let dx = own.signed(0, ACROSS + spread, around(given[0] - from[0], periods[0]));
            let step = (dx.unsigned_abs() as usize).min(STEPS - 1);
            let dy = own.signed(1, ALONG + STEPS * spread + step, around(given[1] - from[1], periods[1]));
            let is = [around(from[0] + dx, periods[0]), around(from[1] + dy, periods[1])];
            *normal = is.map(|along| along as i16);
            last = Some(is);
        }
    }
    *coder = own;
}

#[inline(always)]
fn known(normal: [i16; 2]) -> Option<[i32; 2]> {
    (normal != MISSING).then(|| normal.map(i32::from))
}

/// From one normal to another, and how far that is in half cells.
#[inline(always)]
fn step(from: [i32; 2], to: [i32; 2], periods: [i32; 2]) -> ([i32; 2], u32) {
    let step = [0, 1].map(|axis| around(to[axis] - from[axis], periods[axis]));
    (step, step[0].unsigned_abs().max(2 * step[1].unsigned_abs()))
}

/// How far a parent is from the one before it and the one behind it. What varies above varies below; and that is known
/// before any child is.
#[inline(always)]
fn spread_of(parents: &[[i16; 2]], parent: usize, periods: [i32; 2]) -> usize {
    let Some(own) = known(parents[parent]) else {
        return SPREADS - 1;
    };
    let beside = [parents.get(parent.wrapping_sub(1)), parents.get(parent + 1)];
    let apart = beside.map(|beside| {
        let beside = beside.and_then(|&beside| known(beside));
        beside.map_or(0, |beside| step(own, beside, periods).1)
    });
    (32 - (apart[0] + apart[1]).leading_zeros()).min(SPREADS as u32 - 1) as usize
}

/// What the normal is expected to be: the middle between parent and node before, if they are near each other.
#[inline(always)]
fn predict(parent: Option<[i32; 2]>, last: Option<[i32; 2]>, periods: [i32; 2]) -> [i32; 2] {
    let (parent, last) = match (parent, last) {
        (Some(parent), Some(last)) => (parent, last),
        (known, None) | (None, known) => return known.unwrap_or([0, 0]),
    };
    let (apart, distance) = step(parent, last, periods);
    // Across a fold of the square the parent alone is believed.
    if distance >= FAR {
        return parent;
    }
    [0, 1].map(|axis| around(parent[axis] + ((apart[axis] + 1) >> 1), periods[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reel::attributes::NormalGrid;

    #[test]
    fn every_number_is_a_place_and_back() {
        for bits in [13, 15, 17] {
            let grid = NormalGrid::of(bits);
            for index in 0..1 << bits {
                let place = grid.place(index);
                assert_eq!(place_of(halves(place)), place);
            }
            let half = grid.half();
            let all = (-2 * half..2 * half).flat_map(|x| (-half..half).map(move |y| (x as i16, y as i16)));
            for (x, y) in all {
                assert_eq!(halves(place_of([x, y])), [x, y]);
            }
        }
    }
}
