//! Numbers and strings read one after the other from bytes, as messages and records have them.

/// Remaining bytes to read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
    big_endian: bool,
    /// Numbers lie at multiples of their size, or of this, if that is less.
    max_alignment: usize,
}

impl<'a> Bytes<'a> {
    /// Little endian without gaps.
    pub(super) fn new(all: &'a [u8]) -> Self {
        Self {
            all,
            at: 0,
            big_endian: false,
            max_alignment: 1,
        }
    }

    /// As CDR has it: numbers lie at multiples of their size, up to `max_alignment` bytes.
    pub(super) fn aligned(all: &'a [u8], big_endian: bool, max_alignment: usize) -> Self {
        Self {
            all,
            at: 0,
            big_endian,
            max_alignment,
        }
    }

    /// Returns the position of the next read.
    pub(super) fn position(&self) -> usize {
        self.at
    }

    pub(super) fn is_empty(&self) -> bool {
        self.at == self.all.len()
    }

    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.all.get(self.at..self.at.checked_add(count)?)?;
        self.at += count;
        Some(taken)
    }

    fn number<const SIZE: usize>(&mut self) -> Option<[u8; SIZE]> {
        self.at = self.at.checked_next_multiple_of(SIZE.min(self.max_alignment))?;
        let mut raw: [u8; SIZE] = self.take(SIZE)?.try_into().ok()?;
        if self.big_endian {
            raw.reverse();
        }
        Some(raw)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.number().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.number().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.number().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.number().map(u64::from_le_bytes)
    }

    pub(super) fn f32(&mut self) -> Option<f32> {
        self.number().map(f32::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        self.number().map(f64::from_le_bytes)
    }

    /// `COUNT` of them.
    pub(super) fn f64s<const COUNT: usize>(&mut self) -> Option<[f64; COUNT]> {
        let mut numbers = [0.0; COUNT];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Some(numbers)
    }

    /// Bytes behind their number.
    pub(super) fn counted(&mut self) -> Option<&'a [u8]> {
        let count = self.u32()?;
        self.take(count as usize)
    }

    /// Text behind the number of its bytes, without the zero that CDR puts behind it.
    pub(super) fn text(&mut self) -> Option<String> {
        let text = self.counted()?;
        let text = text.strip_suffix(b"\0").unwrap_or(text);
        Some(String::from_utf8_lossy(text).into_owned())
    }
}
