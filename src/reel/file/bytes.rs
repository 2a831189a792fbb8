//! Numbers and texts as bytes, little-endian; whole numbers in groups of seven bits, lowest first.

use crate::reel::error::Fault;

/// Appends.
#[derive(Debug, Default)]
pub(in crate::reel) struct ByteWriter {
    pub(in crate::reel) bytes: Vec<u8>,
}

impl ByteWriter {
    pub(in crate::reel) fn byte(&mut self, byte: u8) {
        self.bytes.push(byte);
    }

    /// Seven bits a byte, the highest bit set where more follow.
    pub(in crate::reel) fn number(&mut self, mut number: u64) {
        while number >= 1 << 7 {
            self.bytes.push(number as u8 | 1 << 7);
            number >>= 7;
        }
        self.bytes.push(number as u8);
    }

    pub(in crate::reel) fn u32(&mut self, number: u32) {
        self.bytes.extend(number.to_le_bytes());
    }

    pub(in crate::reel) fn f32(&mut self, number: f32) {
        self.bytes.extend(number.to_le_bytes());
    }

    pub(in crate::reel) fn f64(&mut self, number: f64) {
        self.bytes.extend(number.to_le_bytes());
    }

    /// Its length, then UTF-8.
    pub(in crate::reel) fn text(&mut self, text: &str) {
        self.number(text.len() as u64);
        self.bytes.extend(text.as_bytes());
    }
}

/// Takes from the front; every answer is an error where the bytes end before it.
#[derive(Debug, Clone)]
pub(in crate::reel) struct ByteReader<'a> {
    rest: &'a [u8],
}

impl<'a> ByteReader<'a> {
    pub(in crate::reel) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(in crate::reel) fn left(&self) -> usize {
        self.rest.len()
    }

    pub(in crate::reel) fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let (taken, rest) = self
            .rest
            .split_at_checked(count)
            .ok_or_else(|| Fault::new(format!("{count} bytes were expected, {} are left", self.rest.len())))?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        Ok(bytes)
    }

    pub(in crate::reel) fn byte(&mut self) -> Result<u8, Fault> {
        Ok(self.array::<1>()?[0])
    }

    pub(in crate::reel) fn number(&mut self) -> Result<u64, Fault> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            if bits << shift >> shift != bits {
                break;
            }
            number |= bits << shift;
            if byte < 1 << 7 {
                return Ok(number);
            }
        }
        Err(Fault::new("a whole number has more than 64 bits"))
    }

    /// A number of items of at least one byte each.
    pub(in crate::reel) fn count(&mut self, what: &str) -> Result<usize, Fault> {
        let count = self.number()?;
        if count > self.left() as u64 {
            return Err(Fault::new(format!("{count} {what} do not fit {} bytes", self.left())));
        }
        Ok(count as usize)
    }

    pub(in crate::reel) fn u32(&mut self) -> Result<u32, Fault> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub(in crate::reel) fn f32(&mut self) -> Result<f32, Fault> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    pub(in crate::reel) fn f64(&mut self) -> Result<f64, Fault> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    pub(in crate::reel) fn text(&mut self) -> Result<String, Fault> {
        let length = self.count("bytes of a text")?;
        let bytes = self.take(length)?;
        let text = std::str::from_utf8(bytes).map_err(|_| Fault::new("a text is not UTF-8"))?;
        Ok(text.to_owned())
    }

    /// An error unless all was taken.
    pub(in crate::reel) fn end(&self) -> Result<(), Fault> {
        match self.rest.len() {
            0 => Ok(()),
            rest => Err(Fault::new(format!("{rest} bytes are left over"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bytes_round_trip(number in any::<u64>(), text in ".{0,20}", value in any::<f64>()) {
            let mut writer = ByteWriter::default();
            writer.number(number);
            writer.text(&text);
            writer.f64(value);
            let mut reader = ByteReader::new(&writer.bytes);
            prop_assert_eq!(reader.number(), Ok(number));
            prop_assert_eq!(reader.text(), Ok(text));
            prop_assert_eq!(reader.f64().map(f64::to_bits), Ok(value.to_bits()));
            prop_assert_eq!(reader.end(), Ok(()));
            prop_assert!(reader.byte().is_err());
        }
    }

    #[test]
    fn unterminated_numbers_are_rejected() {
        assert!(ByteReader::new(&[0xff; 20]).number().is_err());
        assert!(ByteReader::new(&[0xff; 9]).number().is_err());
        assert!(ByteReader::new(&[200, 1]).count("things").is_err());
    }
}
