//! Revolutions of a sensor as its packets arrive, from a network instead of a file.
//!
//! The first stream of packets of a sensor is the one that is shown (`streams.rs`); others are skipped. A revolution is
//! handed over when the next one begins, as its packets: the consumer decodes them into points. The first revolution is
//! incomplete, and is skipped.

use super::companions::Companions;
use super::link::Datagram;
use super::maker::{Position, Scanner, Sensor, Sort, Step};
use super::makers::{MAKERS, Makers, Sender};
use super::part::{FrameId, TurnPart};
use super::seam::Coverage;
use super::streams::{PacketUse, Streams};
use super::turn::{LONGEST_TURN, MAX_PACKETS};
use super::unpacking::Unpacking;
use crate::cloud::RawCloud;
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use std::fs::File;
use std::io::Read as _;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// The text of a companion file that the packets of some sensors require.
#[derive(Debug, Clone)]
pub(crate) struct Companion(Arc<str>);

/// A revolution, as its packets.
#[derive(Debug, Clone)]
pub(crate) struct LiveTurn {
    scanner: Arc<dyn Scanner>,
    part: TurnPart,
    /// When its first packet came.
    pub(crate) time: Duration,
    packets: Vec<Box<[u8]>>,
}

/// Duration for which azimuths are observed before the first revolution: two revolutions of the slowest sensors.
const LEARNING: Duration = Duration::from_millis(400);

/// Azimuths in which a sensor measures, before its revolutions are cut.
struct Learning {
    begin: Duration,
    coverage: Coverage,
}

/// Finds the revolutions of a sensor.
pub(crate) struct LiveTurns {
    makers: Makers,
    streams: Streams,
    /// The sensor that is shown.
    sensor: Option<Box<dyn Sensor>>,
    /// Sentences on streams that are to be said.
    notes: Vec<String>,
    /// Over once it is known where the sensor measures.
    learning: Option<Learning>,
    /// The current revolution.
    current: Option<LiveTurn>,
    /// True if the current revolution was received from its beginning.
    is_whole: bool,
}

impl Companion {
    /// Reads and identifies the companion file at `path`.
    ///
    /// # Errors
    /// The problem with the file, with its name.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let mut bytes = Vec::new();
        let kinds = || MAKERS.iter().map(|maker| &maker.companion);
        let max = kinds().map(|kind| kind.max_bytes).max().unwrap_or(0);
        let read = File::open(path).and_then(|file| file.take(max).read_to_end(&mut bytes));
        read.map_err(|error| format!("{} cannot be read ({error})", path.display()))?;
        let text = String::from_utf8_lossy(&bytes);
        let told = |fault: Fault| format!("{}, {}: {}", path.display(), fault.place, fault.problem);
        // If it is of no known kind, the error is the one that the last kind reports.
        let kind = kinds()
            .find(|kind| (kind.is_one)(&text))
            .or_else(|| kinds().next_back());
        kind.map_or(Ok(()), |kind| (kind.check)(&text)).map_err(told)?;
        Ok(Self(text.into()))
    }
}

impl LiveTurns {
    /// No packets yet, of a sensor with that file, which loses its place after `silence`.
    pub(crate) fn new(companion: Option<Companion>, silence: Duration) -> Self {
        let companions = Companions::Given(companion.map(|companion| companion.0));
        Self {
            makers: Makers::new(&companions),
            streams: Streams::new(silence),
            sensor: None,
            notes: Vec::new(),
            learning: None,
            current: None,
            is_whole: false,
        }
    }

    /// True while a sensor is shown.
    pub(crate) fn has_sensor(&self) -> bool {
        self.sensor.is_some()
    }

    /// Sentences that are to be said since the last time.
    pub(crate) fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Notes that it is `now`, by the clock of the datagrams.
    pub(crate) fn look(&mut self, now: Duration) {
        let Some(note) = self.streams.look(now) else {
            return;
        };
        self.notes.push(note);
        (self.sensor, self.learning, self.current) = (None, None, None);
        self.is_whole = false;
    }

    /// Adds a datagram from `source` that came at `time` of a monotonic clock; returns the revolution that it ends, if
    /// any.
    ///
    /// # Errors
    /// Packets of a sensor cannot be read: a companion file is missing.
    pub(crate) fn add(&mut self, source: SocketAddr, time: Duration, bytes: &[u8]) -> Result<Option<LiveTurn>, String> {
        self.look(time);
        let datagram = Datagram {
            source: source.ip(),
            // The port of the socket is the user's choice.
            port: 0,
            byte_count: bytes.len(),
            bytes,
        };
        let Some((sender, sort)) = self.sender(&datagram) else {
            return Ok(None);
        };
        match self.streams.add(source, &sort, time) {
            PacketUse::Shown => {}
            PacketUse::Free => {
                self.sensor = Some(self.open(&sender, &datagram)?);
                self.streams.show(source, sort, time);
                self.learning = Some(Learning {
                    begin: time,
                    coverage: Coverage::default(),
                });
            }
            PacketUse::Second(note) => {
                self.notes.push(note);
                return Ok(None);
            }
            PacketUse::Skipped => return Ok(None),
        }
        let Some(kind) = &mut self.sensor else {
            return Ok(None);
        };
        if let Some(learning) = &mut self.learning {
            kind.cover(bytes, &mut learning.coverage);
            if time.saturating_sub(learning.begin) < LEARNING {
                return Ok(None);
            }
            kind.set_seam(learning.coverage.seam());
            self.learning = None;
        }
        let Some(step) = kind.step(bytes) else {
            return Ok(None);
        };
        let scanner = kind.scanner();
        Ok(match step {
            Step::Cycles(begins_at) => self.add_cycles(begins_at, scanner, time, bytes),
            Step::Frame(frame) => self.add_frame(TurnPart::Frame(frame), scanner, time, bytes),
        })
    }

