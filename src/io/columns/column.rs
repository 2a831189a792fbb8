//! A column of numbers in any layout: in rows, in its own block, or parsed from text.

pub(in crate::io) use crate::binary::Scalar;
use std::ops::Range;

/// Storage of the values of a column.
#[derive(Debug, Clone)]
pub(in crate::io) enum Values<'a> {
    /// Number `i` is at byte `start + i * step`. Every one lies within `bytes`.
    Packed {
        bytes: &'a [u8],
        start: usize,
        step: usize,
        big_endian: bool,
    },
    /// Already parsed.
    Parsed(Vec<f64>),
}

/// A named column.
#[derive(Debug, Clone)]
pub(in crate::io) struct Column<'a> {
    pub(in crate::io) name: String,
    /// Type in the file; text counts as [`Scalar::F64`].
    pub(in crate::io) scalar: Scalar,
    pub(in crate::io) values: Values<'a>,
}

/// The loop of [`Column::for_each_f32`] and its twin: one for every type and byte order, so that neither is tested for
/// every number.
macro_rules! walk {
    ($column:expr, $range:expr, $each:expr, $target:ty) => {{
        let (bytes, start, step, big_endian) = match &$column.values {
            Values::Parsed(values) => {
                for index in $range {
                    $each(index, values[index] as $target);
                }
                return;
            }
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } => (*bytes, *start, *step, *big_endian),
        };
        macro_rules! numbers {
            ($from:ty, $read:path) => {
                for index in $range {
                    let at = start + index * step;
                    let mut raw = [0; size_of::<$from>()];
                    raw.copy_from_slice(&bytes[at..at + size_of::<$from>()]);
                    $each(index, $read(raw) as $target);
                }
            };
        }
        match ($column.scalar, big_endian) {
            (Scalar::I8, _) => numbers!(i8, i8::from_le_bytes),
            (Scalar::U8, _) => numbers!(u8, u8::from_le_bytes),
            (Scalar::I16, false) => numbers!(i16, i16::from_le_bytes),
            (Scalar::I16, true) => numbers!(i16, i16::from_be_bytes),
            (Scalar::U16, false) => numbers!(u16, u16::from_le_bytes),
            (Scalar::U16, true) => numbers!(u16, u16::from_be_bytes),
            (Scalar::I32, false) => numbers!(i32, i32::from_le_bytes),
            (Scalar::I32, true) => numbers!(i32, i32::from_be_bytes),
            (Scalar::U32, false) => numbers!(u32, u32::from_le_bytes),
            (Scalar::U32, true) => numbers!(u32, u32::from_be_bytes),
            (Scalar::I64, false) => numbers!(i64, i64::from_le_bytes),
            (Scalar::I64, true) => numbers!(i64, i64::from_be_bytes),
            (Scalar::U64, false) => numbers!(u64, u64::from_le_bytes),
            (Scalar::U64, true) => numbers!(u64, u64::from_be_bytes),
            (Scalar::F32, false) => numbers!(f32, f32::from_le_bytes),
            (Scalar::F32, true) => numbers!(f32, f32::from_be_bytes),
            (Scalar::F64, false) => numbers!(f64, f64::from_le_bytes),
            (Scalar::F64, true) => numbers!(f64, f64::from_be_bytes),
        }
    }};
}

/// Returns true if the decimal number `value` is the printed form of a single-precision number: the nearest of these is
/// off by less than half of the last digit.
fn is_written_single(value: f64) -> bool {
    /// More than single precision has, of numbers near 1.
    const MAX_DECIMALS: i32 = 12;
    let error = (f64::from(value as f32) - value).abs();
    if error == 0.0 || !value.is_finite() {
        return true;
    }
    let is_last_digit = |decimals: &i32| {
        let scale = 10f64.powi(*decimals);
        (value * scale).round() / scale == value
    };
    let decimals = (0..=MAX_DECIMALS).find(is_last_digit);
    decimals.is_some_and(|decimals| error <= 0.5 * 10f64.powi(-decimals))
}

