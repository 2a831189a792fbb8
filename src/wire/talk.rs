//! Small messages: the time, and acknowledgements.
//!
//! Clocks of two machines differ. A client that asks at t₀ and hears at t₃ that the server was asked at t₁ and answered
//! at t₂ knows the difference of the clocks, ((t₁ − t₀) + (t₂ − t₃)) / 2, up to half of the time on the way (Mills
//! 1991).

use super::bytes::{Fields, Written};
use super::error::WireError;
use super::message::{Kind, Message};

/// Current time at the server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Now {
    /// The clock of the server, ns.
    pub clock_ns: u64,
    /// The frame that was served last; `None` before the first.
    pub newest: Option<u64>,
}

/// The client asks for the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ping {
    /// The clock of the client, ns since anything.
    pub client_ns: u64,
}

/// The answer to a ping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pong {
    /// The clock of the client in the ping.
    pub client_ns: u64,
    /// The clock of the server when the ping came, ns.
    pub received_ns: u64,
    /// The clock of the server when this was sent, ns.
    pub sent_ns: u64,
}

/// The client has received a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Got {
    /// Its number.
    pub number: u64,
}

/// Stands for no frame.
const NONE: u64 = u64::MAX;

impl Now {
    /// As a message.
    pub fn message(self) -> Message {
        let mut payload = Written::default();
        payload.u64(self.clock_ns).u64(self.newest.unwrap_or(NONE));
        Message::new(Kind::Now, payload.0)
    }

    /// Parses a payload.
    pub fn parse(payload: &[u8]) -> Result<Self, WireError> {
        let mut fields = Fields::new(payload, "the time of the server");
        Ok(Self {
            clock_ns: fields.u64()?,
            newest: Some(fields.u64()?).filter(|&number| number != NONE),
        })
    }
}

impl Ping {
    /// As a message.
    pub fn message(self) -> Message {
        Message::new(Kind::Ping, self.client_ns.to_le_bytes().to_vec())
    }

    /// Parses a payload.
    pub fn parse(payload: &[u8]) -> Result<Self, WireError> {
        let client_ns = Fields::new(payload, "a ping").u64()?;
        Ok(Self { client_ns })
    }
}

impl Pong {
    /// As a message.
    pub fn message(self) -> Message {
        let mut payload = Written::default();
        payload.u64(self.client_ns).u64(self.received_ns).u64(self.sent_ns);
        Message::new(Kind::Pong, payload.0)
    }

    /// Parses a payload.
    pub fn parse(payload: &[u8]) -> Result<Self, WireError> {
        let mut fields = Fields::new(payload, "the answer to a ping");
        Ok(Self {
            client_ns: fields.u64()?,
            received_ns: fields.u64()?,
            sent_ns: fields.u64()?,
        })
    }
}

impl Got {
    /// As a message.
    pub fn message(self) -> Message {
        Message::new(Kind::Got, self.number.to_le_bytes().to_vec())
    }

    /// Parses a payload.
    pub fn parse(payload: &[u8]) -> Result<Self, WireError> {
        let number = Fields::new(payload, "the number of a frame").u64()?;
        Ok(Self { number })
    }
}
