//! ROS serialisation: reads the consecutively written fields of a message.

use super::bytes::Bytes;
use std::time::Duration;

/// Kind of CDR and options, before the message itself.
const CDR_HEAD_BYTES: usize = 4;
const NANOS_PER_SECOND: u32 = 1_000_000_000;

/// Serialisation of the consecutively written fields of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Serialisation {
    /// ROS 1: little endian without gaps.
    Ros1,
    /// ROS 2: numbers at multiples of their size, in the byte order that the first bytes say.
    Cdr,
}

/// `std_msgs/Header`.
pub(super) struct MessageHeader<'a> {
    /// As it is written, be it a time of a recording or not.
    pub(super) time: Duration,
    /// The name of the coordinate frame.
    pub(super) frame_id: &'a [u8],
}

impl Serialisation {
    /// By its name in a recording.
    pub(super) fn of(encoding: &str) -> Option<Self> {
        match encoding {
            "ros1" => Some(Self::Ros1),
            "cdr" => Some(Self::Cdr),
            _ => None,
        }
    }

    /// The fields of `message`, after the encapsulation header.
    pub(super) fn body(self, message: &[u8]) -> Option<Bytes<'_>> {
        match self {
            Self::Ros1 => Some(Bytes::new(message)),
            Self::Cdr => {
                let (head, rest) = message.split_at_checked(CDR_HEAD_BYTES)?;
                // Plain CDR of the first version, and of the second, in which 8-byte numbers are aligned to multiples
                // of 4.
                match head[..2] {
                    [0, 0] => Some(Bytes::aligned(rest, true, 8)),
                    [0, 1] => Some(Bytes::aligned(rest, false, 8)),
                    [0, 6] => Some(Bytes::aligned(rest, true, 4)),
                    [0, 7] => Some(Bytes::aligned(rest, false, 4)),
                    _ => None,
                }
            }
        }
    }

    /// The header at the beginning of `fields`.
    pub(super) fn header<'a>(self, fields: &mut Bytes<'a>) -> Option<MessageHeader<'a>> {
        let (seconds, nanos) = self.time(fields)?;
        let frame_id = fields.counted()?;
        Some(MessageHeader {
            time: Duration::new(seconds.into(), nanos),
            frame_id: frame_id.strip_suffix(b"\0").unwrap_or(frame_id),
        })
    }

    /// Acquisition time in the header of a message, if `start`, its first bytes, has it.
    pub(super) fn stamp(self, start: &[u8]) -> Option<Duration> {
        let (seconds, nanos) = self.time(&mut self.body(start)?)?;
        // ROS 2 has signed 32-bit seconds: no recording is from before 1970.
        let is_negative = self == Self::Cdr && seconds > i32::MAX as u32;
        let is_time = !is_negative && nanos < NANOS_PER_SECOND && (seconds, nanos) != (0, 0);
        is_time.then(|| Duration::new(seconds.into(), nanos))
    }

    /// The seconds and nanoseconds of a header.
    fn time(self, fields: &mut Bytes<'_>) -> Option<(u32, u32)> {
        if self == Self::Ros1 {
            let _sequence = fields.u32()?;
        }
        Some((fields.u32()?, fields.u32()?))
    }
}
