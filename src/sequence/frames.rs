//! The frames of a source: decoded, validated, moved to their common origin.

use super::detail::Detail;
use super::error::{FrameError, catch_panic};
use super::space::{SpaceFinder, SpaceFrames};
use super::stamps::Stamps;
use crate::assumption::{Assumption, Assumptions, Evidence, Subject};
use crate::cloud::{CloudError, FoundIn, Frame, Mesh, MissingPoints, NoData, RawCloud, Space, ValueSample, make_holes};
use crate::locks::lock;
use crate::progress::Progress;
use crate::rgbd::Filters;
use crate::source::{
    self, DecodeFailure, DecodedFrame, DecodedLevel, Decoder, Example, FrameBytes, FrameEntry, FrameList, OpenOptions,
    SequenceError, Source,
};
use crate::stopwatch::milliseconds_since;
use crate::timeline::{DEFAULT_FPS, Pace};
use glam::DVec3;
use std::num::NonZero;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Instant;

/// The frames of a source, their common origin and their pace. Shared between threads behind an [`Arc`]; may grow at
/// its end.
pub struct Sequence {
    source: Arc<dyn Source>,
    /// Idle decoders, those unused for longest first, and the frame that each has decoded last.
    decoders: Mutex<IdleDecoders>,
    /// Idle decoders for meshes.
    mesh_decoders: Mutex<IdleDecoders>,
    decode_count: AtomicU64,
    space: SpaceFinder,
    fps: Option<f64>,
    no_data: NoData,
    stamps: Mutex<Stamps>,
    /// Assumptions of the frames decoded so far.
    assumptions: Mutex<Assumptions>,
}

type IdleDecoders = Vec<(usize, Box<dyn Decoder>)>;

/// A frame as [`Sequence::load`] gives it.
pub(crate) struct LoadedFrame {
    pub(crate) frame: Frame,
    /// Time of the decoder and of the validation.
    pub(crate) decode_ms: f32,
    /// Time of the decoder alone that all frames take, however many of their points are wanted.
    pub(crate) decoder_ms: f32,
}

impl Sequence {
    /// The frames of `source`.
    pub fn of(source: impl Source + 'static) -> Self {
        Self::of_shared(Arc::new(source), None, NoData::Auto)
    }

    fn of_shared(source: Arc<dyn Source>, fps: Option<f64>, no_data: NoData) -> Self {
        Self {
            source,
            decoders: Mutex::default(),
            mesh_decoders: Mutex::default(),
            decode_count: AtomicU64::new(0),
            space: SpaceFinder::default(),
            fps,
            no_data,
            stamps: Mutex::default(),
            assumptions: Mutex::default(),
        }
    }

    /// The frames of `inputs`: folders, glob patterns and files in any mix, in natural number order. See
    /// [`SequenceError`] for possible errors.
    pub fn discover(inputs: &[PathBuf]) -> Result<Self, SequenceError> {
        Self::open(inputs, &OpenOptions::default())
    }

    /// [`Sequence::discover`] with a choice of how.
    pub fn open(inputs: &[PathBuf], options: &OpenOptions) -> Result<Self, SequenceError> {
        Self::open_observed(inputs, options, &Progress::default())
    }

    /// [`Sequence::open`], where `progress` counts the files that were looked at, and may be cancelled.
    ///
    /// # Errors
    /// As [`Sequence::open`], and [`SequenceError::Cancelled`].
    pub fn open_observed(
        inputs: &[PathBuf],
        options: &OpenOptions,
        progress: &Progress,
    ) -> Result<Self, SequenceError> {
        let source = source::open(inputs, options, progress)?;
        Ok(Self::of_shared(source, options.fps, options.no_data))
    }

    /// The sequence embedded in the program: 24 poses of about 8,000 coloured points.
    pub fn demo() -> Self {
        Self::of(source::demo())
    }

    /// An example embedded in the program.
    pub fn example(example: Example) -> Self {
        Self::of_shared(example.source(), None, NoData::Auto)
    }

    /// Frames that one function decodes: see [`FrameList`].
    pub fn with_decoder(
        entries: Vec<FrameEntry>,
        decode: impl Fn(&FrameEntry) -> Result<RawCloud, DecodeFailure> + Send + Sync + 'static,
    ) -> Self {
        Self::of(FrameList::new(entries, move |entry, _| decode(entry)))
    }

    /// Returns a sequence of the same frames, with nothing decoded yet and the origin undecided.
    #[must_use]
    pub(crate) fn fresh(&self) -> Self {
        Self::of_shared(Arc::clone(&self.source), self.fps, self.no_data)
    }

