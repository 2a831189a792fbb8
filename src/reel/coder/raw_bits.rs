//! Bits that are equally likely 0 or 1, the lowest first: stored verbatim.

/// Bytes that are looked at for them, wherever in the first one they begin.
const WINDOW: usize = 8;

/// Writes bits.
#[derive(Debug, Default)]
pub(super) struct RawWriter {
    bytes: Vec<u8>,
    /// Bits that do not fill a byte yet.
    last: u64,
    bits: u32,
}

impl RawWriter {
    /// The lowest `bits` bits of a number, at most 32.
    pub(super) fn write(&mut self, bits: u32, value: u32) {
        let retained = u64::from(value) & ((1 << bits) - 1);
        self.last |= retained << self.bits;
        self.bits += bits;
        while self.bits >= 8 {
            self.bytes.push(self.last as u8);
            self.last >>= 8;
            self.bits -= 8;
        }
    }

    /// All bytes; the last is filled up by zeros.
    pub(super) fn finish(mut self) -> Vec<u8> {
        if self.bits > 0 {
            self.bytes.push(self.last as u8);
        }
        self.bytes
    }
}

/// Reads bits. Behind the last byte are zeros.
#[derive(Debug, Default)]
pub(super) struct RawReader<'a> {
    bytes: &'a [u8],
    /// Bits that were read.
    read: usize,
}

/// The bytes from a place near the end on.
#[cold]
fn last_bytes(bytes: &[u8], start: usize) -> [u8; WINDOW] {
    let mut window = [0; WINDOW];
    let rest = bytes.get(start..).unwrap_or_default();
    let count = rest.len().min(WINDOW);
    window[..count].copy_from_slice(&rest[..count]);
    window
}

impl<'a> RawReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, read: 0 }
    }

    /// The next bits, at most 32.
    #[inline(always)]
    pub(super) fn read(&mut self, bits: u32) -> u32 {
        let start = self.read / 8;
        let window = match self.bytes.get(start..start + WINDOW).and_then(<[u8]>::first_chunk) {
            Some(&window) => window,
            None => last_bytes(self.bytes, start),
        };
        let value = u64::from_le_bytes(window) >> (self.read % 8) & ((1 << bits) - 1);
        self.read += bits as usize;
        value as u32
    }

    /// Returns true if all bits were read, and no more.
    pub(super) fn is_at_end(&self) -> bool {
        self.read.div_ceil(8) == self.bytes.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bits_round_trip(all in prop::collection::vec((0..=32_u32, any::<u32>()), 0..40)) {
            let mut writer = RawWriter::default();
            for &(bits, value) in &all {
                writer.write(bits, value);
            }
            let bytes = writer.finish();
            let mut reader = RawReader::new(&bytes);
            for &(bits, value) in &all {
                prop_assert_eq!(u64::from(reader.read(bits)), u64::from(value) & ((1 << bits) - 1));
            }
            prop_assert!(reader.is_at_end());
            reader.read(8);
            prop_assert!(!reader.is_at_end());
            prop_assert_eq!(reader.read(32), 0);
        }
    }
}
