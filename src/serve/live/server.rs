//! Plays a sequence to all who are connected.

use super::audience::{Audience, Client, Joining, LiveEvent};
use super::client::{self, Estimators};
use super::feed::Feed;
use super::outgoing::{Body, Outgoing};
use super::schedule::Schedule;
use super::surfels::WholeFrame;
use crate::deadlines::{MinRate, ServerDeadlines};
use crate::serve::accept::AcceptBackOff;
use crate::source::Source;
use crate::wire::{FrameHead, ImageCoding, StreamHead};
use std::collections::VecDeque;
use std::hash::{BuildHasher as _, Hasher as _, RandomState};
use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Interval of checks for the end, and for new clients.
const LOOK: Duration = Duration::from_millis(10);

/// Clients that wait for a place; more are left to the queue of the system.
const MAX_WAITING: usize = 16;

/// Options for serving a sequence live.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LiveOptions {
    /// Image coding used for sending.
    pub coding: ImageCoding,
    /// True if playback loops: the sequence restarts at its end.
    pub repeats: bool,
    /// Maximum bytes that a frame may take in memory.
    pub max_bytes: u64,
}

/// Server statistics so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LiveReport {
    /// Number of connected clients.
    pub clients: usize,
    /// Frames that were served, each counted once.
    pub served_frames: u64,
    /// Frames that could not be made in time while a client was connected, or not at all.
    pub missed_frames: u64,
    /// Frames that were dropped for newer ones, of all clients together.
    pub dropped_frames: u64,
    /// Bytes that were sent, to all clients together.
    pub sent_bytes: u64,
}

/// Serves a sequence as a live stream until it is stopped.
pub struct LiveServer {
    listener: TcpListener,
    source: Arc<dyn Source>,
    schedule: Schedule,
    options: LiveOptions,
    deadlines: ServerDeadlines,
    shared: Arc<Shared>,
}

/// State shared between the client threads and the playback thread.
struct Shared {
    audience: Audience,
    estimators: Estimators,
    begun: Instant,
    session: u64,
    fps: f64,
    is_over: AtomicBool,
    served: AtomicU64,
    missed: AtomicU64,
    dropped: AtomicU64,
    sent_bytes: AtomicU64,
    tell: Box<dyn Fn(LiveEvent) + Send + Sync>,
}

impl Shared {
    /// The clock of the server, ns.
    fn clock_ns(&self) -> u64 {
        u64::try_from(self.begun.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    fn head(&self) -> StreamHead {
        let wall = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        StreamHead {
            session: self.session,
            clock_ns: self.clock_ns(),
            fps: self.fps,
            wall_ns: u64::try_from(wall.as_nanos()).unwrap_or(u64::MAX),
        }
    }
}

impl LiveServer {
    /// Listens at `address`; clients are not answered before [`LiveServer::run`]. `tell` receives their arrivals and
    /// departures.
    ///
    /// # Errors
    /// Errors of the system, if listening fails.
    pub fn bind(
        source: Arc<dyn Source>,
        schedule: Schedule,
        address: SocketAddr,
        options: LiveOptions,
        tell: impl Fn(LiveEvent) + Send + Sync + 'static,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            source,
            options,
            deadlines: ServerDeadlines::default(),
            shared: Arc::new(Shared {
                audience: Audience::default(),
                estimators: Estimators::default(),
                begun: Instant::now(),
                // A different number after each start: the frame numbers and the clock that clients know are not
                // continued.
                session: RandomState::new().build_hasher().finish(),
                fps: schedule.fps(),
                is_over: AtomicBool::new(false),
                served: AtomicU64::new(0),
                missed: AtomicU64::new(0),
                dropped: AtomicU64::new(0),
                sent_bytes: AtomicU64::new(0),
                tell: Box::new(tell),
            }),
            schedule,
        })
    }

    /// Sets the deadlines for clients.
    #[must_use]
    pub fn with_deadlines(self, deadlines: ServerDeadlines) -> Self {
        Self { deadlines, ..self }
    }

    /// Returns the server's URL: `tcp://127.0.0.1:9000`.
    pub fn url(&self) -> io::Result<String> {
        Ok(format!("tcp://{}", self.listener.local_addr()?))
    }