    /// Returns a sequence of the same frames with other filters of depth images; `None` if frames are none: see
    /// [`DepthImages::filtered`](crate::source::DepthImages::filtered).
    #[must_use]
    pub fn filtered(&self, filters: Filters) -> Option<Self> {
        let source = self.source.filtered(filters)?;
        Some(Self::of_shared(source, self.fps, self.no_data))
    }

    /// Handling of points that stand for no measurement.
    pub fn no_data(&self) -> NoData {
        self.no_data
    }

    /// Returns the source of the frames.
    pub fn source(&self) -> &Arc<dyn Source> {
        &self.source
    }

    /// Returns this sequence with another frame rate; values that are not positive and finite change nothing.
    #[must_use]
    pub fn with_fps(mut self, fps: f64) -> Self {
        if fps.is_finite() && fps > 0.0 {
            self.fps = Some(fps);
        }
        self
    }

    /// The frames that can be decoded, or are broken: see [`Source::frames`].
    pub fn frames(&self) -> Range<usize> {
        self.source.frames()
    }

    /// The frames that one decoder had best decode in their order: see
    /// [`Groups::group`](crate::source::Groups::group).
    pub(crate) fn group(&self, index: usize) -> Range<usize> {
        self.source.group(index)
    }

    /// Number of frames, broken ones and those that are gone included.
    pub fn len(&self) -> usize {
        self.frames().end
    }

    /// True without frames; a discovered sequence has at least one.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the entries of all frames, in order.
    pub fn entries(&self) -> Vec<Arc<FrameEntry>> {
        (0..self.len()).map(|index| self.entry(index)).collect()
    }

    /// Returns the entry of frame `index`. Precondition: `index < len()`.
    pub fn entry(&self, index: usize) -> Arc<FrameEntry> {
        self.source.entry(index)
    }

    /// Returns the frames per second at normal speed, for most of the time.
    pub fn fps(&self) -> f64 {
        let stamped = || self.stamped_pace().map(|(_, fps)| fps);
        let said = || self.source.fps();
        self.fps.or_else(stamped).or_else(said).unwrap_or(DEFAULT_FPS)
    }

    /// Returns the pace, the duration of each frame: as its timestamps give it, unless a frame rate was chosen.
    pub fn pace(&self) -> Pace {
        let stamped = || self.stamped_pace().map(|(pace, _)| pace);
        match self.fps {
            Some(_) => Pace::default(),
            None => stamped().unwrap_or_default(),
        }
    }

    /// Returns pace and frames per second by the timestamps, if every frame has one and they increase.
    fn stamped_pace(&self) -> Option<(Pace, f64)> {
        let mut stamps = lock(&self.stamps);
        stamps.pace(self.len(), |index| self.entry(index).time)
    }

    /// Returns the origin, which is subtracted from file coordinates before they become f32.
    ///
    /// Zero unless the coordinates are large against the extent of the cloud; decided by the first frame that can be
    /// read and has a finite point. The first call decodes that frame, and caches it for the next load.
    pub fn origin(&self) -> DVec3 {
        // Some points may have decided it: nobody waits for the others then.
        self.space.known_origin().unwrap_or_else(|| self.space().origin)
    }

    /// The space of the frames: see [`Sequence::origin`]. Its cells are those of the cube around the frame that decides
    /// the origin.
    pub fn space(&self) -> Space {
        // It cannot be cancelled.
        let never = Progress::default();
        self.space.space(self, &never).unwrap_or_default()
    }

    /// Takes the space of `other` where f32 from its origin keep the detail, so that the same coordinates of both files
    /// become the same f32, in the same cells. To be set before the origin is requested; later it changes nothing.
    pub fn share_origin_with(self: &Arc<Self>, other: &Arc<Self>) {
        if !Arc::ptr_eq(self, other) {
            self.space.share(Arc::clone(other) as Arc<dyn SpaceFrames>);
        }
    }

    /// Decodes frame `index` in file coordinates. A panic of the decoder is an error like any other.
    pub fn decode(&self, index: usize) -> Result<RawCloud, FrameError> {
        let decoded = self.decode_observed(index, Detail::Full, &Progress::default());
        decoded.map(|decoded| decoded.cloud)
    }

    fn decode_observed(&self, index: usize, detail: Detail, progress: &Progress) -> Result<DecodedFrame, FrameError> {
        self.decode_with(&self.decoders, || self.source.decoder(), index, detail, progress)
    }

