//! A sequence of point clouds through time: finding its files, preparing its frames ahead of the playhead, playing it.
//!
//! [`Sequence::discover`] orders files without reading them. [`Clock`] says which frame is due. A [`Loader`] decodes and
//! prepares frames on worker threads in the order in which the clock will ask for them, and keeps what a byte budget
//! allows:
//!
//! ```no_run
//! use pointreel::sequence::{Direction, Loader, LoaderOptions, Needs, Sequence};
//! use std::sync::Arc;
//!
//! let sequence = Arc::new(Sequence::discover(&["scans/".into()])?);
//! let loader = Loader::new(sequence, LoaderOptions::default())?;
//! let needs = Needs::default();
//! loader.request(0, Direction::Forward, &needs);   // never blocks; frames 0, 1, 2 … are on their way
//! let frame = loader.wait(0, &needs)?;             // without a window; a window polls `Loader::get`
//! println!("{} points", frame.points.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod clock;
mod coloring;
mod companions;
mod demo;
mod detail;
mod discover;
mod effort;
mod error;
mod ghosts;
mod loader;
mod needs;
mod onion;
mod origin;
mod pace;
mod play_range;
mod prepare;
mod recording;
mod records;
mod scaled;
mod shapes;
mod source;
mod stamps;
mod trails;
mod travel;
mod watch;

pub use crate::io::natural_order;
pub use clock::{Clock, DEFAULT_FPS, MAX_SPEED, MIN_SPEED};
pub use coloring::{
    ColorHints, ColorRange, ColorSource, Coloring, DistanceFrom, FieldName, HeightAxis, Paint,
    PaintValues, ParseColoringError, plain_field_name, value_kind,
};
pub use detail::Detail;
pub use error::{FrameError, SequenceError};
pub use ghosts::{Ghost, with_ghosts};
#[cfg(test)]
pub(crate) use loader::simulation;
pub use loader::{
    FrameFacts, FrameState, Loader, LoaderOptions, LoaderStats, Reading, ReadingStage, Slot,
};
pub use needs::Needs;
pub use onion::OnionSkin;
pub use pace::Pace;
pub use play_range::PlayRange;
pub use prepare::{PrepareCounters, PreparedFrame, Timings, complete, prepare, prepare_part};
pub use recording::Recording;
pub use records::UNIFORM_COLOR;
pub use scaled::NO_VALUE_COLOR;
pub use shapes::Shape;
pub(crate) use shapes::{OUTLIERS, Sampled};
pub use source::{Content, Decode, DecodeFailure, Source};
pub use trails::{BreakReason, TrailBreak, TrailMeasure, TrailRequest, Trails};
pub use travel::{Direction, LoopMode};
pub use watch::watch;

use crate::cloud::{Frame, RawCloud};
use crate::io::{ReadOptions, Topic};
use crate::progress::Progress;
use companions::Known;
use glam::DVec3;
use origin::OriginFinder;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, RwLock};
use std::time::{Duration, Instant};

/// How inputs are opened.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OpenOptions {
    /// How files are read.
    pub read: ReadOptions,
    /// Frames a second, in place of what time stamps say.
    pub fps: Option<f64>,
    /// The scans of an E57 file are one frame, not a frame each.
    pub merge_scans: bool,
    /// The topic of recordings whose point clouds are the frames; of each the one that has the most if `None`.
    pub topic: Option<Arc<str>>,
}

/// Ordered sources of frames, their common origin and their pace. Shared between threads behind an [`Arc`]; may grow at its end.
pub struct Sequence {
    sources: RwLock<Vec<Arc<Source>>>,
    decode: Arc<Decode>,
    /// How some points of a frame are read alone, where that is possible.
    sample: Option<Arc<source::Sample>>,
    decode_count: AtomicU64,
    origin: OriginFinder,
    fps: Option<f64>,
    /// What was opened, and how, if it is to be looked at again.
    opened: Option<(Vec<PathBuf>, OpenOptions)>,
    recordings: Vec<Recording>,
    notes: Vec<String>,
    /// What was found out about files beside the frames.
    known: Mutex<Known>,
}

