//! A live stream over TCP (`tcp://HOST:PORT`), as `pointreel serve --live` sends it, and recordings of one.
//!
//! **How it works.** One thread is connected, reads messages ([`crate::wire`]) and puts frames into a ring as they
//! came; images and points are unpacked when the frame is requested. The ring has the newest seconds, up to a number of
//! bytes: older frames are gone for good. A connection that breaks, or is silent for
//! [`ClientDeadlines::silence`](crate::deadlines::ClientDeadlines::silence), is re-established automatically. The
//! stream can be written to a file as it arrives; the file has the bytes of the stream.

mod address;
mod clock;
mod connection;
mod decoder;
mod file;
mod rate;
mod recorder;
mod ring;
mod shared;
mod status;
mod stream;
mod timeline;
mod watch;

pub(in crate::source) use file::RECORDING;
pub use file::RecordedStream;
pub use recorder::StreamRecording;
pub use status::{Live, LiveState, LiveStatus};
pub(in crate::source) use stream::ADDRESS;
pub use stream::LiveStream;
pub use watch::{ConnectionChange, ConnectionWatch};