impl Column<'_> {
    /// Returns true if coordinates need double precision. Text does where it has more digits than the single precision
    /// that its header declares: some writers call all numbers `float`.
    pub(in crate::io) fn is_wide(&self) -> bool {
        match &self.values {
            Values::Parsed(values) if self.scalar == Scalar::F32 => {
                !values.iter().all(|&value| is_written_single(value))
            }
            Values::Parsed(_) => true,
            Values::Packed { .. } => self.scalar.is_wide(),
        }
    }

    /// [`Self::is_wide`] without a look at the numbers: whether that may be.
    pub(super) fn may_be_wide(&self) -> bool {
        match &self.values {
            Values::Parsed(_) => true,
            Values::Packed { .. } => self.scalar.is_wide(),
        }
    }

    /// Bytes that it owns: none for numbers that lie in a file.
    pub(in crate::io) fn parsed_bytes(&self) -> usize {
        match &self.values {
            Values::Parsed(values) => size_of_val(values.as_slice()),
            Values::Packed { .. } => 0,
        }
    }

    /// Hands over the numbers of `range` with their indices. Precondition: the column has them.
    pub(super) fn for_each_f32(&self, range: Range<usize>, mut each: impl FnMut(usize, f32)) {
        walk!(self, range, each, f32);
    }

    /// [`Self::for_each_f32`] with all digits.
    pub(super) fn for_each_f64(&self, range: Range<usize>, mut each: impl FnMut(usize, f64)) {
        walk!(self, range, each, f64);
    }

    /// `count` numbers as f32.
    pub(in crate::io) fn to_f32(&self, count: usize) -> Vec<f32> {
        let mut numbers = Vec::with_capacity(count);
        self.append_f32(&mut numbers, count);
        numbers
    }

    /// `count` numbers with all digits.
    pub(in crate::io) fn to_f64(&self, count: usize) -> Vec<f64> {
        let mut numbers = Vec::with_capacity(count);
        self.append_f64(&mut numbers, count);
        numbers
    }

    /// Appends the first `count` numbers as f32.
    pub(super) fn append_f32(&self, numbers: &mut Vec<f32>, count: usize) {
        let start = numbers.len();
        numbers.resize(start + count, 0.0);
        let numbers = &mut numbers[start..];
        self.for_each_f32(0..count, |index, value| numbers[index] = value);
    }

    /// [`Self::append_f32`] with all digits.
    pub(super) fn append_f64(&self, numbers: &mut Vec<f64>, count: usize) {
        let start = numbers.len();
        numbers.resize(start + count, 0.0);
        let numbers = &mut numbers[start..];
        self.for_each_f64(0..count, |index, value| numbers[index] = value);
    }

    /// The four bytes of `count` numbers as they are in the file, for colours packed into one number.
    pub(in crate::io) fn bits(&self, count: usize) -> Vec<u32> {
        match &self.values {
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } if self.scalar.byte_size() == 4 => (0..count)
                .map(|index| {
                    let at = start + index * step;
                    let mut raw = [0; 4];
                    raw.copy_from_slice(&bytes[at..at + 4]);
                    if *big_endian {
                        u32::from_be_bytes(raw)
                    } else {
                        u32::from_le_bytes(raw)
                    }
                })
                .collect(),
            Values::Parsed(values) if self.scalar == Scalar::F32 => values
                .iter()
                .take(count)
                .map(|&value| (value as f32).to_bits())
                .collect(),
            // Negative integers hold the same 32 bits, wider types the same value.
            _ => {
                let mut bits = vec![0; count];
                self.for_each_f64(0..count, |index, value| bits[index] = value as i64 as u32);
                bits
            }
        }
    }

    /// The largest of `count` numbers.
    pub(in crate::io) fn largest(&self, count: usize) -> f64 {
        let mut largest = f64::NEG_INFINITY;
        // f64::max ignores NaN.
        self.for_each_f64(0..count, |_, value| largest = largest.max(value));
        largest
    }
}

#[cfg(test)]
pub(in crate::io) mod tests {
    use super::*;

    /// A column in rows.
    pub(crate) fn packed(bytes: &[u8], scalar: Scalar, start: usize, step: usize, big_endian: bool) -> Column<'_> {
        Column {
            name: "c".to_owned(),
            scalar,
            values: Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            },
        }
    }

    #[test]
    fn text_with_more_digits_than_declared_is_read_as_f64() {
        for (values, is_wide) in [
            (&[0.1, -3.25, 1e-7, f64::NAN][..], false),
            (&[1.234_567, 12_345.678, -0.001_234_567], false),
            // An f32 printed with `%f`.
            (&[f64::from(0.1f32), 123.456_787], false),
            (&[0.1, 691_234.567], true),
            (&[0.123_456_789_1], true),
            (&[5_334_567.125, 0.001], true),
        ] {
            let column = parsed(values, Scalar::F32);
            assert_eq!(column.is_wide(), is_wide, "{values:?}");
            assert!(parsed(values, Scalar::F64).is_wide());
        }
    }

    /// A column of text.
    pub(crate) fn parsed(values: &[f64], scalar: Scalar) -> Column<'static> {
        Column {
            name: "c".to_owned(),
            scalar,
            values: Values::Parsed(values.to_vec()),
        }
    }

    #[test]
    fn packed_colors_preserve_their_bits_in_any_carrier_type() {
        // 0xffc00001 is a NaN as a float, but a negative number as an integer.
        let bits = 0xffc0_0001_u32;
        for scalar in [Scalar::U32, Scalar::I32, Scalar::F32] {
            assert_eq!(packed(&bits.to_le_bytes(), scalar, 0, 4, false).bits(1), [bits]);
            assert_eq!(packed(&bits.to_be_bytes(), scalar, 0, 4, true).bits(1), [bits]);
        }
        assert_eq!(parsed(&[f64::from(bits)], Scalar::U32).bits(1), [bits]);
        assert_eq!(parsed(&[f64::from(bits as i32)], Scalar::I32).bits(1), [bits]);
        let float = f32::from_bits(0x00ff_8000);
        assert_eq!(parsed(&[f64::from(float)], Scalar::F32).bits(1), [0x00ff_8000]);
    }
}
