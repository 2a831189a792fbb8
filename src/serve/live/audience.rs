//! The connected clients.

use super::mailbox::Mailbox;
use super::outgoing::Outgoing;
use crate::locks::lock;
use crate::wire::View;
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// Clients at once.
pub(super) const MAX_CLIENTS: usize = 64;

/// Clients that speak at all do so more often: pings come twice per second.
const SPEAKS_WITHIN: Duration = Duration::from_secs(2);

/// Timeout for clients to be notified that it is over.
const PARTING: Duration = Duration::from_millis(500);

/// Event while a sequence is served.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LiveEvent {
    /// Somebody has connected.
    Joined(SocketAddr),
    /// Somebody has left, or was left.
    Left(ClientReport),
    /// A client was rejected: the client limit is reached.
    Full(SocketAddr),
}

/// Report of the data sent to a client.
#[derive(Debug, Clone, PartialEq)]
pub struct ClientReport {
    /// Address of the client.
    pub address: SocketAddr,
    /// Frames that it was sent.
    pub sent_frames: u64,
    /// Frames that were dropped for newer ones.
    pub dropped_frames: u64,
    /// Bytes that it was sent.
    pub sent_bytes: u64,
    /// Bytes that it would have been sent without a view; `None` where it has sent none.
    pub whole_bytes: Option<u64>,
    /// Duration of the connection.
    pub time: Duration,
    /// The reason why it is gone.
    pub reason: String,
}

/// One client.
#[derive(Debug)]
pub(super) struct Client {
    pub(super) address: SocketAddr,
    pub(super) mailbox: Mailbox,
    pub(super) sent_frames: AtomicU64,
    pub(super) sent_bytes: AtomicU64,
    /// Bytes of the same frames, whole.
    pub(super) whole_bytes: AtomicU64,
    view: Mutex<Option<View>>,
    joined: Instant,
    /// While it is sent a message: when it took something last.
    taking: Mutex<Option<Instant>>,
    /// Time of its last message; clients that show the stream send them all the time.
    heard: Mutex<Option<Instant>>,
    /// For ending the waits of its threads.
    pub(super) stream: TcpStream,
}

/// The answer to a client that wants to join.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Joining {
    Joined,
    /// All places are taken.
    Full,
    /// There are no more frames.
    Over,
}

impl Client {
    pub(super) fn new(address: SocketAddr, stream: TcpStream) -> Self {
        Self {
            address,
            mailbox: Mailbox::default(),
            sent_frames: AtomicU64::new(0),
            sent_bytes: AtomicU64::new(0),
            whole_bytes: AtomicU64::new(0),
            view: Mutex::default(),
            joined: Instant::now(),
            taking: Mutex::default(),
            heard: Mutex::default(),
            stream,
        }
    }

    /// Returns the view of the client, if it has sent one.
    pub(super) fn view(&self) -> Option<View> {
        *lock(&self.view)
    }

    pub(super) fn look_from(&self, view: View) {
        *lock(&self.view) = Some(view);
    }

    /// Notes that a message is being sent to it from now on.
    pub(super) fn begins_to_take(&self) {
        *lock(&self.taking) = Some(Instant::now());
    }

    /// Notes that it has taken the whole message.
    pub(super) fn has_taken(&self) {
        *lock(&self.taking) = None;
    }

    /// Notes that it has sent a message.
    pub(super) fn has_spoken(&self) {
        *lock(&self.heard) = Some(Instant::now());
    }

    /// Time since it last took any data sent to it. For a client whose messages may lie in network buffers: time since
    /// its last message, or since it connected. Clients that take nothing come before silent ones.
    fn idle_for(&self) -> (bool, Duration) {
        if let Some(taken) = *lock(&self.taking) {
            return (true, taken.elapsed());
        }
        let silent = match *lock(&self.heard) {
            Some(heard) => heard.elapsed().saturating_sub(SPEAKS_WITHIN),
            None => self.joined.elapsed(),
        };
        (false, silent)
    }

    pub(super) fn hang_up(&self) {
        // It may have disconnected already.
        let _ = self.stream.shutdown(Shutdown::Both);
    }

