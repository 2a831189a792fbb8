//! The connected thread: reads messages, and reconnects when no more arrive.
//!
//! An absent server is tried again after a tenth of a second, then after twice as long each time, up to five seconds.
//! One that sends nothing for [`ClientDeadlines::silence`] counts as gone, as servers send their time once per second;
//! so does one whose message comes more slowly than [`ClientDeadlines::transfer`] allows.

use super::shared::Shared;
use crate::deadlines::ClientDeadlines;
use crate::locks::lock;
use crate::wire::{Got, Kind, Ping, Pong, StreamHead, WireError, read_message};
use std::io::{self, BufReader, ErrorKind, Read, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// Interval of checks for remaining listeners.
const LOOK: Duration = Duration::from_millis(50);

/// Between pings.
const PING_INTERVAL: Duration = Duration::from_millis(500);

/// The first and the longest time until a connection is tried again.
const BACK_OFF: [Duration; 2] = [Duration::from_millis(100), Duration::from_secs(5)];

/// Stays connected to `address` until the source is closed.
pub(super) fn run(shared: &Arc<Shared>, address: &str, max_bytes: u64, deadlines: &ClientDeadlines) {
    let [shortest, longest] = BACK_OFF;
    let mut back_off = shortest;
    while !shared.is_closed() {
        let received = shared.status().received_frames;
        let (problem, is_final) = match connect(address, deadlines) {
            Ok(stream) => {
                let Err(error) = follow(shared, &stream, max_bytes, deadlines);
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

fn connect(address: &str, deadlines: &ClientDeadlines) -> Result<TcpStream, String> {
    let found = address.to_socket_addrs();
    let found = found.map_err(|error| format!("the host cannot be found ({error}): check its name"))?;
    let mut problem = "the host has no address: check its name".to_owned();
    for address in found {
        match TcpStream::connect_timeout(&address, deadlines.connect) {
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

/// Uninhabited type: never returned.
enum Never {}

/// Takes messages until they end.
fn follow(
    shared: &Shared,
    stream: &TcpStream,
    max_bytes: u64,
    deadlines: &ClientDeadlines,
) -> Result<Never, WireError> {
    let prepared = stream
        .set_nodelay(true)
        .and_then(|()| stream.set_read_timeout(Some(LOOK)))
        .and_then(|()| stream.set_write_timeout(Some(deadlines.silence)));
    prepared.map_err(WireError::Io)?;
    let now = Instant::now();
    let patient = Patient {
        stream,
        shared,
        deadlines,
        heard: now,
        message: None,
        pinged: None,
    };
    let mut reader = BufReader::with_capacity(1 << 16, patient);
    let head = StreamHead::read(&mut reader)?;
    // Before this, the other side may not be a stream server, which pings would confuse.
    reader.get_mut().pinged = Some(now.checked_sub(PING_INTERVAL).unwrap_or(now));
    shared.connected(head);
    loop {
        // Data read ahead involved no waiting.
        reader.get_mut().message = None;
        let message = read_message(&mut reader, max_bytes)?;
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

/// Reads as long as the source is wanted and the server sends something. Requests its time at intervals, and sends it
/// the view.
struct Patient<'a> {
    stream: &'a TcpStream,
    shared: &'a Shared,
    deadlines: &'a ClientDeadlines,
    heard: Instant,
    /// Time when the first bytes of the message being read came, and the number of bytes so far.
    message: Option<(Instant, u64)>,
    /// Time of the last ping; `None` while none is to be sent.
    pinged: Option<Instant>,
}

impl Patient<'_> {
    /// A server that is gone, or as good as gone.
    fn check(&self) -> io::Result<()> {
        let silence = self.deadlines.silence;
        let problem = if self.heard.elapsed() >= silence {
            format!(
                "the server has said nothing for {} seconds: check that it is `pointreel serve --live`, and the \
                 network",
                silence.as_secs_f64()
            )
        } else if let Some((begun, bytes)) = self.message
            && self.deadlines.transfer.time_left(bytes, begun.elapsed()).is_none()
        {
            format!(
                "the server has sent {bytes} bytes of a message in {:.0} seconds, expected at least {:.0} per second: \
                 check the network",
                begun.elapsed().as_secs_f64(),
                self.deadlines.transfer.bytes_per_s
            )
        } else {
            return Ok(());
        };
        Err(io::Error::new(ErrorKind::TimedOut, problem))
    }

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
                return Err(io::Error::other("no one wants frames any more"));
            }
            self.check()?;
            self.ping()?;
            let mut stream = self.stream;
            match stream.read(buffer) {
                Ok(count) => {
                    self.heard = Instant::now();
                    self.message.get_or_insert((self.heard, 0)).1 += count as u64;
                    return Ok(count);
                }
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => return Err(error),
            }
        }
    }
}

impl Drop for Patient<'_> {
    fn drop(&mut self) {
        // So that the server does not have to find out by itself.
        let _ = self.stream.shutdown(std::net::Shutdown::Both);
    }
}

/// Returns the reason why there is no connection, and true if retrying is of no use.
pub(super) fn problem(shared: &Shared) -> Option<(String, bool)> {
    lock(&shared.link).problem.clone()
}
