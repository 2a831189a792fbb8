//! A binary range coder with a state of 64 bits.
//!
//! How it works: the bits so far are an interval of numbers; each bit takes the part of it given by its probability
//! (Martin 1979). The lower end is held in 64 bits, the upper 32 of which are written whenever the interval is shorter
//! than 2³²; a carry is added to the words written. The decoder holds the distance of the number read above the lower
//! end.

use super::bit_model::{BitModel, PROBABILITY_BITS};

/// Even bits that are coded in one step.
const MAX_EVEN_BITS: u32 = 16;

/// Codes bits in one direction or the other.
// Own implementation: `constriction` has a range coder, but models distributions that are known in advance. Each bit
// has its own probability here, and most of the code is the modelling, which it would not save.
pub(in crate::reel) trait BitCoder: Default {
    /// True for a decoder: bits are read, and the bits passed in have no meaning.
    const DECODES: bool;

    /// Codes a bit of this probability (of a set one, in 2⁻¹⁶, neither 0 nor 1): the one given, or the one read.
    fn bit_of(&mut self, probability: u32, bit: bool) -> bool;

    /// Codes a bit by its model, which sees it.
    #[inline(always)]
    // One set of functions for both directions, so that encoder and decoder always agree: they continue with the
    // returned bit, the one that a decoder sees.
    fn bit(&mut self, model: &mut BitModel, bit: bool) -> bool {
        let bit = self.bit_of(model.probability(), bit);
        model.see(bit);
        bit
    }

    /// Codes a number below 2ᵇ, b at most [`MAX_EVEN_BITS`], all of them equally likely.
    fn few_even_bits(&mut self, bits: u32, value: u64) -> u64;

    /// Codes the lowest `bits` bits of a number, all equally likely.
    #[inline]
    fn even_bits(&mut self, bits: u32, value: u64) -> u64 {
        let (mut coded, mut left) = (0, bits);
        while left > 0 {
            let some = left.min(MAX_EVEN_BITS);
            left -= some;
            coded = coded << some | self.few_even_bits(some, value >> left & ((1 << some) - 1));
        }
        coded
    }
}

/// Writes bits.
#[derive(Debug)]
pub(in crate::reel) struct RangeEncoder {
    words: Vec<u32>,
    low: u64,
    range: u64,
}

impl Default for RangeEncoder {
    fn default() -> Self {
        Self {
            words: Vec::new(),
            low: 0,
            range: u64::MAX,
        }
    }
}

/// Adds one to the last of some words.
#[cold]
fn carry(words: &mut [u32]) {
    for word in words.iter_mut().rev() {
        let (next, overflows) = word.overflowing_add(1);
        *word = next;
        if !overflows {
            break;
        }
    }
}

impl RangeEncoder {
    #[inline(always)]
    fn refill(&mut self) {
        if self.range < 1 << 32 {
            self.words.push((self.low >> 32) as u32);
            self.low <<= 32;
            self.range <<= 32;
        }
    }

    /// All bytes: the shortest that name a number in the interval.
    pub(in crate::reel) fn finish(mut self) -> Vec<u8> {
        // The number in the interval with the most trailing zeros.
        let last = self.low.wrapping_add(self.range - 1);
        let has_carried = last < self.low;
        let number = if self.low == 0 {
            0
        } else if has_carried {
            carry(&mut self.words);
            0
        } else {
            let differing = 63 - (self.low ^ last).leading_zeros().min(63);
            let rounded = last >> differing << differing;
            if rounded >= self.low { rounded } else { last }
        };
        let mut bytes: Vec<u8> = self.words.iter().flat_map(|word| word.to_be_bytes()).collect();
        // No word is dropped, even if it is 0: the number of bytes bounds the number of bits.
        let min = bytes.len();
        bytes.extend(number.to_be_bytes());
        while bytes.len() > min && bytes.last() == Some(&0) {
            bytes.pop();
        }
        bytes
    }
}

impl BitCoder for RangeEncoder {
    const DECODES: bool = false;

    #[inline(always)]
    fn bit_of(&mut self, probability: u32, bit: bool) -> bool {
        let bound = (self.range >> PROBABILITY_BITS) * u64::from(probability);
        let unset = u64::from(bit).wrapping_sub(1);
        let (low, carries) = self.low.overflowing_add(bound & unset);
        self.low = low;
        self.range = bound ^ ((bound ^ (self.range - bound)) & unset);
        if carries {
            carry(&mut self.words);
        }
        self.refill();
        bit
    }

    #[inline]
    fn few_even_bits(&mut self, bits: u32, value: u64) -> u64 {
        let step = self.range >> bits;
        let (low, carries) = self.low.overflowing_add(step * value);
        self.low = low;
        self.range = step;
        if carries {
            carry(&mut self.words);
        }
        self.refill();
        value
    }
}

/// The word behind the last whole one. The decoder is not lent for it, so that it stays in registers.
#[cold]
fn last_word(bytes: &[u8], next: usize) -> u32 {
    let mut word = [0; 4];
    let rest = bytes.get(next..).unwrap_or_default();
    word[..rest.len()].copy_from_slice(rest);
    u32::from_be_bytes(word)
}

/// Range decoder that reads bits. Behind the last byte are zeros; reading on is detected by
/// [`RangeDecoder::has_overrun`].
#[derive(Debug)]
pub(in crate::reel) struct RangeDecoder<'a> {
    bytes: &'a [u8],
    /// The next word begins here.
    next: usize,
    above_low: u64,
    range: u64,
}

impl Default for RangeDecoder<'_> {
    /// Creates a decoder of no bytes.
    fn default() -> Self {
        Self::new(&[])
    }
}

impl<'a> RangeDecoder<'a> {
    pub(in crate::reel) fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self {
            bytes,
            next: 0,
            above_low: 0,
            range: u64::MAX,
        };
        decoder.above_low = u64::from(decoder.word()) << 32;
        decoder.above_low |= u64::from(decoder.word());
        decoder
    }

    #[inline]
    fn word(&mut self) -> u32 {
        let word = match self.bytes.get(self.next..self.next + 4) {
            Some(&[a, b, c, d]) => u32::from_be_bytes([a, b, c, d]),
            _ => last_word(self.bytes, self.next),
        };
        self.next += 4;
        word
    }

    #[inline(always)]
    fn refill(&mut self) {
        if self.range < 1 << 32 {
            self.above_low = self.above_low << 32 | u64::from(self.word());
            self.range <<= 32;
        }
    }

    /// Returns true if more was read than an encoder ever wrote: the bytes are not all there, or not those that were
    /// written.
    pub(in crate::reel) fn has_overrun(&self) -> bool {
        self.next > self.bytes.len() + 8 + 3
    }
}

impl BitCoder for RangeDecoder<'_> {
    const DECODES: bool = true;

    #[inline(always)]
    fn bit_of(&mut self, probability: u32, _: bool) -> bool {
        let bound = (self.range >> PROBABILITY_BITS) * u64::from(probability);
        let bit = self.above_low < bound;
        // No branch: half of the bits would be mispredicted.
        let unset = u64::from(bit).wrapping_sub(1);
        self.above_low -= bound & unset;
        self.range = bound ^ ((bound ^ (self.range - bound)) & unset);
        self.refill();
        bit
    }

    #[inline]
    fn few_even_bits(&mut self, bits: u32, _: u64) -> u64 {
        let step = self.range >> bits;
        // The last interval extends to the end.
        let value = (self.above_low / step).min((1 << bits) - 1);
        self.above_low -= step * value;
        self.range = step;
        self.refill();
        value
    }
}
