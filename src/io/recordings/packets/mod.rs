//! LiDAR packet captures: packets of Velodyne and Ouster in files of pcap and pcapng.
//!
//! **How it works.** [`list`] walks over the packets once and notes where each revolution of each sensor begins and
//! ends ([`found`]); [`read`] then reads the packets of one revolution, and nothing before or after them. `pcap-parser`
//! reads the records of a capture ([`capture`], [`block`]), `etherparse` the network headers ([`link`]) and the
//! fragmented datagrams ([`fragments`]). The packet contents are parsed here: one folder per maker ([`velodyne`],
//! [`ouster`]), after their manuals, and a row of [`makers`]. Packets that come from a network instead of a file are
//! grouped into revolutions by [`live`].
//!
//! Sensors take the role of the topics of a recording: the one that sent most packets is read unless another is named.
//! The timestamps of frames are the times at which their first packets were captured; times of points are the sensor's.

mod block;
mod capture;
mod clock;
mod companions;
mod found;
mod fragments;
mod layout;
mod link;
mod live;
mod maker;
mod makers;
mod ouster;
mod part;
mod points;
mod rows;
mod seam;
mod streams;
mod traffic;
mod turn;
mod unpacking;
mod unread;
mod velodyne;
mod window;

pub(crate) use live::{Companion, LiveTurn, LiveTurns};
pub use turn::Turn;

use super::containers::CAPTURE as FORMAT;
use crate::cloud::RawCloud;
use crate::io::contents::Contents;
use crate::io::error::{Fault, IoError, Place};
use crate::io::files::long_walk::LongWalk;
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use capture::{Capture, Packet};
use clock::Clock;
use found::FoundSensors;
use fragments::Fragments;
use link::{Content, Datagram};
use maker::Position;
use std::fs::File;
use std::path::Path;
use unpacking::Unpacking;

/// Bytes of a capture that its sensors are learned from: several revolutions of the largest one.
const PROBE_BYTES: u64 = 48 << 20;

/// Packets between two checks for cancellation.
const PACKETS_PER_LOOK: u32 = 256;

/// The sensors in the capture at `path`, and the revolutions of `wanted` (of the one that sent most packets, if
/// `None`).
pub(in crate::io) fn list(path: &Path, wanted: Option<&str>, options: &ReadOptions) -> Result<Contents, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let open = |clock| {
        let file = File::open(path).map_err(failed)?;
        Capture::open(file, clock).map_err(|fault| fault.of(path, FORMAT))
    };
    let mut found = FoundSensors::new(path, options);
    // A first pass over the beginning: the seam at which revolutions are cut depends on the azimuths in which a sensor
    // measures.
    let mut beginning = open(Clock::Stated)?;
    while beginning.offset() < PROBE_BYTES
        && let Ok(Some((packet, _))) = beginning.next()
    {
        found.probe(&packet);
    }
    let clock = found.end_probe(beginning.fractions());
    let mut capture = open(clock)?;
    let file_bytes = path.metadata().map_err(failed)?.len();
    // Reads the header of each packet and some bytes of its contents: 2 to 3 GB per second from memory, so the disk is
    // the bottleneck.
    let mut long = LongWalk::new(path, file_bytes);
    let mut end = None;
    loop {
        long.step(capture.offset());
        match capture.next() {
            Ok(Some((packet, layout))) => found.add(&packet, layout),
            Ok(None) => break,
            Err(fault) => {
                end = Some(format!(
                    "{}: {}: the packets before that are read",
                    fault.place, fault.problem
                ));
                break;
            }
        }
    }
    let contents = found.contents(wanted, clock);
    let mut contents = contents.map_err(|problem| Fault::header(problem).of(path, FORMAT))?;
    if let Some(end) = end {
        if contents.entries.is_empty() {
            contents.without_frames.push_str("; ");
            contents.without_frames.push_str(&end);
        }
        contents.damage.push(end);
    }
    Ok(contents)
}

/// The points of a revolution.
pub(in crate::io) fn read(
    path: &Path,
    turn: &Turn,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<RawCloud, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(failed)?;
    let layout = std::sync::Arc::clone(&turn.layout);
    // Only its own part of the file: 52,000 points of a VLP-16 take 4 ms, 111,000 of an Ouster 5 to 7 ms (AMD EPYC, one
    // thread).
    let mut capture = Capture::resume(file, layout, turn.place.begin).map_err(failed)?;
    let mut reading = Reading {
        turn,
        fragments: Fragments::default(),
        unpacking: Unpacking::new(&*turn.scanner, turn.place.part),
    };
    let mut warning = None;
    let mut until_look = PACKETS_PER_LOOK;
    while capture.offset() <= turn.place.last {
        match capture.next() {
            Ok(Some((packet, _))) if packet.offset <= turn.place.last => reading.packet(&packet),
            Ok(_) => break,
            Err(fault) => {
                warning = Some(fault);
                break;
            }
        }
        until_look -= 1;
        if until_look == 0 {
            until_look = PACKETS_PER_LOOK;
            reading
                .unpacking
                .points
                .check(options)
                .map_err(|fault| fault.of(path, FORMAT))?;
            if progress.is_cancelled() {
                return Err(Fault::cancelled().of(path, FORMAT));
            }
        }
    }
    if reading.unpacking.packets == 0 {
        let place = Place::Byte(turn.place.begin as usize);
        let fault = Fault::new(
            place,
            "no packet of the turn is there: the capture has changed since it was opened",
        );
        return Err(warning.unwrap_or(fault).of(path, FORMAT));
    }
    let mut cloud = reading.unpacking.finish();
    let told = |fault: Fault| format!("{}, {}: {} ({FORMAT} file)", path.display(), fault.place, fault.problem);
    cloud.warnings.extend(warning.map(told));
    Ok(cloud)
}

/// Finds the packets of a revolution in a capture.
struct Reading<'a> {
    turn: &'a Turn,
    fragments: Fragments,
    unpacking: Unpacking<'a>,
}

impl Reading<'_> {
    fn packet(&mut self, packet: &Packet<'_>) {
        match packet.link.content(packet.bytes) {
            Content::Datagram(datagram) => self.datagram(&datagram, packet.offset, packet.offset),
            Content::Fragment(fragment) if fragment.of.0 == self.turn.sensor.0 => {
                if let Some(joined) = self.fragments.add(&fragment, packet.offset)
                    && let Some(datagram) = Datagram::of(fragment.of.0, &joined.bytes)
                {
                    self.datagram(&datagram, joined.begin, packet.offset);
                }
            }
            Content::Fragment(_) | Content::Other => {}
        }
    }

    /// A datagram whose pieces are in the records from `begin` to `last`.
    fn datagram(&mut self, datagram: &Datagram<'_>, begin: u64, last: u64) {
        if (datagram.source, datagram.port) == self.turn.sensor {
            let position = Position {
                is_first: begin == self.turn.place.begin,
                is_last: last == self.turn.place.last,
            };
            self.unpacking.add(datagram.bytes, position);
        }
    }
}
