//! Further numbers a point, which the standard record of extra bytes describes.

use super::header::{LasHeader, Record, take};
use crate::io::column::Scalar;

/// Fields that are taken.
const MAX_FIELDS: usize = 16;

/// Bytes that describe a field.
const DESCRIPTION_BYTES: usize = 192;

/// A field of one plain number.
#[derive(Debug, Clone)]
pub(super) struct ExtraField {
    pub(super) name: String,
    pub(super) scalar: Scalar,
    /// Byte of a point where it begins.
    pub(super) start: usize,
    /// The number in the file that stands for none.
    no_data: Option<f64>,
    scale: f64,
    offset: f64,
}

impl ExtraField {
    /// From the numbers in the file to what they mean.
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
    /// Names that other fields of the cloud have.
    const TAKEN: [&str; 6] = [
        "intensity",
        "classification",
        "gps_time",
        "return_number",
        "number_of_returns",
        "near_ir",
    ];
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
        if end > header.point_bytes || fields.len() == MAX_FIELDS {
            break;
        }
        if let Some(scalar) = scalar(kind) {
            let name = &description[4..36];
            let length = name.iter().position(|&byte| byte == 0).unwrap_or(name.len());
            let mut name = String::from_utf8_lossy(&name[..length]).trim().to_owned();
            let is_taken = |name: &str| {
                TAKEN.iter().any(|taken| taken.eq_ignore_ascii_case(name))
                    || fields.iter().any(|field| field.name == name)
            };
            if name.is_empty() || is_taken(&name) {
                name = format!("{name} extra {}", fields.len() + 1);
            }
            fields.push(ExtraField {
                name,
                scalar,
                start,
                no_data: (options & 1 != 0).then(|| widest(scalar).read(&description[40..48], false)),
                scale: factor(description, 8, 112, 1.0),
                offset: factor(description, 16, 136, 0.0),
            });
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

/// Bytes of a field; kind 0 is so many bytes without a meaning, those above 10 are two or three numbers.
fn byte_size(kind: u8, options: u8) -> Option<usize> {
    match kind {
        0 => Some(usize::from(options)),
        1..=30 => {
            let numbers = usize::from((kind - 1) / 10) + 1;
            Some(numbers * scalar((kind - 1) % 10 + 1)?.byte_size())
        }
        _ => None,
    }
}

/// Type of the number that stands for none: the widest of its kind.
fn widest(scalar: Scalar) -> Scalar {
    match scalar {
        Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => Scalar::U64,
        Scalar::I8 | Scalar::I16 | Scalar::I32 | Scalar::I64 => Scalar::I64,
        Scalar::F32 | Scalar::F64 => Scalar::F64,
    }
}
