//! A sequence as a live stream: `pointreel serve walk/ --live`.
//!
//! **How it works.** One thread plays: it makes the frame that is due next, as bytes of the wire format
//! ([`crate::wire`]), waits until it is due, and hands it to every client's mailbox. A client has a thread that sends
//! and one that listens. A mailbox holds two frames; where a third comes the oldest is dropped, so a client that is
//! slow misses frames, is never late by more than these, and stops nobody else. Frames of a recording of depth images
//! are sent as its images, before any filter; all others as points. A client that says what it looks at is sent the
//! points that it sees (`surfels.rs`).
//!
//! **Bounds.** So many clients at once, so much of what they say and so often, and a client that takes a message more
//! slowly than [`ServerDeadlines`](crate::deadlines::ServerDeadlines) allow is left. Where all places are taken, those
//! that take nothing, and then those that say nothing, give way to whoever comes.

mod audience;
mod client;
mod feed;
mod mailbox;
mod outgoing;
mod schedule;
mod server;
mod surfels;
#[cfg(test)]
mod tests;

pub use audience::{ClientReport, LiveEvent};
pub use schedule::Schedule;
pub use server::{LiveOptions, LiveReport, LiveServer};
