//! The places of connections: when all are taken, an unused one gives way.
//!
//! **How it works.** A connection waits for a request or is answered. Of those that wait, the longest-waiting one is
//! closed when another one comes; else the one that has taken nothing of its answer for longest, if that is longer than
//! [`ServerDeadlines::stuck`](crate::deadlines::ServerDeadlines::stuck); else the slowest of those below the minimum
//! transfer rate. So any number of slow clients cannot keep others out.

use crate::locks::lock;
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Minimum transfer rate, in bytes per second: slower responses give way after the grace period.
const MIN_RATE: f64 = 65536.0;
const GRACE: Duration = Duration::from_secs(5);

/// Time to wait for a free slot before the other connections are checked again.
const LOOK: Duration = Duration::from_millis(100);

/// Places for connections.
#[derive(Debug)]
pub(super) struct Places {
    max: usize,
    stuck: Duration,
    taken: Mutex<Taken>,
    left: Condvar,
}

#[derive(Debug, Default)]
struct Taken {
    places: Vec<Held>,
    next: u64,
}

#[derive(Debug)]
struct Held {
    number: u64,
    /// To hang up.
    stream: Arc<TcpStream>,
    since: Instant,
    /// Time when it last took data.
    last: Instant,
    /// Bytes of the answer that were sent since then; `None` while it waits for a request.
    sent_bytes: Option<u64>,
    /// True if the connection was closed by the server.
    is_over: bool,
}

/// A place, which is left when this is dropped.
#[derive(Debug)]
pub(super) struct Place {
    places: Arc<Places>,
    number: u64,
}

impl Places {
    /// `max` of them; those that take nothing for longer than `stuck` give way.
    pub(super) fn new(max: usize, stuck: Duration) -> Self {
        Self {
            max,
            stuck,
            taken: Mutex::default(),
            left: Condvar::new(),
        }
    }

    /// A place for `stream`, once there is one.
    pub(super) fn take(self: &Arc<Self>, stream: &Arc<TcpStream>) -> Place {
        let mut taken = lock(&self.taken);
        while taken.places.len() >= self.max {
            taken.give_way(self.stuck);
            let waited = self.left.wait_timeout(taken, LOOK);
            taken = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        let number = taken.next;
        taken.next += 1;
        taken.places.push(Held {
            number,
            stream: Arc::clone(stream),
            since: Instant::now(),
            last: Instant::now(),
            sent_bytes: None,
            is_over: false,
        });
        Place {
            places: Arc::clone(self),
            number,
        }
    }

    /// Places that are taken.
    #[cfg(test)]
    pub(super) fn taken(&self) -> usize {
        lock(&self.taken).places.len()
    }

    /// Hangs up on an unused connection, if there is one: descriptors are used up.
    pub(super) fn free_one(&self) {
        lock(&self.taken).give_way(self.stuck);
    }
}

impl Taken {
    /// Hangs up on one who holds a place for nothing, unless that was done and has not come to its end.
    fn give_way(&mut self, stuck: Duration) {
        if self.places.iter().any(|held| held.is_over) {
            return;
        }
        let waiting = self.places.iter().filter(|held| held.sent_bytes.is_none());
        let stuck = self.places.iter().filter(|held| held.last.elapsed() > stuck);
        let slow = self.places.iter().filter(|held| held.rate() < MIN_RATE);
        let chosen = waiting
            .min_by_key(|held| held.since)
            .or_else(|| stuck.min_by_key(|held| held.last))
            .or_else(|| slow.min_by(|a, b| a.rate().total_cmp(&b.rate())))
            .map(|held| held.number);
        let chosen = self.places.iter_mut().find(|held| Some(held.number) == chosen);
        if let Some(held) = chosen {
            held.is_over = true;
            // It may have disconnected already.
            let _ = held.stream.shutdown(Shutdown::Both);
        }
    }
}

impl Held {
    /// Returns the transfer rate in bytes per second; infinite at first.
    fn rate(&self) -> f64 {
        let age = self.since.elapsed();
        match self.sent_bytes {
            Some(bytes) if age > GRACE => bytes as f64 / age.as_secs_f64(),
            _ => f64::INFINITY,
        }
    }
}

impl Place {
    fn with(&self, change: impl FnOnce(&mut Held)) {
        let mut taken = lock(&self.places.taken);
        if let Some(held) = taken.places.iter_mut().find(|held| held.number == self.number) {
            change(held);
        }
    }

    /// From now on it waits for a request.
    pub(super) fn waits(&self) {
        self.with(|held| (held.since, held.sent_bytes) = (Instant::now(), None));
    }

    /// From now on it is answered.
    pub(super) fn is_answered(&self) {
        self.with(|held| {
            let now = Instant::now();
            (held.since, held.last, held.sent_bytes) = (now, now, Some(0));
        });
    }

    /// Records this many more bytes as sent.
    pub(super) fn sent(&self, bytes: usize) {
        self.with(|held| {
            held.last = Instant::now();
            if let Some(sent) = &mut held.sent_bytes {
                *sent += bytes as u64;
            }
        });
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        lock(&self.places.taken)
            .places
            .retain(|held| held.number != self.number);
        self.places.left.notify_all();
    }
}
