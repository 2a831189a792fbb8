//! Frames: which one, when, and its images or points.

use super::bytes::{Fields, Written};
use super::error::WireError;
use super::images::ReceivedImages;
use super::message::{Kind, Message};
use super::points::ReceivedPoints;
use std::sync::Arc;

/// Bytes before the body of a frame, as this version writes them.
pub(super) const FRAME_HEAD_BYTES: usize = 32;

/// Name of the part being read, for errors.
const WHAT: &str = "the head of a frame";

/// Frame header: identifies the frame, and states when it was served.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameHead {
    /// Index of the frame in the sequence being played.
    pub index: u32,
    /// Frames that the server has played before; missing numbers were dropped on the way.
    pub number: u64,
    /// Due time, ns since the stream began; goes on where the sequence begins again.
    pub time_ns: u64,
    /// The clock of the server when it was handed to all clients, ns.
    pub served_ns: u64,
}

/// A frame that was received.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Frame header.
    pub head: FrameHead,
    /// Frame content.
    pub content: Content,
    /// Bytes of its payload.
    pub byte_size: usize,
}

/// Content of a frame.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Content {
    /// A depth image and colours.
    Images(Box<ReceivedImages>),
    /// A point cloud.
    Points(ReceivedPoints),
}

impl FrameHead {
    /// Its bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut head = Written(Vec::with_capacity(FRAME_HEAD_BYTES));
        head.u32(FRAME_HEAD_BYTES as u32)
            .u32(self.index)
            .u64(self.number)
            .u64(self.time_ns)
            .u64(self.served_ns);
        head.0
    }

    /// The head that `payload` begins with, and where its body begins.
    pub fn parse(payload: &[u8]) -> Result<(Self, usize), WireError> {
        let (head, bytes) = Self::parse_begin(payload)?;
        if !(FRAME_HEAD_BYTES..=payload.len()).contains(&bytes) {
            let reason = format!(
                "it claims {bytes} bytes, expected {FRAME_HEAD_BYTES} to {}",
                payload.len()
            );
            return Err(WireError::malformed(WHAT, reason));
        }
        Ok((head, bytes))
    }

    /// Parses the frame head from the first [`FRAME_HEAD_BYTES`] of a payload whose end is not there.
    pub(crate) fn parse_begin(begin: &[u8]) -> Result<(Self, usize), WireError> {
        let mut fields = Fields::new(begin, WHAT);
        let bytes = fields.u32()? as usize;
        let head = Self {
            index: fields.u32()?,
            number: fields.u64()?,
            time_ns: fields.u64()?,
            served_ns: fields.u64()?,
        };
        Ok((head, bytes))
    }
}

impl Frame {
    /// The frame in `message`; `None` if it is none.
    ///
    /// # Errors
    /// [`WireError`], for a frame that cannot be.
    pub fn of(message: Message) -> Result<Option<Self>, WireError> {
        let Message { kind, payload } = message;
        if !kind.is_frame() {
            return Ok(None);
        }
        let (head, body) = FrameHead::parse(&payload)?;
        let byte_size = payload.len();
        let payload = Arc::new(payload);
        let content = match kind {
            Kind::Images => Content::Images(Box::new(ReceivedImages::parse(&payload, body)?)),
            _ => Content::Points(ReceivedPoints::new(payload, body)),
        };
        Ok(Some(Self {
            head,
            content,
            byte_size,
        }))
    }
}
