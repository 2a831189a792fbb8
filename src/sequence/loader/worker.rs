//! The threads that make frames.

use super::queue::{Job, NextStage, Queue};
use super::readings::{ReadingStage, Readings};
use super::stages;
use crate::cloud::{Frame, Mesh, PointRecord, ShapeRecord};
use crate::locks::lock;
use crate::memory;
use crate::priority;
use crate::progress::Progress;
use crate::sequence::effort::MakingCost;
use crate::sequence::error::catch_panic;
use crate::sequence::prepare::{complete_observed, prepare, prepare_observed, prepare_sample};
use crate::sequence::{FrameError, Needs, PrepareCounters, PreparedFrame, Sequence, SequenceError};
use crate::stopwatch::milliseconds_since;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// State shared between the loader and its workers.
pub(super) struct Shared {
    /// Thread pool for the stages of a frame that is prepared alone. Not the pool that draws: an image must not wait
    /// for a frame that is not even in it.
    pub(super) pool: rayon::ThreadPool,
    /// Thread pool for the points of a frame at rest: there is nothing else to draw, so these threads have normal
    /// priority.
    pub(super) first_pool: rayon::ThreadPool,
    pub(super) sequence: Arc<Sequence>,
    pub(super) queue: Mutex<Queue>,
    pub(super) readings: Readings,
    /// There may be work: a request, a waiter, a finished frame, the end.
    pub(super) work: Condvar,
    /// A frame was finished.
    pub(super) finished: Condvar,
    pub(super) counters: PrepareCounters,
    pub(super) machine_bytes: u64,
    pub(super) wake: Arc<dyn Fn() + Send + Sync>,
}

impl Shared {
    pub(super) fn queue(&self) -> MutexGuard<'_, Queue> {
        lock(&self.queue)
    }

    /// Runs the stages of one frame. On the worker's own thread while others are busy too: frames side by side waste
    /// less than stages side by side (measured: 10 %).
    fn run_stages<T: Send>(&self, job: &Job, stages: impl FnOnce() -> T + Send) -> T {
        let is_alone = self.queue().cache.in_flight() <= 1;
        match job.next_stage {
            // Two in one pool could deadlock while waiting for the origin.
            _ if !is_alone => stages(),
            Some(NextStage::Sample | NextStage::AllPoints(_)) => self.first_pool.install(stages),
            _ => self.pool.install(stages),
        }
    }

    /// Sleeps until `condition` may have changed.
    pub(super) fn sleep<'a>(condition: &Condvar, queue: MutexGuard<'a, Queue>) -> MutexGuard<'a, Queue> {
        condition.wait(queue).unwrap_or_else(PoisonError::into_inner)
    }
}

/// Threads for the stages of frames, which have a lower priority than drawing: their results are due later.
pub(super) fn pool(threads: usize) -> Result<rayon::ThreadPool, SequenceError> {
    pool_of(threads, |_| priority::go_behind_drawing())
}

/// Threads for work needed before anything can be drawn.
pub(super) fn first_pool(threads: usize) -> Result<rayon::ThreadPool, SequenceError> {
    pool_of(threads, |_| {})
}

fn pool_of(threads: usize, begin: impl Fn(usize) + Send + Sync + 'static) -> Result<rayon::ThreadPool, SequenceError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|number| format!("frame stages {number}"))
        .start_handler(begin)
        .build()
        .map_err(|error| SequenceError::NoThread {
            reason: std::io::Error::other(error),
        })
}

/// Takes jobs until the loader is dropped. Called in a pool of one thread, where work that would be shared out stays.
pub(super) fn run(shared: &Shared) {
    while let Some(job) = next_job(shared) {
        let index = job.index;
        let entry = shared.sequence.entry(index);
        match catch_panic(index, &entry.path, || make(shared, &job)) {
            Ok(None) => {
                shared.queue().cancel(index);
                shared.work.notify_all();
                (shared.wake)();
            }
            outcome => {
                // `Ok(None)` was handled above, so transposing always finds a frame or an error.
                if let Some(outcome) = outcome.map_err(Arc::new).transpose() {
                    finish(shared, index, outcome);
                }
                shared.work.notify_all();
                shared.finished.notify_all();
                (shared.wake)();
            }
        }
    }
}