    pub(super) fn report(&self, reason: String) -> ClientReport {
        ClientReport {
            address: self.address,
            sent_frames: self.sent_frames.load(Ordering::Relaxed),
            dropped_frames: self.mailbox.dropped(),
            sent_bytes: self.sent_bytes.load(Ordering::Relaxed),
            whole_bytes: self.view().map(|_| self.whole_bytes.load(Ordering::Relaxed)),
            time: self.joined.elapsed(),
            reason,
        }
    }
}

/// All clients, and the newest frame, which a new client begins with.
#[derive(Debug, Default)]
pub(super) struct Audience {
    inside: Mutex<Inside>,
}

#[derive(Debug, Default)]
struct Inside {
    clients: Vec<Arc<Client>>,
    newest: Option<Arc<Outgoing>>,
    is_over: bool,
}

impl Inside {
    fn give_way(&mut self, stuck: Duration) -> bool {
        let idle = self.clients.iter().map(|client| (client.idle_for(), client));
        let idle = idle
            .filter(|((_, time), _)| *time > stuck)
            .max_by_key(|(idle, _)| *idle);
        let Some(chosen) = idle.map(|(_, client)| Arc::clone(client)) else {
            return false;
        };
        chosen.hang_up();
        self.clients.retain(|other| !Arc::ptr_eq(other, &chosen));
        true
    }
}

impl Audience {
    /// Accepts a client. If all places are taken, one that has taken or sent nothing for longer than `stuck` gives way.
    pub(super) fn join(&self, client: &Arc<Client>, stuck: Duration) -> Joining {
        let mut inside = lock(&self.inside);
        if inside.is_over {
            return Joining::Over;
        }
        if inside.clients.len() >= MAX_CLIENTS && !inside.give_way(stuck) {
            return Joining::Full;
        }
        if let Some(newest) = &inside.newest {
            client.mailbox.push(Arc::clone(newest));
        }
        inside.clients.push(Arc::clone(client));
        Joining::Joined
    }

    /// Hangs up on one that has taken or sent nothing for longer than `stuck`, if there is one.
    pub(super) fn free_one(&self, stuck: Duration) {
        lock(&self.inside).give_way(stuck);
    }

    pub(super) fn leave(&self, client: &Arc<Client>) {
        lock(&self.inside).clients.retain(|other| !Arc::ptr_eq(other, client));
    }

    /// Hands a frame to all clients; returns the number of frames dropped for it.
    pub(super) fn send(&self, frame: &Arc<Outgoing>) -> u64 {
        let mut inside = lock(&self.inside);
        inside.newest = Some(Arc::clone(frame));
        let dropped = inside
            .clients
            .iter()
            .filter(|client| client.mailbox.push(Arc::clone(frame)));
        dropped.count() as u64
    }

    /// Number of the newest frame.
    pub(super) fn newest(&self) -> Option<u64> {
        lock(&self.inside).newest.as_ref().map(|frame| frame.number)
    }

    pub(super) fn len(&self) -> usize {
        lock(&self.inside).clients.len()
    }

    /// Returns true if any client has sent its view.
    pub(super) fn has_views(&self) -> bool {
        let inside = lock(&self.inside);
        inside.clients.iter().any(|client| client.view().is_some())
    }

    #[cfg(test)]
    pub(super) fn all_have_spoken(&self) -> bool {
        let inside = lock(&self.inside);
        inside.clients.iter().all(|client| lock(&client.heard).is_some())
    }

    /// Bytes that those who are there were sent.
    pub(super) fn sent_bytes(&self) -> u64 {
        let inside = lock(&self.inside);
        inside
            .clients
            .iter()
            .map(|client| client.sent_bytes.load(Ordering::Relaxed))
            .sum()
    }

    /// Announces the end, and hangs up on clients that do not listen.
    pub(super) fn end(&self, reason: &str) {
        let clients = {
            let mut inside = lock(&self.inside);
            inside.is_over = true;
            inside.clients.clone()
        };
        for client in &clients {
            client.mailbox.end(reason);
        }
        let begun = Instant::now();
        while self.len() > 0 && begun.elapsed() < PARTING {
            thread::sleep(Duration::from_millis(5));
        }
        for client in &clients {
            client.hang_up();
        }
    }
}
