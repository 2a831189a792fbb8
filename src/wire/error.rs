//! Wire format errors.

use std::io;

/// Reasons why bytes are not a stream, or no more of it can be read. Messages are the end of a sentence that names the
/// address or the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WireError {
    /// Something else is there.
    #[error(
        "this is not a live stream of pointreel: it begins with {found}. Check the port, and that \
         `pointreel serve INPUT --live` listens there"
    )]
    NotAStream {
        /// The first bytes, in quotes.
        found: String,
    },
    /// A version that is not known.
    #[error("the stream has version {found}, and {known} is read: use the same pointreel on both sides")]
    Version {
        /// Version of the stream.
        found: u32,
        /// Supported version.
        known: u32,
    },
    /// A length that is larger than any may be.
    #[error("{what} claims {bytes} bytes, and {max} are read: raise --max-memory if that is right")]
    TooLong {
        /// Part of the stream with the excessive length.
        what: &'static str,
        /// Claimed length, in bytes.
        bytes: u64,
        /// The limit.
        max: u64,
    },
    /// A payload that is another than was sent.
    #[error("a message of {bytes} bytes has another checksum than it claims: its bytes were changed on the way")]
    Checksum {
        /// Bytes of the payload.
        bytes: usize,
    },
    /// A field of a message that cannot be.
    #[error("{what}: {reason}")]
    Malformed {
        /// Malformed part of the message.
        what: &'static str,
        /// Reason for the error.
        reason: String,
    },
    /// Unexpected end of the stream: it is truncated.
    #[error("the stream ends within {within}")]
    IsTruncated {
        /// Part of the stream that was being read.
        within: &'static str,
    },
    /// The end, between two messages.
    #[error("the stream has ended")]
    Ended,
    /// The system could not read.
    #[error("nothing can be read any more ({0})")]
    Io(#[source] io::Error),
}

impl WireError {
    pub(super) fn malformed(what: &'static str, reason: impl Into<String>) -> Self {
        Self::Malformed {
            what,
            reason: reason.into(),
        }
    }

    /// Returns true if retrying is of no use: another program, or another version of this one, is there.
    pub fn is_final(&self) -> bool {
        matches!(self, Self::NotAStream { .. } | Self::Version { .. })
    }
}
