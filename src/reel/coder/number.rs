//! Whole numbers as adaptive bits: small ones in a few, large ones in twice their length.

use super::bit_model::BitModel;
use super::range::BitCoder;

/// Largest number that is coded in unary.
const UNARY: usize = 14;

/// Models of a number from 0 on: one set bit per unit up to [`UNARY`], each with a model of its own, then
/// [`RestModels`]. One CPU cache line, as there may be hundreds of them.
#[derive(Debug, Clone, PartialEq, Default)]
#[repr(align(64))]
pub(in crate::reel) struct MagnitudeModel {
    unary: [BitModel; UNARY],
    sign: BitModel,
}

/// Models of the remainder beyond the unary part: an Elias-gamma code (Elias 1975), whose length and the highest bit
/// below it have models. Few numbers come here, so many models of magnitudes share these.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct RestModels {
    length: [BitModel; 64],
    high: [BitModel; 64],
}

impl Default for RestModels {
    fn default() -> Self {
        Self {
            length: [BitModel::default(); 64],
            high: [BitModel::default(); 64],
        }
    }
}

impl MagnitudeModel {
    /// Codes a number below 2⁶³.
    #[inline(always)]
    pub(in crate::reel) fn code<C: BitCoder>(&mut self, coder: &mut C, rest: &mut RestModels, value: u64) -> u64 {
        let mut coded = 0;
        for model in &mut self.unary {
            if !coder.bit(model, value > coded) {
                return coded;
            }
            coded += 1;
        }
        // Passed by value: elsewhere the coder stays in registers.
        let more;
        (*coder, more) = rest.code(std::mem::take(coder), value.wrapping_sub(coded));
        coded.saturating_add(more)
    }

    /// Codes a number of either sign and a magnitude below 2⁶².
    #[inline(always)]
    pub(in crate::reel) fn code_signed<C: BitCoder>(
        &mut self,
        coder: &mut C,
        rest: &mut RestModels,
        value: i64,
    ) -> i64 {
        let magnitude = self.code(coder, rest, value.unsigned_abs()) as i64;
        if magnitude == 0 {
            return 0;
        }
        if coder.bit(&mut self.sign, value < 0) {
            -magnitude
        } else {
            magnitude
        }
    }
}

impl RestModels {
    #[cold]
    fn code<C: BitCoder>(&mut self, mut coder: C, value: u64) -> (C, u64) {
        let value = value.wrapping_add(1);
        let max = 62;
        let length = if C::DECODES { 0 } else { value.ilog2().min(max) };
        let mut coded_length = 0;
        while coded_length < max && coder.bit(&mut self.length[coded_length as usize], length > coded_length) {
            coded_length += 1;
        }
        if coded_length == 0 {
            return (coder, 0);
        }
        let below = coded_length - 1;
        let high = coder.bit(&mut self.high[coded_length as usize], value >> below & 1 != 0);
        let low = coder.even_bits(below, value & ((1 << below) - 1));
        (coder, (1 << coded_length | u64::from(high) << below | low) - 1)
    }
}
