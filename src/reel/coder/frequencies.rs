//! Symbol frequencies of a static coder: a table of 256 entries in integer parts of 4096.

use super::number::{MagnitudeModel, RestModels};
use super::range::BitCoder;
use crate::reel::error::Fault;

/// Symbols of an alphabet.
pub(in crate::reel) const SYMBOLS: usize = 256;

/// Bits of a frequency.
pub(in crate::reel) const SCALE_BITS: u32 = 12;

/// Sum of the frequencies of a table.
pub(in crate::reel) const SCALE: u32 = 1 << SCALE_BITS;

/// No symbol is more frequent, so that each costs something: bytes bound the number of symbols.
const MAX_FREQUENT: u32 = SCALE - 8;

/// Fractional bits of a logarithm.
pub(in crate::reel) const LOG_BITS: u32 = 16;

/// Approximate size in a file of a symbol entry of a table, and of a table in addition to its symbols, in 2⁻¹⁶ bits.
const SYMBOL_COST: u64 = 5 << LOG_BITS;
const TABLE_COST: u64 = 16 << LOG_BITS;

/// `LOGARITHMS[m]` is log₂(1 + m / 256) in 2⁻¹⁶.
static LOGARITHMS: [u32; 257] = logarithms();

const fn logarithms() -> [u32; 257] {
    let mut table = [0; 257];
    let mut place = 0;
    while place < 257 {
        // Bit by bit: squaring doubles the logarithm (Knuth 1997, 1.2.2).
        let mut number = (256 + place as u64) << 23;
        let mut bits = 0;
        let mut logarithm = 0;
        while bits <= LOG_BITS {
            let is_two = number >= 1 << 32;
            if is_two {
                number >>= 1;
            }
            logarithm = logarithm << 1 | is_two as u32;
            number = (number * number) >> 31;
            bits += 1;
        }
        table[place] = logarithm;
        place += 1;
    }
    table
}

/// log₂ of a number that is not 0, in 2⁻¹⁶, the same on every machine.
fn logarithm(number: u64) -> u64 {
    let whole = number.ilog2();
    // 24 bits below the highest.
    let below = (number << (63 - whole) << 1) >> 40;
    let (place, part) = ((below >> 16) as usize, below & 0xffff);
    let [low, high] = [LOGARITHMS[place], LOGARITHMS[place + 1]].map(u64::from);
    (u64::from(whole) << LOG_BITS) + low + (((high - low) * part) >> 16)
}

/// Histogram of symbol counts.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct Counts {
    of: Box<[u32; SYMBOLS]>,
    /// One more than the last symbol that came.
    end: usize,
}

impl Default for Counts {
    fn default() -> Self {
        Self {
            of: Box::new([0; SYMBOLS]),
            end: 0,
        }
    }
}

impl Counts {
    pub(in crate::reel) fn see(&mut self, symbol: u8) {
        self.of[usize::from(symbol)] += 1;
        self.end = self.end.max(usize::from(symbol) + 1);
    }

    pub(in crate::reel) fn is_empty(&self) -> bool {
        self.end == 0
    }

    /// Returns the sum of both histograms.
    pub(in crate::reel) fn and(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        sum.end = self.end.max(other.end);
        for (sum, other) in sum.of[..other.end].iter_mut().zip(&other.of[..]) {
            *sum += other;
        }
        sum
    }

    /// Bits, in 2⁻¹⁶, that these symbols take by a table of their own, and that table.
    pub(in crate::reel) fn cost(&self) -> u64 {
        self.cost_with(&[])
    }

    /// [`Counts::cost`] of these and others together.
    pub(in crate::reel) fn cost_and(&self, other: &Self) -> u64 {
        if other.end > self.end {
            other.cost_with(&self.of[..self.end])
        } else {
            self.cost_with(&other.of[..other.end])
        }
    }

    fn cost_with(&self, others: &[u32]) -> u64 {
        let (mut all, mut told, mut different) = (0, 0, 0);
        let mut add = |count: u32| {
            if count > 0 {
                let count = u64::from(count);
                all += count;
                told += count * logarithm(count);
                different += 1;
            }
        };
        let (both, rest) = self.of[..self.end].split_at(others.len());
        for (count, other) in both.iter().zip(others) {
            add(count + other);
        }
        for &count in rest {
            add(count);
        }
        match all {
            0 => 0,
            all => TABLE_COST + different * SYMBOL_COST + (all * logarithm(all)).saturating_sub(told),
        }
    }
}

