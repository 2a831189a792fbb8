//! Live LiDAR source: a sensor that sends packets to this machine, `udp://:2368`.
//!
//! **How it works.** A thread receives datagrams and detects the start of each revolution, which takes microseconds per
//! packet, so that nothing queues beyond the socket buffer of the system. Completed revolutions go to a ring buffer, as
//! their packets; points are computed from them when the frame is requested. The ring has the newest [`RING_LENGTH`]
//! revolutions and no more than [`RING_BYTES`] of packets: older ones are gone for good.
//!
//! A sensor that sends nothing for [`ClientDeadlines::sensor_silence`] loses its slot to the next one that sends;
//! packets that stray have none (`io/recordings/packets/streams.rs`).
//!
//! The part of the address after a `?` is the file that packets of some sensors cannot be read without: metadata of
//! Ouster, or the calibration of an HDL-64E.

use super::opener::{Name, One};
use super::{About, Capabilities, DecodeFailure, DecodedFrame, Decoder, FrameEntry, Growth, SequenceError, Source};
use crate::deadlines::ClientDeadlines;
use crate::io::ReadOptions;
use crate::io::recordings::packets::{Companion, LiveTurn, LiveTurns};
use crate::locks::lock;
use crate::progress::Progress;
use crate::waiting::Waiting;
use std::collections::VecDeque;
use std::io::{self, ErrorKind};
use std::net::{SocketAddr, UdpSocket};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Prefix of the address to listen on.
const SCHEME: Name = Name::Scheme("udp://");

/// Number of newest revolutions that can be decoded: two seconds of the fastest sensors, five of most.
const RING_LENGTH: usize = 48;

/// Packets of that many revolutions are seldom more: at 20 revolutions per second, the largest sensor has 10 MB each.
const RING_BYTES: usize = 512 << 20;

/// A datagram has no more.
const MAX_DATAGRAM_BYTES: usize = 1 << 16;

/// Interval of checks for remaining listeners.
const LOOK: Duration = Duration::from_millis(50);

/// LiDAR sensor on the network.
#[derive(Debug)]
pub struct LiveScanner {
    input: PathBuf,
    ring: Arc<Ring>,
    /// Frames that were reported.
    told: Mutex<usize>,
    options: ReadOptions,
    /// Listens as long as the source is there.
    thread: Option<JoinHandle<()>>,
}

/// Ring buffer shared by the listening thread, the source and its decoders.
#[derive(Debug, Default)]
struct Ring {
    turns: Mutex<Turns>,
    comes: Condvar,
    is_closed: AtomicBool,
}

#[derive(Debug, Default)]
struct Turns {
    /// The newest last.
    newest: VecDeque<Arc<LiveTurn>>,
    byte_size: usize,
    /// Turns that have come.
    count: usize,
    /// The reason why some packets cannot be read, or why there will be no more.
    problem: Option<String>,
    /// Datagrams that have come, and the last of them.
    datagrams: u64,
    last: Option<(SocketAddr, usize)>,
}

/// The address of a sensor.
pub(super) const ADDRESS: One = One {
    names: &[SCHEME],
    open: |input, asked| {
        let scanner = LiveScanner::open(input, &asked.options.read, asked.progress)?;
        Ok(Arc::new(scanner))
    },
    sidecar_others: Some(|input| SequenceError::Scanner {
        input: input.display().to_string(),
        problem: "a live sensor is a sequence of its own: open it without other inputs".to_owned(),
    }),
};

impl LiveScanner {
    /// Listens at `input`, such as `udp://:2368` or `udp://192.168.1.100:7502?os1.json`, until the first turn is over.
    /// `progress` may be cancelled.
    ///
    /// # Errors
    /// [`SequenceError::Scanner`], and [`SequenceError::Cancelled`].
    pub fn open(input: &Path, options: &ReadOptions, progress: &Progress) -> Result<Self, SequenceError> {
        Self::open_within(input, options, progress, ClientDeadlines::default())
    }

