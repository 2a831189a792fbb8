//! The header of an array: type, order and shape.

use super::super::column::{Column, Scalar, Values};
use super::super::error::{Fault, Place};

/// What every array begins with.
const MAGIC: &[u8] = b"\x93NUMPY";

/// An array whose bytes are all there.
#[derive(Debug)]
pub(super) struct Array<'a> {
    pub(super) shape: Vec<usize>,
    pub(super) kind: ArrayLayout,
    pub(super) is_fortran: bool,
    pub(super) payload: &'a [u8],
    /// Where the first entry is, and how far apart the next ones along the first dimension are, entries: in the order
    /// of Fortran alone.
    first: usize,
    apart: usize,
}

/// What the entries are.
#[derive(Debug)]
pub(super) enum ArrayLayout {
    /// Numbers.
    Table(Number),
    /// Named numbers.
    Records { fields: Vec<RecordField>, row_bytes: usize },
}

/// A field of a record.
#[derive(Debug)]
pub(super) struct RecordField {
    pub(super) name: String,
    /// None for text and other things.
    pub(super) number: Option<Number>,
    pub(super) offset: usize,
    /// How many numbers it is.
    pub(super) length: usize,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Number {
    /// None for half precision.
    scalar: Option<Scalar>,
    big_endian: bool,
}

impl Number {
    pub(super) fn bytes(self) -> usize {
        self.scalar.map_or(2, Scalar::byte_size)
    }

    /// The `count` numbers from `start` on, `step` bytes apart. Precondition: `bytes` has them.
    pub(super) fn column(self, name: String, bytes: &[u8], start: usize, step: usize, count: usize) -> Column<'_> {
        let Some(scalar) = self.scalar else {
            let half = |index: usize| {
                let at = start + index * step;
                let raw = [bytes[at], bytes[at + 1]];
                half(if self.big_endian {
                    u16::from_be_bytes(raw)
                } else {
                    u16::from_le_bytes(raw)
                })
            };
            return Column {
                name,
                scalar: Scalar::F32,
                values: Values::Parsed((0..count).map(half).collect()),
            };
        };
        Column {
            name,
            scalar,
            values: Values::Packed {
                bytes,
                start,
                step,
                big_endian: self.big_endian,
            },
        }
    }
}

