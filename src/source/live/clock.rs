//! Clock offset between the server and this machine.
//!
//! The round trip of a ping yields the offset of the clocks up to half of its duration, for any clocks (Mills 1991).
//! The fastest of the last pings is trusted: the others waited somewhere, mostly in one direction.

use crate::wire::Pong;
use std::collections::VecDeque;

/// Pings that are remembered: clocks drift by some 10 µs in the seconds that these take.
const BUFFERED: usize = 16;

/// The difference of two clocks.
#[derive(Debug, Default)]
pub(super) struct ClockDifference {
    measured: VecDeque<Measured>,
}

/// Measurement of one ping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Measured {
    /// To be added to our clock to have the server's, ns.
    server_ahead_ns: i128,
    /// Round-trip time, ns.
    way_ns: u64,
}

impl ClockDifference {
    /// Takes the answer to a ping, which came at `now_ns` of our clock. One that makes no sense is passed over.
    pub(super) fn add(&mut self, pong: Pong, now_ns: u64) {
        let at_server = pong.sent_ns.checked_sub(pong.received_ns);
        let since = now_ns.checked_sub(pong.client_ns);
        let way = since
            .zip(at_server)
            .and_then(|(since, at_server)| since.checked_sub(at_server));
        let Some(way_ns) = way else { return };
        let [asked, received, sent, now] = [pong.client_ns, pong.received_ns, pong.sent_ns, now_ns].map(i128::from);
        if self.measured.len() == BUFFERED {
            self.measured.pop_front();
        }
        self.measured.push_back(Measured {
            server_ahead_ns: (received - asked).midpoint(sent - now),
            way_ns,
        });
    }

    /// Returns the age of server timestamp `server_ns` at `now_ns` of the local clock, and its uncertainty, both in
    /// seconds. `None` before the first answer.
    pub(super) fn since_s(&self, server_ns: u64, now_ns: u64) -> Option<(f64, f64)> {
        let best = self.measured.iter().min_by_key(|measured| measured.way_ns)?;
        let since_ns = i128::from(now_ns) + best.server_ahead_ns - i128::from(server_ns);
        Some((since_ns as f64 * 1e-9, best.way_ns as f64 * 0.5e-9))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_fastest_ping_is_used() {
        let mut clock = ClockDifference::default();
        assert_eq!(clock.since_s(0, 0), None);
        // The server is 1000 ahead; the way there takes 10, the way back 30.
        let pong = Pong {
            client_ns: 100,
            received_ns: 1110,
            sent_ns: 1115,
        };
        clock.add(pong, 145);
        // Half of 40 may be wrong: the estimate is 990 instead of 1000.
        assert_eq!(clock.since_s(1145, 145), Some((-10e-9, 20e-9)));
        // Both directions take 2.
        clock.add(
            Pong {
                client_ns: 200,
                received_ns: 1202,
                sent_ns: 1202,
            },
            204,
        );
        let (since, wrong) = clock.since_s(1200, 250).unwrap();
        assert!((since - 50e-9).abs() < 1e-15 && wrong == 2e-9);
        // Answers dated before the question are ignored.
        clock.add(
            Pong {
                client_ns: 900,
                received_ns: 2,
                sent_ns: 1,
            },
            1000,
        );
        clock.add(
            Pong {
                client_ns: 900,
                received_ns: 0,
                sent_ns: 0,
            },
            100,
        );
        assert_eq!(clock.measured.len(), 2);
    }

    proptest! {
        /// The truth is within the reported bound, for any clocks and any delays.
        #[test]
        fn the_error_bound_holds(
            ahead in -1_000_000_000i64..1_000_000_000,
            pings in prop::collection::vec((0u64..1_000_000, 0u64..50_000, 0u64..50_000, 0u64..50_000), 1..40),
        ) {
            let mut clock = ClockDifference::default();
            let base = 2_000_000_000u64;
            let server = |client_ns: u64| client_ns.checked_add_signed(ahead).unwrap();
            for (at, there, work, back) in pings {
                let asked = base + at;
                let pong = Pong {
                    client_ns: asked,
                    received_ns: server(asked + there),
                    sent_ns: server(asked + there + work),
                };
                clock.add(pong, asked + there + work + back);
            }
            let now = base + 5_000_000;
            let (since, wrong) = clock.since_s(server(now - 1000), now).unwrap();
            prop_assert!((since - 1e-6).abs() <= wrong + 2e-9, "{since} ± {wrong}");
        }

        #[test]
        fn any_numbers_are_accepted(numbers: [u64; 5]) {
            let [client_ns, received_ns, sent_ns, now, at] = numbers;
            let mut clock = ClockDifference::default();
            clock.add(Pong { client_ns, received_ns, sent_ns }, now);
            let _ = clock.since_s(at, now);
        }
    }
}