    /// [`LiveScanner::open`] with these `deadlines` for sensors.
    ///
    /// # Errors
    /// As of [`LiveScanner::open`].
    pub fn open_within(
        input: &Path,
        options: &ReadOptions,
        progress: &Progress,
        deadlines: ClientDeadlines,
    ) -> Result<Self, SequenceError> {
        let failed = |problem: String| SequenceError::Scanner {
            input: input.display().to_string(),
            problem,
        };
        let (address, companion) = parse(input).map_err(failed)?;
        let companion = companion
            .map(|path| Companion::read(&path))
            .transpose()
            .map_err(failed)?;
        let socket = UdpSocket::bind(address).and_then(|socket| {
            socket.set_read_timeout(Some(LOOK))?;
            Ok(socket)
        });
        let socket = socket.map_err(|error| failed(format!("{address} cannot be listened to ({error})")))?;
        let ring = Arc::<Ring>::default();
        let listening = Arc::clone(&ring);
        let thread = thread::Builder::new()
            .name("laser scanner".to_owned())
            .spawn(move || listening.listen(&socket, LiveTurns::new(companion, deadlines.sensor_silence)))
            .map_err(|reason| SequenceError::NoThread { reason })?;
        let scanner = Self {
            input: input.to_owned(),
            ring,
            told: Mutex::default(),
            options: *options,
            thread: Some(thread),
        };
        let begun = Instant::now();
        let seconds = deadlines.first_frame.as_secs_f64();
        let _waiting = Waiting::for_(format!(
            "the first turn of a laser scanner at {} (up to {seconds} s)",
            input.display()
        ));
        loop {
            scanner.look_again()?;
            let problem = lock(&scanner.ring.turns).problem.clone();
            match problem {
                _ if !scanner.frames().is_empty() => return Ok(scanner),
                Some(problem) if begun.elapsed() >= deadlines.other_sensors => return Err(failed(problem)),
                _ if progress.is_cancelled() => return Err(SequenceError::Cancelled),
                _ if begun.elapsed() >= deadlines.first_frame => {
                    return Err(failed(format!(
                        "no turn of a laser scanner came within {seconds} seconds ({}): check that the sensor is on, \
                         that it sends to this machine and this port, and that no firewall is between",
                        scanner.ring.came()
                    )));
                }
                _ => scanner.ring.wait(0, LOOK),
            }
        }
    }
}

/// The address to listen at, and the file behind it.
fn parse(input: &Path) -> Result<(SocketAddr, Option<PathBuf>), String> {
    let text = SCHEME.address(input).unwrap_or_default();
    let (address, companion) = match text.split_once('?') {
        Some((address, companion)) => (address, Some(PathBuf::from(companion))),
        None => (text, None),
    };
    let address = address.trim_end_matches('/');
    let whole = if address.starts_with(':') {
        format!("0.0.0.0{address}")
    } else {
        address.to_owned()
    };
    let parsed = whole.parse().map_err(|_| {
        format!(
            "{} is no address to listen at, expected one of this machine and a port, or a port alone, as in \
             udp://:2368",
            address.escape_default()
        )
    })?;
    Ok((parsed, companion))
}

impl Ring {
    /// Receives packets until they are no longer wanted.
    fn listen(&self, socket: &UdpSocket, mut found: LiveTurns) {
        let mut buffer = vec![0; MAX_DATAGRAM_BYTES];
        // The time of day at the start: clock adjustments in the meantime do not change the order.
        let (begun, day) = (Instant::now(), SystemTime::now());
        let day = day.duration_since(UNIX_EPOCH).unwrap_or_default();
        while !self.is_closed.load(Ordering::Relaxed) {
            let received = socket.recv_from(&mut buffer);
            let time = day + begun.elapsed();
            match received {
                Ok((count, source)) => self.take(&mut found, source, time, &buffer[..count]),
                Err(error) if is_passing(&error) => found.look(time),
                Err(error) => return self.end(format!("nothing can be received any more ({error})")),
            }
            for note in found.take_notes() {
                log::warn!("LiDAR: {note}");
            }
        }
    }

    fn take(&self, found: &mut LiveTurns, source: SocketAddr, time: Duration, bytes: &[u8]) {
        match found.add(source, time, bytes) {
            Ok(None) => {}
            // As packets: points are made by the same workers that decode any frame, so a slow machine loses frames but
            // no packets.
            Ok(Some(turn)) => self.push(turn),
            // Another sensor may send readable packets.
            Err(problem) => lock(&self.turns).problem = Some(problem),
        }
        let mut turns = lock(&self.turns);
        turns.datagrams += 1;
        turns.last = Some((source, bytes.len()));
        if found.has_sensor() {
            turns.problem = None;
        }
    }

    /// A sentence on the packets so far.
    fn came(&self) -> String {
        let turns = lock(&self.turns);
        match turns.last {
            None => "no packet at all has come".to_owned(),
            Some((source, bytes)) => format!(
                "{} packets have come, the last of {bytes} bytes from {source}, and no run of packets of one sensor",
                turns.datagrams
            ),
        }
    }

