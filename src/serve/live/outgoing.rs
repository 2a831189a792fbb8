//! A frame as it is sent to every client.

use super::surfels::WholeFrame;
use crate::analysis::screen::ScreenEstimator;
use crate::wire::{FrameHead, Kind, MessageHeader, View, points_body};
use crc32fast::Hasher;
use std::sync::Arc;

/// The body of a frame, which may be sent several times.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub(super) kind: Kind,
    pub(super) bytes: Arc<Vec<u8>>,
    checksum: Hasher,
}

impl Body {
    pub(super) fn new(kind: Kind, bytes: Vec<u8>) -> Self {
        let mut checksum = Hasher::new();
        checksum.update(&bytes);
        Self {
            kind,
            bytes: Arc::new(bytes),
            checksum,
        }
    }
}

/// A frame as it is sent.
#[derive(Debug)]
pub(super) struct Outgoing {
    pub(super) number: u64,
    frame: FrameHead,
    /// The header of the message and the head of the frame.
    pub(super) head: Vec<u8>,
    pub(super) body: Body,
    /// For clients that are sent visible points, if there are any.
    whole: Option<Arc<WholeFrame>>,
}

impl Outgoing {
    pub(super) fn new(head: FrameHead, body: Body) -> Self {
        let frame_head = head.encode();
        let mut checksum = Hasher::new();
        checksum.update(&frame_head);
        checksum.combine(&body.checksum);
        let header = MessageHeader {
            kind: body.kind,
            payload_bytes: (frame_head.len() + body.bytes.len()) as u32,
            checksum: checksum.finalize(),
        };
        let mut bytes = header.encode();
        bytes.extend(frame_head);
        Self {
            number: head.number,
            frame: head,
            head: bytes,
            body,
            whole: None,
        }
    }

    /// Attaches the whole frame with all of its points, for clients that are sent only the points visible in their
    /// view.
    pub(super) fn with_whole(self, whole: Option<Arc<WholeFrame>>) -> Self {
        Self { whole, ..self }
    }

    /// The frame as `view` shows it; `None` if no view had been received when it was made.
    pub(super) fn seen_by(&self, view: &View, estimator: &mut ScreenEstimator) -> Option<Arc<Self>> {
        let seen = self.whole.as_ref()?.seen(view, estimator);
        Some(Arc::new(Self::new(
            self.frame,
            Body::new(Kind::Points, points_body(&seen)),
        )))
    }

    /// Bytes that are sent.
    pub(super) fn byte_size(&self) -> usize {
        self.head.len() + self.body.bytes.len()
    }
}
