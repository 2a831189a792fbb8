//! The wire format of live streams: sent by `pointreel serve --live` and read by `tcp://` inputs.
//!
//! **How it works.** A stream is a head and messages, each with its kind, its length and a checksum. Every frame
//! contains all that is needed to read it (cameras, pose, units), so a client that connects late, misses frames or
//! opens a recording partway through needs nothing that was sent before. All numbers are little endian.
//! ARCHITECTURE.md, "Live streams over TCP", documents the layout in tables.
//!
//! A file with the same bytes is a recording (`.pointreel-stream`).
//!
//! **Bounds.** Payloads are read as they come, and never more than a limit; images and arrays have the number of bytes
//! of their sizes, or are rejected before they are decoded.

mod bytes;
mod cameras;
mod error;
mod frame;
mod head;
mod images;
mod message;
mod packed_image;
mod points;
mod talk;
#[cfg(test)]
mod tests;
mod view;

pub use error::WireError;
pub use frame::{Content, Frame, FrameHead};
pub use head::{HEAD_BYTES, MAGIC, StreamHead, VERSION};
pub use images::{ColorCoding, DepthCoding, ImageCoding, RawImages, ReceivedImages};
pub(crate) use images::{RawColor, images_body};
pub(crate) use message::MessageHeader;
pub use message::{Kind, MAX_PAYLOAD_BYTES, Message, read_message};
pub use packed_image::PackedImage;
pub use points::{ReceivedPoints, points_body};
pub use talk::{Got, Now, Ping, Pong};
pub use view::View;

/// Bytes of the header of a message: kind, length, checksum.
pub const MESSAGE_HEADER_BYTES: usize = message::HEADER_BYTES;

/// Bytes before the body of a frame, as this version writes them.
pub const FRAME_HEAD_BYTES: usize = frame::FRAME_HEAD_BYTES;
