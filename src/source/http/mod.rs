//! A file on a web server, of which ranges are read: any server of plain files will do.
//!
//! **How it works.** What is read is asked for by `Range` (RFC 9110 §14), over connections that stay open. Small pieces
//! come from blocks that are kept, since an index and the directories of groups are read in many. A connection that
//! breaks is opened again where it broke, with growing pauses; a server that answers wrongly is an error at once. A
//! file that is another one meanwhile, by its tag or its date, is an error too.
//!
//! **Bounds.** No more is read than was asked for, whatever the server sends, and no faster than is allowed
//! ([`pace`]). Blocks take [`MOST_BLOCKS`] times [`BLOCK_BYTES`].

mod pace;

use crate::locks::lock;
use crate::reel::ReadAt;
use pace::BytePace;
use std::collections::VecDeque;
use std::io::{self, Read as _};
use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;
use ureq::http::{HeaderMap, StatusCode, header};

/// Pieces up to this size come from blocks.
const BLOCK_BYTES: u64 = 1 << 16;

/// Blocks that are kept.
const MOST_BLOCKS: usize = 64;

/// How often a read is tried again before it fails, and the first pause, which doubles: twelve seconds in all.
const TRIES: u32 = 8;
const FIRST_PAUSE: Duration = Duration::from_millis(50);

/// Nothing at all for so long is a broken connection.
const PATIENCE: Duration = Duration::from_secs(5);

/// Bytes between two looks at the pace.
const PIECE_BYTES: usize = 1 << 14;

const CHANGED: &str = "the file has changed on the server: open it again";

/// A file on a web server.
pub(super) struct HttpFile {
    agent: ureq::Agent,
    url: String,
    len: u64,
    /// By which the file is known to be the same one.
    version: Option<String>,
    pace: BytePace,
    blocks: Mutex<VecDeque<(u64, Arc<Vec<u8>>)>>,
}

impl std::fmt::Debug for HttpFile {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = formatter.debug_struct("HttpFile");
        text.field("url", &self.url)
            .field("len", &self.len)
            .finish_non_exhaustive()
    }
}

/// Why an answer is of no use.
enum Failure {
    /// It may be better the next time.
    Broken(io::Error),
    /// It will not.
    Refused(io::Error),
}

impl HttpFile {
    /// Asks for the size of the file at `url`, which is read with at most so many bits a second.
    ///
    /// # Errors
    /// No such file, no answer, and servers that do not answer ranges.
    pub(super) fn open(url: &str, most_bits_per_s: Option<f64>) -> io::Result<Self> {
        let config = ureq::Agent::config_builder()
            .http_status_as_error(false)
            .timeout_connect(Some(PATIENCE))
            .timeout_recv_response(Some(PATIENCE))
            .timeout_per_read(Some(PATIENCE))
            .user_agent(concat!("pointreel/", env!("CARGO_PKG_VERSION")))
            .build();
        let mut file = Self {
            agent: config.into(),
            url: url.to_owned(),
            len: 0,
            version: None,
            pace: BytePace::new(most_bits_per_s.map(|bits| bits / 8.0)),
            blocks: Mutex::default(),
        };
        let (whole, version) = file.again_and_again(|file| {
            let response = file.ask(0..1)?;
            let whole = whole_length(response.headers())
                .ok_or_else(|| Failure::Refused(io::Error::other("the server does not say how long the file is")))?;
            Ok((whole, version_of(response.headers())))
        })?;
        (file.len, file.version) = (whole, version);
        Ok(file)
    }

    /// The answer to a request for a range, unless it is something else.
    fn ask(&self, range: Range<u64>) -> Result<ureq::http::Response<ureq::Body>, Failure> {
        let wanted = format!("bytes={}-{}", range.start, range.end - 1);
        let response = self.agent.get(&self.url).header(header::RANGE, &wanted).call();
        let response = response.map_err(|error| match error {
            ureq::Error::Io(_)
            | ureq::Error::Timeout(_)
            | ureq::Error::ConnectionFailed
            | ureq::Error::HostNotFound => Failure::Broken(io::Error::other(error)),
            error => Failure::Refused(io::Error::other(error)),
        })?;
        let refused = |reason: String| Err(Failure::Refused(io::Error::other(reason)));
        match response.status() {
            StatusCode::PARTIAL_CONTENT => {}
            StatusCode::OK => {
                return refused("the server sends files whole: one that answers ranges is needed".to_owned());
            }
            StatusCode::NOT_FOUND => {
                return Err(Failure::Refused(io::Error::new(
                    io::ErrorKind::NotFound,
                    "the server has no such file",
                )));
            }
            // No byte beyond the end is ever asked for.
            StatusCode::RANGE_NOT_SATISFIABLE => return refused(CHANGED.to_owned()),
            status if status.is_server_error() => {
                return Err(Failure::Broken(io::Error::other(format!(
                    "the server answers {status}"
                ))));
            }
            status => return refused(format!("the server answers {status}")),
        }
        if content_start(response.headers()) != Some(range.start) {
            return refused(format!("the server sends another part than {wanted}"));
        }
        if self.version.is_some() && version_of(response.headers()) != self.version {
            return refused(CHANGED.to_owned());
        }
        Ok(response)
    }