impl<'a> Array<'a> {
    pub(super) fn parse(bytes: &'a [u8]) -> Result<Self, Fault> {
        let fault = |problem: &str| Fault::header(problem.to_owned());
        let Some([major, _]) = bytes.strip_prefix(MAGIC).and_then(|rest| rest.first_chunk()) else {
            return Err(fault("it does not begin with `\\x93NUMPY`: this is no NPY file"));
        };
        let (start, length) = match (major, &bytes[MAGIC.len() + 2..]) {
            (1, [low, high, ..]) => (10, usize::from(u16::from_le_bytes([*low, *high]))),
            (2 | 3, [a, b, c, d, ..]) => (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
            (1..=3, _) => return Err(fault("the file ends within its header: it is truncated")),
            _ => {
                return Err(Fault::header(format!("version {major} is not known, expected 1 to 3")));
            }
        };
        let Some((header, payload)) = bytes[start..].split_at_checked(length) else {
            return Err(fault("the file ends within its header: it is truncated"));
        };
        let text = String::from_utf8_lossy(header);
        let mut array = Dictionary::parse(&text).ok_or_else(|| {
            fault(
                "the header is not understood: expected a dictionary of `descr`, `fortran_order` and `shape`, and \
                types that are numbers",
            )
        })?;
        array.payload = payload;
        array.check_claim(start + length)?;
        Ok(array)
    }

    /// An array by its begin, which may end anywhere behind the header; without its payload. `None` if it is none.
    pub(super) fn parse_head(bytes: &[u8]) -> Option<Array<'static>> {
        let [major, _] = bytes.strip_prefix(MAGIC)?.first_chunk()?;
        let (start, length) = match (major, &bytes[MAGIC.len() + 2..]) {
            (1, [low, high, ..]) => (10, usize::from(u16::from_le_bytes([*low, *high]))),
            (2 | 3, [a, b, c, d, ..]) => (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
            _ => return None,
        };
        let (header, _) = bytes[start..].split_at_checked(length)?;
        Dictionary::parse(&String::from_utf8_lossy(header))
    }

    /// Bytes of all entries, if so many can be counted.
    pub(super) fn claimed_bytes(&self) -> Option<usize> {
        let mut lengths = self.shape.iter();
        lengths.try_fold(self.row_bytes(), |bytes, &length| bytes.checked_mul(length))
    }

    /// Leaves the layer of this number along the first dimension. Precondition: there is one.
    pub(super) fn take_layer(&mut self, layer: usize) {
        let layers = self.shape.remove(0);
        if self.is_fortran {
            self.first += layer * self.apart;
            self.apart *= layers;
        } else {
            let entries: usize = self.shape.iter().product();
            self.payload = &self.payload[layer * entries * self.row_bytes()..];
        }
    }

    /// A table with a layer of one beside its rows and columns, as those of shape N × 1 × 3, without that: its numbers
    /// lie in the same order.
    pub(super) fn without_single_layers(mut self) -> Self {
        while self.shape.len() > 2
            && let Some(place) = self.shape.iter().position(|&length| length == 1)
        {
            self.shape.remove(place);
        }
        self
    }

    fn row_bytes(&self) -> usize {
        match &self.kind {
            ArrayLayout::Table(number) => number.bytes(),
            ArrayLayout::Records { row_bytes, .. } => *row_bytes,
        }
    }

    fn check_claim(&self, start: usize) -> Result<(), Fault> {
        let needed = self.claimed_bytes();
        // Entries of no bytes would be as many as the header likes.
        if needed.is_none_or(|needed| needed > self.payload.len()) || self.row_bytes() == 0 {
            return Err(Fault::new(
                Place::Byte(start),
                format!(
                    "{} bytes follow the header, but it claims an array of {:?} entries of {} bytes: the file is \
                     truncated, or its header is wrong",
                    self.payload.len(),
                    self.shape,
                    self.row_bytes()
                ),
            ));
        }
        Ok(())
    }

    /// Column `index` of `width` in a table with `count` rows.
    pub(super) fn column(&self, name: String, index: usize, width: usize, count: usize) -> Column<'a> {
        let ArrayLayout::Table(number) = self.kind else {
            return Column {
                name,
                scalar: Scalar::F64,
                values: Values::Parsed(vec![f64::NAN; count]),
            };
        };
        let bytes = number.bytes();
        let (start, step) = if self.is_fortran {
            ((self.first + self.apart * index * count) * bytes, self.apart * bytes)
        } else {
            (index * bytes, width * bytes)
        };
        number.column(name, self.payload, start, step, count)
    }
}

/// A reader of the dictionary, sign by sign and without looking back.
struct Dictionary<'a> {
    rest: &'a str,
}