/// A table: frequencies that add up to [`SCALE`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::reel) struct Frequencies(pub(in crate::reel) [u16; SYMBOLS]);

impl Frequencies {
    /// About as often as they came, and none of those never.
    pub(in crate::reel) fn of(counts: &Counts) -> Self {
        let all = counts.of.iter().map(|&count| u64::from(count)).sum::<u64>().max(1);
        let mut frequencies = counts.of.map(|count| match count {
            0 => 0,
            count => ((u64::from(count) * u64::from(SCALE) + all / 2) / all).clamp(1, u64::from(MAX_FREQUENT)) as u16,
        });
        let mut sum: u32 = frequencies.iter().map(|&frequency| u32::from(frequency)).sum();
        while sum != SCALE {
            // The most frequent one that may change: for it the change costs least.
            let may_grow = sum < SCALE;
            let fits = |frequency: u32| {
                if may_grow {
                    frequency < MAX_FREQUENT
                } else {
                    frequency > 1
                }
            };
            let place = (0..SYMBOLS)
                .rev()
                .filter(|&symbol| fits(u32::from(frequencies[symbol])))
                .max_by_key(|&symbol| frequencies[symbol])
                .unwrap_or(0);
            let frequency = u32::from(frequencies[place]);
            let changed = if may_grow {
                (frequency + SCALE - sum).min(MAX_FREQUENT)
            } else {
                // Continues with others once another is more frequent than half of it.
                frequency - (sum - SCALE).min((frequency / 2).max(1)).min(frequency - 1)
            };
            sum = sum + changed - frequency;
            frequencies[place] = changed as u16;
        }
        Self(frequencies)
    }

    /// Codes a table: for each symbol the number of bits, and the bits below the highest, until the frequencies are
    /// complete.
    pub(in crate::reel) fn code<C: BitCoder>(&mut self, coder: &mut C, models: &mut TableModels) -> Result<(), Fault> {
        let (mut sum, mut last) = (0, 0);
        for frequency in &mut self.0 {
            if sum == SCALE {
                *frequency = 0;
                continue;
            }
            let length = u64::from(u16::BITS - frequency.leading_zeros());
            let length = models.lengths[last]
                .code(coder, &mut models.rest, length)
                .min(u64::from(SCALE_BITS));
            last = length as usize;
            *frequency = match length as u32 {
                0 => 0,
                length => {
                    let below = length - 1;
                    let bits = coder.even_bits(below, u64::from(*frequency) & ((1 << below) - 1));
                    (1 << below | bits) as u16
                }
            };
            sum += u32::from(*frequency);
            if sum > SCALE || u32::from(*frequency) > MAX_FREQUENT {
                break;
            }
        }
        if sum == SCALE && self.0.iter().all(|&frequency| u32::from(frequency) <= MAX_FREQUENT) {
            return Ok(());
        }
        Err(Fault::new(format!(
            "frequencies of symbols add up to {sum} instead of {SCALE}"
        )))
    }
}

/// Probability models of table frequencies, by the number of bits of the previous one.
#[derive(Debug, Default)]
pub(in crate::reel) struct TableModels {
    lengths: [MagnitudeModel; SCALE_BITS as usize + 1],
    rest: RestModels,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn logarithms_are_right_to_a_thousandth_of_a_bit() {
        for number in (1..5000u64).chain((13..60).map(|bits| (1 << bits) + (1 << (bits - 7)) - 1)) {
            let exact = (number as f64).log2();
            let found = logarithm(number) as f64 / f64::from(1 << LOG_BITS);
            assert!((found - exact).abs() < 1e-3, "{number}: {found} for {exact}");
        }
    }

    proptest! {
        #[test]
        fn tables_add_up_and_cover_all_symbols(symbols in prop::collection::vec((any::<u8>(), 1u32..1 << 24), 1..256)) {
            let mut counts = Counts::default();
            for &(symbol, count) in &symbols {
                counts.see(symbol);
                counts.of[usize::from(symbol)] = count;
            }
            let Frequencies(frequencies) = Frequencies::of(&counts);
            prop_assert_eq!(frequencies.iter().map(|&frequency| u32::from(frequency)).sum::<u32>(), SCALE);
            for (&frequency, &count) in frequencies.iter().zip(&counts.of[..]) {
                prop_assert!(frequency > 0 || count == 0);
                prop_assert!(u32::from(frequency) <= MAX_FREQUENT);
            }
        }
    }
}
