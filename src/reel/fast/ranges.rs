//! Numbers as a symbol and raw bits: the symbol selects the range of each of up to three numbers, and the bits the
//! position in it.
//!
//! How it works: a decoder always needs a multiple of a number, in some lanes of a word. So a symbol has a word for the
//! least numbers of its ranges, and the factors of the bits are the same for all symbols: three products and sums,
//! whatever the numbers mean, and no branch. Ranges grow with the *shift* of a level, the number of bits of each number
//! that are written verbatim.

use crate::reel::coder::SymbolCoder;

/// Numbers that a symbol may have ranges of.
pub(super) const NUMBERS: usize = 3;

/// The range of a number: its least one, and the number of bits that select one in it, for the first two numbers at
/// most 16.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Range {
    pub(super) min: i32,
    pub(super) bits: u32,
}

/// Decoded meaning of a symbol.
#[derive(Debug, Clone, Copy, Default)]
struct Symbol {
    /// Word of the least numbers.
    word: u64,
    /// The first two numbers among the bits, and where the second and the third begin.
    masks: [u16; 2],
    starts: [u8; 2],
    /// Number of bits.
    bits: u8,
}

/// Ranges of all symbols.
#[derive(Debug)]
pub(super) struct Ranges {
    symbols: Box<[Symbol; 256]>,
    factors: [u64; NUMBERS],
    /// XOR mask applied to the word at the end.
    flipped: u64,
    min: Vec<[i32; NUMBERS]>,
}

impl Ranges {
    /// Builds the table from the ranges of symbols from 0 on; other symbols are 0 and have no bits. A number counts as
    /// often as its factor says. `flipped` is added to all words before bits are, and removed at the end, as lanes
    /// require it.
    pub(super) fn new(factors: [u64; NUMBERS], flipped: u64, of: impl Iterator<Item = [Range; NUMBERS]>) -> Self {
        let mut symbols = Box::new([Symbol::default(); 256]);
        let mut min = Vec::with_capacity(256);
        for (symbol, ranges) in symbols.iter_mut().zip(of) {
            let words = ranges.iter().zip(factors);
            symbol.word = words.fold(flipped, |sum, (range, factor)| {
                sum.wrapping_add((i64::from(range.min) as u64).wrapping_mul(factor))
            });
            let [first, second, third] = ranges.map(|range| range.bits);
            symbol.masks = [first, second].map(|bits| ((1u32 << bits) - 1) as u16);
            symbol.starts = [first as u8, (first + second) as u8];
            symbol.bits = (first + second + third) as u8;
            min.push(ranges.map(|range| range.min));
        }
        Self {
            symbols,
            factors,
            flipped,
            min,
        }
    }

    /// Returns the number of bits that follow a symbol.
    pub(super) fn bits(&self, symbol: u8) -> u64 {
        u64::from(self.symbols[usize::from(symbol)].bits)
    }

    /// The word of a symbol that was read.
    #[inline(always)]
    pub(super) fn read<C: SymbolCoder>(&self, coder: &mut C, symbol: u8) -> u64 {
        let symbol = &self.symbols[usize::from(symbol)];
        self.word(symbol, coder.raw(u32::from(symbol.bits), 0))
    }

    #[inline(always)]
    fn word(&self, symbol: &Symbol, bits: u32) -> u64 {
        let parts = [
            bits & u32::from(symbol.masks[0]),
            bits >> symbol.starts[0] & u32::from(symbol.masks[1]),
            bits >> symbol.starts[1],
        ];
        let words = parts.into_iter().zip(self.factors);
        let sum = words.fold(symbol.word, |sum, (part, factor)| {
            sum.wrapping_add(u64::from(part).wrapping_mul(factor))
        });
        sum ^ self.flipped
    }

    /// Writes the bits of numbers that are in the ranges of a symbol; the word that a decoder has of them.
    pub(super) fn write<C: SymbolCoder>(&self, coder: &mut C, symbol: u8, numbers: [i32; NUMBERS]) -> u64 {
        let min = self.min.get(usize::from(symbol)).copied().unwrap_or_default();
        let symbol = &self.symbols[usize::from(symbol)];
        let [first, second, third] = [0, 1, 2].map(|number| numbers[number].wrapping_sub(min[number]) as u32);
        let bits = first | second << symbol.starts[0] | third << symbol.starts[1];
        let bits = (u64::from(bits) & ((1 << symbol.bits) - 1)) as u32;
        coder.raw(u32::from(symbol.bits), bits);
        self.word(symbol, bits)
    }
}