    /// The sender of a packet, as far as known; `None` for packets without points.
    fn sender(&mut self, datagram: &Datagram<'_>) -> Option<(Sender, Sort)> {
        let sender = self.makers.sender(datagram)?;
        let sort = match &sender {
            Sender::Read { sort, .. } => sort.clone(),
            Sender::Unread(maker) if maker.advice.is_empty() => return None,
            Sender::Unread(maker) => format!("what sends {}", maker.name).into(),
        };
        Some((sender, sort))
    }

    /// The sensor that sent a packet.
    fn open(&mut self, sender: &Sender, datagram: &Datagram<'_>) -> Result<Box<dyn Sensor>, String> {
        match sender {
            Sender::Read { maker, .. } => self.makers.open(*maker, datagram),
            Sender::Unread(maker) => Err(format!("it has {}, which are not read: {}", maker.name, maker.advice)),
        }
    }

    fn add_cycles(
        &mut self,
        begins_at: Option<u8>,
        scanner: Arc<dyn Scanner>,
        time: Duration,
        bytes: &[u8],
    ) -> Option<LiveTurn> {
        let is_over = self.is_over(time).then_some(0);
        let Some(first) = begins_at.or(is_over) else {
            self.push(bytes);
            return None;
        };
        if first > 0 {
            self.push(bytes);
            if let Some(LiveTurn {
                part: TurnPart::Cycles { end, .. },
                ..
            }) = &mut self.current
            {
                *end = first;
            }
        }
        self.begin(TurnPart::Cycles { first, end: u8::MAX }, scanner, time, bytes)
    }

    /// Late packets are added to the current revolution, which does not use them: finished revolutions are not held
    /// back.
    fn add_frame(
        &mut self,
        part: TurnPart,
        scanner: Arc<dyn Scanner>,
        time: Duration,
        bytes: &[u8],
    ) -> Option<LiveTurn> {
        let is_before = |now: TurnPart| match (part, now) {
            (TurnPart::Frame(frame), TurnPart::Frame(now)) => is_next(frame, now),
            _ => false,
        };
        let now = self.current.as_ref().map(|turn| turn.part);
        if !self.is_over(time) && now.is_some_and(|now| now == part || is_before(now)) {
            self.push(bytes);
            return None;
        }
        self.begin(part, scanner, time, bytes)
    }

    fn is_over(&self, time: Duration) -> bool {
        self.current.as_ref().is_some_and(|turn| {
            turn.packets.len() as u64 >= MAX_PACKETS || time.saturating_sub(turn.time) >= LONGEST_TURN
        })
    }

    fn push(&mut self, bytes: &[u8]) {
        if let Some(turn) = &mut self.current {
            turn.packets.push(bytes.into());
        }
    }

    /// Begins a revolution with a packet; the one before is over.
    fn begin(&mut self, part: TurnPart, scanner: Arc<dyn Scanner>, time: Duration, bytes: &[u8]) -> Option<LiveTurn> {
        let turn = LiveTurn {
            scanner,
            part,
            time,
            packets: vec![bytes.into()],
        };
        let before = self.current.replace(turn)?;
        let was_whole = std::mem::replace(&mut self.is_whole, true);
        was_whole.then_some(before)
    }
}

/// Returns true if frame `now` follows `frame`: frame numbers have 16 bits, or 32.
fn is_next(frame: FrameId, now: FrameId) -> bool {
    let is_end = frame.number == u32::from(u16::MAX) && now.number == 0;
    is_end || frame.number.wrapping_add(1) == now.number
}

impl LiveTurn {
    /// Bytes of its packets.
    pub(crate) fn byte_size(&self) -> usize {
        self.packets.iter().map(|packet| packet.len()).sum()
    }

    /// Its points.
    ///
    /// # Errors
    /// More points than `options` have memory for, as the end of a sentence.
    pub(crate) fn cloud(&self, options: &ReadOptions) -> Result<RawCloud, String> {
        let mut unpacking = Unpacking::new(&*self.scanner, self.part);
        for (index, packet) in self.packets.iter().enumerate() {
            let position = Position {
                is_first: index == 0,
                is_last: index + 1 == self.packets.len(),
            };
            unpacking.add(packet, position);
        }
        unpacking.points.check(options).map_err(|fault| fault.problem)?;
        Ok(unpacking.finish())
    }
}
