//! Colour coding: how many steps green is off, red off green, and blue off red, since colours change in brightness more
//! than in hue.
//!
//! With a step of 2 e + 1 no channel is wrong by more than e, on any level, since everything is predicted from values
//! as a decoder has them.

use super::blocks::{Kind, Upwards, code_level};
use super::ranges::{NUMBERS, Range, Ranges};
use super::slopes::{OfParents, Slopes};
use crate::reel::coder::SymbolCoder;

/// Ranges of a number of steps: the least, and bits; the last is for all others. One table for levels with hardly any
/// residuals, and one for others, which have a shift.
const NARROW: [(i32, u32); 6] = [(0, 0), (1, 0), (-1, 0), (2, 2), (-5, 2), (-512, 10)];
const WIDE: [(i32, u32); 6] = [(0, 0), (1, 1), (-2, 1), (3, 3), (-10, 3), (-512, 10)];
const COUNT: usize = WIDE.len();
const OTHERS: usize = COUNT - 1;

/// The range that a number of steps is in.
#[inline(always)]
fn range_of(steps: i32, shift: u32) -> usize {
    let Some(shift) = shift.checked_sub(1) else {
        return match steps {
            0 => 0,
            1 => 1,
            -1 => 2,
            2..=5 => 3,
            -5..=-2 => 4,
            _ => OTHERS,
        };
    };
    match (steps + (1 << shift >> 1)) >> shift {
        0 => 0,
        1..=2 => 1,
        -2..=-1 => 2,
        3..=10 => 3,
        -10..=-3 => 4,
        _ => OTHERS,
    }
}

/// One in each lane of a word.
const LANES: u64 = 0x0001_0001_0001_0001;

/// The lanes that green, red and blue move: red, green, blue and alpha, the lowest first.
const INTER: [u64; NUMBERS] = [0x0001_0001_0001, 0x0001_0000_0001, 0x0001_0000_0000];

/// Codes the colours of a level: red, green, blue and 255. None is wrong by more than half of `step`, which is odd.
#[inline(always)]
pub(in crate::reel) fn code_colors<C: SymbolCoder>(
    coder: &mut C,
    upwards: Upwards<'_>,
    parents: &[[u8; 4]],
    colors: &mut [[u8; 4]],
    step: u8,
) {
    code_level(&Colors { step: step.max(1) }, coder, upwards, parents, colors);
}

struct Colors {
    step: u8,
}

/// Returns the predicted value of a channel.
#[inline(always)]
fn expected(parent: u8, slope: i16) -> i32 {
    (i32::from(parent) + i32::from(slope)).clamp(0, 255)
}

impl Colors {
    /// Returns the residual of each number in steps.
    #[inline(always)]
    fn steps(&self, parent: [u8; 4], slope: [i16; 4], [red, green, blue, _]: [u8; 4]) -> [i32; NUMBERS] {
        let step = i32::from(self.step);
        let steps = |channel: usize, off: i32, is: u8| {
            (i32::from(is) - expected(parent[channel], slope[channel]) - off + step / 2).div_euclid(step)
        };
        let of_green = steps(1, 0, green);
        let of_red = steps(0, step * of_green, red);
        [of_green, of_red, steps(2, step * (of_green + of_red), blue)]
    }
}

impl Kind for Colors {
    type Value = [u8; 4];

    fn ranges(&self, shift: u32) -> Ranges {
        let (ranges, shift) = shift.checked_sub(1).map_or((NARROW, 0), |shift| (WIDE, shift));
        let range = |place: usize| match (place, ranges[place]) {
            (OTHERS, (min, bits)) => Range { min, bits },
            (_, (min, bits)) => Range {
                min: (min << shift) - (1 << shift >> 1),
                bits: bits + shift,
            },
        };
        let of = (0..COUNT * COUNT * COUNT)
            .map(move |symbol| [symbol % COUNT, symbol / COUNT % COUNT, symbol / (COUNT * COUNT)].map(range));
        Ranges::new(INTER.map(|lanes| lanes * u64::from(self.step)), LANES << 15, of)
    }

    #[inline(always)]
    fn below(&self, parent: [u8; 4], slope: [i16; 4], word: u64) -> [u8; 4] {
        std::array::from_fn(|lane| {
            let off = (word >> (16 * lane)) as i16;
            (expected(parent[lane], slope[lane]) + i32::from(off)).clamp(0, 255) as u8
        })
    }

    #[inline(always)]
    fn eight_below(
        &self,
        parent: [u8; 4],
        is_coded: bool,
        slopes: Option<&Slopes>,
        words: &[u64; 8],
        below: &mut [[u8; 4]; 8],
    ) {
        let retained = i16::from(is_coded).wrapping_neg();
        for ((below, &word), child) in below.iter_mut().zip(words).zip(0..8) {
            for lane in 0..4 {
                let mut expected = i16::from(parent[lane]);
                if let Some(slopes) = slopes {
                    expected = (expected + (slopes[child][lane] & retained)).clamp(0, 255);
                }
                let off = (word >> (16 * lane)) as i16 & retained;
                below[lane] = expected.saturating_add(off).clamp(0, 255) as u8;
            }
        }
    }

    #[inline(always)]
    fn symbol(&self, parent: [u8; 4], slope: [i16; 4], value: [u8; 4], shift: u32) -> (u8, [i32; NUMBERS]) {
        let steps = self.steps(parent, slope, value);
        let [green, red, blue] = steps.map(|steps| range_of(steps, shift));
        ((green + COUNT * red + COUNT * COUNT * blue) as u8, steps)
    }

    #[inline(always)]
    fn slopes<'a>(slopes: &'a mut OfParents<'_>, parents: &[[u8; 4]]) -> Option<&'a Slopes> {
        Some(slopes.next(parents))
    }
}
