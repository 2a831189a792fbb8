//! Offsets along the normal, coded in pairs: two of them are one symbol. They are not predicted.

use crate::reel::coder::SymbolCoder;

/// Codes the offsets of the nodes of the deepest level, of `bits` bits (1 to 4).
#[inline(always)]
pub(in crate::reel) fn code_offsets<C: SymbolCoder>(coder: &mut C, bits: u8, offsets: &mut [u8]) {
    let mut own = std::mem::take(coder);
    let mask = (1 << bits.min(4)) - 1;
    let mut symbols = vec![0; offsets.len().div_ceil(2)];
    if !C::DECODES {
        for (symbol, pair) in symbols.iter_mut().zip(offsets.chunks(2)) {
            *symbol = pair[0] & mask | pair.get(1).map_or(0, |second| (second & mask) << bits);
        }
    }
    own.plain(&mut symbols);
    for (&symbol, pair) in symbols.iter().zip(offsets.chunks_mut(2)) {
        for (offset, value) in pair.iter_mut().zip([symbol & mask, symbol >> bits & mask]) {
            *offset = value;
        }
    }
    *coder = own;
}