    /// Decodes frame `index` by an idle decoder, or one that `decoder` makes.
    fn decode_with(
        &self,
        idle: &Mutex<IdleDecoders>,
        decoder: impl FnOnce() -> Box<dyn Decoder>,
        index: usize,
        detail: Detail,
        progress: &Progress,
    ) -> Result<DecodedFrame, FrameError> {
        let frames = self.source.frames();
        if index >= frames.end {
            let count = frames.end;
            return Err(FrameError::NoSuchFrame { index, count });
        }
        let entry = self.entry(index);
        let path = entry.path.clone();
        if index < frames.start {
            return Err(FrameError::Gone { index, path });
        }
        self.decode_count.fetch_add(1, Ordering::Relaxed);
        progress.set(0, 0);
        let mut decoder = take_idle(idle, index, |frame| self.source.group(frame)).unwrap_or_else(decoder);
        let mut decoded = catch_panic(index, &path, || {
            let decoded = decoder.decode(index, &entry, detail.max_points(), progress);
            // A decoder that has panicked is not used again.
            lock(idle).push((index, decoder));
            decoded.map_err(|reason| FrameError::Decode {
                index,
                path: path.clone(),
                reason: reason.into(),
            })
        });
        if progress.is_cancelled() {
            return Err(self.cancelled(index));
        }
        progress.set(0, 0);
        if let Ok(decoded) = &mut decoded {
            // The user's choice applies to every command, statistics only to images.
            if let NoData::Value(_) | NoData::Place(_) = self.no_data {
                self.drop_missing(&mut decoded.cloud, None);
            }
            lock(&self.assumptions).extend(&decoded.cloud.assumptions);
        }
        decoded
    }

    /// Assumptions about the inputs and the frames that were decoded so far.
    pub fn assumptions(&self) -> Vec<Assumption> {
        let mut assumptions = Assumptions::default();
        assumptions.extend(self.source.assumptions());
        assumptions.extend(&lock(&self.assumptions).sorted());
        let mut assumptions = assumptions.sorted();
        match self.fps {
            // A user's statement is not an assumption.
            Some(_) => assumptions.retain(|assumption| assumption.subject != Subject::FrameTimes),
            None => assumptions.extend(self.assumed_fps()),
        }
        assumptions
    }

    /// The frame rate of files without known times.
    fn assumed_fps(&self) -> Option<Assumption> {
        let is_file = |index| matches!(self.entry(index).content, FrameBytes::File(_));
        let is_read = !self.source.inputs().is_empty();
        let is_untold = is_read && self.len() > 1 && self.source.fps().is_none() && is_file(0);
        if !is_untold || self.stamped_pace().is_some() {
            return None;
        }
        let value = format!("{DEFAULT_FPS} frames per second");
        let why = "nothing says when the frames were taken";
        Some(Assumption::new(Subject::FrameTimes, value, why, Evidence::Fallback))
    }

    /// Points of frame `index` that represent the value ranges of all.
    fn sample_of(&self, index: usize, raw: &RawCloud, origin: DVec3) -> ValueSample {
        let missing = MissingPoints::of(raw, self.no_data);
        let mut sample = ValueSample::of_raw(raw, &missing.indices, origin);
        for further in self.further_samples(index) {
            sample.add_scalars_of(&further);
        }
        sample
    }

    /// Returns true if the value ranges belong to a file that has changed since: all frames have to be prepared again.
    pub(crate) fn are_ranges_outdated(&self) -> bool {
        self.space.is_sample_outdated()
    }

    /// [`Growth::changed_since`](crate::source::Growth::changed_since): frames that are to be read again.
    pub(crate) fn changed_since(&self, since: usize) -> Vec<usize> {
        let changed = self.source.changed_since(since);
        for &index in &changed {
            self.space.forget(index);
        }
        changed
    }

    /// The error that the reading of frame `index` was cancelled.
    pub(crate) fn cancelled(&self, index: usize) -> FrameError {
        let path = self.entry(index).path.clone();
        FrameError::Cancelled { index, path }
    }

    /// [`Sequence::decode`], or the frame decoded to decide the origin and not requested since.
    pub(crate) fn take_decoded(&self, index: usize) -> Result<RawCloud, FrameError> {
        match self.space.take_cached(index) {
            Some(cached) => cached.map(|(raw, _)| raw),
            None => self.decode(index),
        }
    }

    /// Frame `index`: decoded, validated and moved to [`Sequence::origin`].
    pub fn frame(&self, index: usize) -> Result<Frame, FrameError> {
        let progress = Progress::default();
        self.load(index, Detail::Full, &progress).map(|loaded| loaded.frame)
    }

