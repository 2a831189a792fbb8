//! One probability of several: models that know different things of a bit are weighed by how right they were.
//!
//! How it works: logistic mixing (Mahoney, *Adaptive Weighing of Context Models for Lossless Data Compression*, 2005).
//! Probabilities are stretched to ln(p / (1 − p)), added up by weights, and squashed back; after the bit, each weight
//! moves along the gradient of the cost. Which weights are used is chosen by a small context. Integers only.

use super::bit_model::BitModel;
use super::range::BitCoder;

/// Stretched values are in 2⁻⁸, between −8 and 8.
const MAX_STRETCHED: i32 = 2047;

/// The logistic function at −16, −15, …, 16 halves, in 2⁻¹².
const HALVES: [i32; 33] = [
    1, 2, 3, 6, 10, 16, 27, 45, 73, 120, 194, 310, 488, 747, 1101, 1546, 2048, 2550, 2995, 3349, 3608, 3786, 3902,
    3976, 4023, 4051, 4069, 4080, 4086, 4090, 4093, 4094, 4095,
];

/// 1 / (1 + e^(−x)) in 2⁻¹², of x in 2⁻⁸: a straight line between halves.
// In integers, like all models: files have the same bytes on every machine.
const fn squash(stretched: i32) -> i32 {
    if stretched > MAX_STRETCHED {
        return 4095;
    }
    if stretched < -MAX_STRETCHED {
        return 1;
    }
    let between = stretched & 127;
    let place = ((stretched >> 7) + 16) as usize;
    (HALVES[place] * (128 - between) + HALVES[place + 1] * between + 64) >> 7
}

/// [`squash`] of every value, as twelve bits in two's complement.
static SQUASHED: [i16; 4096] = squashed();

const fn squashed() -> [i16; 4096] {
    let mut table = [0; 4096];
    let mut value = -MAX_STRETCHED;
    while value <= MAX_STRETCHED {
        table[(value & 4095) as usize] = squash(value) as i16;
        value += 1;
    }
    table
}

/// The inverse of [`squash`]: the least value that is squashed to a probability or more.
static STRETCHED: [i16; 4096] = stretched();

const fn stretched() -> [i16; 4096] {
    let mut table = [MAX_STRETCHED as i16; 4096];
    let mut probability = 0;
    let mut value = -MAX_STRETCHED;
    while value <= MAX_STRETCHED {
        let reached = squash(value) as usize;
        while probability <= reached {
            table[probability] = value as i16;
            probability += 1;
        }
        value += 1;
    }
    table
}

/// Weights are in 2⁻¹⁶.
const ONE: i32 = 1 << 16;

/// Learning rate: how far an error moves a weight.
const RATE: i32 = 6;

/// A weight may not grow beyond this.
const MAX_WEIGHT: i32 = 4 * ONE;

/// Weights of `N` models for each of some contexts.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct Mixer<const N: usize> {
    weights: Box<[[i32; N]]>,
}

impl<const N: usize> Mixer<N> {
    /// Weights for this number of contexts.
    pub(in crate::reel) fn new(contexts: usize) -> Self {
        let even = 11 * ONE / (10 * N as i32);
        Self {
            weights: vec![[even; N]; contexts].into_boxed_slice(),
        }
    }

    /// Codes a bit by these models, which see it.
    #[inline(always)]
    pub(in crate::reel) fn code<C: BitCoder>(
        &mut self,
        coder: &mut C,
        context: usize,
        models: [&mut BitModel; N],
        bit: bool,
    ) -> bool {
        let weights = &mut self.weights[context];
        let mut inputs = [0; N];
        let mut sum = 0;
        for ((input, weight), model) in inputs.iter_mut().zip(&*weights).zip(&models) {
            *input = i32::from(STRETCHED[(model.probability() >> 4) as usize & 4095]);
            sum += *input * *weight;
        }
        let stretched = (sum >> 16).clamp(-MAX_STRETCHED, MAX_STRETCHED);
        let probability = i32::from(SQUASHED[(stretched & 4095) as usize]);
        let bit = coder.bit_of(probability as u32 * 16 + 8, bit);
        let error = ((i32::from(bit) << 12) - probability) * RATE;
        for (weight, input) in weights.iter_mut().zip(inputs) {
            *weight = (*weight + ((input * error + (1 << 13)) >> 14)).clamp(-MAX_WEIGHT, MAX_WEIGHT);
        }
        for model in models {
            model.see(bit);
        }
        bit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squashing_is_the_logistic_function() {
        for value in -MAX_STRETCHED..=MAX_STRETCHED {
            let exact = 4096.0 / (1.0 + (-f64::from(value) / 256.0).exp());
            // Chords of half a unit are off by at most a sixteenth of the second derivative, plus rounding.
            assert!((f64::from(squash(value)) - exact).abs() < 13.0, "{value}");
            assert!(value == -MAX_STRETCHED || squash(value) >= squash(value - 1));
        }
        for (probability, &value) in (0..).zip(&STRETCHED).skip(1) {
            let value = i32::from(value);
            assert!(squash(value) >= probability && (value == -MAX_STRETCHED || squash(value - 1) < probability));
        }
    }
}
