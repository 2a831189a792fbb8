//! Extra bytes: further values per point, which the standard record of extra bytes describes.

use super::header::{LasHeader, Record, take};
use crate::io::columns::column::Scalar;

/// Bytes that describe a field.
const DESCRIPTION_BYTES: usize = 192;

/// A plain number.
#[derive(Debug, Clone)]
pub(super) struct ExtraField {
    /// Field name in the file; may be empty, or the same as another field's.
    pub(super) name: String,
    /// Counted from 1.
    pub(super) number: usize,
    pub(super) scalar: Scalar,
    /// Byte of a point where it begins.
    pub(super) start: usize,
    /// The no-data number of the file.
    no_data: Option<f64>,
    scale: f64,
    offset: f64,
}

impl ExtraField {
    /// Returns true if the field is unscaled: the numbers in the file are the values themselves.
    pub(super) fn is_plain(&self) -> bool {
        self.no_data.is_none() && (self.scale, self.offset) == (1.0, 0.0)
    }

    /// Converts stored numbers to values.
    pub(super) fn apply(&self, values: &mut [f64]) {
        for value in values {
            *value = if self.no_data == Some(*value) {
                f64::NAN
            } else {
                *value * self.scale + self.offset
            };
        }
    }
}

/// The fields that `records` describe, as far as they lie within a point.
pub(super) fn fields<'a>(header: &LasHeader, records: impl Iterator<Item = Record<'a>>) -> Vec<ExtraField> {
    let mut fields: Vec<ExtraField> = Vec::new();
    let mut start = header.extra_start();
    let descriptions = records
        .filter(|record| record.is(b"LASF_Spec", 4))
        .flat_map(|record| record.data.as_chunks::<DESCRIPTION_BYTES>().0);
    for description in descriptions {
        let (kind, options) = (description[2], description[3]);
        let Some(bytes) = byte_size(kind, options) else {
            break;
        };
        let end = start + bytes;
        if end > header.point_bytes {
            break;
        }
        let (single, numbers) = numbers(kind);
        if let Some(scalar) = single {
            let text = &description[4..36];
            let length = text.iter().position(|&byte| byte == 0).unwrap_or(text.len());
            let name = String::from_utf8_lossy(&text[..length]).trim().to_owned();
            for place in 0..numbers {
                let name = match numbers {
                    1 => name.clone(),
                    _ => format!("{name}_{place}"),
                };
                fields.push(ExtraField {
                    name,
                    number: fields.len() + 1,
                    scalar,
                    start: start + place * scalar.byte_size(),
                    no_data: (options & 1 != 0).then(|| widest(scalar).read(&description[40 + 8 * place..], false)),
                    scale: factor(description, 8, 112 + 8 * place, 1.0),
                    offset: factor(description, 16, 136 + 8 * place, 0.0),
                });
            }
        }
        start = end;
    }
    fields
}

/// The number at `at`, if the options have `bit` and it is finite.
fn factor(description: &[u8; DESCRIPTION_BYTES], bit: u8, at: usize, otherwise: f64) -> f64 {
    Some(f64::from_le_bytes(take(description, at)))
        .filter(|number| description[3] & bit != 0 && number.is_finite())
        .unwrap_or(otherwise)
}

fn scalar(kind: u8) -> Option<Scalar> {
    const SCALARS: [Scalar; 10] = [
        Scalar::U8,
        Scalar::I8,
        Scalar::U16,
        Scalar::I16,
        Scalar::U32,
        Scalar::I32,
        Scalar::U64,
        Scalar::I64,
        Scalar::F32,
        Scalar::F64,
    ];
    SCALARS.get(usize::from(kind.checked_sub(1)?)).copied()
}

/// The type of each number of a field, and their count: two or three for kinds above 10.
fn numbers(kind: u8) -> (Option<Scalar>, usize) {
    match kind {
        1..=30 => (scalar((kind - 1) % 10 + 1), usize::from((kind - 1) / 10) + 1),
        _ => (None, 0),
    }
}

/// Bytes of a field; kind 0 has `options` bytes without a meaning.
fn byte_size(kind: u8, options: u8) -> Option<usize> {
    match numbers(kind) {
        (Some(scalar), numbers) => Some(numbers * scalar.byte_size()),
        (None, _) => (kind == 0).then_some(usize::from(options)),
    }
}

/// Type of the no-data number: the widest of its kind.
fn widest(scalar: Scalar) -> Scalar {
    match scalar {
        Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => Scalar::U64,
        Scalar::I8 | Scalar::I16 | Scalar::I32 | Scalar::I64 => Scalar::I64,
        Scalar::F32 | Scalar::F64 => Scalar::F64,
    }
}
