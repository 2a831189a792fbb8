//! Single numbers: alpha, radii, scalars.

use super::blocks::{Kind, Upwards, code_level};
use super::ranges::{NUMBERS, Range, Ranges};
use super::slopes::{OfParents, Slopes};
use crate::reel::coder::SymbolCoder;

/// Differences of at most so much are symbols.
const MAX: i32 = 127;

/// The symbol of others, and their number of bits.
const FAR: u8 = 255;
const FAR_RANGE: Range = Range {
    min: -(1 << 16),
    bits: 17,
};

/// Codes the single numbers of a level, at most `max`.
#[inline(always)]
pub(in crate::reel) fn code_singles<C: SymbolCoder>(
    coder: &mut C,
    upwards: Upwards<'_>,
    parents: &[[u16; 1]],
    values: &mut [[u16; 1]],
    max: u16,
) {
    code_level(&Singles { max }, coder, upwards, parents, values);
}

struct Singles {
    max: u16,
}

impl Kind for Singles {
    type Value = [u16; 1];

    fn ranges(&self, shift: u32) -> Ranges {
        // The third number may have more bits than the others.
        let one = |range: Range| [Range::default(), Range::default(), range];
        let near = (-MAX..=MAX).map(move |difference| {
            one(Range {
                min: (difference << shift) - (1 << shift >> 1),
                bits: shift,
            })
        });
        Ranges::new([0, 0, 1], 0, near.chain(std::iter::once(one(FAR_RANGE))))
    }

    #[inline(always)]
    fn below(&self, [parent]: [u16; 1], _: [i16; 4], word: u64) -> [u16; 1] {
        [i32::from(parent)
            .wrapping_add(word as i32)
            .clamp(0, i32::from(self.max)) as u16]
    }

    #[inline(always)]
    fn eight_below(
        &self,
        [parent]: [u16; 1],
        is_coded: bool,
        _: Option<&Slopes>,
        words: &[u64; 8],
        below: &mut [[u16; 1]; 8],
    ) {
        let retained = i32::from(is_coded).wrapping_neg();
        for (below, &word) in below.iter_mut().zip(words) {
            let is = i32::from(parent).wrapping_add(word as i32 & retained);
            *below = [is.clamp(0, i32::from(self.max)) as u16];
        }
    }

    #[inline(always)]
    fn symbol(&self, [parent]: [u16; 1], _: [i16; 4], [value]: [u16; 1], shift: u32) -> (u8, [i32; NUMBERS]) {
        let difference = i32::from(value) - i32::from(parent);
        let near = (difference + (1 << shift >> 1)) >> shift;
        let symbol = if near.abs() <= MAX { (near + MAX) as u8 } else { FAR };
        (symbol, [0, 0, difference])
    }

    #[inline(always)]
    fn slopes<'a>(_: &'a mut OfParents<'_>, _: &[[u16; 1]]) -> Option<&'a Slopes> {
        None
    }
}
