//! Normals as positions on the unfolded octahedron, coded as steps from a position interpolated between the parent's
//! and those across its faces.
//!
//! How it works: positions are interpolated in 64ths of a third of a cell, so that even a finely sampled smooth surface
//! is predicted, to half a cell. Then they are counted in half cells along the first axis, as the two triangles of a
//! cell follow each other there, and in cells along the second one. Both wrap around at the border of the square, so
//! every number is a position. A small step along both is one symbol. On finer grids the lowest bits of a step are
//! written verbatim.

use super::families::{Above, Families, Family, across, across_bits, of_counts, of_masks};
use crate::reel::attributes::{MISSING, NormalGrid};
use crate::reel::coder::SymbolCoder;
use crate::reel::tree::{Faces, NONE};

/// Classes of the spread of the parents around; the last is that the parent has no normal.
const CLASSES: u8 = 8;
const MAX_SPREAD: u8 = CLASSES - 2;

/// Contexts: for each class, and the half of the cell that is foreseen; and nodes outside.
const OUTSIDE: u8 = 2 * CLASSES;

/// Contexts of normals.
pub(in crate::reel) const NORMAL_CONTEXTS: usize = OUTSIDE as usize + 1;

/// Maximum step that is a symbol, and the number of those along an axis.
const MAX_STEP: i32 = 7;
const STEPS: i32 = 2 * MAX_STEP + 1;

/// Symbols of a position that is written verbatim, and of a missing normal.
const PLACE: u8 = (STEPS * STEPS) as u8;
const NO_NORMAL: u8 = PLACE + 1;

/// For each symbol the steps along both axes.
static STEPS_OF: [[i8; 2]; 256] = steps();

const fn steps() -> [[i8; 2]; 256] {
    let mut table = [[0; 2]; 256];
    let mut symbol = 0;
    while symbol < STEPS * STEPS {
        table[symbol as usize] = [(symbol % STEPS - MAX_STEP) as i8, (symbol / STEPS - MAX_STEP) as i8];
        symbol += 1;
    }
    table
}

/// A node across a face that is so far from the parent, in thirds of a cell of the coarsest grid, carries no
/// information.
const FAR: i32 = 18;

/// Parts of a third that places are interpolated in, and of a cell.
const PARTS: i32 = 64;
const CELL: i32 = 3 * PARTS;

/// Upper bound of the distance of any position from the centre, in cells.
const OUTMOST: i32 = 1 << 9;

/// Factor of the sum of their steps from the parent, for each number of faces.
const WEIGHTS: [i32; 4] = [32, 21, 16, 13];

/// Bits of a normal of the coarsest grid.
const COARSEST_BITS: u8 = 13;

/// A number around zero, modulo this number of steps, a power of two.
#[inline(always)]
fn around(number: i32, steps: i32) -> i32 {
    ((number + steps / 2) & (steps - 1)) - steps / 2
}

/// A place, in half cells and cells.
#[inline(always)]
fn halves([x, y]: [i16; 2]) -> [i32; 2] {
    let [x, y] = [x, y].map(i32::from);
    [2 * x.div_euclid(3) + i32::from(x.rem_euclid(3) == 2), y.div_euclid(3)]
}

/// The inverse of [`halves`].
#[inline(always)]
fn place_of([x, y]: [i32; 2]) -> [i16; 2] {
    let upper = x & 1;
    let u = x >> 1;
    // The diagonals differ between quadrants.
    let is_mirrored = (u < 0) != (y < 0);
    [
        (3 * u + 1 + upper) as i16,
        (3 * y + 1 + (upper ^ i32::from(is_mirrored))) as i16,
    ]
}

/// The half cell that a point is in, in parts.
#[inline(always)]
fn half_at([x, y]: [i32; 2]) -> [i32; 2] {
    // Relative to a corner outside the square: unsigned numbers are divided faster.
    let [u, v] = [x, y].map(|along| ((along + OUTMOST * CELL) as u32 / CELL as u32) as i32 - OUTMOST);
    let (across, along) = (x - CELL * u, y - CELL * v);
    let is_mirrored = (u < 0) != (v < 0);
    let is_upper = if is_mirrored {
        across > along
    } else {
        across + along > CELL
    };
    [2 * u + i32::from(is_upper), v]
}

