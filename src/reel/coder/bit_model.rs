//! The probability of a bit, as it was seen so far.
//!
//! How it works: a state is the probability that the bit is set, 22 bits, above the number of bits seen, 10 bits. A new
//! bit moves the probability by 1 part in 1.5 more than were seen, so that the first bits count much and a state
//! settles to the mean of all; after [`MAX_SEEN`] it forgets the oldest at a fixed rate. The scheme follows the state
//! maps of Mahoney's lpaq (2007). Integers only: every machine computes the same.

/// Number of bits after which a state follows at a fixed rate.
const MAX_SEEN: u32 = 254;

/// Bits of the number of bits seen.
const SEEN_BITS: u32 = 10;

/// `RATES[n]` is 2¹⁶ / (n + 1.5).
static RATES: [u32; MAX_SEEN as usize + 1] = rates();

const fn rates() -> [u32; MAX_SEEN as usize + 1] {
    let mut rates = [0; MAX_SEEN as usize + 1];
    let mut seen = 0;
    while seen < rates.len() {
        rates[seen] = (1 << 17) / (2 * seen as u32 + 3);
        seen += 1;
    }
    rates
}

/// Bits of a probability as the coder takes it.
pub(in crate::reel) const PROBABILITY_BITS: u32 = 16;

/// No bit is taken for more certain than this, in 2⁻¹⁶: a wrong one costs at most 11 bits, and each one costs
/// something, so that bytes bound the number of bits.
const MIN: u32 = 1 << 5;

/// Equivalent of the minimum probability at the precision of a model state.
const TARGET: i64 = (MIN as i64) << (22 - PROBABILITY_BITS);

/// The running probability of one bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) struct BitModel(u32);

impl Default for BitModel {
    fn default() -> Self {
        Self(1 << 31)
    }
}

impl BitModel {
    /// The probability of a set bit in 2⁻¹⁶.
    #[inline(always)]
    pub(in crate::reel) fn probability(self) -> u32 {
        self.0 >> 16
    }

    /// Updates the model with a bit.
    #[inline(always)]
    pub(in crate::reel) fn see(&mut self, bit: bool) {
        let seen = self.0 & ((1 << SEEN_BITS) - 1);
        let probability = (self.0 >> SEEN_BITS) as i64;
        let target = if bit { (1 << 22) - TARGET } else { TARGET };
        let inter = probability + (((target - probability) * i64::from(RATES[seen as usize])) >> 16);
        self.0 = (inter as u32) << SEEN_BITS | (seen + 1).min(MAX_SEEN);
    }
}
