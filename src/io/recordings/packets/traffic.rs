//! Datagrams of a capture that no sensor that is read has sent, and those that are not whole: counted for messages.

use super::link::Datagram;
use super::makers::all_packets;
use super::unread::{Unread, unread};
use std::collections::BTreeMap;
use std::net::IpAddr;

/// Maximum number of datagram kinds that are distinguished: more than that are not sensors, but a network's whole
/// traffic.
const MAX_KINDS: usize = 1024;

/// Kinds that a sentence names.
const MAX_NAMED: usize = 8;

/// Datagrams of one length to one port.
#[derive(Debug, Default)]
struct Kind {
    count: u64,
    maker: Option<&'static Unread>,
}

/// Datagrams that were captured in part.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Cut {
    pub(super) count: u64,
    /// Bytes of a packet that were captured, of the longest.
    pub(super) captured_bytes: usize,
}

/// All that was seen.
#[derive(Debug, Default)]
pub(super) struct Traffic {
    /// By port and length.
    kinds: BTreeMap<(u16, usize), Kind>,
    /// By sender and port.
    cut: BTreeMap<(IpAddr, u16), Cut>,
    /// Packets that are not UDP.
    others: u64,
}

impl Traffic {
    /// Counts a packet that is not a datagram.
    pub(super) fn add_other(&mut self) {
        self.others += 1;
    }

    /// Counts a datagram that no sensor that is read has sent.
    pub(super) fn add(&mut self, datagram: &Datagram<'_>) {
        let key = (datagram.port, datagram.byte_count);
        if self.kinds.len() >= MAX_KINDS && !self.kinds.contains_key(&key) {
            self.others += 1;
            return;
        }
        let kind = self.kinds.entry(key).or_default();
        kind.count += 1;
        if kind.count == 1 {
            kind.maker = unread(datagram.port, datagram.bytes);
        }
    }

    /// Counts a truncated datagram: the capture has only `captured_bytes` of its packet.
    pub(super) fn add_cut(&mut self, datagram: &Datagram<'_>, captured_bytes: usize) {
        self.add(datagram);
        let key = (datagram.source, datagram.port);
        if self.cut.len() < MAX_KINDS || self.cut.contains_key(&key) {
            let cut = self.cut.entry(key).or_default();
            cut.count += 1;
            cut.captured_bytes = cut.captured_bytes.max(captured_bytes);
        }
    }

    /// The datagrams of a sender that were captured in part.
    pub(super) fn cut_of(&self, sensor: (IpAddr, u16)) -> Option<Cut> {
        self.cut.get(&sensor).copied()
    }

    /// Makers whose packets are skipped, a sentence each.
    pub(super) fn notes(&self) -> Vec<String> {
        let makers = self.makers();
        let with_points = makers.iter().filter(|(maker, _)| !maker.advice.is_empty());
        with_points
            .map(|(maker, (port, count))| {
                format!("{count} {} on port {port} are skipped: {}", maker.name, maker.advice)
            })
            .collect()
    }

    /// Makers, each with a port and the number of datagrams.
    fn makers(&self) -> Vec<(&'static Unread, (u16, u64))> {
        let mut makers: Vec<(&'static Unread, (u16, u64))> = Vec::new();
        for ((port, _), kind) in &self.kinds {
            let Some(maker) = kind.maker else {
                continue;
            };
            match makers.iter_mut().find(|(known, _)| known.name == maker.name) {
                Some((_, (_, count))) => *count += kind.count,
                None => makers.push((maker, (*port, kind.count))),
            }
        }
        makers
    }

    /// The content of a capture without a sensor that is read, as the end of a sentence.
    pub(super) fn describe(&self) -> String {
        let mut parts: Vec<String> = self
            .makers()
            .into_iter()
            .map(|(maker, (port, _))| match maker.advice {
                "" => format!("it has {} (port {port})", maker.name),
                advice => format!("it has {} on port {port}, which are not read: {advice}", maker.name),
            })
            .collect();
        let cut: u64 = self.cut.values().map(|cut| cut.count).sum();
        if cut > 0 {
            let captured_bytes = self.cut.values().map(|cut| cut.captured_bytes).max().unwrap_or(0);
            parts.push(said_cut(cut, captured_bytes));
        }
        parts.push(self.datagrams());
        parts.join("; ")
    }

    /// Ports and lengths, the most frequent first.
    fn datagrams(&self) -> String {
        let mut kinds: Vec<_> = self.kinds.iter().collect();
        kinds.sort_by_key(|(_, kind)| std::cmp::Reverse(kind.count));
        let named: Vec<String> = kinds
            .iter()
            .take(MAX_NAMED)
            .map(|((port, bytes), kind)| format!("{} of {bytes} bytes to port {port}", kind.count))
            .collect();
        let more = if kinds.len() > MAX_NAMED { ", …" } else { "" };
        let others = match self.others {
            0 => String::new(),
            count => format!(" and {count} other packets"),
        };
        match (named.is_empty(), self.others) {
            (true, 0) => "no packet is in it".to_owned(),
            (true, count) => format!("none of its {count} packets is a UDP datagram, as LiDAR sensors send them"),
            _ => format!(
                "its UDP datagrams are {}{more}{others}; packets of {} are read",
                named.join(", "),
                all_packets()
            ),
        }
    }
}

/// A sentence about packets that were captured in part.
pub(super) fn said_cut(count: u64, captured_bytes: usize) -> String {
    format!(
        "{count} packets are cut after {captured_bytes} bytes (the snap length) and are skipped: capture again with \
         `tcpdump -s 0`"
    )
}
