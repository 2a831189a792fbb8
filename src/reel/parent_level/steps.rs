//! Whole numbers of a node as one symbol, and bits that stand for themselves.
//!
//! How it works: for three channels the symbol gives the number of bits of each number; the bits themselves, and the
//! sign, are equally likely either way. So one look-up replaces three, and numbers that are small together cost little
//! together. For a single channel the symbol is the number itself.

use crate::reel::coder::SymbolCoder;

/// Bit length from which on numbers share one kind, with eight raw bits.
const MAX_BITS: u32 = 5;

/// Kinds of a number.
const KINDS: usize = MAX_BITS as usize + 1;

/// Raw bits of a number of each kind: its sign, and those below its highest bit.
const TOLD: [u32; KINDS] = [0, 1, 2, 3, 4, 9];

/// The least number of each kind.
const MIN: [i32; KINDS] = [0, 1, 2, 4, 8, 16];

/// The largest number.
const MAX: u32 = MIN[KINDS - 1] as u32 + (1 << (TOLD[KINDS - 1] - 1)) - 1;

/// The symbol of larger single numbers.
const ESCAPE: u8 = 255;

/// Bits of such a number.
const ESCAPED_BITS: u32 = 18;

/// Table that maps each symbol to the kinds of three numbers, 4 bits each, and above 16 bits the number of raw bits.
static KINDS_OF: [u32; 256] = kinds();

const fn kinds() -> [u32; 256] {
    let mut table = [0; 256];
    let mut symbol = 0;
    while symbol < KINDS * KINDS * KINDS {
        let of = [symbol % KINDS, symbol / KINDS % KINDS, symbol / (KINDS * KINDS)];
        let told = TOLD[of[0]] + TOLD[of[1]] + TOLD[of[2]];
        table[symbol] = told << 16 | (of[0] | of[1] << 4 | of[2] << 8) as u32;
        symbol += 1;
    }
    table
}

/// The steps that a symbol begins. Precondition: one channel or three.
#[inline(always)]
pub(super) fn read<C: SymbolCoder, const N: usize>(coder: &mut C, symbol: u8) -> [i32; N] {
    if N == 1 {
        let folded = if symbol == ESCAPE {
            coder.raw(ESCAPED_BITS, 0)
        } else {
            u32::from(symbol)
        };
        return [(folded >> 1) as i32 ^ -((folded & 1) as i32); N];
    }
    let kinds = KINDS_OF[usize::from(symbol)];
    let mut bits = coder.raw(kinds >> 16, 0);
    std::array::from_fn(|channel| {
        let kind = (kinds >> (4 * channel) & 15) as usize % KINDS;
        let told = bits & ((1 << TOLD[kind]) - 1);
        bits >>= TOLD[kind];
        let magnitude = MIN[kind] + (told >> 1) as i32;
        let sign = (told & 1) as i32;
        (magnitude ^ -sign) + sign
    })
}

/// The symbol of steps; writes the bits it leaves open.
pub(super) fn write<C: SymbolCoder, const N: usize>(coder: &mut C, steps: [i32; N]) -> u8 {
    if N == 1 {
        let folded = (steps[0] << 1 ^ steps[0] >> 31) as u32;
        if folded >= u32::from(ESCAPE) {
            coder.raw(ESCAPED_BITS, folded);
        }
        return folded.min(u32::from(ESCAPE)) as u8;
    }
    let (mut symbol, mut place, mut bits, mut told) = (0, 1, 0, 0);
    for step in steps {
        let magnitude = step.unsigned_abs().min(MAX);
        let kind = (u32::BITS - magnitude.leading_zeros()).min(MAX_BITS) as usize;
        symbol += place * kind;
        place *= KINDS;
        let of_step = (magnitude - MIN[kind] as u32) << 1 | u32::from(step < 0);
        bits |= of_step << told;
        told += TOLD[kind];
    }
    coder.raw(told, bits);
    symbol as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reel::coder::{SymbolDecoder, SymbolEncoder};
    use proptest::prelude::*;

    fn come_back<const N: usize>(all: &[[i32; N]]) {
        let mut encoder = SymbolEncoder::new(1);
        let mut symbols: Vec<u8> = all.iter().map(|&steps| write(&mut encoder, steps)).collect();
        let contexts = vec![0; symbols.len()];
        encoder.symbols(&contexts, &mut symbols);
        let bytes = encoder.finish();
        let mut decoder = SymbolDecoder::new(&bytes, 1).unwrap();
        decoder.symbols(&contexts, &mut symbols);
        for (&symbol, steps) in symbols.iter().zip(all) {
            assert_eq!(read::<_, N>(&mut decoder, symbol), *steps);
        }
        assert!(decoder.is_at_end());
    }

    proptest! {
        #[test]
        fn steps_round_trip(small in prop::collection::vec([-3..4i32, -20..20, -255..256], 1..50),
            one in prop::collection::vec((-(1 << 16)..1 << 16).prop_map(|step| [step]), 1..20)) {
            come_back(&small);
            come_back(&one);
        }
    }
}