/// Codes the normals of a level, each a position on a grid of this many bits, or [`MISSING`]. The normals of the level
/// above are `parents`.
#[inline(always)]
pub(in crate::reel) fn code_normals<C: SymbolCoder>(
    coder: &mut C,
    bits: u8,
    above: Above<'_>,
    parents: &[[i16; 2]],
    normals: &mut [[i16; 2]],
) {
    let level = Level {
        faces: above.faces,
        parents,
        half: NormalGrid::of(bits).half(),
        finer: u32::from(bits - COARSEST_BITS) / 2,
    };
    match above.families {
        Families::Masks(masks) => level.code(coder, of_masks(masks), normals),
        Families::Counts(counts, outside) => level.code(coder, of_counts(counts, outside), normals),
    }
}

/// State of a level known before it is coded.
struct Level<'a> {
    faces: &'a [Faces],
    parents: &'a [[i16; 2]],
    /// Cells along half the square.
    half: i32,
    /// Number of times its cells halve those of the coarsest grid.
    finer: u32,
}

/// Contexts of coded nodes, and the half cells in which they are predicted.
#[derive(Default)]
struct Foreseen {
    contexts: Vec<u8>,
    places: Vec<[i16; 2]>,
}

impl Level<'_> {
    #[inline(always)]
    fn code<C: SymbolCoder>(
        &self,
        coder: &mut C,
        families: impl Iterator<Item = Family> + Clone,
        normals: &mut [[i16; 2]],
    ) {
        // A local copy, not a reference: its state stays in registers.
        let mut own = std::mem::take(coder);
        let Foreseen { contexts, places } = self.foresee(families.clone(), normals.len());
        let mut symbols = vec![0; contexts.len()];
        if C::DECODES {
            own.symbols(&contexts, &mut symbols);
        }
        let mut told = symbols.iter_mut().zip(places);
        let mut left = normals;
        let mut last_outside = self.parents.first().copied().unwrap_or(MISSING);
        for family in families {
            let count = family.count.min(left.len());
            let children;
            (children, left) = left.split_at_mut(count);
            let Some(&parent) = self.parents.get(family.parent) else {
                break;
            };
            if family.is_clear() {
                children.fill(parent);
                continue;
            }
            for (normal, (symbol, foreseen)) in children.iter_mut().zip(&mut told) {
                let mut foreseen = foreseen.map(i32::from);
                if family.is_outside {
                    foreseen = halves(if last_outside == MISSING { [1; 2] } else { last_outside });
                }
                self.tell(&mut own, normal, symbol, foreseen);
                if family.is_outside {
                    last_outside = *normal;
                }
            }
        }
        drop(told);
        if !C::DECODES {
            own.symbols(&contexts, &mut symbols);
        }
        *coder = own;
    }

    #[inline(always)]
    fn tell<C: SymbolCoder>(&self, coder: &mut C, normal: &mut [i16; 2], symbol: &mut u8, foreseen: [i32; 2]) {
        let periods = [4 * self.half, 2 * self.half];
        // As many bits as needed for the half cells along the first axis; one less along the second one.
        let bits = periods.map(|period| (period as u32).ilog2());
        if !C::DECODES {
            *symbol = self.write(coder, *normal, foreseen);
        }
        if *symbol == NO_NORMAL {
            *normal = MISSING;
            return;
        }
        if !C::DECODES {
            return;
        }
        let is = if *symbol == PLACE {
            let told = bits.map(|bits| coder.raw(bits, 0) as i32);
            [0, 1].map(|axis| told[axis] - periods[axis] / 2)
        } else {
            let steps = STEPS_OF[usize::from(*symbol)].map(|step| i32::from(step) << self.finer);
            let below = if self.finer == 0 {
                0
            } else {
                coder.raw(2 * self.finer, 0) as i32
            };
            let below = [below & ((1 << self.finer) - 1), below >> self.finer];
            [0, 1].map(|axis| around(foreseen[axis] + (steps[axis] | below[axis]), periods[axis]))
        };
        *normal = place_of(is);
    }

    /// The symbol of a normal; writes the bits it leaves open.
    fn write<C: SymbolCoder>(&self, coder: &mut C, normal: [i16; 2], foreseen: [i32; 2]) -> u8 {
        if normal == MISSING {
            return NO_NORMAL;
        }
        let periods = [4 * self.half, 2 * self.half];
        let is = halves(normal);
        let off = [0, 1].map(|axis| around(is[axis] - foreseen[axis], periods[axis]));
        let steps = off.map(|off| off >> self.finer);
        if steps.iter().any(|step| step.abs() > MAX_STEP) {
            for (along, period) in is.into_iter().zip(periods) {
                coder.raw((period as u32).ilog2(), (along + period / 2) as u32);
            }
            return PLACE;
        }
        if self.finer > 0 {
            let below = off.map(|off| off as u32 & ((1 << self.finer) - 1));
            coder.raw(2 * self.finer, below[0] | below[1] << self.finer);
        }
        (steps[0] + MAX_STEP + STEPS * (steps[1] + MAX_STEP)) as u8
    }

    /// All predictions of a level.
    #[inline(always)]
    fn foresee(&self, families: impl Iterator<Item = Family>, nodes: usize) -> Foreseen {
        let mut foreseen = Foreseen {
            contexts: Vec::with_capacity(nodes),
            places: Vec::with_capacity(nodes),
        };
        for family in families {
            if family.is_outside {
                foreseen.contexts.push(OUTSIDE);
                foreseen.places.push([0; 2]);
            } else if family.count > 1 {
                self.foresee_family(family, &mut foreseen);
            }
        }
        foreseen
    }

    #[inline(always)]
    fn foresee_family(&self, family: Family, foreseen: &mut Foreseen) {
        let mut add = |class: u8, at: [i32; 2]| {
            let place = half_at(at);
            foreseen.contexts.push(2 * class + (place[0] & 1) as u8);
            foreseen.places.push(place.map(|along| along as i16));
        };
        let own = match self.parents.get(family.parent) {
            Some(&own) if own != MISSING => own.map(i32::from),
            _ => {
                (0..family.count).for_each(|_| add(CLASSES - 1, [PARTS; 2]));
                return;
            }
        };
        let (mut spread, mut near, mut steps) = (0, 0u32, [[0; 2]; 6]);
        for (face, other) in family.faces(self.faces).into_iter().enumerate() {
            // No branch: it would be unpredictable.
            let is_there = other != NONE;
            let place = self.parents[if is_there { other as usize } else { 0 }];
            let is_there = is_there && place != MISSING;
            let step = [0, 1].map(|axis| i32::from(place[axis]) - own[axis]);
            let distance = step[0].abs().max(step[1].abs());
            // The border of the square is folded: a neighbour may be on its other side.
            let is_outside = is_there && distance < 3 * self.half;
            spread |= if is_outside { distance } else { 0 };
            let is_near = is_there && distance < FAR << self.finer;
            near |= u32::from(is_near) << face;
            steps[face] = step.map(|along| if is_near { along } else { 0 });
        }
        let class = (u32::BITS - (spread as u32 >> self.finer).leading_zeros()).min(u32::from(MAX_SPREAD)) as u8;
        let at = own.map(|along| PARTS * along);
        if family.mask == 0 {
            (0..family.count).for_each(|_| add(class, at));
            return;
        }
        let mut octants = family.mask;
        while octants != 0 {
            let octant = octants.trailing_zeros() as usize;
            octants &= octants - 1;
            let [a, b, c] = across(octant).map(|face| steps[face]);
            let weight = WEIGHTS[(near & across_bits(octant)).count_ones() as usize];
            let [x, y] = [a[0] + b[0] + c[0], a[1] + b[1] + c[1]];
            add(class, [at[0] + x * weight, at[1] + y * weight]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_places_round_trip() {
        for bits in [13, 15, 17] {
            let grid = NormalGrid::of(bits);
            for index in 0..1 << bits {
                let place = grid.place(index);
                assert_eq!(place_of(halves(place)), place);
                assert_eq!(half_at(place.map(|along| PARTS * i32::from(along))), halves(place));
            }
        }
    }
}