/// Hands over the result of a job.
pub(super) fn finish(shared: &Shared, index: usize, outcome: Result<Finished, Arc<FrameError>>) {
    let mut queue = shared.queue();
    let is_complete = |frame: &PreparedFrame| {
        let needs = queue.needs.as_ref();
        needs.is_none_or(|needs| frame.satisfies(needs))
    };
    // A single stage indicates little about the time of the whole frame.
    if let Some(finished) = outcome.as_ref().ok().filter(|made| is_complete(&made.frame)) {
        queue.effort.note_made(&finished.made());
    }
    let is_settled = outcome.as_ref().is_ok_and(|made| made.is_settled);
    queue.finish(index, outcome.map(|finished| Arc::new(finished.frame)));
    if is_settled {
        queue.cache.settle(index);
    }
}

/// A frame that was made.
pub(super) struct Finished {
    pub(super) frame: PreparedFrame,
    /// Time of the decoder alone, milliseconds; `None` if it was not called.
    pub(super) decoder_ms: Option<f32>,
    /// It stays as it is, as there is no memory for its missing parts.
    pub(super) is_settled: bool,
}

impl Finished {
    fn made(&self) -> MakingCost {
        let frame = &self.frame.frame;
        let rest_ms = self.frame.timings.total_ms() - self.decoder_ms.unwrap_or(0.0);
        MakingCost {
            decode_ms: self.decoder_ms.map(f64::from),
            rest_ms: f64::from(rest_ms),
            points: frame.len(),
            points_in_file: frame.points_in_file(),
        }
    }
}

/// Sleeps until there is a job; `None` when the loader is dropped.
fn next_job(shared: &Shared) -> Option<Job> {
    let mut queue = shared.queue();
    loop {
        if queue.shutdown {
            return None;
        }
        match queue.next_job() {
            Some(job) => return Some(job),
            None => queue = Shared::sleep(&shared.work, queue),
        }
    }
}

/// Decodes and prepares; `None` if the frame is no longer wanted.
pub(super) fn make(shared: &Shared, job: &Job) -> Result<Option<Finished>, FrameError> {
    if let Some(existing) = &job.existing {
        return complete_existing(shared, job, existing);
    }
    if job.next_stage == Some(NextStage::Sample)
        && let Some(sample) = sample(shared, job)
    {
        return Ok(Some(sample));
    }
    let stage = match job.next_stage {
        Some(NextStage::AllPoints(count)) => ReadingStage::AllPoints(count),
        _ => ReadingStage::Frame,
    };
    let reading = shared.readings.begin(job.index, stage);
    let load = || {
        let sequence = &shared.sequence;
        sequence.load(job.index, job.detail, &reading.progress)
    };
    let loaded = shared.run_stages(job, load)?;
    reading.note_read();
    let bytes = expected_bytes(&loaded.frame, &job.needs);
    let Some(needs) = shared.queue().still_wanted(job, bytes) else {
        return Ok(None);
    };
    let mut frame = loaded.frame;
    let in_stages = job.next_stage.is_some() && stages::comes_in_stages(&frame, &needs);
    let fits = check_memory(shared, job.index, &frame, &needs);
    let is_settled = in_stages && fits.is_err();
    match fits {
        // If a machine lacks the memory for the next stage, the results of the earlier ones are retained.
        Err(error) if in_stages => frame.warn(format!("{error}: its points are shown")),
        fits => fits?,
    }
    let needs = if in_stages {
        stages::points_alone(&frame, &needs)
    } else {
        needs
    };
    let has_mesh = needs.mesh && frame.has_faces();
    let (mesh, mesh_ms) = load_mesh(shared, job, has_mesh, &reading.progress)?;
    let frame = Arc::new(frame);
    let prepared = || {
        prepare_observed(
            job.index,
            frame,
            mesh,
            loaded.decode_ms + mesh_ms,
            &needs,
            &shared.counters,
            &reading.progress,
        )
    };
    let frame = shared.run_stages(job, prepared);
    if reading.progress.is_cancelled() {
        return Err(shared.sequence.cancelled(job.index));
    }
    Ok(Some(Finished {
        frame,
        decoder_ms: Some(loaded.decoder_ms + mesh_ms),
        is_settled,
    }))
}

