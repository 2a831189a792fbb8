//! Sequences over the network: one file by HTTP, or frames as a live stream ([`live`]).
//!
//! One file by HTTP, for those who read ranges of it: `pointreel serve walk.reel`.
//!
//! **How it works.** One thread per connection, a few at once; requests are parsed by `httparse`. `GET` and `HEAD` of
//! the file's name, whole or a range (RFC 9110 §14), are answered, and nothing else: there are no paths to other files.
//! Connections stay open, and requests that follow each other without waiting are answered in their order. Any server
//! of plain files does the same; this one needs no installation.
//!
//! **Bounds.** A request has 8 KiB of head at most and no body; it has to come, and its answer has to be taken, within
//! [`ServerDeadlines`]. Beyond `MAX_CONNECTIONS`, idle and slow connections give way (`places.rs`); if descriptors are
//! used up, the server pauses (`accept.rs`).

mod accept;
mod answer;
#[cfg(test)]
mod attacks;
mod cors;
pub mod live;
mod places;
mod range;
mod request;
mod steady;

pub use cors::CorsOrigin;

use crate::deadlines::ServerDeadlines;
use crate::regular_file;
use accept::{AcceptBackOff, is_out_of_descriptors};
use answer::{Answer, Served};
use places::{Place, Places};
use request::{Method, Request};
use std::fs::{File, Metadata};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime};
use steady::SteadyWriter;

/// Connections that are answered at once.
const MAX_CONNECTIONS: usize = 64;

/// Bytes of the head of a request.
const MAX_HEAD_BYTES: usize = 8 << 10;

/// Bytes that are read and sent at a time.
const PIECE_BYTES: usize = 1 << 16;

/// Time and byte limits for draining a refused client: a connection that is closed with unread bytes is reset, and the
/// client does not see the reason.
const PARTING: (Duration, usize) = (Duration::from_millis(200), 1 << 16);

/// Number of attempts to open the file when file descriptors are exhausted, and the pause between them.
const OPEN_TRIES: u32 = 50;
const OPEN_PAUSE: Duration = Duration::from_millis(20);

/// Options for serving a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FileServerOptions {
    /// Pages that may read it: none, unless they are named.
    pub cors: Vec<CorsOrigin>,
    /// Timeouts for waiting on clients.
    pub deadlines: ServerDeadlines,
}

/// Serves one file until it is stopped.
#[derive(Debug)]
pub struct FileServer {
    listener: TcpListener,
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    path: PathBuf,
    /// Request target of the file: `/` followed by its name.
    target: String,
    options: FileServerOptions,
    places: Arc<Places>,
    sent_bytes: AtomicU64,
    is_over: AtomicBool,
}

