//! State shared between the connection thread, the source and its decoders.

use super::clock::ClockDifference;
use super::decoder::FrameStore;
use super::rate::Rate;
use super::recorder::{Recorder, StreamRecording};
use super::ring::Ring;
use super::status::{LiveState, LiveStatus};
use super::timeline::Timeline;
use crate::locks::lock;
use crate::wire::{Frame, FrameHead, Message, Pong, StreamHead, View, WireError};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// State shared by the connection thread.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) ring: Ring,
    /// True if frames are no longer wanted.
    pub(super) is_closed: AtomicBool,
    /// Epoch of the local clock.
    begun: Instant,
    pub(super) link: Mutex<Link>,
    /// Current view, and a flag that is true if it has yet to be sent to the server.
    view: Mutex<(Option<View>, bool)>,
    /// A slow disk blocks the connected thread, but not status queries.
    pub(super) recorder: Mutex<Option<Recorder>>,
}

/// The connection, as others see it.
#[derive(Debug, Default)]
pub(super) struct Link {
    /// The reason why there is no connection, and true if another one would not help.
    pub(super) problem: Option<(String, bool)>,
    /// Head of the stream that was connected last.
    pub(super) head: Option<StreamHead>,
    timeline: Timeline,
    clock: ClockDifference,
    /// The number of the newest frame, and how many have come since it was connected.
    newest: Option<u64>,
    came: u64,
    /// Latency of the newest frame, and its uncertainty.
    delay_s: Option<(f64, f64)>,
    received: u64,
    lost: u64,
    connections: u64,
    rate: Rate,
    /// State of the recording written so far.
    pub(super) recording: Option<StreamRecording>,
}

impl Shared {
    pub(super) fn new(keeps: Duration) -> Self {
        Self {
            ring: Ring::new(keeps),
            is_closed: AtomicBool::new(false),
            begun: Instant::now(),
            link: Mutex::default(),
            view: Mutex::default(),
            recorder: Mutex::default(),
        }
    }

    pub(super) fn is_closed(&self) -> bool {
        self.is_closed.load(Ordering::Relaxed)
    }

    /// Our clock, ns.
    pub(super) fn now_ns(&self) -> u64 {
        u64::try_from(self.begun.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// A connection begins with `head`.
    pub(super) fn connected(&self, head: StreamHead) {
        let mut link = lock(&self.link);
        // Numbers and the clock may belong to another run.
        (link.newest, link.came) = (None, 0);
        link.clock = ClockDifference::default();
        link.head = Some(head);
        link.connections += 1;
        link.problem = None;
        drop(link);
        // The new server has not received the view yet.
        let mut view = lock(&self.view);
        view.1 = view.0.is_some();
    }

    pub(super) fn look_from(&self, view: View) {
        let mut looked = lock(&self.view);
        if looked.0 != Some(view) {
            *looked = (Some(view), true);
        }
    }

    /// Returns the view that has yet to be sent to the server, once.
    pub(super) fn view_to_tell(&self) -> Option<View> {
        let mut looked = lock(&self.view);
        let view = looked.0.filter(|_| looked.1);
        looked.1 = false;
        view
    }

    /// The connection has ended, or there is none.
    pub(super) fn failed(&self, problem: String, is_final: bool) {
        lock(&self.link).problem = Some((problem, is_final));
    }

    pub(super) fn pong(&self, pong: Pong) {
        let now_ns = self.now_ns();
        lock(&self.link).clock.add(pong, now_ns);
    }

    /// Takes a frame; returns its number. `message` is its message, which is recorded.
    pub(super) fn frame(&self, message: Message) -> Result<Option<u64>, WireError> {
        let now = Instant::now();
        if message.kind.is_frame() {
            // Anything that is not a frame is not recorded.
            FrameHead::parse(&message.payload)?;
        }
        let recorded = self.record(&message);
        let bytes = message.payload.len();
        let Some(frame) = Frame::of(message)? else {
            return Ok(None);
        };
        let head = frame.head;
        let now_ns = self.now_ns();
        let mut link = lock(&self.link);
        let (session, fps) = link.head.map_or((0, 30.0), |head| (head.session, head.fps));
        let spacing = Duration::try_from_secs_f64(fps.recip()).unwrap_or_default();
        let time = link.timeline.next(session, head.time_ns, spacing);
        // The first frame may be an old one, which is shown until there is a newer one.
        if link.came > 1 {
            let expected = link.newest.map_or(0, |newest| newest.saturating_add(1));
            link.lost += head.number.saturating_sub(expected);
        }
        (link.newest, link.came) = (Some(head.number), link.came + 1);
        link.delay_s = link.clock.since_s(head.served_ns, now_ns);
        link.received += 1;
        link.rate.add(now, bytes);
        let problem = match recorded {
            Ok(recording) => {
                link.recording = recording;
                None
            }
            Err(problem) => {
                link.recording = None;
                Some(problem)
            }
        };
        drop(link);
        if let Some(problem) = problem {
            log::warn!("{problem}");
        }
        self.ring.push(frame, time, now);
        Ok(Some(head.number))
    }

    /// Reports the bytes written so far. A file that cannot be written is closed, so that this is reported once.
    fn record(&self, message: &Message) -> Result<Option<StreamRecording>, String> {
        let mut recorder = lock(&self.recorder);
        let Some(writing) = recorder.as_mut().filter(|_| message.kind.is_frame()) else {
            return Ok(None);
        };
        let added = writing.add(message);
        let written = writing.written().clone();
        added.map(|()| Some(written.clone())).map_err(|error| {
            *recorder = None;
            format!(
                "{}: the recording has ended, as no more can be written ({error})",
                written.path.display()
            )
        })
    }

    /// Ends the recording, if there is one.
    pub(super) fn stop_recording(&self) -> Result<Option<StreamRecording>, String> {
        let Some(recorder) = lock(&self.recorder).take() else {
            return Ok(None);
        };
        lock(&self.link).recording = None;
        let path = recorder.written().path.display().to_string();
        let finished = recorder.finish();
        let finished = finished.map_err(|error| format!("{path}: its end could not be written ({error})"))?;
        Ok(Some(finished))
    }

    pub(super) fn status(&self) -> LiveStatus {
        let link = lock(&self.link);
        let (bytes_per_s, frames_per_s) = link.rate.per_s(Instant::now());
        let (buffered_s, buffered_bytes) = self.ring.buffered();
        LiveStatus {
            state: match &link.problem {
                None => LiveState::Connected,
                Some((problem, _)) => LiveState::Reconnecting(problem.clone()),
            },
            received_frames: link.received,
            lost_frames: link.lost,
            bytes_per_s,
            frames_per_s,
            delay_s: link.delay_s,
            buffered_s,
            buffered_bytes,
            reconnects: link.connections.saturating_sub(1),
            recording: link.recording.clone(),
        }
    }
}

impl FrameStore for Shared {
    fn frame(&self, index: usize) -> Result<Frame, String> {
        let held = self.ring.frame(index);
        held.map(|held| held.frame.clone())
            .ok_or_else(|| "it is gone for good".to_owned())
    }
}
