//! A live stream as a source of frames.

use super::address;
use super::connection;
use super::decoder::{StreamDecoder, group, has_images, raw_images, sensor};
use super::recorder::{Recorder, StreamRecording};
use super::shared::Shared;
use super::status::{Live, LiveStatus};
use crate::deadlines::ClientDeadlines;
use crate::locks::lock;
use crate::printable;
use crate::progress::Progress;
use crate::rgbd::{Filters, Sensor};
use crate::source::opener::One;
use crate::source::rgbd::ReceivedFrames;
use crate::source::{
    About, Capabilities, DecodeFailure, Decoder, DepthImages, FrameEntry, Groups, Growth, OpenOptions, SequenceError,
    Source,
};
use crate::waiting::Waiting;
use crate::wire::{RawImages, View};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// Default number of seconds for rewinding.
const USUAL_SECONDS: f64 = 10.0;

/// Interval of checks for the first frame.
const LOOK: Duration = Duration::from_millis(50);

/// A live stream over TCP.
#[derive(Debug)]
pub struct LiveStream {
    input: PathBuf,
    shared: Arc<Shared>,
    /// Streams with other filters have it as well.
    wanted: Arc<Wanted>,
    received: Arc<ReceivedFrames>,
    max_bytes: u64,
    is_of_surfels: bool,
    /// Frames that were reported.
    told: Mutex<usize>,
}

/// The connection stays open as long as this exists.
#[derive(Debug)]
struct Wanted {
    shared: Arc<Shared>,
}

/// The address of a stream.
pub(in crate::source) const ADDRESS: One = One {
    names: &[address::SCHEME],
    open: |input, asked| {
        let stream = LiveStream::open(input, asked.options, asked.progress)?;
        Ok(Arc::new(stream))
    },
    sidecar_others: Some(|input| SequenceError::Stream {
        input: input.display().to_string(),
        problem: "a live stream is a sequence of its own: open it without other inputs".to_owned(),
    }),
};

impl LiveStream {
    /// Connects to `input`, such as `tcp://127.0.0.1:9000`, and waits for the first frame. `progress` may be cancelled.
    ///
    /// # Errors
    /// [`SequenceError::Stream`], and [`SequenceError::Cancelled`].
    pub fn open(input: &Path, options: &OpenOptions, progress: &Progress) -> Result<Self, SequenceError> {
        Self::open_within(input, options, progress, ClientDeadlines::default())
    }

    /// [`LiveStream::open`] with these `deadlines` for the server.
    ///
    /// # Errors
    /// As of [`LiveStream::open`].
    pub fn open_within(
        input: &Path,
        options: &OpenOptions,
        progress: &Progress,
        deadlines: ClientDeadlines,
    ) -> Result<Self, SequenceError> {
        let failed = |problem: String| SequenceError::Stream {
            input: input.display().to_string(),
            problem,
        };
        let address = address::parse(input).map_err(failed)?;
        let keeps = options.live_seconds.unwrap_or(USUAL_SECONDS);
        let keeps = Duration::try_from_secs_f64(keeps).unwrap_or(Duration::MAX);
        let shared = Arc::new(Shared::new(keeps));
        let connected = Arc::clone(&shared);
        let max_bytes = options.read.max_memory_bytes;
        thread::Builder::new()
            .name("live stream".to_owned())
            .spawn(move || connection::run(&connected, &address, max_bytes, &deadlines))
            .map_err(|reason| SequenceError::NoThread { reason })?;
        let stream = Self {
            input: input.to_owned(),
            wanted: Arc::new(Wanted {
                shared: Arc::clone(&shared),
            }),
            shared,
            received: Arc::new(ReceivedFrames::new(input, options)),
            max_bytes,
            is_of_surfels: options.live_surfels,
            told: Mutex::default(),
        };
        let begun = Instant::now();
        let ClientDeadlines {
            first_frame, silence, ..
        } = deadlines;
        let seconds = first_frame.as_secs_f64();
        let _waiting = Waiting::for_(format!("the first frame of {} (up to {seconds} s)", input.display()));
        loop {
            stream.look_again()?;
            let is_late = begun.elapsed() >= first_frame;
            match connection::problem(&stream.shared) {
                _ if !stream.frames().is_empty() => return Ok(stream),
                Some((problem, is_final)) if is_final || is_late => return Err(failed(problem)),
                _ if progress.is_cancelled() => return Err(SequenceError::Cancelled),
                // A silent connection ends at about this time, and gives the reason.
                None if begun.elapsed() >= first_frame.max(silence) + 20 * LOOK => {
                    return Err(failed(format!(
                        "no frame came within {seconds} seconds: check that the sequence that is served plays"
                    )));
                }
                _ => stream.shared.ring.wait(0, LOOK),
            }
        }
    }
}

