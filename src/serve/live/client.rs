//! The two threads of a client: one sends, one listens.

use super::audience::Client;
use super::mailbox::{Next, heartbeat};
use crate::analysis::screen::ScreenEstimator;
use crate::deadlines::MinRate;
use crate::locks::lock;
use crate::serve::steady::SteadyWriter;
use crate::wire::{Got, Kind, Message, Ping, Pong, StreamHead, View, WireError, read_message};
use std::io::{self, BufReader, Write as _};
use std::net::TcpStream;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Heartbeat interval: if there is no frame, the server's presence is signalled once in this time.
// Clients take five seconds of silence to mean that the server is gone.
const HEARTBEAT: Duration = Duration::from_secs(1);

/// Bytes of a message of a client.
const MAX_SAID_BYTES: u64 = 256;

/// Number of messages of a client read in this time: more than there are frames, and little CPU load.
const MAX_SAID: (u32, Duration) = (1000, Duration::from_millis(50));

/// Estimators of the surfaces in views: one per CPU, as each has numbers for every pixel of the largest view it has
/// received.
#[derive(Debug)]
pub(super) struct Estimators {
    all: Vec<Mutex<ScreenEstimator>>,
    next: AtomicUsize,
}

impl Default for Estimators {
    fn default() -> Self {
        let count = thread::available_parallelism().map_or(1, usize::from);
        Self {
            all: (0..count).map(|_| Mutex::default()).collect(),
            next: AtomicUsize::new(0),
        }
    }
}

impl Estimators {
    /// One of them, in turn.
    fn one(&self) -> &Mutex<ScreenEstimator> {
        &self.all[self.next.fetch_add(1, Ordering::Relaxed) % self.all.len()]
    }
}

/// Sends the contents of the mailbox until the client has left, or there is no more; returns the reason for the end.
pub(super) fn send(
    client: &Client,
    min: MinRate,
    head: &StreamHead,
    estimators: &Estimators,
    clock_ns: impl Fn() -> u64,
    newest: impl Fn() -> Option<u64>,
) -> String {
    let deliver = |parts: &[&[u8]]| -> io::Result<()> {
        let mut writer = SteadyWriter::new(&client.stream, min);
        client.begins_to_take();
        for part in parts {
            writer.write(part, |_| client.begins_to_take())?;
        }
        client.has_taken();
        Ok(())
    };
    let sent = || -> io::Result<String> {
        client.stream.set_nodelay(true)?;
        deliver(&[&head.encode()])?;
        loop {
            match client.mailbox.next(HEARTBEAT) {
                Next::Frame(frame) => {
                    let whole_bytes = frame.byte_size() as u64;
                    let seen = client
                        // The newest view at the time of sending, not that at the time of decoding.
                        .view()
                        .and_then(|view| frame.seen_by(&view, &mut lock(estimators.one())));
                    let frame = seen.unwrap_or(frame);
                    deliver(&[&frame.head, &frame.body.bytes])?;
                    client.sent_frames.fetch_add(1, Ordering::Relaxed);
                    client.sent_bytes.fetch_add(frame.byte_size() as u64, Ordering::Relaxed);
                    client.whole_bytes.fetch_add(whole_bytes, Ordering::Relaxed);
                }
                Next::Answer(mut answer) => {
                    stamp(&mut answer.payload, answer.kind, clock_ns());
                    deliver(&[&answer.encode()])?;
                }
                Next::Nothing => deliver(&[&heartbeat(clock_ns(), newest()).encode()])?,
                Next::End(reason) => {
                    deliver(&[&end(&reason)])?;
                    return Ok(reason);
                }
            }
        }
    };
    match sent() {
        Ok(reason) => reason,
        Err(error) if error.kind() == io::ErrorKind::TimedOut => error.to_string(),
        Err(error) => format!("it has left ({error})"),
    }
}

/// The message that there will be no more.
fn end(reason: &str) -> Vec<u8> {
    Message::new(Kind::End, reason.as_bytes().to_vec()).encode()
}

/// Tells a rejected client the reason, if that is possible at once.
pub(super) fn refuse(mut stream: &TcpStream, head: &StreamHead, reason: &str) -> io::Result<()> {
    // Buffers of a new connection hold that much.
    stream.set_nonblocking(true)?;
    stream.write_all(&head.encode())?;
    stream.write_all(&end(reason))
}

/// An answer to a ping says when it is sent, not when it was made: it may have waited behind a frame.
fn stamp(payload: &mut Vec<u8>, kind: Kind, clock_ns: u64) {
    if kind == Kind::Pong
        && let Ok(pong) = Pong::parse(payload)
    {
        let stamped = Pong {
            sent_ns: clock_ns,
            ..pong
        };
        *payload = stamped.message().payload;
    }
}

/// Reads the client's messages until there are no more.
pub(super) fn listen(client: &Client, stream: &TcpStream, clock_ns: impl Fn() -> u64) -> WireError {
    let mut reader = BufReader::with_capacity(1 << 10, stream);
    let (max, time) = MAX_SAID;
    let (mut said, mut begun) = (0, Instant::now());
    loop {
        if said == max {
            thread::sleep(time.saturating_sub(begun.elapsed()));
            (said, begun) = (0, Instant::now());
        }
        said += 1;
        let heard = read_message(&mut reader, MAX_SAID_BYTES).and_then(|message| {
            match message.kind {
                Kind::Ping => {
                    let received_ns = clock_ns();
                    let Ping { client_ns } = Ping::parse(&message.payload)?;
                    let pong = Pong {
                        client_ns,
                        received_ns,
                        sent_ns: received_ns,
                    };
                    client.mailbox.answer(pong.message());
                }
                Kind::View => client.look_from(View::parse(&message.payload)?),
                Kind::Got => client.mailbox.got(Got::parse(&message.payload)?.number),
                _ => {}
            }
            client.has_spoken();
            Ok(())
        });
        if let Err(error) = heard {
            return error;
        }
    }
}
