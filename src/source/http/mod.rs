//! A file on a web server, read in ranges: any server of plain files will do.
//!
//! **How it works.** Data is requested by `Range` (RFC 9110 §14), over connections that stay open. Small pieces come
//! from cached blocks, since an index and the directories of groups are read in many. A connection that breaks is
//! resumed at that position, with growing pauses; a server that answers wrongly is an error at once. A file that is
//! another one meanwhile, by its tag or its date, is an error too. Redirections are followed when the file is opened,
//! and not again.
//!
//! **Bounds.** No more is read than was requested, whatever the server sends, and no faster than is allowed ([`pace`]).
//! Blocks take [`MAX_BLOCKS`] times [`BLOCK_BYTES`]. A transfer slower than [`ClientDeadlines::transfer`] allows is an
//! error, however often a server begins again or sends a byte.

mod answer;
mod pace;
#[cfg(test)]
mod tests;
mod transfer;

use crate::deadlines::ClientDeadlines;
use crate::locks::lock;
use crate::reel::ReadAt;
use crate::waiting::Waiting;
use answer::{content_range, version_of};
use pace::BytePace;
use std::collections::VecDeque;
use std::io::{self, Read as _};
use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;
use transfer::Transfer;
use ureq::ResponseExt as _;
use ureq::http::{Response, StatusCode, header};

/// Pieces up to this size come from blocks.
const BLOCK_BYTES: u64 = 1 << 16;

/// Number of cached blocks.
const MAX_BLOCKS: usize = 64;

/// Before a read is tried again: the first pause, which doubles up to the longest.
const PAUSES: [Duration; 2] = [Duration::from_millis(50), Duration::from_secs(1)];

/// Bytes between two looks at the pace.
const PIECE_BYTES: usize = 1 << 14;

/// Redirections of one address.
const MAX_REDIRECTS: u32 = 5;

const CHANGED: &str = "the file has changed on the server: open it again";

/// A file on a web server.
pub(super) struct HttpFile {
    agent: ureq::Agent,
    /// The address that redirections have led to.
    url: String,
    len: u64,
    /// The version tag that identifies the unchanged file.
    version: Option<String>,
    pace: BytePace,
    deadlines: ClientDeadlines,
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

/// Reasons why an answer is of no use.
enum Failure {
    /// A failure that may be gone the next time.
    Broken(io::Error),
    /// A permanent failure.
    Refused(io::Error),
}

impl HttpFile {
    /// Requests the size of the file at `url`, which is read with at most this many bits per second.
    ///
    /// # Errors
    /// No such file, no answer within `deadlines`, and servers that do not answer ranges.
    pub(super) fn open(url: &str, max_bits_per_s: Option<f64>, deadlines: ClientDeadlines) -> io::Result<Self> {
        let mut file = Self {
            // Redirects may have endless bodies.
            agent: agent(&deadlines, MAX_REDIRECTS, Some(deadlines.transfer.grace)),
            url: url.to_owned(),
            len: 0,
            version: None,
            pace: BytePace::new(max_bits_per_s.map(|bits| bits / 8.0)),
            deadlines,
            blocks: Mutex::default(),
        };
        let mut transfer = file.transfer("the size of the file".to_owned());
        let (url, whole, version) = file.again_and_again(&mut transfer, |_| {
            let (response, whole) = file.ask(0..1)?;
            Ok((response.get_uri().to_string(), whole, version_of(response.headers())))
        })?;
        file.agent = agent(&deadlines, 0, None);
        (file.url, file.len, file.version) = (url, whole, version);
        Ok(file)
    }

    fn transfer(&self, what: String) -> Transfer<'_> {
        Transfer::new(&self.url, what, self.deadlines.transfer)
    }

