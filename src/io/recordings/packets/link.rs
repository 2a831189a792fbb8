//! From a captured packet to the sensor's payload: links, IP and UDP, by `etherparse`.

use etherparse::{EtherType, IpFragOffset, IpNumber, LaxNetSlice, LaxSlicedPacket, UdpSlice};
use std::net::IpAddr;

/// Link type, the header that a captured packet begins with: <https://www.tcpdump.org/linktypes.html>.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Link {
    Ethernet,
    /// An IP packet alone.
    Ip,
    /// Four bytes before an IP packet.
    Loopback,
    /// Linux, any interface.
    Cooked,
    /// Linux cooked capture, second version.
    Cooked2,
    /// No link that carries the packets of a scanner.
    Other,
}

/// A UDP datagram, or the beginning of one that came in fragments.
#[derive(Debug, Clone, Copy)]
pub(super) struct Datagram<'a> {
    pub(super) source: IpAddr,
    /// The port that it was sent to: sensors keep it, and may send from any.
    pub(super) port: u16,
    /// Byte count sent in the datagram, according to its header.
    pub(super) byte_count: usize,
    /// The captured part of them.
    pub(super) bytes: &'a [u8],
}

/// A piece of a datagram that was larger than the packets of the network.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fragment<'a> {
    /// From, to, and the number that all pieces of a datagram have.
    pub(super) of: (IpAddr, IpAddr, u32),
    pub(super) offset: IpFragOffset,
    pub(super) has_more: bool,
    pub(super) bytes: &'a [u8],
}

/// Content of a captured packet.
#[derive(Debug, Clone, Copy)]
pub(super) enum Content<'a> {
    Datagram(Datagram<'a>),
    Fragment(Fragment<'a>),
    /// Content that no LiDAR sends.
    Other,
}

impl Link {
    /// By its number in a capture.
    pub(super) fn of(number: i32) -> Self {
        match number {
            1 => Self::Ethernet,
            0 | 108 => Self::Loopback,
            12 | 14 | 101 | 228 | 229 => Self::Ip,
            113 => Self::Cooked,
            276 => Self::Cooked2,
            _ => Self::Other,
        }
    }

    /// Parses the content of a packet.
    pub(super) fn content(self, bytes: &[u8]) -> Content<'_> {
        self.found(bytes).unwrap_or(Content::Other)
    }

    fn found(self, bytes: &[u8]) -> Option<Content<'_>> {
        let of_type = |at: usize, head: usize| {
            let kind = u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?);
            Some(LaxSlicedPacket::from_ether_type(EtherType(kind), bytes.get(head..)?))
        };
        // Lenient, as packets may be truncated by the snap length of the capture.
        let packet = match self {
            Self::Ethernet => LaxSlicedPacket::from_ethernet(bytes).ok()?,
            Self::Ip => LaxSlicedPacket::from_ip(bytes).ok()?,
            Self::Loopback => LaxSlicedPacket::from_ip(bytes.get(4..)?).ok()?,
            Self::Cooked => of_type(14, 16)?,
            Self::Cooked2 => of_type(0, 20)?,
            Self::Other => return None,
        };
        let (source, fragment, payload) = match packet.net? {
            LaxNetSlice::Ipv4(ip) => {
                let header = ip.header();
                let source = IpAddr::V4(header.source_addr());
                let fragment = Fragment {
                    of: (
                        source,
                        IpAddr::V4(header.destination_addr()),
                        u32::from(header.identification()),
                    ),
                    offset: header.fragments_offset(),
                    has_more: header.more_fragments(),
                    bytes: ip.payload().payload,
                };
                (source, fragment, ip.payload().clone())
            }
            LaxNetSlice::Ipv6(ip) => {
                let header = ip.header();
                let source = IpAddr::V6(header.source_addr());
                let extensions = ip.extensions().clone().into_iter();
                let of_fragment = |extension| match extension {
                    etherparse::Ipv6ExtensionSlice::Fragment(fragment) => Some(fragment.to_header()),
                    _ => None,
                };
                let head = extensions.into_iter().find_map(of_fragment);
                let fragment = Fragment {
                    of: (
                        source,
                        IpAddr::V6(header.destination_addr()),
                        head.as_ref().map_or(0, |head| head.identification),
                    ),
                    offset: head.as_ref().map_or(IpFragOffset::ZERO, |head| head.fragment_offset),
                    has_more: head.as_ref().is_some_and(|head| head.more_fragments),
                    bytes: ip.payload().payload,
                };
                (source, fragment, ip.payload().clone())
            }
            LaxNetSlice::Arp(_) => return None,
        };
        if payload.ip_number != IpNumber::UDP {
            return None;
        }
        if payload.fragmented {
            return Some(Content::Fragment(fragment));
        }
        Datagram::of(source, payload.payload).map(Content::Datagram)
    }
}

impl<'a> Datagram<'a> {
    /// Parses the datagram from the bytes after the IP header, or from the first of them.
    pub(super) fn of(source: IpAddr, bytes: &'a [u8]) -> Option<Self> {
        let udp = UdpSlice::from_slice_lax(bytes).ok()?;
        Some(Self {
            source,
            port: udp.destination_port(),
            byte_count: usize::from(udp.length()).saturating_sub(8),
            bytes: udp.payload(),
        })
    }
}

impl<'a> Fragment<'a> {
    /// The beginning of the datagram; `None` of a later piece.
    pub(super) fn first(&self) -> Option<Datagram<'a>> {
        let is_first = self.offset.byte_offset() == 0;
        is_first.then(|| Datagram::of(self.of.0, self.bytes)).flatten()
    }
}