    /// What `attempt` returns, as often as it takes while the connection breaks.
    fn again_and_again<T>(&self, mut attempt: impl FnMut(&Self) -> Result<T, Failure>) -> io::Result<T> {
        let mut pause = FIRST_PAUSE;
        let mut tries = 0;
        loop {
            match attempt(self) {
                Ok(answer) => return Ok(answer),
                Err(Failure::Refused(error)) => return Err(error),
                Err(Failure::Broken(error)) if tries == TRIES => return Err(error),
                Err(Failure::Broken(error)) => log::debug!("{}: {error}, again in {pause:?}", self.url),
            }
            tries += 1;
            thread::sleep(pause);
            pause *= 2;
        }
    }

    /// Fills `bytes` with those from `offset` on, from where a broken connection ended.
    fn fetch(&self, offset: u64, bytes: &mut [u8]) -> io::Result<()> {
        let mut done = 0;
        while done < bytes.len() {
            let before = done;
            let outcome = self.again_and_again(|file| {
                let begin = offset + done as u64;
                let response = file.ask(begin..offset + bytes.len() as u64)?;
                let mut body = response.into_body().into_reader();
                while done < bytes.len() {
                    let end = bytes.len().min(done + PIECE_BYTES);
                    match body.read(&mut bytes[done..end]) {
                        Ok(0) => break,
                        Ok(count) => {
                            done += count;
                            file.pace.note(count);
                        }
                        Err(error) if done > before => {
                            log::debug!("{}: {error} after {done} bytes", file.url);
                            break;
                        }
                        Err(error) => return Err(Failure::Broken(error)),
                    }
                }
                if done == before {
                    return Err(Failure::Broken(io::ErrorKind::UnexpectedEof.into()));
                }
                Ok(())
            });
            outcome?;
        }
        Ok(())
    }

    fn block(&self, index: u64) -> io::Result<Arc<Vec<u8>>> {
        let known = lock(&self.blocks).iter().find(|(known, _)| *known == index).cloned();
        if let Some((_, block)) = known {
            return Ok(block);
        }
        let start = index * BLOCK_BYTES;
        let mut bytes = vec![0; BLOCK_BYTES.min(self.len - start) as usize];
        self.fetch(start, &mut bytes)?;
        let block = Arc::new(bytes);
        let mut blocks = lock(&self.blocks);
        blocks.push_back((index, Arc::clone(&block)));
        if blocks.len() > MOST_BLOCKS {
            blocks.pop_front();
        }
        Ok(block)
    }
}

impl ReadAt for HttpFile {
    fn len(&self) -> io::Result<u64> {
        Ok(self.len)
    }

    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> io::Result<()> {
        let count = bytes.len() as u64;
        if offset.checked_add(count).is_none_or(|end| end > self.len) {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        if count > BLOCK_BYTES {
            return self.fetch(offset, bytes);
        }
        let mut done = 0;
        while done < bytes.len() {
            let at = offset + done as u64;
            let block = self.block(at / BLOCK_BYTES)?;
            let there = &block[(at % BLOCK_BYTES) as usize..];
            let taken = there.len().min(bytes.len() - done);
            bytes[done..done + taken].copy_from_slice(&there[..taken]);
            done += taken;
        }
        Ok(())
    }
}

/// `bytes 0-99/1234` is 0 and 1234.
fn content_range(headers: &HeaderMap) -> Option<(u64, u64)> {
    let range = headers.get(header::CONTENT_RANGE)?.to_str().ok()?;
    let (part, whole) = range.strip_prefix("bytes ")?.split_once('/')?;
    let (start, _) = part.split_once('-')?;
    Some((start.trim().parse().ok()?, whole.trim().parse().ok()?))
}

fn content_start(headers: &HeaderMap) -> Option<u64> {
    content_range(headers).map(|(start, _)| start)
}

fn whole_length(headers: &HeaderMap) -> Option<u64> {
    content_range(headers).map(|(_, whole)| whole)
}

fn version_of(headers: &HeaderMap) -> Option<String> {
    let header = headers.get(header::ETAG).or(headers.get(header::LAST_MODIFIED))?;
    header.to_str().ok().map(str::to_owned)
}