    /// Returns the number of decoder calls so far.
    pub fn decode_count(&self) -> u64 {
        self.decode_count.load(Ordering::Relaxed)
    }

    /// [`Sequence::frame`] in some detail, with its time; takes the frame that decided the origin if it is still
    /// cached.
    ///
    /// # Errors
    /// As [`Sequence::frame`], and [`FrameError::Cancelled`] once `progress` is.
    pub(crate) fn load(&self, index: usize, detail: Detail, progress: &Progress) -> Result<LoadedFrame, FrameError> {
        let space = self.space_observed(progress).ok_or_else(|| self.cancelled(index))?;
        let (decoded, decoder_ms) = if let Some(cached) = self.space.take_cached(index) {
            let (raw, decoder_ms) = cached?;
            (raw.into(), decoder_ms)
        } else {
            let start = Instant::now();
            let decoded = self.decode_observed(index, detail, progress)?;
            (decoded, milliseconds_since(start) as f32)
        };
        let start = Instant::now();
        let mut decoded = decoded;
        self.drop_missing(&mut decoded.cloud, None);
        if matches!(detail, Detail::Full) && !decoded.cloud.positions.is_empty() {
            self.space
                .renew_sample(index, || self.sample_of(index, &decoded.cloud, space.origin));
        }
        let has_levels = decoded.level.is_some();
        let frame = validated(decoded, space, detail).and_then(Frame::drawable);
        let frame = frame.map_err(|reason| self.invalid(index, reason))?;
        if let Some(sample) = self.space.sample() {
            frame.share_sample(sample);
        }
        Ok(LoadedFrame {
            frame,
            decode_ms: decoder_ms + milliseconds_since(start) as f32,
            // A cost that grows with the points is not a fixed cost.
            decoder_ms: if has_levels { 0.0 } else { decoder_ms },
        })
    }

    /// The triangles of frame `index`, relative to [`Sequence::origin`]: the file is read once more, as most images are
    /// drawn without them.
    ///
    /// # Errors
    /// As [`Sequence::load`].
    pub(crate) fn load_mesh(&self, index: usize, progress: &Progress) -> Result<Mesh, FrameError> {
        let space = self.space_observed(progress).ok_or_else(|| self.cancelled(index))?;
        // A separate decoder: opening a mesh as points costs nothing more, at the price that a frame drawn as triangles
        // is decoded twice.
        let decoder = || self.source.mesh_decoder();
        let decoded = self.decode_with(&self.mesh_decoders, decoder, index, Detail::Full, progress)?;
        Mesh::from_raw(decoded.cloud, space.origin).map_err(|reason| self.invalid(index, reason))
    }

    /// Makes holes of the points that stand for no measurement, and remembers that. Images of a depth camera have holes
    /// already. `whole_count` is the frame's if `cloud` is a sample.
    fn drop_missing(&self, cloud: &mut RawCloud, whole_count: Option<usize>) -> MissingPoints {
        let rule = match cloud.made_from {
            Some(_) => NoData::None,
            None => self.no_data,
        };
        let missing = MissingPoints::of(cloud, rule);
        // Here, so that they affect no image, octree or estimate: one 0 0 0 in a survey moved the origin by thousands
        // of kilometres, and f32 became coarser than the point spacing. `decode` leaves them in, for `info` and
        // `convert`.
        make_holes(&mut cloud.positions, &missing.indices);
        let found_in = FoundIn {
            point_count: cloud.positions.len(),
            whole_count,
            is_only_frame: self.len() == 1,
        };
        lock(&self.assumptions).extend(missing.assumption(rule, found_in).iter());
        missing
    }

    fn invalid(&self, index: usize, reason: CloudError) -> FrameError {
        let path = self.entry(index).path.clone();
        FrameError::Invalid { index, path, reason }
    }

    /// At most `max_points` of frame `index`, if it has at least `min_points` and they can be read without the
    /// others.
    pub(crate) fn load_sample(&self, index: usize, max_points: usize, min_points: usize) -> Option<LoadedFrame> {
        let start = Instant::now();
        let entry = self.entry(index);
        // Errors are reported when the whole frame is read.
        let sampled = catch_panic(index, &entry.path, || {
            let sample = self.source.sample(index, max_points, min_points);
            sample.map_err(|reason| FrameError::Decode {
                index,
                path: entry.path.clone(),
                reason: reason.into(),
            })
        });
        let (mut sample, point_count) = sampled.ok().flatten()?;
        let present = self.drop_missing(&mut sample.cloud, Some(point_count)).bounds;
        let space = match index {
            // The sample already determines the origin, so that the camera stays in place when all points have arrived.
            0 => self.space.decided_by(present)?,
            _ => self.space.known_of_sample()?,
        };
        let decoder_ms = milliseconds_since(start) as f32;
        let frame = match sample.level {
            Some(_) => validated(sample, space, Detail::Full),
            None => Frame::from_sampled(sample.cloud, space, point_count),
        };
        let frame = frame.and_then(Frame::drawable).ok()?;
        Some(LoadedFrame {
            frame,
            decode_ms: milliseconds_since(start) as f32,
            decoder_ms,
        })
    }

