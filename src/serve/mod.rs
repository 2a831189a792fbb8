//! Sequences over the network: one file by HTTP, or frames as a live stream ([`live`]).
//!
//! One file by HTTP, for those who read ranges of it: `pointreel serve walk.reel`.
//!
//! **How it works.** A thread a connection, a few at once; requests are parsed by `httparse`. `GET` and `HEAD` of the
//! file's name, whole or a range (RFC 9110 §14), are answered, and nothing else: there are no paths to other files.
//! Connections stay open. Any server of plain files does the same; this one needs no installation.
//!
//! **Bounds.** A request has 8 KiB of head at most, which come within `HEAD_TIME`, and no body; a connection that says
//! nothing is closed; of more connections than `MOST_CONNECTIONS` the idle and the slow give way (`places.rs`).

pub mod live;
mod places;
mod request;

use crate::regular_file;
use places::{Place, Places};
use request::{Answer, Request};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Connections that are answered at once.
const MOST_CONNECTIONS: usize = 64;

/// A connection that says nothing for so long is closed.
const PATIENCE: Duration = Duration::from_secs(30);

/// How long the head of a request may take from its first byte on.
const HEAD_TIME: Duration = Duration::from_secs(10);

/// Bytes of the head of a request.
const MOST_HEAD_BYTES: usize = 8 << 10;

/// Bytes that are read and sent at a time.
const PIECE_BYTES: usize = 1 << 16;

/// Serves one file until it is stopped.
#[derive(Debug)]
pub struct FileServer {
    listener: TcpListener,
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    path: PathBuf,
    /// What the file is called in requests: `/` and its name.
    target: String,
    places: Arc<Places>,
    sent_bytes: AtomicU64,
    is_over: AtomicBool,
}

impl FileServer {
    /// Listens at `address` for requests of the file at `path`; nothing is answered before [`FileServer::run`].
    pub fn bind(path: &Path, address: SocketAddr) -> io::Result<Self> {
        // That it can be read is known before anybody asks.
        regular_file::open(path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(Self {
            listener: TcpListener::bind(address)?,
            shared: Arc::new(Shared {
                path: path.to_owned(),
                target: format!("/{}", request::encoded(&name)),
                places: Arc::new(Places::new(MOST_CONNECTIONS)),
                sent_bytes: AtomicU64::new(0),
                is_over: AtomicBool::new(false),
            }),
        })
    }

    /// Where the file is: `http://127.0.0.1:8080/walk.reel`.
    pub fn url(&self) -> io::Result<String> {
        Ok(format!("http://{}{}", self.listener.local_addr()?, self.shared.target))
    }

    /// Bytes of the file that were sent so far.
    pub fn sent_bytes(&self) -> u64 {
        self.shared.sent_bytes.load(Ordering::Relaxed)
    }

    /// Answers requests until [`FileServer::stop`].
    pub fn run(&self) -> io::Result<()> {
        for stream in self.listener.incoming() {
            if self.shared.is_over.load(Ordering::Relaxed) {
                return Ok(());
            }
            let stream = match stream {
                Ok(stream) => stream,
                Err(error) => {
                    log::warn!("a connection failed: {error}");
                    continue;
                }
            };
            let shared = Arc::clone(&self.shared);
            let Ok(place) = shared.places.take(&stream) else {
                continue;
            };
            let answered = thread::Builder::new().name("connection".to_owned()).spawn(move || {
                if let Err(error) = shared.answer_all(stream, &place) {
                    log::debug!("a connection ended: {error}");
                }
            });
            if let Err(error) = answered {
                log::warn!("a connection has no thread ({error}): it is closed");
            }
        }
        Ok(())
    }

    /// Ends [`FileServer::run`], which another thread is in.
    pub fn stop(&self) -> io::Result<()> {
        self.shared.is_over.store(true, Ordering::Relaxed);
        TcpStream::connect(self.listener.local_addr()?).map(drop)
    }
}

impl Shared {
    fn answer_all(&self, mut stream: TcpStream, place: &Place) -> io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.set_nodelay(true)?;
        let mut read = Vec::new();
        while let Some(request) = next_request(&mut stream, &mut read)? {
            place.is_answered();
            let keeps_open = self.answer(&mut stream, &request, place)?;
            place.waits();
            if !keeps_open || self.is_over.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok(())
    }

    /// Answers one request; says whether the connection stays open.
    fn answer(&self, stream: &mut TcpStream, request: &Request, place: &Place) -> io::Result<bool> {
        let mut file = regular_file::open(&self.path)?;
        let metadata = file.metadata()?;
        let answer = request.answer(&self.target, metadata.len(), metadata.modified().ok());
        stream.write_all(answer.head().as_bytes())?;
        if let Answer { body: Some(range), .. } = &answer {
            file.seek(SeekFrom::Start(range.start))?;
            let mut left = file.take(range.end - range.start);
            let mut piece = vec![0; PIECE_BYTES];
            loop {
                let count = left.read(&mut piece)?;
                if count == 0 {
                    break;
                }
                stream.write_all(&piece[..count])?;
                place.sent(count);
                self.sent_bytes.fetch_add(count as u64, Ordering::Relaxed);
            }
            // A file that was cut meanwhile: who waits for the rest would wait in vain.
            if left.limit() > 0 {
                return Ok(false);
            }
        }
        Ok(answer.keeps_open)
    }
}

/// The next request of a connection, of which `read` has what was read beyond the last one; `None` at its end.
fn next_request(stream: &mut TcpStream, read: &mut Vec<u8>) -> io::Result<Option<Request>> {
    let mut piece = [0; 1024];
    let mut begun = (!read.is_empty()).then(Instant::now);
    loop {
        match Request::parse(read) {
            Ok(Some((request, end))) => {
                read.drain(..end);
                return Ok(Some(request));
            }
            Ok(None) if read.len() > MOST_HEAD_BYTES => return Ok(Some(Request::bad())),
            Ok(None) => {}
            Err(_) => return Ok(Some(Request::bad())),
        }
        let left = begun.map_or(PATIENCE, |begun| HEAD_TIME.saturating_sub(begun.elapsed()));
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
