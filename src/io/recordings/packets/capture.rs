//! Packets in a file of libpcap or in pcapng, one after the other.
//!
//! **How it works.** The length of a record is read first and checked against a limit; then the record is handed to
//! `pcap-parser` in place. The metadata for the packets after a position, byte order and interfaces, is a [`Layout`]:
//! stored with an offset, it allows reading from there without the part before.
//!
//! libpcap: <https://www.ietf.org/archive/id/draft-ietf-opsawg-pcap-04.html>

use super::block;
use super::clock::{Clock, Fractions};
use super::layout::{ByteOrder, Layout, Records, Section};
use super::link::Link;
use super::window::Window;
use crate::io::error::{Fault, Place};
use pcap_parser::{parse_pcap_frame, parse_pcap_frame_be, parse_pcap_frame_modified, parse_pcap_header};
use std::fs::File;
use std::io;
use std::sync::Arc;
use std::time::Duration;

/// The longest packet that `tcpdump` captures has 256 KiB; records have names and statistics besides.
const MAX_RECORD_BYTES: u32 = 1 << 20;

/// The header of a file of libpcap.
const FILE_HEADER_BYTES: usize = 24;

/// The head of a record of libpcap, and where in it the length of its packet is.
const RECORD_HEAD_BYTES: usize = 16;
const MODIFIED_HEAD_BYTES: usize = 24;
const LENGTH_AT: usize = 8;

/// A packet as it was captured.
#[derive(Debug, Clone, Copy)]
pub(super) struct Packet<'a> {
    /// Byte offset of the packet's record in the file.
    pub(super) offset: u64,
    /// When it was captured, since 1970.
    pub(super) time: Duration,
    pub(super) link: Link,
    /// From the header of the link on, as much of it as was captured.
    pub(super) bytes: &'a [u8],
    /// True if the packet was truncated: longer than its captured bytes.
    pub(super) is_cut: bool,
}

/// A packet, and its metadata.
pub(super) type Next<'a> = (Packet<'a>, &'a Arc<Layout>);

/// A capture that is read from a place on.
#[derive(Debug)]
pub(super) struct Capture {
    window: Window,
    layout: Arc<Layout>,
    /// Timestamp of the previous packet.
    time: Duration,
    clock: Clock,
    fractions: Fractions,
}

impl Capture {
    /// Opens the whole of `file`, with times read by `clock`.
    pub(super) fn open(file: File, clock: Clock) -> Result<Self, Fault> {
        let failed = |error| unreadable(0, &error);
        let mut window = Window::at(file, 0).map_err(failed)?;
        let mut fractions = Fractions::default();
        let head = window.peek(FILE_HEADER_BYTES).map_err(failed)?;
        let layout = if head.starts_with(&block::SECTION) {
            Layout::Blocks(Section {
                order: ByteOrder::Little,
                interfaces: Vec::new(),
            })
        } else {
            let Ok((_, header)) = parse_pcap_header(head) else {
                return Err(Fault::new(
                    Place::Byte(0),
                    "this is not a packet capture: expected the first bytes of pcap or pcapng",
                ));
            };
            window.take(FILE_HEADER_BYTES);
            let is_nanoseconds = header.is_nanosecond_precision();
            fractions.is_nanoseconds = Some(is_nanoseconds);
            Layout::Records(Records {
                order: if header.is_bigendian() {
                    ByteOrder::Big
                } else {
                    ByteOrder::Little
                },
                is_modified: header.is_modified_format(),
                nanos_per_tick: match clock {
                    Clock::NanosecondParts => 1,
                    Clock::Stated | Clock::Nanoseconds if is_nanoseconds => 1,
                    Clock::MicrosecondParts | Clock::Stated | Clock::Nanoseconds => 1000,
                },
                // The upper bits describe checksums after frames.
                link: Link::of(header.network.0 & 0xffff),
            })
        };
        Ok(Self {
            window,
            layout: Arc::new(layout),
            time: Duration::ZERO,
            clock,
            fractions,
        })
    }

    /// The parts of seconds of the records so far.
    pub(super) fn fractions(&self) -> Fractions {
        self.fractions
    }

    /// `file` from byte `offset` on, where a record begins that `layout` tells of; its times do not matter.
    pub(super) fn resume(file: File, layout: Arc<Layout>, offset: u64) -> io::Result<Self> {
        Ok(Self {
            window: Window::at(file, offset)?,
            layout,
            time: Duration::ZERO,
            clock: Clock::default(),
            fractions: Fractions::default(),
        })
    }

    /// Returns the byte offset of the next record in the file.
    pub(super) fn offset(&self) -> u64 {
        self.window.offset()
    }