/// A frame as [`Sequence::load`] gives it.
pub(crate) struct LoadedFrame {
    pub(crate) frame: Frame,
    /// Time of the decoder and of the validation.
    pub(crate) decode_ms: f32,
    /// Time of the decoder alone.
    pub(crate) decoder_ms: f32,
}

impl Sequence {
    /// Finds the frames of `inputs`: folders, glob patterns and files in any mix, in natural number order.
    ///
    /// Nothing is read but folders and the lists of contents of files that hold many frames. See [`SequenceError`] for what can
    /// be wrong.
    pub fn discover(inputs: &[PathBuf]) -> Result<Self, SequenceError> {
        Self::open(inputs, &OpenOptions::default())
    }

    /// [`Sequence::discover`] with a choice of how.
    pub fn open(inputs: &[PathBuf], options: &OpenOptions) -> Result<Self, SequenceError> {
        Self::open_observed(inputs, options, &mut |_, _| ControlFlow::Continue(()))
    }

    /// [`Sequence::open`], where `observe` is told of how many files of how many were looked at, and may cancel.
    ///
    /// # Errors
    /// As [`Sequence::open`], and [`SequenceError::Cancelled`].
    pub fn open_observed(
        inputs: &[PathBuf],
        options: &OpenOptions,
        observe: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<Self, SequenceError> {
        let mut known = Known::default();
        let discovered = discover::discover(inputs, options, &mut known, observe)?;
        let read = options.read;
        let decode =
            move |source: &Source, progress: &Progress| source::decode(source, &read, progress);
        if options.topic.is_none() {
            recording::warn_of_unread(&discovered.recordings);
        }
        Ok(Self {
            fps: options.fps,
            opened: Some((inputs.to_vec(), options.clone())),
            recordings: discovered.recordings,
            notes: discovered.notes,
            known: Mutex::new(known),
            sample: Some(Arc::new(source::sample)),
            ..Self::with_observed_decoder(discovered.sources, decode)
        })
    }

    /// What was opened: nothing for the demo and for a decoder of one's own.
    pub fn inputs(&self) -> &[PathBuf] {
        self.opened.as_ref().map_or(&[], |(inputs, _)| inputs)
    }

    /// The recordings among what was opened.
    pub fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    /// The topics with point clouds of all recordings together, in the order of their names.
    pub fn topics(&self) -> Vec<Topic> {
        recording::topics_of(&self.recordings)
    }

    /// What of the inputs is left out, a sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Whether [`Sequence::look_again`] can find anything: a folder or a pattern is open, not only files.
    pub fn may_grow(&self) -> bool {
        self.inputs().iter().any(|input| !input.is_file())
    }

    /// Looks at the inputs again and takes the frames that came behind the last one; says how many. What came between others is
    /// left out: frames keep their places. Files that are still being written are left for the next time. Normals that came beside a
    /// frame are read with it from then on.
    pub fn look_again(&self) -> Result<usize, SequenceError> {
        let Some((inputs, options)) = &self.opened else {
            return Ok(0);
        };
        let observe = &mut |_, _| ControlFlow::Continue(());
        let mut known = lock(&self.known);
        let found = discover::discover(inputs, options, &mut known, observe)?.sources;
        drop(known);
        let mut sources = write(&self.sources);
        let is_last = |source: &Source| {
            let last = sources.last();
            last.is_some_and(|last| last.path == source.path && last.content == source.content)
        };
        let Some(last) = found.iter().rposition(is_last) else {
            return Ok(0);
        };
        let mut found = found.into_iter();
        join_late_normals(&mut sources, found.by_ref().take(last + 1));
        let count_before = sources.len();
        for source in found {
            let before = sources.last();
            let expects_normals = before.is_some_and(|before| before.normals.is_some());
            if !discover::is_written(&source, expects_normals) {
                break;
            }
            sources.push(Arc::new(source));
        }
        Ok(sources.len() - count_before)
    }

    /// The sequence embedded in the program: 24 poses of about 8,000 coloured points.
    pub fn demo() -> Self {
        let read = ReadOptions::default();
        Self::with_observed_decoder(demo::sources(), move |source, progress| {
            source::decode(source, &read, progress)
        })
    }

    /// A sequence whose frames come from `decode`: sensors, generators, slow or broken files in tests.
    pub fn with_decoder(
        sources: Vec<Source>,
        decode: impl Fn(&Source) -> Result<RawCloud, DecodeFailure> + Send + Sync + 'static,
    ) -> Self {
        Self::with_observed_decoder(sources, move |source, _| decode(source))
    }

    /// [`Sequence::with_decoder`] for decoders that tell how far they are and look whether they are still wanted: see [`Decode`].
    pub fn with_observed_decoder(
        sources: Vec<Source>,
        decode: impl Fn(&Source, &Progress) -> Result<RawCloud, DecodeFailure> + Send + Sync + 'static,
    ) -> Self {
        Self {
            sources: RwLock::new(sources.into_iter().map(Arc::new).collect()),
            decode: Arc::new(decode),
            sample: None,
            decode_count: AtomicU64::new(0),
            origin: OriginFinder::default(),
            fps: None,
            opened: None,
            recordings: Vec::new(),
            notes: Vec::new(),
            known: Mutex::default(),
        }
    }

    /// The same sequence, of whose frames `sample` reads some points alone: see [`source::Sample`].
    #[cfg(test)]
    pub(crate) fn with_sample(
        mut self,
        sample: impl Fn(&Source, usize, usize) -> Result<Option<(RawCloud, usize)>, DecodeFailure>
        + Send
        + Sync
        + 'static,
    ) -> Self {
        self.sample = Some(Arc::new(sample));
        self
    }

    /// The same frames, of which nothing is decoded yet and the origin is not decided.
    #[must_use]
    pub(crate) fn anew(&self) -> Self {
        Self {
            sources: RwLock::new(self.sources()),
            decode: Arc::clone(&self.decode),
            sample: self.sample.clone(),
            decode_count: AtomicU64::new(0),
            origin: OriginFinder::default(),
            fps: self.fps,
            opened: self.opened.clone(),
            recordings: self.recordings.clone(),
            notes: self.notes.clone(),
            known: Mutex::default(),
        }
    }

    /// The same sequence at another frame rate; values that are not positive and finite change nothing.
    #[must_use]
    pub fn with_fps(mut self, fps: f64) -> Self {
        if fps.is_finite() && fps > 0.0 {
            self.fps = Some(fps);
        }
        self
    }

    /// Number of frames, broken ones included.
    pub fn len(&self) -> usize {
        read(&self.sources).len()
    }

    /// True without frames; a discovered sequence has at least one.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All sources in order.
    pub fn sources(&self) -> Vec<Arc<Source>> {
        read(&self.sources).clone()
    }

    /// Source of frame `index`. Precondition: `index < len()`.
    pub fn source(&self, index: usize) -> Arc<Source> {
        Arc::clone(&read(&self.sources)[index])
    }

    /// Frames a second at normal speed, for most of the time.
    pub fn fps(&self) -> f64 {
        let stamped = || self.stamped_pace().map(|(_, fps)| fps);
        self.fps.or_else(stamped).unwrap_or(DEFAULT_FPS)
    }

    /// How long each frame lasts: as its time stamps say, unless a frame rate was chosen.
    pub fn pace(&self) -> Pace {
        let stamped = || self.stamped_pace().map(|(pace, _)| pace);
        match self.fps {
            Some(_) => Pace::default(),
            None => stamped().unwrap_or_default(),
        }
    }

    /// Pace and frames a second by the time stamps, if every frame has one and they grow.
    fn stamped_pace(&self) -> Option<(Pace, f64)> {
        let times: Option<Vec<Duration>> = read(&self.sources)
            .iter()
            .map(|source| source.time)
            .collect();
        Pace::of_times(&times?)
    }

    /// What is subtracted from file coordinates before they become f32.
    ///
    /// Zero unless the coordinates are large against the extent of the cloud; decided by the first frame that can be
    /// read and has a finite point. The first call decodes that frame, and keeps it for whoever loads it next.
    pub fn origin(&self) -> DVec3 {
        // Nobody can cancel it.
        let never = Progress::default();
        self.origin.origin(self, &never).unwrap_or_default()
    }

    /// Takes the origin of `other` where f32 from there keep the detail, so that the same coordinates of both files become
    /// the same f32. To be said before the origin is asked for; later it changes nothing.
    pub fn share_origin_with(self: &Arc<Self>, other: &Arc<Self>) {
        if !Arc::ptr_eq(self, other) {
            self.origin.share(Arc::clone(other));
        }
    }

    /// Decodes frame `index` in file coordinates. A panic of the decoder is an error like any other.
    pub fn decode(&self, index: usize) -> Result<RawCloud, FrameError> {
        self.decode_observed(index, &Progress::default())
    }

    fn decode_observed(&self, index: usize, progress: &Progress) -> Result<RawCloud, FrameError> {
        let source = read(&self.sources).get(index).map(Arc::clone);
        let source = source.ok_or_else(|| FrameError::NoSuchFrame {
            index,
            count: self.len(),
        })?;
        self.decode_count.fetch_add(1, Ordering::Relaxed);
        progress.set(0, 0);
        let decoded = error::catch_panic(index, &source.path, || {
            (self.decode)(&source, progress).map_err(|reason| FrameError::Decode {
                index,
                path: source.path.clone(),
                reason: reason.into(),
            })
        });
        if progress.is_cancelled() {
            return Err(self.cancelled(index));
        }
        progress.set(0, 0);
        decoded
    }

    /// That the reading of frame `index` was cancelled.
    pub(crate) fn cancelled(&self, index: usize) -> FrameError {
        let path = self.source(index).path.clone();
        FrameError::Cancelled { index, path }
    }

    /// [`Sequence::decode`], or what was decoded to decide the origin and nobody has asked for since.
    pub(crate) fn take_decoded(&self, index: usize) -> Result<RawCloud, FrameError> {
        match self.origin.take_kept(index) {
            Some(kept) => kept.map(|(raw, _)| raw),
            None => self.decode(index),
        }
    }

    /// Frame `index`: decoded, validated and moved to [`Sequence::origin`].
    pub fn frame(&self, index: usize) -> Result<Frame, FrameError> {
        let progress = Progress::default();
        self.load(index, Detail::Full, &progress)
            .map(|loaded| loaded.frame)
    }

    /// How often a decoder was called so far.
    pub fn decode_count(&self) -> u64 {
        self.decode_count.load(Ordering::Relaxed)
    }

    /// [`Sequence::frame`] in some detail, with its time; takes the frame that decided the origin if it is still kept.
    ///
    /// # Errors
    /// As [`Sequence::frame`], and [`FrameError::Cancelled`] once `progress` is.
    pub(crate) fn load(
        &self,
        index: usize,
        detail: Detail,
        progress: &Progress,
    ) -> Result<LoadedFrame, FrameError> {
        let origin = self.origin.origin(self, progress);
        let origin = origin.ok_or_else(|| self.cancelled(index))?;
        let (raw, decoder_ms) = match self.origin.take_kept(index) {
            Some(kept) => kept?,
            None => self.decode_timed(index, progress)?,
        };
        let start = Instant::now();
        let frame = Frame::from_raw_sample(raw, origin, detail.most_points());
        let frame = frame.map_err(|reason| FrameError::Invalid {
            index,
            path: self.source(index).path.clone(),
            reason,
        })?;
        if let Some(sample) = self.origin.sample() {
            frame.share_sample(Arc::clone(sample));
        }
        Ok(LoadedFrame {
            frame,
            decode_ms: decoder_ms + milliseconds_since(start),
            decoder_ms,
        })
    }

    /// At most `most_points` of frame `index`, if it has at least `fewest_points` and they can be read without the others.
    pub(crate) fn load_sample(
        &self,
        index: usize,
        most_points: usize,
        fewest_points: usize,
    ) -> Option<LoadedFrame> {
        let start = Instant::now();
        let source = self.source(index);
        let sample = self.sample.as_ref()?;
        // What is wrong is said when all of it is read.
        let sampled = error::catch_panic(index, &source.path, || {
            sample(&source, most_points, fewest_points).map_err(|reason| FrameError::Decode {
                index,
                path: source.path.clone(),
                reason: reason.into(),
            })
        });
        let (raw, point_count) = sampled.ok().flatten()?;
        let origin = match index {
            0 => self.origin.decided_by(&raw)?,
            _ => self.origin.known()?,
        };
        let decoder_ms = milliseconds_since(start);
        let frame = Frame::from_sampled(raw, origin, point_count).ok()?;
        Some(LoadedFrame {
            frame,
            decode_ms: milliseconds_since(start),
            decoder_ms,
        })
    }

    /// Bytes of the decoded frame kept since the origin was decided.
    pub(crate) fn kept_bytes(&self) -> usize {
        self.origin.kept_bytes()
    }

    /// Gives the memory of [`Sequence::kept_bytes`] back; the frame is decoded again when it is wanted.
    pub(crate) fn drop_kept(&self) {
        self.origin.drop_kept();
    }

    fn decode_timed(
        &self,
        index: usize,
        progress: &Progress,
    ) -> Result<(RawCloud, f32), FrameError> {
        let start = Instant::now();
        let raw = self.decode_observed(index, progress)?;
        Ok((raw, milliseconds_since(start)))
    }
}

impl std::fmt::Debug for Sequence {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Sequence")
            .field("sources", &read(&self.sources))
            .field("fps", &self.fps())
            .finish_non_exhaustive()
    }
}