impl FileServer {
    /// Listens at `address` for requests of the file at `path`; nothing is answered before [`FileServer::run`].
    pub fn bind(path: &Path, address: SocketAddr, options: FileServerOptions) -> io::Result<Self> {
        // Ensures that it can be read before the first request.
        regular_file::open(path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(Self {
            listener: TcpListener::bind(address)?,
            shared: Arc::new(Shared {
                path: path.to_owned(),
                target: format!("/{}", answer::encoded(&name)),
                places: Arc::new(Places::new(MAX_CONNECTIONS, options.deadlines.stuck)),
                options,
                sent_bytes: AtomicU64::new(0),
                is_over: AtomicBool::new(false),
            }),
        })
    }

    /// Returns the URL of the file: `http://127.0.0.1:8080/walk.reel`.
    pub fn url(&self) -> io::Result<String> {
        Ok(format!("http://{}{}", self.listener.local_addr()?, self.shared.target))
    }

    /// Bytes of the file that were sent so far.
    pub fn sent_bytes(&self) -> u64 {
        self.shared.sent_bytes.load(Ordering::Relaxed)
    }

    /// Answers requests until [`FileServer::stop`].
    pub fn run(&self) -> io::Result<()> {
        let mut back_off = AcceptBackOff::default();
        for stream in self.listener.incoming() {
            if self.shared.is_over.load(Ordering::Relaxed) {
                return Ok(());
            }
            match stream {
                Ok(stream) => {
                    back_off.works();
                    self.welcome(stream);
                }
                Err(error) => {
                    let pause = back_off.failed(&error);
                    if !pause.is_zero() {
                        self.shared.places.free_one();
                        thread::sleep(pause);
                    }
                }
            }
        }
        Ok(())
    }

    fn welcome(&self, stream: TcpStream) {
        let shared = Arc::clone(&self.shared);
        let stream = Arc::new(stream);
        let place = shared.places.take(&stream);
        let answered = thread::Builder::new().name("connection".to_owned()).spawn(move || {
            if let Err(error) = shared.answer_all(&stream, &place) {
                log::debug!("a connection ended: {error}");
            }
        });
        if let Err(error) = answered {
            log::warn!("a connection has no thread ({error}): it is closed");
        }
    }

    /// Ends [`FileServer::run`], which another thread is in.
    pub fn stop(&self) -> io::Result<()> {
        self.shared.is_over.store(true, Ordering::Relaxed);
        TcpStream::connect(self.listener.local_addr()?).map(drop)
    }
}

impl Shared {
    fn answer_all(&self, stream: &TcpStream, place: &Place) -> io::Result<()> {
        stream.set_nodelay(true)?;
        let mut read = Vec::new();
        while let Some(request) = next_request(stream, &mut read, &self.options.deadlines)? {
            place.is_answered();
            let keeps_open = self.answer(stream, &request, place)?;
            place.waits();
            if request.method == Method::Bad {
                part(stream)?;
            }
            if !keeps_open || self.is_over.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok(())
    }

    /// Answers one request; returns true if the connection stays open.
    fn answer(&self, stream: &TcpStream, request: &Request, place: &Place) -> io::Result<bool> {
        let mut writer = SteadyWriter::new(stream, self.options.deadlines.answer);
        let (mut file, metadata) = match self.open() {
            Ok(opened) => opened,
            Err(error) => {
                log::debug!("{} cannot be opened: {error}", self.path.display());
                writer.write(Answer::unavailable().head().as_bytes(), |_| ())?;
                return Ok(false);
            }
        };
        let served = Served {
            target: &self.target,
            len: metadata.len(),
            modified: metadata.modified().ok(),
            now: SystemTime::now(),
            cors: &self.options.cors,
        };
        let answer = served.answer(request);
        writer.write(answer.head().as_bytes(), |_| ())?;
        let Some(range) = answer.body else {
            return Ok(answer.keeps_open);
        };
        file.seek(SeekFrom::Start(range.start))?;
        let mut left = file.take(range.end - range.start);
        let mut piece = vec![0; PIECE_BYTES];
        loop {
            let count = left.read(&mut piece)?;
            if count == 0 {
                break;
            }
            writer.write(&piece[..count], |sent| {
                place.sent(sent);
                self.sent_bytes.fetch_add(sent as u64, Ordering::Relaxed);
            })?;
        }
        // The file was truncated in the meantime: a client waiting for the rest would wait forever.
        Ok(answer.keeps_open && left.limit() == 0)
    }

    /// The file. Where descriptors are used up, idle connections give theirs.
    fn open(&self) -> io::Result<(File, Metadata)> {
        for _ in 1..OPEN_TRIES {
            match regular_file::open(&self.path) {
                Err(error) if is_out_of_descriptors(&error) => {
                    self.places.free_one();
                    thread::sleep(OPEN_PAUSE);
                }
                opened => return with_metadata(opened?),
            }
        }
        with_metadata(regular_file::open(&self.path)?)
    }
}

fn with_metadata(file: File) -> io::Result<(File, Metadata)> {
    let metadata = file.metadata()?;
    Ok((file, metadata))
}

/// The next request of a connection, where `read` has the bytes read beyond the last one; `None` at its end.
fn next_request(
    mut stream: &TcpStream,
    read: &mut Vec<u8>,
    deadlines: &ServerDeadlines,
) -> io::Result<Option<Request>> {
    let mut piece = [0; 1024];
    let mut begun = (!read.is_empty()).then(Instant::now);
    loop {
        match Request::parse(read) {
            Ok(Some((request, end))) => {
                read.drain(..end);
                return Ok(Some(request));
            }
            Ok(None) if read.len() <= MAX_HEAD_BYTES => {}
            Ok(None) | Err(_) => return Ok(Some(Request::bad())),
        }
        let left = begun.map_or(deadlines.idle, |begun| deadlines.head.saturating_sub(begun.elapsed()));
        if left.is_zero() {
            return Ok(None);
        }
        stream.set_read_timeout(Some(left))?;
        let count = stream.read(&mut piece)?;
        if count == 0 {
            return Ok(None);
        }
        begun = begun.or_else(|| Some(Instant::now()));
        read.extend(&piece[..count]);
    }
}

/// Lets a client that was refused see the answer.
fn part(mut stream: &TcpStream) -> io::Result<()> {
    let (time, max_bytes) = PARTING;
    stream.shutdown(Shutdown::Write)?;
    let (begun, mut piece, mut bytes) = (Instant::now(), [0; 1024], 0);
    while bytes < max_bytes {
        let left = time.saturating_sub(begun.elapsed());
        if left.is_zero() {
            break;
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut piece)? {
            0 => break,
            count => bytes += count,
        }
    }
    Ok(())
}
