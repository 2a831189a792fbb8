//! Whole numbers as adaptive bits: small ones in a few, large ones in twice their length.

use super::bit_model::BitModel;
use super::range::BitCoder;

/// Numbers up to this are told one by one.
const UNARY: usize = 14;

/// A number from 0 on: so many set bits as it has ones up to [`UNARY`], each with a model of its own, then an
/// Elias-gamma code (Elias 1975) of the rest, of which the length and the highest bit below it have models.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct MagnitudeModel {
    unary: [BitModel; UNARY],
    length: [BitModel; 64],
    high: [BitModel; 64],
}

impl Default for MagnitudeModel {
    fn default() -> Self {
        Self {
            unary: [BitModel::default(); UNARY],
            length: [BitModel::default(); 64],
            high: [BitModel::default(); 64],
        }
    }
}

impl MagnitudeModel {
    /// Codes a number below 2⁶³.
    #[inline]
    pub(in crate::reel) fn code<C: BitCoder>(&mut self, coder: &mut C, value: u64) -> u64 {
        let mut coded = 0;
        while coded < UNARY as u64 {
            if !coder.bit(&mut self.unary[coded as usize], value > coded) {
                return coded;
            }
            coded += 1;
        }
        coded.saturating_add(self.code_rest(coder, value.wrapping_sub(coded)))
    }

    #[cold]
    fn code_rest<C: BitCoder>(&mut self, coder: &mut C, value: u64) -> u64 {
        let value = value.wrapping_add(1);
        let most = 62;
        let length = if C::DECODES { 0 } else { value.ilog2().min(most) };
        let mut coded_length = 0;
        while coded_length < most && coder.bit(&mut self.length[coded_length as usize], length > coded_length) {
            coded_length += 1;
        }
        if coded_length == 0 {
            return 0;
        }
        let below = coded_length - 1;
        let high = coder.bit(&mut self.high[coded_length as usize], value >> below & 1 != 0);
        let low = coder.even_bits(below, value & ((1 << below) - 1));
        (1 << coded_length | u64::from(high) << below | low) - 1
    }
}

/// A number of either sign.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::reel) struct SignedModel {
    magnitude: MagnitudeModel,
    sign: BitModel,
}

impl SignedModel {
    /// Codes a number of magnitude below 2⁶².
    #[inline]
    pub(in crate::reel) fn code<C: BitCoder>(&mut self, coder: &mut C, value: i64) -> i64 {
        let magnitude = self.magnitude.code(coder, value.unsigned_abs()) as i64;
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
