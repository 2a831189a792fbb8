//! Numbers that are not predicted, bit by bit, each in the context of its prediction.

use crate::reel::coder::{BitCoder, BitModel, MagnitudeModel, RestModels};

/// Probability models of prediction residuals, by context.
#[derive(Debug, Clone)]
pub(in crate::reel) struct ValueModels {
    numbers: Vec<MagnitudeModel>,
    rest: RestModels,
    flags: Vec<BitModel>,
}

impl ValueModels {
    /// For this number of contexts.
    pub(in crate::reel) fn new(contexts: usize) -> Self {
        Self {
            numbers: vec![MagnitudeModel::default(); contexts],
            rest: RestModels::default(),
            flags: vec![BitModel::default(); contexts],
        }
    }
}

/// A coder of bits, and the models of its values.
#[derive(Debug)]
pub(in crate::reel) struct ValueCoder<'a, C> {
    /// Held by value: its state stays in registers.
    pub(in crate::reel) bits: C,
    pub(in crate::reel) models: &'a mut ValueModels,
}

/// Clamp limit for coded values, since damaged bytes may decode to any number.
const MAX: i64 = 1 << 22;

impl<C: BitCoder> ValueCoder<'_, C> {
    /// Codes a number of either sign and less than 23 bits.
    #[inline(always)]
    pub(super) fn signed(&mut self, context: usize, value: i32) -> i32 {
        let model = &mut self.models.numbers[context];
        let coded = model.code_signed(&mut self.bits, &mut self.models.rest, i64::from(value));
        coded.clamp(-MAX, MAX - 1) as i32
    }

    #[inline(always)]
    pub(super) fn flag(&mut self, context: usize, is_set: bool) -> bool {
        self.bits.bit(&mut self.models.flags[context], is_set)
    }
}