    fn push(&self, turn: LiveTurn) {
        let mut turns = lock(&self.turns);
        turns.byte_size += turn.byte_size();
        turns.newest.push_back(Arc::new(turn));
        turns.count += 1;
        while turns.newest.len() > RING_LENGTH || (turns.byte_size > RING_BYTES && turns.newest.len() > 1) {
            let gone = turns.newest.pop_front().map_or(0, |turn| turn.byte_size());
            turns.byte_size -= gone;
        }
        drop(turns);
        self.comes.notify_all();
    }

    fn end(&self, problem: String) {
        log::warn!("LiDAR: {problem}");
        lock(&self.turns).problem = Some(problem);
    }

    /// Until there are more than `count` turns, or that time is over.
    fn wait(&self, count: usize, at_most: Duration) {
        let turns = lock(&self.turns);
        let nothing_new = |turns: &mut Turns| turns.count <= count;
        let waited = self.comes.wait_timeout_while(turns, at_most, nothing_new);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    /// Turn `index`; `None` where it is gone.
    fn turn(&self, index: usize) -> Option<Arc<LiveTurn>> {
        let turns = lock(&self.turns);
        let oldest = turns.count - turns.newest.len();
        turns.newest.get(index.checked_sub(oldest)?).cloned()
    }
}

/// Errors after which packets come again: nothing came, or an answer without a recipient.
fn is_passing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::ConnectionReset
    )
}

impl Drop for LiveScanner {
    fn drop(&mut self) {
        self.ring.is_closed.store(true, Ordering::Relaxed);
        // Frees the port for the next one to open it.
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            log::debug!("the thread that listened at {} has panicked", self.input.display());
        }
    }
}

impl Source for LiveScanner {
    fn frames(&self) -> Range<usize> {
        let told = *lock(&self.told);
        let turns = lock(&self.ring.turns);
        (turns.count - turns.newest.len()).min(told)..told
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        Arc::new(FrameEntry {
            name: format!("{} {index}", self.input.display()),
            number: Some(index as u64),
            time: self.ring.turn(index).map(|turn| turn.time),
            ..FrameEntry::embedded(self.input.clone(), &[])
        })
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(ScannerDecoder {
            input: self.input.clone(),
            ring: Arc::clone(&self.ring),
            options: self.options,
        })
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: std::slice::from_ref(&self.input),
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            growth: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Growth for LiveScanner {
    fn is_live(&self) -> bool {
        true
    }

    fn may_grow(&self) -> bool {
        true
    }

    fn look_again(&self) -> Result<usize, SequenceError> {
        // Locked first, so that the number never decreases.
        let mut told = lock(&self.told);
        let count = lock(&self.ring.turns).count;
        let before = std::mem::replace(&mut *told, count);
        Ok(count - before)
    }

    fn wait_for_more(&self, at_most: Duration) -> Result<usize, SequenceError> {
        let told = *lock(&self.told);
        self.ring.wait(told, at_most);
        self.look_again()
    }
}

struct ScannerDecoder {
    input: PathBuf,
    ring: Arc<Ring>,
    options: ReadOptions,
}

impl Decoder for ScannerDecoder {
    fn decode(
        &mut self,
        index: usize,
        _entry: &FrameEntry,
        _max_points: usize,
        _progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let turn = self.ring.turn(index);
        let turn = turn.ok_or_else(|| format!("{}: turn {index} is gone for good", self.input.display()))?;
        let cloud = turn.cloud(&self.options);
        let cloud = cloud.map_err(|problem| format!("{}, turn {index}: {problem}", self.input.display()))?;
        Ok(cloud.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(input: &str) -> Result<(String, Option<PathBuf>), String> {
        parse(Path::new(input)).map(|(address, companion)| (address.to_string(), companion))
    }

    #[test]
    fn addresses_have_a_port_and_may_have_a_file() {
        assert_eq!(parsed("udp://:2368"), Ok(("0.0.0.0:2368".to_owned(), None)));
        assert_eq!(parsed("udp://127.0.0.1:9/"), Ok(("127.0.0.1:9".to_owned(), None)));
        assert_eq!(parsed("udp://[::1]:7502"), Ok(("[::1]:7502".to_owned(), None)));
        let with_file = Ok(("0.0.0.0:7502".to_owned(), Some(PathBuf::from("a/os1.json"))));
        assert_eq!(parsed("udp://:7502?a/os1.json"), with_file);
        for wrong in ["udp://", "udp://:", "udp://:99999", "udp://sensor", "udp://2368"] {
            let problem = parsed(wrong).unwrap_err();
            assert!(problem.contains("udp://:2368"), "{problem}");
        }
        assert!(ADDRESS.can_read(Path::new("udp://:1")) && !ADDRESS.can_read(Path::new("drive.pcap")));
    }
}
