//! Stream header.

use super::bytes::{Fields, Written};
use super::error::WireError;
use std::io::{ErrorKind, Read};

/// The first bytes of a stream.
pub const MAGIC: [u8; 8] = *b"\x89live\r\n\x1a";

/// The version that is written and read.
pub const VERSION: u32 = 1;

/// Bytes of the head as this version writes it.
pub const HEAD_BYTES: usize = 48;

/// Magic, version, and the number of bytes behind them.
const FIXED_BYTES: usize = 16;

/// Maximum number of bytes read after the fixed ones: later writers may add unknown fields.
const MAX_BYTES: u32 = 1 << 16;

/// Bytes of something else that an error quotes.
const QUOTED: usize = 8;

/// Header at the start of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamHead {
    /// A number of this run of the server: another number is another run, whose frames are counted from 0 again.
    pub session: u64,
    /// The clock of the server when this was sent, ns since the server began.
    pub clock_ns: u64,
    /// Frame rate, in frames per second.
    pub fps: f64,
    /// The time of day when this was sent, ns since 1970 by the clock of the server's machine.
    pub wall_ns: u64,
}

impl StreamHead {
    /// Its bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut head = Written(MAGIC.to_vec());
        head.u32(VERSION)
            .u32((HEAD_BYTES - FIXED_BYTES) as u32)
            .u64(self.session)
            .u64(self.clock_ns)
            .f64s(&[self.fps])
            .u64(self.wall_ns);
        head.0
    }

    /// Reads the head of a stream.
    ///
    /// # Errors
    /// [`WireError`]: [`WireError::Ended`] if there is nothing at all.
    pub fn read(reader: &mut impl Read) -> Result<Self, WireError> {
        const WITHIN: &str = "its head";
        let mut magic = [0; MAGIC.len()];
        let mut count = 0;
        // Something else is recognised by the bytes it has sent: it may send no more.
        while count < magic.len() && magic[..count] == MAGIC[..count] {
            match reader.read(&mut magic[count..]) {
                Ok(0) => break,
                Ok(more) => count += more,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(WireError::Io(error)),
            }
        }
        if count == 0 {
            return Err(WireError::Ended);
        }
        if magic[..count] != MAGIC[..count] {
            let found = String::from_utf8_lossy(&magic[..count.min(QUOTED)]);
            return Err(WireError::NotAStream {
                found: format!("`{}`", found.escape_default()),
            });
        }
        if count < magic.len() {
            return Err(WireError::IsTruncated { within: WITHIN });
        }
        let mut fixed = [0; FIXED_BYTES - MAGIC.len()];
        read_exact(reader, &mut fixed, WITHIN)?;
        let mut fields = Fields::new(&fixed, WITHIN);
        let (version, more) = (fields.u32()?, fields.u32()?);
        if version != VERSION {
            return Err(WireError::Version {
                found: version,
                known: VERSION,
            });
        }
        if more > MAX_BYTES {
            return Err(WireError::TooLong {
                what: "the head of the stream",
                bytes: more.into(),
                max: MAX_BYTES.into(),
            });
        }
        let mut rest = vec![0; more as usize];
        read_exact(reader, &mut rest, WITHIN)?;
        let mut fields = Fields::new(&rest, WITHIN);
        let head = Self {
            session: fields.u64()?,
            clock_ns: fields.u64()?,
            fps: fields.f64()?,
            wall_ns: fields.u64()?,
        };
        if !(head.fps.is_finite() && head.fps > 0.0) {
            let reason = format!("{} frames per second, expected a number above 0", head.fps);
            return Err(WireError::malformed("the head of the stream", reason));
        }
        Ok(head)
    }
}

/// All of `bytes`.
pub(super) fn read_exact(reader: &mut impl Read, bytes: &mut [u8], within: &'static str) -> Result<(), WireError> {
    reader.read_exact(bytes).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => WireError::IsTruncated { within },
        _ => WireError::Io(error),
    })
}