    /// Returns the server statistics so far.
    pub fn report(&self) -> LiveReport {
        let shared = &self.shared;
        LiveReport {
            clients: shared.audience.len(),
            served_frames: shared.served.load(Ordering::Relaxed),
            missed_frames: shared.missed.load(Ordering::Relaxed),
            dropped_frames: shared.dropped.load(Ordering::Relaxed),
            sent_bytes: shared.sent_bytes.load(Ordering::Relaxed) + shared.audience.sent_bytes(),
        }
    }

    /// True once all clients have sent a message.
    #[cfg(test)]
    pub(super) fn all_have_spoken(&self) -> bool {
        self.shared.audience.all_have_spoken()
    }

    /// Stops [`LiveServer::run`], which is running on another thread; clients are notified.
    pub fn stop(&self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
    }

    /// Plays until [`LiveServer::stop`], or to the end of a sequence that is not repeated.
    pub fn run(&self) -> io::Result<()> {
        let mut feed = Feed::new(Arc::clone(&self.source), self.options.coding, self.options.max_bytes);
        let reason = thread::scope(|scope| -> io::Result<&str> {
            let accepting = thread::Builder::new()
                .name("live clients".to_owned())
                .spawn_scoped(scope, || self.accept())?;
            let reason = if self.source.is_live() {
                self.relay(&mut feed)
            } else {
                self.play(&mut feed)
            };
            self.shared.audience.end(reason);
            self.stop();
            // If listening fails, that thread reports it.
            let _ = accepting.join();
            Ok(reason)
        })?;
        log::debug!("{reason}");
        Ok(())
    }

