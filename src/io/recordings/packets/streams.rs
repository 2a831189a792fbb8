//! Streams of packets to one port: selection of the sensor that is shown.
//!
//! **How it works.** A stream is a source address and port of packets, all of one kind. The first stream that has sent
//! a run of [`RUN_PACKETS`] within [`RUN_TIME`] is selected: sensors send hundreds per second, while stray or malicious
//! packets are mostly single. Another one is reported once and skipped. A sensor that is silent for a while is
//! deselected, so that a restarted one, which sends from another port, can take over.
//!
//! **Bounds.** [`MAX_STREAMS`] are remembered; of more, those that have sent least are forgotten.

use super::maker::Sort;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::Duration;

/// Packets of a run, and how long they may take: sensors send 300 per second and more, one that measures in a narrow
/// window of azimuths a tenth of these.
const RUN_PACKETS: u32 = 16;
const RUN_TIME: Duration = Duration::from_secs(2);

const MAX_STREAMS: usize = 256;

/// Other sensors that are named.
const MAX_NAMED: usize = 8;

/// The use of a packet.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum PacketUse {
    /// It is of the sensor that has the place.
    Shown,
    /// Its stream can have the place.
    Free,
    /// Another sensor is shown, which has to be said.
    Second(String),
    Skipped,
}

/// A stream that may be a sensor's.
#[derive(Debug)]
struct Run {
    sort: Sort,
    begun: Duration,
    packets: u32,
}

/// The sensor that is shown.
#[derive(Debug)]
struct Shown {
    address: SocketAddr,
    sort: Sort,
    last: Duration,
}

/// All streams.
#[derive(Debug)]
pub(super) struct Streams {
    shown: Option<Shown>,
    runs: BTreeMap<SocketAddr, Run>,
    named: Vec<SocketAddr>,
    /// A sensor that sends nothing for so long loses its place.
    silence: Duration,
}

impl Streams {
    pub(super) fn new(silence: Duration) -> Self {
        Self {
            shown: None,
            runs: BTreeMap::new(),
            named: Vec::new(),
            silence,
        }
    }

    /// Advances the time; returns a sentence if the sensor was deselected.
    pub(super) fn look(&mut self, now: Duration) -> Option<String> {
        let silent = |shown: &&mut Shown| now.saturating_sub(shown.last) >= self.silence;
        let shown = self.shown.as_mut().filter(silent)?;
        let said = format!(
            "{} at {} has sent nothing for {} s: its place is free for the next sensor that sends",
            shown.sort,
            shown.address,
            self.silence.as_secs_f64()
        );
        self.shown = None;
        self.named.clear();
        Some(said)
    }

    /// A packet came.
    pub(super) fn add(&mut self, address: SocketAddr, sort: &Sort, now: Duration) -> PacketUse {
        if let Some(shown) = &mut self.shown
            && shown.address == address
            && shown.sort == *sort
        {
            shown.last = now;
            return PacketUse::Shown;
        }
        self.forget(address, now);
        let run = self.runs.entry(address).or_insert_with(|| Run {
            sort: sort.clone(),
            begun: now,
            packets: 0,
        });
        if run.sort != *sort || now.saturating_sub(run.begun) > RUN_TIME {
            (run.sort, run.begun, run.packets) = (sort.clone(), now, 0);
        }
        run.packets += 1;
        if run.packets < RUN_PACKETS {
            return PacketUse::Skipped;
        }
        self.runs.remove(&address);
        match &self.shown {
            None => PacketUse::Free,
            Some(shown) if self.named.len() < MAX_NAMED && !self.named.contains(&address) => {
                self.named.push(address);
                PacketUse::Second(format!(
                    "{sort} at {address} sends to the same port and is skipped: {} at {} is shown. Give each sensor a \
                     port of its own",
                    shown.sort, shown.address
                ))
            }
            Some(_) => PacketUse::Skipped,
        }
    }

    /// The stream from `address` has the place.
    pub(super) fn show(&mut self, address: SocketAddr, sort: Sort, now: Duration) {
        self.shown = Some(Shown {
            address,
            sort,
            last: now,
        });
    }