    /// The answer to a request for a range, unless it is something else; and how long the file is.
    fn ask(&self, range: Range<u64>) -> Result<(Response<ureq::Body>, u64), Failure> {
        let wanted = format!("bytes={}-{}", range.start, range.end - 1);
        let response = self.agent.get(&self.url).header(header::RANGE, &wanted).call();
        let response = response.map_err(|error| match error {
            ureq::Error::Io(_)
            | ureq::Error::Timeout(_)
            | ureq::Error::ConnectionFailed
            | ureq::Error::HostNotFound => Failure::Broken(io::Error::other(error)),
            ureq::Error::TooManyRedirects => refused(format!(
                "the server leads from one address to another, more than {MAX_REDIRECTS} times"
            )),
            error => Failure::Refused(io::Error::other(error)),
        })?;
        match response.status() {
            StatusCode::PARTIAL_CONTENT => {}
            StatusCode::OK => {
                return Err(refused(
                    "the server sends files whole: one that answers ranges is needed".to_owned(),
                ));
            }
            StatusCode::NOT_FOUND => {
                return Err(Failure::Refused(io::Error::new(
                    io::ErrorKind::NotFound,
                    "the server has no such file",
                )));
            }
            StatusCode::RANGE_NOT_SATISFIABLE if self.len == 0 => return Err(refused("the file is empty".to_owned())),
            // No byte beyond the end is ever requested.
            StatusCode::RANGE_NOT_SATISFIABLE => return Err(refused(CHANGED.to_owned())),
            status if status.is_server_error() => {
                return Err(Failure::Broken(io::Error::other(format!(
                    "the server answers {status}"
                ))));
            }
            status if status.is_redirection() && self.len > 0 => {
                return Err(refused("the file is at another address now: open it again".to_owned()));
            }
            status => return Err(refused(format!("the server answers {status}"))),
        }
        let Some((part, whole)) = content_range(response.headers()) else {
            return Err(refused("the server does not say how long the file is".to_owned()));
        };
        if part.start != range.start || part.end > range.end {
            return Err(refused(format!("the server sends another part than {wanted}")));
        }
        let is_known = self.len > 0;
        let is_same = whole == self.len && (self.version.is_none() || version_of(response.headers()) == self.version);
        if is_known && !is_same {
            return Err(refused(CHANGED.to_owned()));
        }
        Ok((response, whole))
    }

    /// Retries `attempt` while the connection fails and time remains, and returns its result.
    fn again_and_again<T>(
        &self,
        transfer: &mut Transfer<'_>,
        mut attempt: impl FnMut(&mut Transfer<'_>) -> Result<T, Failure>,
    ) -> io::Result<T> {
        let _waiting = Waiting::for_(transfer.to_string());
        let [mut pause, longest] = PAUSES;
        loop {
            let error = match attempt(transfer) {
                Ok(answer) => return Ok(answer),
                Err(Failure::Refused(error)) => return Err(error),
                Err(Failure::Broken(error)) => error,
            };
            let Some(left) = transfer.time_left() else {
                return Err(transfer.too_slow(&error));
            };
            log::debug!("{}: {error}, again in {pause:?}", self.url);
            thread::sleep(pause.min(left));
            pause = (2 * pause).min(longest);
        }
    }

    /// Fills `bytes` with those from `offset` on, from where a broken connection ended.
    fn fetch(&self, offset: u64, bytes: &mut [u8]) -> io::Result<()> {
        let end = offset + bytes.len() as u64;
        let mut transfer = self.transfer(format!("bytes {offset} to {end}"));
        let mut done = 0;
        while done < bytes.len() {
            self.again_and_again(&mut transfer, |transfer| {
                let (response, _) = self.ask(offset + done as u64..end)?;
                let (mut body, before) = (response.into_body().into_reader(), done);
                while done < bytes.len() {
                    let piece = bytes.len().min(done + PIECE_BYTES);
                    match body.read(&mut bytes[done..piece]) {
                        Ok(0) => break,
                        Ok(count) => {
                            done += count;
                            transfer.came(count, || self.pace.note(count));
                        }
                        Err(error) if done > before => {
                            log::debug!("{}: {error} after {done} bytes", self.url);
                            break;
                        }
                        Err(error) => return Err(Failure::Broken(error)),
                    }
                    if done < bytes.len() && transfer.time_left().is_none() {
                        return Err(Failure::Broken(io::Error::other("too little comes")));
                    }
                }
                if done == before {
                    return Err(Failure::Broken(io::ErrorKind::UnexpectedEof.into()));
                }
                Ok(())
            })?;
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
        if blocks.len() > MAX_BLOCKS {
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

fn refused(reason: String) -> Failure {
    Failure::Refused(io::Error::other(reason))
}

/// A client of servers. `max` bounds an exchange with its redirections and bodies.
fn agent(deadlines: &ClientDeadlines, max_redirects: u32, max: Option<Duration>) -> ureq::Agent {
    ureq::Agent::config_builder()
        .http_status_as_error(false)
        .max_redirects(max_redirects)
        .max_redirects_will_error(true)
        .timeout_global(max)
        .timeout_resolve(Some(deadlines.silence))
        .timeout_connect(Some(deadlines.silence))
        .timeout_send_request(Some(deadlines.silence))
        .timeout_recv_response(Some(deadlines.silence))
        .timeout_per_read(Some(deadlines.silence))
        .user_agent(concat!("pointreel/", env!("CARGO_PKG_VERSION")))
        .build()
        .into()
}
