//! Normals as places on the unfolded octahedron: cells as differences to a prediction, and which half of the cell.

use super::normal_grid::{MISSING, NormalGrid};
use super::value_coder::ValueCoder;
use crate::reel::coder::{BitCoder, divided};
use crate::reel::tree::{Known, MAX_KNOWN, NONE};
use glam::Vec3;

/// Classes of how far apart the normals around are.
const SPREADS: usize = 8;

/// Contexts: whether there is a normal; the steps along both axes; and which half of the cell.
const ACROSS: usize = 3;
const ALONG: usize = ACROSS + SPREADS;
const HALVES: usize = ALONG + SPREADS * 3;

/// Contexts of normals.
pub(in crate::reel) const NORMAL_CONTEXTS: usize = HALVES + 3 * 3 * 3 * 2;

/// Prediction of a normal.
struct Foreseen {
    /// [`MISSING`] where nothing is.
    place: [i16; 2],
    /// Class of the spread of the normals it was predicted from.
    spread: usize,
    /// Likelihood class of a missing normal: 0 if nothing is predicted, else 1 or 2.
    presence: usize,
}

/// State of the nodes of a level that had normals in the previous frame.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) struct Turned<'a> {
    pub(in crate::reel) plan: &'a [Known],
    /// Normals of the level above, in the frame before and in this one.
    pub(in crate::reel) parents: [&'a [[i16; 2]]; 2],
    /// Normals of the frame before.
    pub(in crate::reel) before: &'a [[i16; 2]],
    /// The unit normals that an encoder has; a decoder has none.
    pub(in crate::reel) directions: &'a [Vec3],
}

/// Codes the normals of a level, each a place of `grid`; or [`MISSING`] if `may_miss`. Each is predicted to turn as
/// those around it did. The prediction stands while it is as near the normal as a rounded one may be: a turn below the
/// precision is not coded.
pub(in crate::reel) fn code_turned_normals<C: BitCoder>(
    coder: &mut ValueCoder<'_, C>,
    grid: &NormalGrid,
    may_miss: bool,
    Turned {
        plan,
        parents,
        before,
        directions,
    }: Turned<'_>,
    places: &mut [[i16; 2]],
) {
    let half = grid.half();
    let foresee = |node: usize, places: &[[i16; 2]]| {
        let known = &plan[node];
        let parent = known.parent as usize;
        let own = before[node];
        if own == MISSING {
            let (place, spread) = mean_around(half, known, parents[1][parent], |neighbour| places[neighbour]);
            let presence = 0;
            return Foreseen {
                place,
                spread,
                presence,
            };
        }
        let step = |was: [i16; 2], is: [i16; 2]| {
            if was == MISSING || is == MISSING {
                MISSING
            } else {
                [0, 1].map(|axis| is[axis].wrapping_sub(was[axis]))
            }
        };
        let of_parent = step(parents[0][parent], parents[1][parent]);
        let (turned, spread) = mean_around(half, known, of_parent, |neighbour| {
            step(before[neighbour], places[neighbour])
        });
        let turned = if turned == MISSING { [0; 2] } else { turned };
        Foreseen {
            place: [0, 1].map(|axis| own[axis].wrapping_add(turned[axis])),
            spread,
            presence: 2,
        }
    };
    let settle = |node: usize, predicted: [i16; 2], place: [i16; 2]| {
        let near = |place: &[i16; 2]| {
            directions
                .get(node)
                .is_some_and(|&direction| grid.is_near(*place, direction))
        };
        // The prediction is used while its error is within the rounding error of a normal (2.5° at 13 bits): rotations
        // below that precision are not encoded at all.
        halves_of(half, predicted).into_iter().find(near).unwrap_or(place)
    };
    code_places(coder, half, may_miss, places, foresee, settle);
}

/// The places in the cell of a place: itself first, if it is one.
fn halves_of(half: i32, [x, y]: [i16; 2]) -> [[i16; 2]; 2] {
    let inside = |along: i16| i32::from(along).div_euclid(3).clamp(-half, half - 1);
    let (u, v) = (inside(x), inside(y));
    let is_mirrored = (u < 0) != (v < 0);
    let place = |x_third: i32| {
        let y_third = if is_mirrored { 3 - x_third } else { x_third };
        [(3 * u + x_third) as i16, (3 * v + y_third) as i16]
    };
    let is_upper = i32::from(x).rem_euclid(3) == 2;
    [1, 2].map(|third| place(if is_upper { 3 - third } else { third }))
}