/// Gives the frames in `sources` the normals that `found` has beside the same files by now.
fn join_late_normals(sources: &mut [Arc<Source>], found: impl Iterator<Item = Source>) {
    let with_normals = found.filter(|source| source.normals.is_some());
    let late: HashMap<PathBuf, Source> = with_normals
        .map(|source| (source.path.clone(), source))
        .collect();
    for source in sources.iter_mut().filter(|source| source.normals.is_none()) {
        if let Some(found) = late.get(&source.path)
            && discover::is_written(found, false)
        {
            *source = Arc::new(Source {
                normals: found.normals.clone(),
                ..Source::clone(source)
            });
        }
    }
}

/// Wall time since `start` in milliseconds.
pub(crate) fn milliseconds_since(start: Instant) -> f32 {
    start.elapsed().as_secs_f32() * 1e3
}

/// Locks `mutex`; a panic elsewhere does not make the data unusable, since no invariant is broken between statements
/// that can panic.
pub(crate) fn lock<T>(mutex: &std::sync::Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// [`lock`] for readers.
fn read<T>(lock: &RwLock<T>) -> std::sync::RwLockReadGuard<'_, T> {
    lock.read()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// [`lock`] for writers.
fn write<T>(lock: &RwLock<T>) -> std::sync::RwLockWriteGuard<'_, T> {
    lock.write()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

// The loader hands sequences and frames to worker threads.
const _: fn() = || {
    fn shared<T: Send + Sync>() {}
    shared::<Arc<Sequence>>();
    shared::<PreparedFrame>();
    shared::<FrameError>();
};
