//! Messages: kind, length, checksum, payload.

use super::bytes::{Fields, Written};
use super::error::WireError;
use super::head::read_exact;
use std::io::{ErrorKind, Read};

/// Bytes of the header of a message: kind, length, checksum.
pub(super) const HEADER_BYTES: usize = 12;

/// Maximum size of a payload, for any memory: 38 million points with colours and normals.
pub const MAX_PAYLOAD_BYTES: u64 = 1 << 30;

/// Bytes of a payload allocated before any has arrived.
const FIRST_BYTES: usize = 1 << 16;

/// Kind of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A depth image, with colours or without.
    Images,
    /// A point cloud.
    Points,
    /// Time at the server, and the newest frame.
    Now,
    /// The answer to a ping.
    Pong,
    /// The server's reason why there will be no more.
    End,
    /// The client asks for the time.
    Ping,
    /// The client has received a frame.
    Got,
    /// View of the client: it is sent the points visible in this view.
    View,
    /// A message of a later version: it is skipped.
    Other(u32),
}

impl Kind {
    /// Its number.
    pub fn number(self) -> u32 {
        match self {
            Self::Images => 1,
            Self::Points => 2,
            Self::Now => 3,
            Self::Pong => 4,
            Self::End => 5,
            Self::Ping => 16,
            Self::Got => 17,
            Self::View => 18,
            Self::Other(number) => number,
        }
    }

    /// The kind of this number.
    pub fn of(number: u32) -> Self {
        let known = [
            Self::Images,
            Self::Points,
            Self::Now,
            Self::Pong,
            Self::End,
            Self::Ping,
            Self::Got,
            Self::View,
        ];
        let found = known.into_iter().find(|kind| kind.number() == number);
        found.unwrap_or(Self::Other(number))
    }

    /// Returns true if the message is a frame.
    pub fn is_frame(self) -> bool {
        matches!(self, Self::Images | Self::Points)
    }
}

/// A message as it came, with its checksum looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Message kind.
    pub kind: Kind,
    /// Message payload.
    pub payload: Vec<u8>,
}

/// Kind, length and checksum of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MessageHeader {
    pub(crate) kind: Kind,
    pub(crate) payload_bytes: u32,
    pub(crate) checksum: u32,
}

impl MessageHeader {
    pub(crate) fn encode(self) -> Vec<u8> {
        let mut header = Written(Vec::with_capacity(HEADER_BYTES));
        header
            .u32(self.kind.number())
            .u32(self.payload_bytes)
            .u32(self.checksum);
        header.0
    }

    /// The header of the next message; `None` at the end.
    pub(crate) fn read(reader: &mut impl Read) -> Result<Option<Self>, WireError> {
        const WITHIN: &str = "the header of a message";
        let mut bytes = [0; HEADER_BYTES];
        let first = loop {
            match reader.read(&mut bytes) {
                Ok(count) => break count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(WireError::Io(error)),
            }
        };
        if first == 0 {
            return Ok(None);
        }
        read_exact(reader, &mut bytes[first..], WITHIN)?;
        let mut fields = Fields::new(&bytes, WITHIN);
        Ok(Some(Self {
            kind: Kind::of(fields.u32()?),
            payload_bytes: fields.u32()?,
            checksum: fields.u32()?,
        }))
    }
}

impl Message {
    /// A message of this payload. Precondition: it has fewer than 2³² bytes.
    pub fn new(kind: Kind, payload: Vec<u8>) -> Self {
        Self { kind, payload }
    }

    /// The header before its payload.
    pub fn header(&self) -> Vec<u8> {
        let header = MessageHeader {
            kind: self.kind,
            payload_bytes: self.payload.len() as u32,
            checksum: crc32fast::hash(&self.payload),
        };
        header.encode()
    }

    /// All of its bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = self.header();
        bytes.extend(&self.payload);
        bytes
    }
}

/// The next message, whose payload has no more than `max_bytes` (nor than [`MAX_PAYLOAD_BYTES`]).
///
/// Memory grows with the bytes that come, not with the claimed size.
///
/// # Errors
/// [`WireError`]: [`WireError::Ended`] between two messages.
pub fn read_message(reader: &mut impl Read, max_bytes: u64) -> Result<Message, WireError> {
    let header = MessageHeader::read(reader)?.ok_or(WireError::Ended)?;
    let (claimed, max) = (u64::from(header.payload_bytes), max_bytes.min(MAX_PAYLOAD_BYTES));
    if claimed > max {
        return Err(WireError::TooLong {
            what: "a message",
            bytes: claimed,
            max,
        });
    }
    let payload = read_payload(reader, header.payload_bytes as usize)?;
    if crc32fast::hash(&payload) != header.checksum {
        return Err(WireError::Checksum { bytes: payload.len() });
    }
    Ok(Message::new(header.kind, payload))
}

/// `count` bytes. Memory for the first is allocated, then doubled as bytes arrive, but never beyond `count`.
fn read_payload(reader: &mut impl Read, count: usize) -> Result<Vec<u8>, WireError> {
    let mut payload = Vec::new();
    while payload.len() < count {
        let (begin, more) = (payload.len(), payload.len().max(FIRST_BYTES).min(count - payload.len()));
        payload.reserve_exact(more);
        payload.resize(begin + more, 0);
        read_exact(reader, &mut payload[begin..], "a message")?;
    }
    Ok(payload)
}
