//! The thread that is connected: reads what comes, and connects again where nothing comes any more.
//!
//! A server that is not there is tried again after a tenth of a second, then after twice as long each time, up to five
//! seconds. One that says nothing at all for [`PATIENCE`] counts as gone: servers say what time it is once a second.

use super::shared::Shared;
use crate::locks::lock;
use crate::wire::{Got, Kind, Ping, Pong, StreamHead, WireError, read_message};
use std::io::{self, BufReader, ErrorKind, Read, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// A server that says nothing for so long is gone.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);

/// How long a connection may take.
const CONNECTING: Duration = Duration::from_secs(2);

/// Between looks at whether anybody listens still.
const LOOK: Duration = Duration::from_millis(50);

/// Between pings.
const PING_INTERVAL: Duration = Duration::from_millis(500);

/// The first and the longest time until a connection is tried again.
const BACK_OFF: [Duration; 2] = [Duration::from_millis(100), Duration::from_secs(5)];

/// Stays connected to `address` until the source is closed.
pub(super) fn run(shared: &Arc<Shared>, address: &str, most_bytes: u64) {
    let [shortest, longest] = BACK_OFF;
    let mut back_off = shortest;
    while !shared.is_closed() {
        let received = shared.status().received_frames;
        let (problem, is_final) = match connect(address) {
            Ok(stream) => {
                let Err(error) = follow(shared, &stream, most_bytes);
                (error.to_string(), error.is_final())
            }
            Err(problem) => (problem, false),
        };
        if shared.status().received_frames > received {
            back_off = shortest;
        }
        log::debug!("{address}: {problem}");
        shared.failed(problem, is_final);
        let begun = Instant::now();
        while begun.elapsed() < back_off && !shared.is_closed() {
            thread::sleep(LOOK.min(back_off));
        }
        back_off = (2 * back_off).min(longest);
    }
}

fn connect(address: &str) -> Result<TcpStream, String> {
    let found = address.to_socket_addrs();
    let found = found.map_err(|error| format!("the host cannot be found ({error}): check its name"))?;
    let mut problem = "the host has no address: check its name".to_owned();
    for address in found {
        match TcpStream::connect_timeout(&address, CONNECTING) {
            Ok(stream) => return Ok(stream),
            Err(error) => {
                problem = format!(
                    "nothing can be reached there ({error}): check that `pointreel serve INPUT --live --listen \
                     ADDRESS:PORT` runs with this port, and that no firewall is between"
                );
            }
        }
    }
    Err(problem)
}

/// What is never returned.
enum Never {}

/// Takes what comes until that is over.
fn follow(shared: &Shared, stream: &TcpStream, most_bytes: u64) -> Result<Never, WireError> {
    let prepared = stream
        .set_nodelay(true)
        .and_then(|()| stream.set_read_timeout(Some(LOOK)))
        .and_then(|()| stream.set_write_timeout(Some(PATIENCE)));
    prepared.map_err(WireError::Io)?;
    let now = Instant::now();
    let patient = Patient {
        stream,
        shared,
        heard: now,
        pinged: None,
    };
    let mut reader = BufReader::with_capacity(1 << 16, patient);
    let head = StreamHead::read(&mut reader)?;
    // Before it, the other side may be no server of streams, which pings would confuse.
    reader.get_mut().pinged = Some(now.checked_sub(PING_INTERVAL).unwrap_or(now));
    shared.connected(head);
    loop {
        let message = read_message(&mut reader, most_bytes)?;
        match message.kind {
            Kind::Images | Kind::Points => {
                if let Some(number) = shared.frame(message)? {
                    say(stream, &Got { number }.message().encode())?;
                }
            }
            Kind::Pong => shared.pong(Pong::parse(&message.payload)?),
            Kind::End => {
                let said = String::from_utf8_lossy(&message.payload);
                let said: String = said.chars().take(200).collect();
                let said = io::Error::other(format!("the server says: {}", said.escape_debug()));
                return Err(WireError::Io(said));
            }
            _ => {}
        }
    }
}

fn say(mut stream: &TcpStream, bytes: &[u8]) -> Result<(), WireError> {
    stream.write_all(bytes).map_err(WireError::Io)
}

/// Reads as long as the source is wanted and the server says something. Asks it from time to time what time it is, and
/// tells it what is looked at.
struct Patient<'a> {
    stream: &'a TcpStream,
    shared: &'a Shared,
    heard: Instant,
    /// When it was asked last; `None` while it is not to be asked.
    pinged: Option<Instant>,
}

impl Patient<'_> {
    fn ping(&mut self) -> io::Result<()> {
        if self.pinged.is_some()
            && let Some(view) = self.shared.view_to_tell()
        {
            let mut stream = self.stream;
            stream.write_all(&view.message().encode())?;
        }
        let is_due = self.pinged.is_some_and(|pinged| pinged.elapsed() >= PING_INTERVAL);
        if is_due {
            self.pinged = Some(Instant::now());
            let client_ns = self.shared.now_ns();
            let mut stream = self.stream;
            stream.write_all(&Ping { client_ns }.message().encode())?;
        }
        Ok(())
    }
}

impl Read for Patient<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            if self.shared.is_closed() {
                return Err(io::Error::other("nobody wants frames any more"));
            }
            self.ping()?;
            let mut stream = self.stream;
            match stream.read(buffer) {
                Ok(count) => {
                    self.heard = Instant::now();
                    return Ok(count);
                }
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    if self.heard.elapsed() >= PATIENCE {
                        let seconds = PATIENCE.as_secs();
                        let problem = format!(
                            "the server has said nothing for {seconds} seconds: check that it is `pointreel serve \
                             --live`, and the network"
                        );
                        return Err(io::Error::new(ErrorKind::TimedOut, problem));
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }
}

impl Drop for Patient<'_> {
    fn drop(&mut self) {
        // The server need not find out by itself.
        let _ = self.stream.shutdown(std::net::Shutdown::Both);
    }
}

/// Whether trying again is of no use, and why there is no connection.
pub(super) fn problem(shared: &Shared) -> Option<(String, bool)> {
    lock(&shared.link).problem.clone()
}