    /// The next packet; `None` at the end of the file.
    ///
    /// # Errors
    /// A truncated or damaged record: no later one can be found.
    pub(super) fn next(&mut self) -> Result<Option<Next<'_>>, Fault> {
        match *self.layout {
            Layout::Records(records) => self.next_record(records),
            Layout::Blocks(_) => self.next_in_block(),
        }
    }

    fn next_record(&mut self, records: Records) -> Result<Option<Next<'_>>, Fault> {
        let offset = self.window.offset();
        let head_bytes = if records.is_modified {
            MODIFIED_HEAD_BYTES
        } else {
            RECORD_HEAD_BYTES
        };
        let Some(head) = self.head(head_bytes)? else {
            return Ok(None);
        };
        let length = records.order.u32(head, LENGTH_AT).ok_or_else(|| cut(offset))?;
        let count = self.take_record(head_bytes, length)?;
        let bytes = self.window.taken(count);
        // Single records: the readers of `pcap-parser` cannot start partway through a file, as a frame requires.
        let parsed = match records.order {
            _ if records.is_modified => parse_pcap_frame_modified(bytes),
            ByteOrder::Little => parse_pcap_frame(bytes),
            ByteOrder::Big => parse_pcap_frame_be(bytes),
        };
        let (_, frame) = parsed.map_err(|_| cut(offset))?;
        // Zeros are not a packet, and a sparse file may contain terabytes of them.
        if frame.origlen == 0 && frame.caplen == 0 {
            return Err(damaged(offset, 0));
        }
        self.fractions.largest = self.fractions.largest.max(frame.ts_usec);
        let nanos = u64::from(frame.ts_usec) * u64::from(records.nanos_per_tick);
        let packet = Packet {
            offset,
            time: self
                .clock
                .time(Duration::from_secs(u64::from(frame.ts_sec)) + Duration::from_nanos(nanos)),
            link: records.link,
            bytes: frame.data,
            is_cut: frame.caplen < frame.origlen,
        };
        Ok(Some((packet, &self.layout)))
    }

    fn next_in_block(&mut self) -> Result<Option<Next<'_>>, Fault> {
        loop {
            let offset = self.window.offset();
            let layout = Arc::clone(&self.layout);
            let Some(head) = self.head(block::HEAD_BYTES)? else {
                return Ok(None);
            };
            let order = block::order(head, &layout);
            let matters = block::matters(head, order);
            let length = order.u32(head, 4).ok_or_else(|| cut(offset))?;
            drop(layout);
            if length < block::HEAD_BYTES as u32 {
                return Err(damaged(offset, length));
            }
            // Other long records, such as encryption keys, are never read.
            if length > MAX_RECORD_BYTES && !matters {
                let skipped = self.window.skip(u64::from(length));
                skipped.map_err(|error| unreadable(offset, &error))?;
                continue;
            }
            let count = self.take_record(0, length)?;
            let bytes = self.window.taken(count);
            let found = block::read(&mut self.layout, bytes, order);
            if let Some(found) = found.map_err(|_| damaged(offset, length))? {
                self.time = found.time.map_or(self.time, |time| self.clock.time(time));
                let packet = Packet {
                    offset,
                    time: self.time,
                    link: found.link,
                    bytes: self.window.taken(count).get(found.bytes).unwrap_or_default(),
                    is_cut: found.is_cut,
                };
                return Ok(Some((packet, &self.layout)));
            }
        }
    }

    /// The first `count` bytes of the next record; `None` at the end of the file.
    fn head(&mut self, count: usize) -> Result<Option<&[u8]>, Fault> {
        let offset = self.window.offset();
        let head = self.window.peek(count).map_err(|error| unreadable(offset, &error))?;
        match head.len() {
            0 => Ok(None),
            there if there < count => Err(cut(offset)),
            _ => Ok(Some(head)),
        }
    }

    /// Takes the next record, which has `length` bytes after the first `head_bytes`; returns its total size.
    fn take_record(&mut self, head_bytes: usize, length: u32) -> Result<usize, Fault> {
        let offset = self.window.offset();
        if length > MAX_RECORD_BYTES {
            return Err(damaged(offset, length));
        }
        let count = head_bytes + length as usize;
        let there = self.window.peek(count).map_err(|error| unreadable(offset, &error))?;
        if there.len() < count {
            return Err(cut(offset));
        }
        self.window.take(count);
        Ok(count)
    }
}

fn cut(offset: u64) -> Fault {
    Fault::new(Place::Byte(offset as usize), "the record of a packet is cut there")
}

fn damaged(offset: u64, length: u32) -> Fault {
    Fault::new(
        Place::Byte(offset as usize),
        format!("the record of a packet there is damaged (it claims {length} bytes)"),
    )
}

fn unreadable(offset: u64, error: &io::Error) -> Fault {
    Fault::new(
        Place::Byte(offset as usize),
        format!("it cannot be read from there on ({error})"),
    )
}
