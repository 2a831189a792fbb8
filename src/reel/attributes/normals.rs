//! Normals as places on the unfolded octahedron: cells as differences to a prediction, and which half of the cell.

use super::normal_grid::{MISSING, NormalGrid};
use crate::reel::coder::{BitCoder, BitModel, MagnitudeModel, RestModels, divided};
use crate::reel::tree::{Known, NONE};

/// Classes of how far apart the normals around are.
const SPREADS: usize = 8;

/// What is known of what is not predicted.
#[derive(Debug, Clone)]
pub(in crate::reel) struct NormalModels {
    missing: [BitModel; 3],
    across: [MagnitudeModel; SPREADS],
    along: [MagnitudeModel; SPREADS * 3],
    rest: RestModels,
    halves: [BitModel; 3 * 3 * 3 * 2],
}

impl Default for NormalModels {
    fn default() -> Self {
        Self {
            missing: Default::default(),
            across: Default::default(),
            along: Default::default(),
            rest: RestModels::default(),
            halves: [BitModel::default(); 54],
        }
    }
}

/// What is foreseen of a normal.
struct Foreseen {
    /// [`MISSING`] where nothing is.
    place: [i16; 2],
    /// Class of how far apart is what it was foreseen by.
    spread: usize,
    /// How likely it is that there is none: 0 if nothing is foreseen, else 1 or 2.
    presence: usize,
}

/// Codes the normals of a level, each a place of `grid`; or [`MISSING`] if `may_miss`. Those of the level above are
/// `parents`.
pub(in crate::reel) fn code_normals<C: BitCoder>(
    coder: &mut C,
    models: &mut NormalModels,
    grid: &NormalGrid,
    may_miss: bool,
    plan: &[Known],
    parents: &[[i16; 2]],
    places: &mut [[i16; 2]],
) {
    let half = grid.half();
    let foresee = |node: usize, places: &[[i16; 2]]| {
        let known = &plan[node];
        let parent = parents[known.parent as usize];
        let (place, spread) = mean_around(half, known, parent, |neighbour| places[neighbour]);
        Foreseen {
            place,
            spread,
            presence: if place == MISSING {
                0
            } else {
                1 + usize::from(parent != MISSING)
            },
        }
    };
    code_places(coder, models, half, may_miss, places, foresee);
}

/// What is known of the nodes of a level that had normals in the frame before.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) struct Turned<'a> {
    pub(in crate::reel) plan: &'a [Known],
    /// Normals of the level above, in the frame before and in this one.
    pub(in crate::reel) parents: [&'a [[i16; 2]]; 2],
    /// Normals of the frame before.
    pub(in crate::reel) before: &'a [[i16; 2]],
}

/// [`code_normals`] of nodes that had normals in the frame before: each is foreseen to turn as those around it did.
pub(in crate::reel) fn code_turned_normals<C: BitCoder>(
    coder: &mut C,
    models: &mut NormalModels,
    grid: &NormalGrid,
    may_miss: bool,
    Turned { plan, parents, before }: Turned<'_>,
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
    code_places(coder, models, half, may_miss, places, foresee);
}

fn code_places<C: BitCoder>(
    coder: &mut C,
    models: &mut NormalModels,
    half: i32,
    may_miss: bool,
    places: &mut [[i16; 2]],
    foresee: impl Fn(usize, &[[i16; 2]]) -> Foreseen,
) {
    for node in 0..places.len() {
        let Foreseen {
            place: predicted,
            spread,
            presence,
        } = foresee(node, places);
        if may_miss && coder.bit(&mut models.missing[presence], places[node] == MISSING) {
            places[node] = MISSING;
            continue;
        }
        let predicted = if predicted == MISSING { [1, 1] } else { predicted };
        let cell = |along: i16| i32::from(along).div_euclid(3);
        let third = |along: i16| i32::from(along).rem_euclid(3) as usize;
        let [u0, v0] = predicted.map(cell);
        let given = if C::DECODES { predicted } else { places[node] };
        let [u, v] = given.map(cell);
        let du = models.across[spread].code_signed(coder, &mut models.rest, i64::from(u - u0));
        let class = du.unsigned_abs().min(2) as usize;
        let dv = models.along[3 * spread + class].code_signed(coder, &mut models.rest, i64::from(v - v0));
        // What damaged bytes say may be any number.
        let inside = |from: i32, step: i64| {
            (i64::from(from).saturating_add(step)).clamp(-i64::from(half), i64::from(half) - 1) as i32
        };
        let (u, v) = (inside(u0, du), inside(v0, dv));
        let is_mirrored = (u < 0) != (v < 0);
        let off = (du.unsigned_abs() + dv.unsigned_abs()).min(2) as usize;
        let context = ((off * 3 + third(predicted[0])) * 3 + third(predicted[1])) * 2 + usize::from(is_mirrored);
        let x_third = 1 + i32::from(coder.bit(&mut models.halves[context], third(given[0]) == 2));
        let y_third = if is_mirrored { 3 - x_third } else { x_third };
        places[node] = [(3 * u + x_third) as i16, (3 * v + y_third) as i16];
    }
}

/// The mean of what the parent and the nodes beside have, and a class of how far apart that is.
#[inline]
fn mean_around(half: i32, known: &Known, parent: [i16; 2], place_of: impl Fn(usize) -> [i16; 2]) -> ([i16; 2], usize) {
    let mut first = parent;
    let (mut sums, mut weights, mut spread) = ([0i32; 2], 0, 0u32);
    let beside = known.beside.iter().take_while(|&&neighbour| neighbour != NONE);
    let around = beside.map(|&neighbour| (place_of(neighbour as usize), 2));
    for (place, weight) in std::iter::once((parent, 1)).chain(around) {
        if place == MISSING {
            continue;
        }
        if first == MISSING {
            first = place;
        }
        let offset = [0, 1].map(|axis| i32::from(place[axis]) - i32::from(first[axis]));
        let distance = offset[0].unsigned_abs().max(offset[1].unsigned_abs());
        // The border of the square is folded: what is near may be on its other side.
        if distance < half as u32 {
            sums[0] += weight * offset[0];
            sums[1] += weight * offset[1];
            weights += weight;
            spread = spread.max(distance);
        }
    }
    if weights == 0 {
        return (MISSING, SPREADS - 1);
    }
    let mean = [0, 1].map(|axis| i32::from(first[axis]) + divided(2 * sums[axis] + weights, 2 * weights));
    let class = (32 - (spread / 2).leading_zeros()).min(SPREADS as u32 - 1) as usize;
    (mean.map(|along| along as i16), class)
}
