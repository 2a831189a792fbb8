//! Floats as they are: bit by bit, in as few bits as a prediction from the one before leaves.

use crate::reel::coder::{BitCoder, MagnitudeModel, RestModels};

/// Floats whose bits are whole numbers in the same order: −0 before +0, NaN of either sign at the ends.
pub(in crate::reel) fn ordered32(bits: u32) -> u32 {
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// The inverse of [`ordered32`].
pub(in crate::reel) fn unordered32(ordered: u32) -> u32 {
    if ordered >> 31 != 0 {
        ordered & !(1 << 31)
    } else {
        !ordered
    }
}

/// Double-precision variant of [`ordered32`].
pub(in crate::reel) fn ordered64(bits: u64) -> u64 {
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// The inverse of [`ordered64`].
pub(in crate::reel) fn unordered64(ordered: u64) -> u64 {
    if ordered >> 63 != 0 {
        ordered & !(1 << 63)
    } else {
        !ordered
    }
}

/// Encoding of a column.
const FLOATS: u64 = 0;
const INTEGERS: u64 = 1;

fn integer(bits: u32) -> Option<i64> {
    let value = f32::from_bits(bits);
    let rounded = value as i32;
    ((rounded as f32).to_bits() == bits).then_some(i64::from(rounded))
}

/// Codes the bits of floats.
pub(in crate::reel) fn code_floats<C: BitCoder>(coder: &mut C, column: &mut [u32]) {
    let kind = if column.iter().all(|&bits| integer(bits).is_some()) {
        INTEGERS
    } else {
        FLOATS
    };
    let kind = coder.even_bits(1, kind);
    let (mut model, mut rest) = (MagnitudeModel::default(), RestModels::default());
    let mut last = 0i64;
    for bits in column {
        let number = if kind == INTEGERS {
            integer(*bits).unwrap_or(0)
        } else {
            i64::from(ordered32(*bits))
        };
        let coded = last.wrapping_add(model.code_signed(coder, &mut rest, number - last));
        last = if kind == INTEGERS {
            i64::from(coded as i32)
        } else {
            i64::from(coded as u32)
        };
        *bits = if kind == INTEGERS {
            (last as i32 as f32).to_bits()
        } else {
            unordered32(last as u32)
        };
    }
}

/// Codes the order of points: indices that mostly follow each other by little.
pub(in crate::reel) fn code_order<C: BitCoder>(coder: &mut C, order: &mut [u32]) {
    let (mut model, mut rest) = (MagnitudeModel::default(), RestModels::default());
    let mut last = -1i64;
    for index in order {
        let step = model.code_signed(coder, &mut rest, i64::from(*index) - last - 1);
        let coded = (last + 1).wrapping_add(step);
        last = i64::from(coded as u32);
        *index = last as u32;
    }
}

/// Codes a number below `span`, all equally likely. Precondition: `span` is not 0.
pub(in crate::reel) fn code_even<C: BitCoder>(coder: &mut C, mut span: u64, mut value: u64) -> u64 {
    let mut base = 0;
    while span > 1 {
        let half = 1u64 << (span - 1).ilog2();
        let upper = span - half;
        let probability = ((u128::from(upper) << 16) / u128::from(span)).clamp(1, (1 << 16) - 1) as u32;
        if coder.bit_of(probability, value >= half) {
            base += half;
            value = value.wrapping_sub(half);
            span = upper;
        } else {
            let bits = half.trailing_zeros();
            return base + coder.even_bits(bits, value & (half - 1));
        }
    }
    base
}

/// Codes how many points are in each cell, one or more.
pub(in crate::reel) fn code_counts<C: BitCoder>(coder: &mut C, counts: &mut [u32]) {
    let (mut models, mut rest): ([MagnitudeModel; 4], _) = (Default::default(), RestModels::default());
    let mut last = 0;
    for count in counts {
        let model = &mut models[(last as usize).min(3)];
        last = model.code(coder, &mut rest, u64::from(*count) - u64::from(!C::DECODES)) as u32;
        *count = last.saturating_add(1);
    }
}

/// Codes how many of at most `max` bits the points of each cell lack; a cell of several points is in a denser part
/// than one of a single point.
pub(in crate::reel) fn code_missing_bits<C: BitCoder>(coder: &mut C, missing: &mut [u8], counts: &[u32], max: u8) {
    let (mut models, mut rest): ([MagnitudeModel; 4], _) = (Default::default(), RestModels::default());
    let mut last = 0i64;
    for (missing, &count) in missing.iter_mut().zip(counts) {
        let model = &mut models[(count.saturating_sub(1) as usize).min(3)];
        let step = model.code_signed(coder, &mut rest, i64::from(*missing) - last);
        last = last.saturating_add(step).clamp(0, max.into());
        *missing = last as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reel::coder::{RangeDecoder, RangeEncoder};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn floats_round_trip_bit_for_bit(mut column in prop::collection::vec(any::<u32>(), 0..50), values in
            prop::collection::vec(-300i32..300, 0..50), spans in prop::collection::vec((1u64.., any::<u64>()), 0..50)) {
            let mut integers: Vec<u32> = values.iter().map(|&value| (value as f32).to_bits()).collect();
            let spans: Vec<(u64, u64)> = spans.into_iter().map(|(span, value)| (span, value % span)).collect();
            let mut encoder = RangeEncoder::default();
            code_floats(&mut encoder, &mut column);
            code_floats(&mut encoder, &mut integers);
            let mut order = column.clone();
            code_order(&mut encoder, &mut order);
            for &(span, value) in &spans {
                code_even(&mut encoder, span, value);
            }
            let bytes = encoder.finish();
            let mut decoder = RangeDecoder::new(&bytes);
            let mut read = vec![0; column.len()];
            code_floats(&mut decoder, &mut read);
            prop_assert_eq!(&read, &column);
            let mut read = vec![0; integers.len()];
            code_floats(&mut decoder, &mut read);
            prop_assert_eq!(read, integers);
            let mut read = vec![0; order.len()];
            code_order(&mut decoder, &mut read);
            prop_assert_eq!(&read, &column);
            for &(span, value) in &spans {
                prop_assert_eq!(code_even(&mut decoder, span, 0), value);
            }
            prop_assert!(!decoder.has_overrun());
        }

        #[test]
        fn integer_order_of_floats_matches_numeric_order(a in any::<f32>(), b in any::<f32>(), c in any::<f64>()) {
            prop_assume!(!a.is_nan() && !b.is_nan());
            prop_assert_eq!(a.total_cmp(&b), ordered32(a.to_bits()).cmp(&ordered32(b.to_bits())));
            prop_assert_eq!(unordered32(ordered32(a.to_bits())), a.to_bits());
            prop_assert_eq!(unordered64(ordered64(c.to_bits())), c.to_bits());
        }
    }
}
