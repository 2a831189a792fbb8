//! The threads that make frames.

use super::queue::{Job, Queue};
use super::readings::Readings;
use crate::cloud::{Frame, PointRecord, ShapeRecord};
use crate::priority;
use crate::sequence::effort::Made;
use crate::sequence::error::catch_panic;
use crate::sequence::prepare::{prepare_observed, prepare_sample};
use crate::sequence::{
    FrameError, Needs, PrepareCounters, PreparedFrame, Sequence, SequenceError, complete, lock,
};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What the loader shares with its workers.
pub(super) struct Shared {
    /// Where a frame that is made alone has its stages shared out. Not the pool that draws: a picture must not wait for a
    /// frame that is not even in it.
    pub(super) pool: rayon::ThreadPool,
    pub(super) sequence: Arc<Sequence>,
    pub(super) queue: Mutex<Queue>,
    pub(super) readings: Readings,
    /// There may be work: a request, a waiter, a finished frame, the end.
    pub(super) work: Condvar,
    /// A frame was finished.
    pub(super) finished: Condvar,
    pub(super) counters: PrepareCounters,
    pub(super) wake: Arc<dyn Fn() + Send + Sync>,
}

impl Shared {
    pub(super) fn queue(&self) -> MutexGuard<'_, Queue> {
        lock(&self.queue)
    }

    /// Runs the stages of one frame. On the worker's own thread while others are busy too: frames side by side waste less
    /// than stages side by side (measured: 10 %).
    fn run_stages<T: Send>(&self, stages: impl FnOnce() -> T + Send) -> T {
        let is_alone = self.queue().cache.in_flight() <= 1;
        if is_alone {
            self.pool.install(stages)
        } else {
            stages()
        }
    }

    /// Sleeps until `condition` may have changed.
    pub(super) fn sleep<'a>(
        condition: &Condvar,
        queue: MutexGuard<'a, Queue>,
    ) -> MutexGuard<'a, Queue> {
        condition
            .wait(queue)
            .unwrap_or_else(PoisonError::into_inner)
    }
}

/// Threads for the stages of frames, which are behind those that draw: what they make is due later.
pub(super) fn pool(threads: usize) -> Result<rayon::ThreadPool, SequenceError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|number| format!("frame stages {number}"))
        .start_handler(|_| priority::go_behind_drawing())
        .build()
        .map_err(|error| SequenceError::NoThread {
            reason: std::io::Error::other(error),
        })
}

/// Takes jobs until the loader is dropped. Called in a pool of one thread, where what would be shared out stays.
pub(super) fn run(shared: &Shared) {
    while let Some(job) = next_job(shared) {
        let index = job.index;
        let source = shared.sequence.source(index);
        match catch_panic(index, &source.path, || make(shared, &job)) {
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

/// Hands over what came of a job.
pub(super) fn finish(shared: &Shared, index: usize, outcome: Result<Finished, Arc<FrameError>>) {
    let mut queue = shared.queue();
    if let Ok(finished) = &outcome {
        queue.effort.note_made(&finished.made());
    }
    queue.finish(index, outcome.map(|finished| Arc::new(finished.frame)));
}

/// A frame that was made.
pub(super) struct Finished {
    pub(super) frame: PreparedFrame,
    /// Time of the decoder alone, milliseconds; `None` if it was not called.
    pub(super) decoder_ms: Option<f32>,
}

impl Finished {
    fn made(&self) -> Made {
        let frame = &self.frame.frame;
        let rest_ms = self.frame.timings.total_ms() - self.decoder_ms.unwrap_or(0.0);
        Made {
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

/// Decodes and prepares; `None` if nobody wants the frame any more.
pub(super) fn make(shared: &Shared, job: &Job) -> Result<Option<Finished>, FrameError> {
    if let Some(existing) = &job.existing {
        let frame = shared.run_stages(|| from_existing(shared, existing, job))?;
        return Ok(Some(Finished {
            frame,
            decoder_ms: None,
        }));
    }
    let reading = shared.readings.begin(job.index);
    let loaded = shared
        .sequence
        .load(job.index, job.detail, &reading.progress)?;
    reading.note_read();
    let bytes = expected_bytes(&loaded.frame, &job.needs);
    let Some(needs) = shared.queue().still_wanted(job, bytes) else {
        return Ok(None);
    };
    let frame = Arc::new(loaded.frame);
    let prepared = || {
        prepare_observed(
            job.index,
            frame,
            loaded.decode_ms,
            &needs,
            &shared.counters,
            &reading.progress,
        )
    };
    let frame = shared.run_stages(prepared);
    if reading.progress.is_cancelled() {
        return Err(shared.sequence.cancelled(job.index));
    }
    Ok(Some(Finished {
        frame,
        decoder_ms: Some(loaded.decoder_ms),
    }))
}

/// What `job` asks for from a frame that was prepared for other needs or with more points.
fn from_existing(
    shared: &Shared,
    existing: &PreparedFrame,
    job: &Job,
) -> Result<PreparedFrame, FrameError> {
    let most_points = job.detail.most_points();
    if !job.detail.is_exceeded_by(&existing.frame) {
        return Ok(complete(existing, &job.needs, &shared.counters));
    }
    prepare_sample(existing, most_points, &job.needs, &shared.counters).map_err(|reason| {
        FrameError::Invalid {
            index: job.index,
            path: shared.sequence.source(job.index).path.clone(),
            reason,
        }
    })
}

/// What `frame` will take when it is prepared, as far as it can be said before: all but the octree.
fn expected_bytes(frame: &Frame, needs: &Needs) -> usize {
    let shape_bytes = if needs.shapes {
        size_of::<ShapeRecord>()
    } else {
        0
    };
    frame.byte_size() + frame.len() * (size_of::<PointRecord>() + shape_bytes)
}
