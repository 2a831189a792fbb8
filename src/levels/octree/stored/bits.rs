//! Numbers of any number of bits, one after the other, from the lowest bit of each byte up.

/// Appends numbers.
#[derive(Debug, Default)]
pub(super) struct BitWriter {
    bytes: Vec<u8>,
    /// Bits that are not in `bytes` yet: fewer than 64.
    pending: u128,
    pending_bits: u32,
}

impl BitWriter {
    /// Appends the `bits` lowest bits of `value`, at most 64. Precondition: all above them are zero.
    pub(super) fn put(&mut self, value: u64, bits: u32) {
        self.pending |= u128::from(value) << self.pending_bits;
        self.pending_bits += bits;
        if self.pending_bits >= u64::BITS {
            let word = self.pending as u64;
            self.bytes.extend_from_slice(&word.to_le_bytes());
            self.pending >>= u64::BITS;
            self.pending_bits -= u64::BITS;
        }
    }

    /// Appends a number in so many bits more than twice its logarithm: as many zeros as it has bits beyond its highest,
    /// a one, and those bits (Elias 1975, the code γ; there the bits stand highest first). Precondition: it is not 0.
    pub(super) fn put_gamma(&mut self, value: u32) {
        let beyond = value.ilog2();
        self.put(1 << beyond, beyond + 1);
        self.put(u64::from(value) ^ 1 << beyond, beyond);
    }

    /// All of it, filled up to a byte with zeros.
    pub(super) fn into_bytes(mut self) -> Vec<u8> {
        let rest = self.pending_bits.div_ceil(u8::BITS) as usize;
        let word = self.pending.to_le_bytes();
        self.bytes.extend_from_slice(&word[..rest]);
        self.bytes
    }
}

/// Takes numbers that [`BitWriter`] wrote. Every answer is `None` where the bytes end before it.
#[derive(Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    next_bit: usize,
}

impl<'a> BitReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, next_bit: 0 }
    }

    /// The next 64 bits; zeros beyond the end.
    #[inline]
    fn window(&self) -> u64 {
        let byte = self.next_bit / 8;
        let mut word = [0; 16];
        if let Some(bytes) = self.bytes.get(byte..byte + 16) {
            word.copy_from_slice(bytes);
        } else {
            let rest = self.bytes.get(byte..).unwrap_or_default();
            word[..rest.len()].copy_from_slice(rest);
        }
        (u128::from_le_bytes(word) >> (self.next_bit % 8)) as u64
    }

    fn skip(&mut self, bits: u32) -> Option<()> {
        let next_bit = self.next_bit + bits as usize;
        (next_bit <= 8 * self.bytes.len()).then(|| self.next_bit = next_bit)
    }

    /// The next number of so many bits, at most 63.
    pub(super) fn take(&mut self, bits: u32) -> Option<u64> {
        let value = self.window() & ((1 << bits) - 1);
        self.skip(bits).map(|()| value)
    }

    /// The next number of [`BitWriter::put_gamma`]; `None` too if it has more than 32 bits.
    pub(super) fn take_gamma(&mut self) -> Option<u32> {
        // At most 63 bits, so all of it is in here.
        let window = self.window();
        let beyond = window.trailing_zeros();
        if beyond >= u32::BITS {
            return None;
        }
        let low = (window >> (beyond + 1)) & ((1 << beyond) - 1);
        self.skip(2 * beyond + 1)?;
        Some(1 << beyond | low as u32)
    }

    /// The bytes after the one that holds the last bit taken; `None` unless the bits left over in that one are zeros.
    pub(super) fn into_rest(self) -> Option<&'a [u8]> {
        let begun = self.next_bit % 8;
        let is_filled_with_zeros = begun == 0 || self.bytes[self.next_bit / 8] >> begun == 0;
        is_filled_with_zeros.then(|| &self.bytes[self.next_bit.div_ceil(8)..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn gamma_codes_by_hand() {
        let mut writer = BitWriter::default();
        for value in [1, 2, 3, 4] {
            writer.put_gamma(value);
        }
        // From the lowest bit: 1; 01 0; 01 1; 001 00.
        assert_eq!(writer.into_bytes(), [0b0110_0101, 0b0000_0010]);
    }

    #[test]
    fn codes_without_end_or_with_too_many_bits_are_none() {
        assert_eq!(BitReader::new(&[0; 3]).take_gamma(), None);
        assert_eq!(BitReader::new(&[0, 0, 0, 0, 1, 255]).take_gamma(), None);
        assert_eq!(BitReader::new(&[0, 0, 0, 128]).take_gamma(), None);
        assert_eq!(BitReader::new(&[]).take(1), None);
        assert_eq!(BitReader::new(&[]).take(0), Some(0));
        let mut reader = BitReader::new(&[0b0000_0101]);
        assert_eq!(reader.take(2), Some(1));
        assert_eq!(reader.into_rest(), None);
    }

    proptest! {
        #[test]
        fn what_is_put_is_taken(numbers in prop::collection::vec((any::<u64>(), 0u32..=63, 1u32..), 0..60)) {
            let mut writer = BitWriter::default();
            for &(value, bits, counted) in &numbers {
                writer.put(value & ((1 << bits) - 1), bits);
                writer.put_gamma(counted);
            }
            let mut bytes = writer.into_bytes();
            let end = bytes.len();
            bytes.extend([7, 9]);
            let mut reader = BitReader::new(&bytes);
            for (value, bits, counted) in numbers {
                prop_assert_eq!(reader.take(bits), Some(value & ((1 << bits) - 1)));
                prop_assert_eq!(reader.take_gamma(), Some(counted));
            }
            prop_assert_eq!(reader.into_rest(), Some(&bytes[end..]));
        }
    }
}