    /// Frees a slot for a stream from `address`.
    fn forget(&mut self, address: SocketAddr, now: Duration) {
        if self.runs.len() < MAX_STREAMS || self.runs.contains_key(&address) {
            return;
        }
        self.runs.retain(|_, run| now.saturating_sub(run.begun) <= RUN_TIME);
        if self.runs.len() >= MAX_STREAMS {
            let min = self.runs.iter().min_by_key(|(_, run)| (run.packets, run.begun));
            if let Some(address) = min.map(|(address, _)| *address) {
                self.runs.remove(&address);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VLP: Sort = Sort::Borrowed("a Velodyne Vlp16");
    const OUSTER: Sort = Sort::Borrowed("an Ouster (packets of 6464 bytes)");

    fn address(port: u16) -> SocketAddr {
        SocketAddr::from(([10, 0, 0, 1], port))
    }

    fn ms(millis: u64) -> Duration {
        Duration::from_millis(millis)
    }

    /// Sends a run, one packet per millisecond; returns the use of its last packet.
    fn run(streams: &mut Streams, address: SocketAddr, sort: &Sort, begin: u64) -> PacketUse {
        let verdicts = (0..u64::from(RUN_PACKETS)).map(|at| streams.add(address, sort, ms(begin + at)));
        verdicts.last().unwrap()
    }

    #[test]
    fn only_a_run_of_packets_takes_the_free_slot() {
        let mut streams = Streams::new(ms(3000));
        assert_eq!(streams.add(address(1), &VLP, ms(0)), PacketUse::Skipped);
        // Packets of several kinds do not form a sensor stream, nor do occasional ones.
        for at in 0..200 {
            let sort = if at % 2 == 0 { VLP } else { OUSTER };
            assert_eq!(streams.add(address(2), &sort, ms(at)), PacketUse::Skipped);
            assert_eq!(streams.add(address(3), &VLP, ms(200 * at)), PacketUse::Skipped);
        }
        assert_eq!(run(&mut streams, address(4), &VLP, 50_000), PacketUse::Free);
        streams.show(address(4), VLP, ms(50_100));
        assert_eq!(streams.add(address(4), &VLP, ms(50_101)), PacketUse::Shown);
        assert_eq!(streams.add(address(4), &OUSTER, ms(50_102)), PacketUse::Skipped);
    }

    #[test]
    fn a_second_sensor_is_reported_once_and_shown_after_silence() {
        let mut streams = Streams::new(ms(3000));
        streams.show(address(1), VLP, ms(0));
        let PacketUse::Second(said) = run(&mut streams, address(2), &VLP, 0) else {
            panic!("it is not named");
        };
        assert!(
            said.contains("10.0.0.1:2") && said.contains("10.0.0.1:1 is shown"),
            "{said}"
        );
        assert_eq!(run(&mut streams, address(2), &VLP, 100), PacketUse::Skipped);
        assert_eq!(streams.look(ms(2999)), None);
        let said = streams.look(ms(3000)).unwrap();
        assert!(said.contains("10.0.0.1:1 has sent nothing for 3 s"), "{said}");
        assert_eq!(streams.look(ms(9000)), None);
        assert_eq!(run(&mut streams, address(2), &VLP, 3000), PacketUse::Free);
    }

    #[test]
    fn a_flood_of_addresses_takes_no_memory_and_blocks_no_sensor() {
        let mut streams = Streams::new(ms(3000));
        let mut packet_use = PacketUse::Skipped;
        for at in 0..100 * u64::from(RUN_PACKETS) {
            streams.add(address(1000 + at as u16), &VLP, ms(at / 100));
            if at % 100 == 0 && packet_use != PacketUse::Free {
                packet_use = streams.add(address(1), &VLP, ms(at / 100));
            }
        }
        assert!(streams.runs.len() <= MAX_STREAMS);
        assert_eq!(packet_use, PacketUse::Free);
    }
}
