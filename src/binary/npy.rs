//! The header of an array of numpy (NPY format 1 to 3): type, order and shape.
//!
//! It is a Python dictionary of three known keys, read character by character: the available crates parse any Python
//! literal, of any depth, on the stack. Nothing is allocated by its claims; the caller checks the number of values that
//! follow.

use super::scalar::Scalar;

/// Magic bytes at the beginning of every array.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Header of an array: its description before the numbers.
#[derive(Debug)]
pub(crate) struct Header {
    /// Entries along each dimension.
    pub(crate) shape: Vec<usize>,
    pub(crate) layout: Layout,
    /// True if the first index changes fastest (Fortran order).
    pub(crate) is_fortran: bool,
    /// Byte of the file at which the entries begin.
    pub(crate) payload_at: usize,
}

/// Layout of the entries.
#[derive(Debug)]
pub(crate) enum Layout {
    /// Numbers.
    Table(Number),
    /// Named numbers.
    Records { fields: Vec<Field>, row_bytes: usize },
}

/// A field of a record.
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) name: String,
    /// None for text and other data.
    pub(crate) number: Option<Number>,
    pub(crate) offset: usize,
    /// Number of values it consists of.
    pub(crate) length: usize,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Number {
    /// None for half precision.
    pub(crate) scalar: Option<Scalar>,
    pub(crate) big_endian: bool,
}

/// Errors of header parsing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum HeaderError {
    #[error("it does not begin with `\\x93NUMPY`: this is not an NPY file")]
    NoMagic,
    #[error("the file ends within its header: it is truncated")]
    Truncated,
    #[error("version {0} is not known, expected 1 to 3")]
    Version(u8),
    #[error(
        "the header is not understood: expected a dictionary of `descr`, `fortran_order` and `shape`, and types that \
         are numbers"
    )]
    NotUnderstood,
    #[error(
        "its values are pickled Python objects, which are code and never run here: save the arrays with numpy.savez, \
         as in numpy.savez('frames.npz', **arrays), or a single one with numpy.save"
    )]
    Pickled,
    #[error("its values are text or other non-numeric data, expected x, y and z of points")]
    Words,
}

impl Number {
    /// Bytes that it takes.
    pub(crate) fn bytes(self) -> usize {
        self.scalar.map_or(2, Scalar::byte_size)
    }

    /// The number at the begin of `bytes`. Precondition: they are at least [`Self::bytes`].
    pub(crate) fn read(self, bytes: &[u8]) -> f64 {
        let pair = [bytes[0], bytes.get(1).copied().unwrap_or_default()];
        match self.scalar {
            Some(scalar) => scalar.read(bytes, self.big_endian),
            None if self.big_endian => half(u16::from_be_bytes(pair)),
            None => half(u16::from_le_bytes(pair)),
        }
    }
}

impl Header {
    /// The header that `bytes` begin with; they may end anywhere behind it.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, HeaderError> {
        let Some([major, _]) = bytes.strip_prefix(MAGIC).and_then(|rest| rest.first_chunk()) else {
            // The first bytes that `pickle` and `numpy.ndarray.dump` write, protocols 2 to 5.
            let is_pickle = matches!(bytes, [0x80, 2..=5, ..]);
            return Err(if is_pickle {
                HeaderError::Pickled
            } else {
                HeaderError::NoMagic
            });
        };
        let (start, length) = match (major, &bytes[MAGIC.len() + 2..]) {
            (1, [low, high, ..]) => (10, usize::from(u16::from_le_bytes([*low, *high]))),
            (2 | 3, [a, b, c, d, ..]) => (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
            (1..=3, _) => return Err(HeaderError::Truncated),
            _ => return Err(HeaderError::Version(*major)),
        };
        // `npyz` 0.9 allocates whatever length a header claims, and parses any Python literal.
        let (header, _) = bytes[start..].split_at_checked(length).ok_or(HeaderError::Truncated)?;
        let text = String::from_utf8_lossy(header);
        Dictionary::parse(&text, start + length).ok_or_else(|| {
            // The object type, alone or in a record, with or without a byte order, which it does not have.
            let is_object = ["'|O'", "'O'", "'<O'", "'>O'"].iter().any(|kind| text.contains(kind));
            let is_word = ["'<U", "'>U", "'|S", "'|V", "'<c", "'<M", "'<m"]
                .iter()
                .any(|kind| text.contains(kind));
            if is_object {
                HeaderError::Pickled
            } else if is_word {
                HeaderError::Words
            } else {
                HeaderError::NotUnderstood
            }
        })
    }

    /// Bytes of an entry.
    pub(crate) fn row_bytes(&self) -> usize {
        match &self.layout {
            Layout::Table(number) => number.bytes(),
            Layout::Records { row_bytes, .. } => *row_bytes,
        }
    }
}

/// A reader of the dictionary, sign by sign and without looking back.
struct Dictionary<'a> {
    rest: &'a str,
}

impl Dictionary<'_> {
    /// The header that the text is, whose payload is at `payload_at`.
    fn parse(text: &str, payload_at: usize) -> Option<Header> {
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
        Some(Header {
            shape: shape?,
            layout: kind?,
            is_fortran: is_fortran?,
            payload_at,
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
        // Python 2 appended an L to long integers.
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

    fn kind(&mut self) -> Option<Layout> {
        if self.sign('[').is_none() {
            let (number, _) = element(&self.string()?)?;
            return number.map(Layout::Table);
        }
        let mut fields = Vec::new();
        let mut offset = 0usize;
        while self.sign(']').is_none() {
            self.sign('(')?;
            // A title may precede the name.
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
            fields.push(Field {
                name,
                number,
                offset,
                length,
            });
            offset = offset.checked_add(bytes.checked_mul(length)?)?;
        }
        Some(Layout::Records {
            fields,
            row_bytes: offset,
        })
    }
}

/// Parses an element type such as `<f4`, and returns its number type and byte size.
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
        // Text, raw bytes and complex numbers are skipped; a character of `U` takes four bytes.
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
pub(crate) fn half(bits: u16) -> f64 {
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
