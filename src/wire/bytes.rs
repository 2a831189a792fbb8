//! Fields of a message, one after the other.

use super::error::WireError;

/// Bytes that are taken from the front.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
    /// Description of the bytes, for errors.
    what: &'static str,
}

impl<'a> Fields<'a> {
    pub(super) fn new(bytes: &'a [u8], what: &'static str) -> Self {
        Self { bytes, what }
    }

    /// The next bytes.
    pub(super) fn take(&mut self, count: u64) -> Result<&'a [u8], WireError> {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        let (taken, rest) = self
            .bytes
            .split_at_checked(count)
            .ok_or(WireError::IsTruncated { within: self.what })?;
        self.bytes = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], WireError> {
        let (taken, rest) = self
            .bytes
            .split_first_chunk::<N>()
            .ok_or(WireError::IsTruncated { within: self.what })?;
        self.bytes = rest;
        Ok(*taken)
    }

    pub(super) fn u32(&mut self) -> Result<u32, WireError> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, WireError> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Result<f64, WireError> {
        self.array().map(f64::from_le_bytes)
    }

    pub(super) fn f32s<const N: usize>(&mut self) -> Result<[f32; N], WireError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.array().map(f32::from_le_bytes)?;
        }
        Ok(numbers)
    }

    pub(super) fn f64s<const N: usize>(&mut self) -> Result<[f64; N], WireError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }
}

/// Bytes that are written one field after the other.
#[derive(Debug, Default)]
pub(super) struct Written(pub(super) Vec<u8>);

impl Written {
    pub(super) fn u32(&mut self, number: u32) -> &mut Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn u64(&mut self, number: u64) -> &mut Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn f64s(&mut self, numbers: &[f64]) -> &mut Self {
        self.0.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        self
    }

    pub(super) fn f32s(&mut self, numbers: &[f32]) -> &mut Self {
        self.0.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        self
    }
}

/// Single floats; the number of bytes must be a multiple of four.
pub(super) fn f32s(bytes: &[u8]) -> Vec<f32> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|&bytes| f32::from_le_bytes(bytes))
        .collect()
}

/// Triples of single floats; the number of bytes must be a multiple of twelve.
pub(super) fn f32_triples(bytes: &[u8]) -> Vec<[f32; 3]> {
    let triples = bytes.as_chunks::<12>().0.iter();
    let number =
        |bytes: &[u8; 12], at: usize| f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    triples
        .map(|triple| [number(triple, 0), number(triple, 4), number(triple, 8)])
        .collect()
}
