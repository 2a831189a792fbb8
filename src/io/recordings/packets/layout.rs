//! Capture layout: the state needed to read packets from a given position of a capture on.

use super::link::Link;
use std::time::Duration;

/// Layout of the packets after a position of a capture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Layout {
    /// libpcap.
    Records(Records),
    /// pcapng, within a section.
    Blocks(Section),
}

/// Record format of libpcap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Records {
    pub(super) order: ByteOrder,
    /// With more in the head of each record.
    pub(super) is_modified: bool,
    /// Nanoseconds of a unit of the second number of a time.
    pub(super) nanos_per_tick: u32,
    pub(super) link: Link,
}

/// A section of pcapng.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Section {
    pub(super) order: ByteOrder,
    pub(super) interfaces: Vec<Interface>,
}

/// Capture interface of the packets of a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Interface {
    pub(super) link: Link,
    /// At least 1.
    pub(super) ticks_per_second: u64,
    pub(super) offset_s: i64,
}

/// Byte order of the numbers of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// The number at byte `at`; `None` where `bytes` end before it does.
    pub(super) fn u32(self, bytes: &[u8], at: usize) -> Option<u32> {
        let raw = bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(match self {
            Self::Little => u32::from_le_bytes(raw),
            Self::Big => u32::from_be_bytes(raw),
        })
    }
}

impl Interface {
    /// The time of a packet, since 1970.
    pub(super) fn time(&self, ticks: u64) -> Duration {
        let seconds = (ticks / self.ticks_per_second).saturating_add_signed(self.offset_s);
        let rest = u128::from(ticks % self.ticks_per_second) * 1_000_000_000 / u128::from(self.ticks_per_second);
        // The remainder is less than a second.
        Duration::new(seconds, rest as u32)
    }
}

/// Option `if_tsresol`: a power of ten, or of two with the highest bit.
pub(super) fn ticks_per_second(resolution: u8) -> Option<u64> {
    let power = u32::from(resolution & 0x7f);
    if resolution & 0x80 == 0 {
        10u64.checked_pow(power)
    } else {
        1u64.checked_shl(power)
    }
}