impl Dictionary<'_> {
    /// The array without its payload.
    fn parse(text: &str) -> Option<Array<'static>> {
        let mut reader = Dictionary { rest: text };
        let (mut kind, mut is_fortran, mut shape) = (None, None, None);
        reader.sign('{')?;
        while reader.sign('}').is_none() {
            let key = reader.string()?;
            reader.sign(':')?;
            match key.as_str() {
                "descr" => kind = Some(reader.kind()?),
                "fortran_order" => is_fortran = Some(reader.boolean()?),
                "shape" => shape = Some(reader.tuple()?),
                _ => return None,
            }
            let _ = reader.sign(',');
        }
        Some(Array {
            shape: shape?,
            kind: kind?,
            is_fortran: is_fortran?,
            payload: &[],
            first: 0,
            apart: 1,
        })
    }

    /// Takes `sign` if it comes next.
    fn sign(&mut self, sign: char) -> Option<()> {
        self.rest = self.rest.trim_start();
        self.rest = self.rest.strip_prefix(sign)?;
        Some(())
    }

    fn string(&mut self) -> Option<String> {
        self.rest = self.rest.trim_start();
        let quote = self.rest.chars().next().filter(|sign| ['\'', '"'].contains(sign))?;
        let (text, rest) = self.rest[1..].split_once(quote)?;
        self.rest = rest;
        Some(text.to_owned())
    }

    fn boolean(&mut self) -> Option<bool> {
        self.rest = self.rest.trim_start();
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Some(value);
            }
        }
        None
    }

    fn integer(&mut self) -> Option<usize> {
        self.rest = self.rest.trim_start();
        let end = self
            .rest
            .find(|sign: char| !sign.is_ascii_digit())
            .unwrap_or(self.rest.len());
        let number = self.rest[..end].parse().ok()?;
        // Python 2 wrote an L behind long integers.
        self.rest = self.rest[end..].trim_start_matches('L');
        Some(number)
    }

    fn tuple(&mut self) -> Option<Vec<usize>> {
        /// Numpy allows 64.
        const MAX_DIMENSIONS: usize = 64;
        self.sign('(')?;
        let mut numbers = Vec::new();
        while self.sign(')').is_none() {
            numbers.push(self.integer()?);
            let _ = self.sign(',');
            if numbers.len() > MAX_DIMENSIONS {
                return None;
            }
        }
        Some(numbers)
    }

    fn kind(&mut self) -> Option<ArrayLayout> {
        if self.sign('[').is_none() {
            let (number, _) = element(&self.string()?)?;
            return number.map(ArrayLayout::Table);
        }
        let mut fields = Vec::new();
        let mut offset = 0usize;
        while self.sign(']').is_none() {
            self.sign('(')?;
            // A title may come before the name.
            let name = if self.sign('(').is_some() {
                let _title = self.string()?;
                self.sign(',')?;
                let name = self.string()?;
                self.sign(')')?;
                name
            } else {
                self.string()?
            };
            self.sign(',')?;
            let (number, bytes) = element(&self.string()?)?;
            let mut length = 1usize;
            if self.sign(',').is_some() {
                for side in self.tuple()? {
                    length = length.checked_mul(side)?;
                }
            }
            self.sign(')')?;
            let _ = self.sign(',');
            fields.push(RecordField {
                name,
                number,
                offset,
                length,
            });
            offset = offset.checked_add(bytes.checked_mul(length)?)?;
        }
        Some(ArrayLayout::Records {
            fields,
            row_bytes: offset,
        })
    }
}

/// What `<f4` and its like mean, and the bytes that it takes.
fn element(name: &str) -> Option<(Option<Number>, usize)> {
    let (order, rest) = match name.chars().next()? {
        order @ ('<' | '>' | '|' | '=') => (order, &name[1..]),
        _ => ('<', name),
    };
    let kind = rest.chars().next().filter(char::is_ascii)?;
    let size: usize = rest[1..].parse().ok()?;
    let scalar = match (kind, size) {
        ('b' | 'u', 1) => Scalar::U8,
        ('i', 1) => Scalar::I8,
        ('i', 2) => Scalar::I16,
        ('u', 2) => Scalar::U16,
        ('i', 4) => Scalar::I32,
        ('u', 4) => Scalar::U32,
        ('i', 8) => Scalar::I64,
        ('u', 8) => Scalar::U64,
        ('f', 4) => Scalar::F32,
        ('f', 8) => Scalar::F64,
        ('f', 2) => {
            return Some((
                Some(Number {
                    scalar: None,
                    big_endian: order == '>',
                }),
                2,
            ));
        }
        // Text, raw bytes and complex numbers are stepped over; four bytes are a sign of `U`.
        ('U', _) => return Some((None, size.checked_mul(4)?)),
        ('S' | 'a' | 'V' | 'c' | 'f', _) => return Some((None, size)),
        _ => return None,
    };
    Some((
        Some(Number {
            scalar: Some(scalar),
            big_endian: order == '>',
        }),
        size,
    ))
}

/// A number of half precision.
pub(in crate::io) fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    sign * match i32::from(bits >> 10 & 0x1f) {
        0 => fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        exponent => (1.0 + fraction) * 2f64.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_precision() {
        for (bits, expected) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x3555, 0.333_251_953_125),
            (0x0001, 5.960_464_477_539_063e-8),
            (0xfc00, f64::NEG_INFINITY),
        ] {
            assert_eq!(half(bits), expected, "{bits:#x}");
        }
        assert!(half(0x7e00).is_nan());
    }
}
