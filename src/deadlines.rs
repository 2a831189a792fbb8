//! Network timeouts: the deadlines of all clients and servers.
//!
//! **How it works.** An idle timeout alone is not a limit: a peer that sends a byte per second is never silent. So
//! every transfer also has a minimum rate, which counts from its start, after a grace period. A transfer that takes
//! longer than both allow is ended, with an error message. Tests pass in shorter deadlines.
//!
//! | who waits | for what | at most |
//! |---|---|---|
//! | `http://`, `tcp://` | a connection | [`ClientDeadlines::connect`] |
//! | `http://`, `tcp://` | the next byte | [`ClientDeadlines::silence`] |
//! | `http://`, `tcp://` | an answer, a message | [`ClientDeadlines::transfer`] |
//! | `tcp://`, `udp://` | the first frame | [`ClientDeadlines::first_frame`] |
//! | `udp://` | a sensor that was there | [`ClientDeadlines::sensor_silence`] |
//! | `serve` | a request | [`ServerDeadlines::idle`], [`ServerDeadlines::head`] |
//! | `serve` | a client that takes an answer | [`ServerDeadlines::answer`] |
//! | `serve --live` | a client that takes a message | [`ServerDeadlines::message`] |

use std::time::Duration;

/// The least rate of a transfer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MinRate {
    /// For so long any rate will do.
    pub grace: Duration,
    /// Bytes per second since the beginning, afterwards.
    pub bytes_per_s: f64,
}

impl MinRate {
    /// Returns the total time allowed for more than `bytes` to arrive, since the start of the transfer.
    pub fn time_for(&self, bytes: u64) -> Duration {
        let seconds = bytes as f64 / self.bytes_per_s;
        Duration::try_from_secs_f64(seconds)
            .unwrap_or(Duration::MAX)
            .max(self.grace)
    }

    /// Returns the time that may still be waited for more than `bytes`, `elapsed` after the start of the transfer;
    /// `None` if it is too late.
    pub fn time_left(&self, bytes: u64, elapsed: Duration) -> Option<Duration> {
        let left = self.time_for(bytes).saturating_sub(elapsed);
        (!left.is_zero()).then_some(left)
    }
}

/// Timeouts of clients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClientDeadlines {
    /// For a connection.
    pub connect: Duration,
    /// For anything at all on a connection: stream servers send the time once per second.
    pub silence: Duration,
    /// For an answer over HTTP with all its attempts, and for a message of a stream.
    pub transfer: MinRate,
    /// For the first frame of a live source.
    pub first_frame: Duration,
    /// For a sensor, before another one may have its place.
    pub sensor_silence: Duration,
    /// For another sensor, where the packets of one cannot be read.
    pub other_sensors: Duration,
}

impl Default for ClientDeadlines {
    fn default() -> Self {
        Self {
            connect: Duration::from_secs(2),
            silence: Duration::from_secs(5),
            // The slowest modem: anything slower cannot show a frame.
            transfer: MinRate {
                grace: Duration::from_secs(10),
                bytes_per_s: 1024.0,
            },
            first_frame: Duration::from_secs(5),
            sensor_silence: Duration::from_secs(3),
            other_sensors: Duration::from_secs(1),
        }
    }
}

/// Timeouts of servers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServerDeadlines {
    /// For a request, on a connection that is open.
    pub idle: Duration,
    /// For the end of a request, since its first byte.
    pub head: Duration,
    /// For a client that takes an answer over HTTP. `--bandwidth` of a client may be as low.
    pub answer: MinRate,
    /// For a client that takes a message of a live stream.
    pub message: MinRate,
    /// A client that has accepted no data of a transfer for this long is dropped when all places are taken.
    pub stuck: Duration,
    /// Timeout of a client waiting for a free slot before it is sent away.
    pub place: Duration,
}

impl Default for ServerDeadlines {
    fn default() -> Self {
        Self {
            idle: Duration::from_secs(30),
            head: Duration::from_secs(10),
            answer: MinRate {
                grace: Duration::from_secs(10),
                bytes_per_s: 1024.0,
            },
            // A frame in transit occupies memory.
            message: MinRate {
                grace: Duration::from_secs(10),
                bytes_per_s: 16384.0,
            },
            stuck: Duration::from_millis(750),
            place: Duration::from_secs(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_per_second_is_too_slow_after_the_grace_and_never_before() {
        let min = MinRate {
            grace: Duration::from_secs(10),
            bytes_per_s: 1024.0,
        };
        assert_eq!(min.time_left(0, Duration::from_secs(4)), Some(Duration::from_secs(6)));
        assert_eq!(min.time_left(10, Duration::from_secs(10)), None);
        assert_eq!(
            min.time_left(20 * 1024, Duration::from_secs(19)),
            Some(Duration::from_secs(1))
        );
        assert_eq!(min.time_left(20 * 1024, Duration::from_secs(21)), None);
        assert!(min.time_for(u64::MAX) > Duration::from_hours(1000));
        let none = MinRate {
            bytes_per_s: 0.0,
            ..min
        };
        assert_eq!(none.time_for(1), Duration::MAX);
    }
}