impl Drop for Wanted {
    fn drop(&mut self) {
        // The thread ends by itself, within the time limit of a connection.
        self.shared.is_closed.store(true, Ordering::Relaxed);
        if let Err(problem) = self.shared.stop_recording() {
            log::warn!("{problem}");
        }
    }
}

impl Source for LiveStream {
    fn frames(&self) -> Range<usize> {
        let told = *lock(&self.told);
        self.shared.ring.range().start.min(told)..told
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        let held = self.shared.ring.frame(index);
        let number = held.as_ref().map_or(index as u64, |held| held.frame.head.number);
        Arc::new(FrameEntry {
            name: printable::name(format!("{} {number}", self.input.display())),
            number: Some(number),
            time: held.map(|held| held.time),
            ..FrameEntry::embedded(self.input.clone(), &[])
        })
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        let store = Arc::clone(&self.shared);
        Box::new(StreamDecoder::new(store, Arc::clone(&self.received)))
    }

    fn about(&self) -> About<'_> {
        About {
            inputs: std::slice::from_ref(&self.input),
            fps: lock(&self.shared.link).head.map(|head| head.fps),
            ..About::default()
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        Capabilities {
            groups: Some(self),
            growth: Some(self),
            live: Some(self),
            depth_images: Some(self),
            ..Capabilities::default()
        }
    }
}

impl Groups for LiveStream {
    fn group(&self, index: usize) -> Range<usize> {
        group(&self.received, index, &self.frames())
    }
}

impl Growth for LiveStream {
    fn is_live(&self) -> bool {
        true
    }

    fn may_grow(&self) -> bool {
        true
    }

    fn look_again(&self) -> Result<usize, SequenceError> {
        // Locked first, so that the number never decreases.
        let mut told = lock(&self.told);
        let count = self.shared.ring.range().end;
        let before = std::mem::replace(&mut *told, count);
        Ok(count - before)
    }

    fn wait_for_more(&self, at_most: Duration) -> Result<usize, SequenceError> {
        let told = *lock(&self.told);
        self.shared.ring.wait(told, at_most);
        self.look_again()
    }
}

impl DepthImages for LiveStream {
    fn sensor(&self, index: usize) -> Option<Sensor> {
        sensor(&self.shared.ring.frame(index)?.frame)
    }

    fn raw_images(&self, index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        raw_images(&self.shared.ring.frame(index)?.frame, self.max_bytes)
    }

    fn filters(&self) -> Option<Filters> {
        let newest = self.shared.ring.newest()?;
        has_images(&newest.frame).then_some(self.received.filters)
    }

    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        self.filters()?;
        Some(Arc::new(Self {
            input: self.input.clone(),
            // Other filters decode all frames again; the connection and the ring buffer stay.
            shared: Arc::clone(&self.shared),
            wanted: Arc::clone(&self.wanted),
            received: Arc::new(self.received.filtered(filters)),
            max_bytes: self.max_bytes,
            is_of_surfels: self.is_of_surfels,
            told: Mutex::new(*lock(&self.told)),
        }))
    }
}

impl Live for LiveStream {
    fn status(&self) -> LiveStatus {
        self.shared.status()
    }

    fn frames_behind(&self, shown: usize) -> Option<u64> {
        // Frame numbers need no clock, unlike the delay.
        let newest = self.shared.ring.newest()?.frame.head.number;
        let shown = self.shared.ring.frame(shown)?.frame.head.number;
        newest.checked_sub(shown)
    }

    fn look_from(&self, view: View) {
        if self.is_of_surfels {
            self.shared.look_from(view);
        }
    }

    fn start_recording(&self, path: &Path) -> Result<(), String> {
        self.stop_recording()?;
        let head = lock(&self.shared.link).head;
        let head = head.ok_or_else(|| format!("{}: no frame has arrived yet", self.input.display()))?;
        let recorder = Recorder::create(path, &head);
        let recorder = recorder.map_err(|error| {
            format!(
                "{} cannot be written ({error}): choose another folder to record to",
                path.display()
            )
        })?;
        let written = recorder.written().clone();
        *lock(&self.shared.recorder) = Some(recorder);
        lock(&self.shared.link).recording = Some(written);
        Ok(())
    }

    fn stop_recording(&self) -> Result<Option<StreamRecording>, String> {
        self.shared.stop_recording()
    }
}