    /// Frames by the schedule.
    fn play(&self, feed: &mut Feed) -> &'static str {
        let schedule = &self.schedule;
        let begun = Instant::now();
        let mut next = 0;
        // The time that a frame takes to make: the one that will be due by then is made.
        let mut cost = Duration::ZERO;
        while !self.shared.is_over() {
            let due = schedule.due_by(begun.elapsed() + cost).max(next);
            let has_clients = self.shared.audience.len() > 0;
            if has_clients {
                self.shared.missed.fetch_add(due - next, Ordering::Relaxed);
            }
            if !self.options.repeats && due >= schedule.count() as u64 {
                return "the sequence is over";
            }
            next = due + 1;
            let making = Instant::now();
            // No client is waiting for it, but a new client is shown something at once.
            let is_wanted = has_clients || self.shared.audience.newest().is_none();
            let body = is_wanted.then(|| feed.body(schedule.index(due)));
            let whole = self.whole(feed, schedule.index(due), body.as_ref().and_then(Option::as_ref));
            cost = making.elapsed();
            self.wait_until(begun, schedule.due(due));
            match body {
                Some(Some(body)) if !self.shared.is_over() => {
                    self.serve(due, schedule.index(due), schedule.due(due), body, whole);
                }
                Some(None) => {
                    self.shared.missed.fetch_add(1, Ordering::Relaxed);
                }
                _ => {}
            }
        }
        "the server was stopped"
    }

    /// The newest frame of a source that is live itself, as it comes.
    fn relay(&self, feed: &mut Feed) -> &'static str {
        let mut last = None;
        while !self.shared.is_over() {
            if let Err(error) = self.source.wait_for_more(Duration::from_millis(100)) {
                log::debug!("{error}");
            }
            let newest = self.source.frames().end.checked_sub(1);
            let Some(index) = newest.filter(|_| newest != last) else {
                continue;
            };
            let missed = last.map_or(0, |last| index.saturating_sub(last + 1));
            last = newest;
            if self.shared.audience.len() == 0 && self.shared.audience.newest().is_some() {
                continue;
            }
            self.shared.missed.fetch_add(missed as u64, Ordering::Relaxed);
            let time = self.source.entry(index).time;
            if let Some(body) = feed.body(index) {
                let time = time.unwrap_or_else(|| self.shared.begun.elapsed());
                let whole = self.whole(feed, index, Some(&body));
                self.serve(index as u64, index, time, body, whole);
            }
        }
        "the server was stopped"
    }

    /// All points of a frame, if its body was made and a client has sent a view.
    fn whole(&self, feed: &mut Feed, index: usize, body: Option<&Body>) -> Option<Arc<WholeFrame>> {
        body.filter(|_| self.shared.audience.has_views())?;
        feed.whole(index)
    }

    fn serve(&self, number: u64, index: usize, time: Duration, body: Body, whole: Option<Arc<WholeFrame>>) {
        let head = FrameHead {
            index: u32::try_from(index).unwrap_or(u32::MAX),
            number,
            time_ns: u64::try_from(time.as_nanos()).unwrap_or(u64::MAX),
            served_ns: self.shared.clock_ns(),
        };
        let frame = Arc::new(Outgoing::new(head, body).with_whole(whole));
        let dropped = self.shared.audience.send(&frame);
        self.shared.dropped.fetch_add(dropped, Ordering::Relaxed);
        self.shared.served.fetch_add(1, Ordering::Relaxed);
    }

    fn wait_until(&self, begun: Instant, due: Duration) {
        while !self.shared.is_over() {
            let left = due.saturating_sub(begun.elapsed());
            if left.is_zero() {
                return;
            }
            thread::sleep(left.min(10 * LOOK));
        }
    }

    /// Takes clients until it is over.
    fn accept(&self) {
        let mut back_off = AcceptBackOff::default();
        // Clients without a place yet.
        let mut waiting = VecDeque::new();
        while !self.shared.is_over() {
            self.seat(&mut waiting);
            if waiting.len() >= MAX_WAITING {
                thread::sleep(LOOK);
                continue;
            }
            match self.listener.accept() {
                Ok((stream, address)) => {
                    back_off.works();
                    // On some systems sockets inherit the mode of the listener.
                    if stream.set_nonblocking(false).is_ok() {
                        waiting.push_back((Arc::new(Client::new(address, stream)), Instant::now()));
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => thread::sleep(LOOK),
                Err(error) => {
                    let pause = back_off.failed(&error);
                    if !pause.is_zero() {
                        self.shared.audience.free_one(self.deadlines.stuck);
                        thread::sleep(pause);
                    }
                }
            }
        }
    }

    /// Gives places to those who wait, in their order, as far as there are any.
    fn seat(&self, waiting: &mut VecDeque<(Arc<Client>, Instant)>) {
        let shared = &self.shared;
        while let Some((client, since)) = waiting.front() {
            match shared.audience.join(client, self.deadlines.stuck) {
                Joining::Joined => {
                    (shared.tell)(LiveEvent::Joined(client.address));
                    if let Err(error) = attend(shared, client, self.deadlines.message) {
                        log::warn!("{} has no thread ({error}): it is closed", client.address);
                        client.hang_up();
                        shared.audience.leave(client);
                    }
                }
                Joining::Full if since.elapsed() < self.deadlines.place => return,
                Joining::Full => {
                    let reason = "the maximum number of clients is connected: try again later";
                    if let Err(error) = client::refuse(&client.stream, &shared.head(), reason) {
                        log::debug!("{}: {error}", client.address);
                    }
                    (shared.tell)(LiveEvent::Full(client.address));
                }
                Joining::Over => {}
            }
            waiting.pop_front();
        }
    }
}

/// Starts the threads of a client.
fn attend(shared: &Arc<Shared>, client: &Arc<Client>, min: MinRate) -> io::Result<()> {
    let (listener, clock) = (Arc::clone(client), Arc::clone(shared));
    // Two separate threads per client: a slow one does not delay the others.
    thread::Builder::new().name("live listener".to_owned()).spawn(move || {
        let error = client::listen(&listener, &listener.stream, || clock.clock_ns());
        log::debug!("{}: {error}", listener.address);
        // The sending thread need not wait for a frame to find out.
        listener.mailbox.end("it has left");
        listener.hang_up();
    })?;
    let (shared, client) = (Arc::clone(shared), Arc::clone(client));
    let sending = thread::Builder::new().name("live sender".to_owned());
    sending
        .spawn(move || {
            let head = shared.head();
            let (clock, newest) = (|| shared.clock_ns(), || shared.audience.newest());
            let reason = client::send(&client, min, &head, &shared.estimators, clock, newest);
            client.hang_up();
            shared.audience.leave(&client);
            let report = client.report(reason);
            shared.sent_bytes.fetch_add(report.sent_bytes, Ordering::Relaxed);
            (shared.tell)(LiveEvent::Left(report));
        })
        .map(drop)
}

impl std::fmt::Debug for LiveServer {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut debug = formatter.debug_struct("LiveServer");
        debug
            .field("address", &self.listener.local_addr())
            .field("report", &self.report())
            .finish_non_exhaustive()
    }
}