/// Adds the requests of `job` to a frame that was prepared for other needs, or takes some of its points; `None` if it
/// is no longer needed.
fn complete_existing(shared: &Shared, job: &Job, existing: &PreparedFrame) -> Result<Option<Finished>, FrameError> {
    let lacks_mesh = existing.lacks_mesh_for(&job.needs);
    let stage = match existing.shapes {
        _ if lacks_mesh => ReadingStage::Mesh,
        None if job.needs.shapes => ReadingStage::Normals,
        _ => ReadingStage::Octree,
    };
    let reading = shared.readings.begin(job.index, stage);
    let progress = &reading.progress;
    if job.next_stage.is_some() {
        progress.set(0, 0);
        let fits = check_memory(shared, job.index, &existing.frame, &job.needs);
        fits.inspect_err(|error| log::warn!("{error}"))?;
        memory::give_back_freed_pages();
    }
    let (mesh, mesh_ms) = load_mesh(shared, job, lacks_mesh, progress)?;
    let mut frame = shared.run_stages(job, || from_existing(shared, existing, mesh, job, progress))?;
    if reading.is_superseded() {
        return Ok(None);
    }
    if progress.is_cancelled() {
        return Err(shared.sequence.cancelled(job.index));
    }
    frame.timings.decode_ms += mesh_ms;
    Ok(Some(Finished {
        frame,
        decoder_ms: None,
        is_settled: false,
    }))
}

/// The triangles of the frame that `job` is for, if they are wanted, and the milliseconds that they took.
fn load_mesh(
    shared: &Shared,
    job: &Job,
    is_wanted: bool,
    progress: &Progress,
) -> Result<(Option<Mesh>, f32), FrameError> {
    if !is_wanted {
        return Ok((None, 0.0));
    }
    let start = Instant::now();
    let mesh = shared.run_stages(job, || shared.sequence.load_mesh(job.index, progress))?;
    Ok((Some(mesh), milliseconds_since(start) as f32))
}

/// Checks that the machine has the memory that `frame` takes when it is completed for `needs`.
fn check_memory(shared: &Shared, index: usize, frame: &Frame, needs: &Needs) -> Result<(), FrameError> {
    let needed_bytes = stages::completion_bytes(frame, needs);
    if needed_bytes <= shared.machine_bytes {
        return Ok(());
    }
    Err(FrameError::TooLarge {
        index,
        path: shared.sequence.entry(index).path.clone(),
        points: frame.len(),
        needed_bytes,
        machine_bytes: shared.machine_bytes,
    })
}

/// The first stage of the frame that `job` is for, if there is one.
fn sample(shared: &Shared, job: &Job) -> Option<Finished> {
    let reading = shared.readings.begin(job.index, ReadingStage::Frame);
    let prepared = || {
        let (max, min) = (stages::SAMPLE_POINTS, stages::MIN_SAMPLED);
        let loaded = shared.sequence.load_sample(job.index, max, min)?;
        let frame = Arc::new(loaded.frame);
        let needs = stages::points_alone(&frame, &job.needs);
        Some(prepare(job.index, frame, loaded.decode_ms, &needs, &shared.counters))
    };
    let frame = shared.run_stages(job, prepared)?;
    reading.note_read();
    Some(Finished {
        frame,
        decoder_ms: None,
        is_settled: false,
    })
}

/// Prepares the requests of `job` from a frame that was prepared for other needs or with more points.
fn from_existing(
    shared: &Shared,
    existing: &PreparedFrame,
    mesh: Option<Mesh>,
    job: &Job,
    progress: &Progress,
) -> Result<PreparedFrame, FrameError> {
    let max_points = job.detail.max_points();
    if !job.detail.is_exceeded_by(&existing.frame) {
        let counters = &shared.counters;
        return Ok(complete_observed(existing, mesh, &job.needs, counters, progress));
    }
    prepare_sample(existing, mesh, max_points, &job.needs, &shared.counters).map_err(|reason| FrameError::Invalid {
        index: job.index,
        path: shared.sequence.entry(job.index).path.clone(),
        reason,
    })
}

/// Returns the expected memory of `frame` when it is prepared, as far as it can be predicted: all but the octree.
fn expected_bytes(frame: &Frame, needs: &Needs) -> usize {
    let shape_bytes = if needs.shapes { size_of::<ShapeRecord>() } else { 0 };
    frame.byte_size() + frame.len() * (size_of::<PointRecord>() + shape_bytes)
}
