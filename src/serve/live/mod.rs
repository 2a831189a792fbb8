//! A sequence as a live stream: `pointreel serve walk/ --live`.
//!
//! **How it works.** One thread plays: it makes the frame that is due next, as bytes of the wire format
//! ([`crate::wire`]), waits until it is due, and hands it to every client's mailbox. A client has a thread that sends
//! and one that listens. A mailbox holds two frames; when a third comes, the oldest is dropped, so a slow client misses
//! frames, is never late by more than these, and does not stop others. Frames of a recording of depth images are sent
//! as its images, before any filter; all others as points. A client that sends its view is sent the points visible in
//! it (`surfels.rs`).
//!
//! **Bounds.** Clients and the size and rate of their messages are limited, and a client that takes a message more
//! slowly than [`ServerDeadlines`](crate::deadlines::ServerDeadlines) allow is disconnected. If all places are taken,
//! clients that take nothing, and then silent ones, give way to new ones.

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
