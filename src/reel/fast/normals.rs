//! Normals as triangles of the unfolded octahedron: half cells along its first axis, cells along the second one, in the
//! two halves of a word. Both go around at the border of the square, so every sum is a triangle.

use super::blocks::{Kind, Upwards, code_level};
use super::ranges::{NUMBERS, Range, Ranges};
use super::slopes::{OfParents, Slopes};
use crate::reel::coder::SymbolCoder;

/// A node without a normal.
pub(in crate::reel) const NO_NORMAL: u32 = 1 << 31;

/// Bit offset of the second axis.
const SECOND: u32 = 16;

/// Maximum step that is a symbol, and the number of those along an axis.
const MAX_STEP: i32 = 7;
const STEPS: i32 = 2 * MAX_STEP + 1;

/// Symbols of a step that is written verbatim, and of a missing normal.
const FAR: u8 = (STEPS * STEPS) as u8;
const NONE: u8 = FAR + 1;

/// Codes the normals of a level, triangles of a grid of `bits` bits: the first axis from bit 0 on, the second one from
/// bit 16 on; or [`NO_NORMAL`].
#[inline(always)]
pub(in crate::reel) fn code_normals<C: SymbolCoder>(
    coder: &mut C,
    bits: u8,
    upwards: Upwards<'_>,
    parents: &[u32],
    normals: &mut [u32],
) {
    let level = u32::from(bits.clamp(13, 17) - 3) / 2;
    let kind = Normals {
        bits: [level + 2, level + 1],
    };
    code_level(&kind, coder, upwards, parents, normals);
}

struct Normals {
    /// Bits of each axis.
    bits: [u32; 2],
}

impl Normals {
    /// Returns the bit mask that a word is reduced to.
    #[inline(always)]
    fn mask(&self) -> u32 {
        let [first, second] = self.bits.map(|bits| (1 << bits) - 1);
        first | second << SECOND | NO_NORMAL
    }

    /// The steps from a parent that has a normal, within half of a wrap.
    #[inline(always)]
    fn steps(&self, parent: u32, normal: u32) -> [i32; 2] {
        let from = if parent & NO_NORMAL == 0 { parent } else { 0 };
        [0, 1].map(|axis| {
            let around = 1 << self.bits[axis];
            let step = |word: u32| (word >> (SECOND * axis as u32) & 0xffff & (around as u32 - 1)) as i32;
            ((step(normal) - step(from) + around / 2) & (around - 1)) - around / 2
        })
    }
}

impl Kind for Normals {
    type Value = u32;

    fn ranges(&self, shift: u32) -> Ranges {
        let near = (0..STEPS * STEPS).map(move |symbol| {
            let along = |step: i32, axis: usize| Range {
                min: ((step - MAX_STEP) << shift).rem_euclid(1 << self.bits[axis]),
                bits: shift,
            };
            [along(symbol % STEPS, 0), along(symbol / STEPS, 1), Range::default()]
        });
        let far = self.bits.map(|bits| Range { min: 0, bits });
        let none = Range {
            min: 1 << (31 - SECOND),
            bits: 0,
        };
        let of = near
            .chain(std::iter::once([far[0], far[1], Range::default()]))
            .chain(std::iter::once([Range::default(), none, Range::default()]));
        Ranges::new([1, 1 << SECOND, 0], 0, of)
    }

    #[inline(always)]
    fn below(&self, parent: u32, _: [i16; 4], word: u64) -> u32 {
        let from = if parent & NO_NORMAL == 0 { parent } else { 0 };
        from.wrapping_add(word as u32) & self.mask()
    }

    #[inline(always)]
    fn eight_below(&self, parent: u32, is_coded: bool, _: Option<&Slopes>, words: &[u64; 8], below: &mut [u32; 8]) {
        let from = if parent & NO_NORMAL == 0 || !is_coded {
            parent
        } else {
            0
        };
        let retained = u32::from(is_coded).wrapping_neg();
        let mask = self.mask();
        for (below, &word) in below.iter_mut().zip(words) {
            *below = from.wrapping_add(word as u32 & retained) & mask;
        }
    }

    #[inline(always)]
    fn symbol(&self, parent: u32, _: [i16; 4], normal: u32, shift: u32) -> (u8, [i32; NUMBERS]) {
        if normal & NO_NORMAL != 0 {
            return (NONE, [0; NUMBERS]);
        }
        let steps = self.steps(parent, normal);
        let [first, second] = steps.map(|step| step >> shift);
        // The wrapped step is the start of a range.
        let [along, across] = [0, 1].map(|axis| steps[axis] & ((1 << self.bits[axis]) - 1));
        if first.abs().max(second.abs()) > MAX_STEP {
            return (FAR, [along, across, 0]);
        }
        let symbol = (first + MAX_STEP) + STEPS * (second + MAX_STEP);
        (symbol as u8, [along, across, 0])
    }

    #[inline(always)]
    // None: with slopes, normals took 3.6 bits instead of 3.7.
    fn slopes<'a>(_: &'a mut OfParents<'_>, _: &[u32]) -> Option<&'a Slopes> {
        None
    }
}