#[inline(always)]
fn code_places<C: BitCoder>(
    coder: &mut ValueCoder<'_, C>,
    half: i32,
    may_miss: bool,
    places: &mut [[i16; 2]],
    foresee: impl Fn(usize, &[[i16; 2]]) -> Foreseen,
    settle: impl Fn(usize, [i16; 2], [i16; 2]) -> [i16; 2],
) {
    for node in 0..places.len() {
        let Foreseen {
            place: predicted,
            spread,
            presence,
        } = foresee(node, places);
        if may_miss && coder.flag(presence, places[node] == MISSING) {
            places[node] = MISSING;
            continue;
        }
        let predicted = if predicted == MISSING { [1, 1] } else { predicted };
        let cell = |along: i16| i32::from(along).div_euclid(3);
        let third = |along: i16| i32::from(along).rem_euclid(3) as usize;
        let [u0, v0] = predicted.map(cell);
        let given = if C::DECODES {
            predicted
        } else {
            settle(node, predicted, places[node])
        };
        let [u, v] = given.map(cell);
        let du = coder.signed(ACROSS + spread, u - u0);
        let class = du.unsigned_abs().min(2) as usize;
        let dv = coder.signed(ALONG + 3 * spread + class, v - v0);
        // Damaged bytes may give any number.
        let inside = |along: i32| along.max(-half).min(half - 1);
        let (u, v) = (inside(u0 + du), inside(v0 + dv));
        let is_mirrored = (u < 0) != (v < 0);
        let off = (du.unsigned_abs() + dv.unsigned_abs()).min(2) as usize;
        let context = ((off * 3 + third(predicted[0])) * 3 + third(predicted[1])) * 2 + usize::from(is_mirrored);
        let x_third = 1 + i32::from(coder.flag(HALVES + context, third(given[0]) == 2));
        let y_third = if is_mirrored { 3 - x_third } else { x_third };
        places[node] = [(3 * u + x_third) as i16, (3 * v + y_third) as i16];
    }
}

/// Computes the mean of the normals of the parent and the adjacent nodes, and a class of how far apart they are.
#[inline(always)]
fn mean_around(half: i32, known: &Known, parent: [i16; 2], place_of: impl Fn(usize) -> [i16; 2]) -> ([i16; 2], usize) {
    let mut around = [MISSING; MAX_KNOWN];
    for (place, neighbour) in around.iter_mut().zip(known.adjacent) {
        let is_there = neighbour != NONE;
        // No branch: their number is unpredictable.
        let found = place_of(if is_there { neighbour as usize } else { 0 });
        *place = if is_there { found } else { MISSING };
    }
    let mut first = parent;
    if first == MISSING {
        first = around.into_iter().find(|place| *place != MISSING).unwrap_or(MISSING);
        if first == MISSING {
            return (MISSING, SPREADS - 1);
        }
    }
    let (mut sums, mut weights, mut spread) = ([0i32; 2], 0, 0);
    let mut add = |place: [i16; 2], weight: i32| {
        let offset = [0, 1].map(|axis| i32::from(place[axis]) - i32::from(first[axis]));
        let distance = offset[0].abs().max(offset[1].abs());
        // The border of the square is folded: a neighbour may be on its other side.
        let mask = -i32::from(place != MISSING) & -i32::from(distance < half);
        sums[0] += (weight * offset[0]) & mask;
        sums[1] += (weight * offset[1]) & mask;
        weights += weight & mask;
        spread = spread.max(distance & mask);
    };
    add(parent, 1);
    for place in around {
        add(place, 2);
    }
    let mean = [0, 1].map(|axis| i32::from(first[axis]) + divided(2 * sums[axis] + weights, 2 * weights));
    let class = (32 - (spread as u32 / 2).leading_zeros()).min(SPREADS as u32 - 1) as usize;
    (mean.map(|along| along as i16), class)
}