    /// Bytes of the decoded frame cached since the origin was decided.
    pub(crate) fn cached_bytes(&self) -> usize {
        self.space.cached_bytes()
    }

    /// Gives the memory of [`Sequence::cached_bytes`] back; the frame is decoded again when it is wanted.
    pub(crate) fn drop_cached(&self) {
        self.space.drop_cached();
    }
}

/// The points of `decoded` in `space`, no more than `detail` asks for.
fn validated(decoded: DecodedFrame, space: Space, detail: Detail) -> Result<Frame, CloudError> {
    let DecodedFrame { cloud, level } = decoded;
    match level {
        Some(DecodedLevel {
            points_in_frame,
            points_of_finer,
        }) if cloud.positions.len() < points_in_frame => {
            Frame::from_level(cloud, space, points_in_frame, points_of_finer)
        }
        // Before sorting, colouring and estimation, so that all stages have less work. Levels of the octree look
        // slightly better, but need the whole frame sorted first, and the time does not allow that.
        _ => Frame::from_raw_sample(cloud, space, detail.max_points()),
    }
}

/// An idle decoder: the one that is nearest before `index` in its group, as it may know the frames that one is made
/// from. One on another group is taken only if there are as many as CPUs: one that has ended its group, as the worker
/// of the next frame of a group comes back for its decoder; or any, if they are twice as many.
fn take_idle(
    idle: &Mutex<IdleDecoders>,
    index: usize,
    group_of: impl Fn(usize) -> Range<usize>,
) -> Option<Box<dyn Decoder>> {
    let mut idle = lock(idle);
    let group = group_of(index);
    // Frames of files have no groups, but one may start where the previous one ends.
    let knows = |last: usize| (group.start..=index).contains(&last) || last + 1 == index;
    let nearest = (0..idle.len()).filter(|&place| knows(idle[place].0));
    let nearest = nearest.max_by_key(|&place| idle[place].0);
    let max = thread::available_parallelism().map_or(1, NonZero::get);
    let has_ended = |&(last, _): &(usize, Box<dyn Decoder>)| last + 1 >= group_of(last).end;
    let oldest = || match idle.len() {
        count if count >= 2 * max => Some(0),
        count if count >= max => idle.iter().position(has_ended),
        _ => None,
    };
    let place = nearest.or_else(oldest)?;
    Some(idle.remove(place).1)
}

impl SpaceFrames for Sequence {
    fn frame_count(&self) -> usize {
        self.len()
    }

    fn decode_timed(&self, index: usize, progress: &Progress) -> Result<(RawCloud, f32), FrameError> {
        let start = Instant::now();
        let decoded = self.decode_observed(index, Detail::Full, progress)?;
        Ok((decoded.cloud, milliseconds_since(start) as f32))
    }

    fn may_grow(&self) -> bool {
        self.source.may_grow()
    }

    fn no_data(&self) -> NoData {
        self.no_data
    }

    fn further_samples(&self, index: usize) -> Vec<RawCloud> {
        /// Enough for percentiles; a disk that seeks takes ten milliseconds for each.
        const POINTS: usize = 256;
        const FRAMES: usize = 3;
        let last = self.len().saturating_sub(1);
        if last <= index || self.source.is_live() {
            return Vec::new();
        }
        let mut places: Vec<usize> = (1..=FRAMES)
            .map(|step| index + step * (last - index) / FRAMES)
            .collect();
        places.retain(|&place| place > index);
        places.dedup();
        let sample = |place: usize| {
            let path = self.entry(place).path.clone();
            let sampled = catch_panic(place, &path, || Ok(self.source.sample(place, POINTS, 1)));
            Some(sampled.ok()?.ok()??.0.cloud)
        };
        places.into_iter().filter_map(sample).collect()
    }

    fn space_observed(&self, progress: &Progress) -> Option<Space> {
        self.space.space(self, progress)
    }
}

impl std::fmt::Debug for Sequence {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Sequence")
            .field("entries", &self.entries())
            .field("fps", &self.fps())
            .finish_non_exhaustive()
    }
}
