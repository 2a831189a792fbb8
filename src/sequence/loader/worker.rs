//! The threads that make frames.

use super::queue::{Job, Queue};
use crate::cloud::{Frame, PointRecord, ShapeRecord};
use crate::sequence::error::catch_panic;
use crate::sequence::{
    FrameError, Needs, PrepareCounters, PreparedFrame, Sequence, SequenceError, complete, lock,
    prepare,
};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What the loader shares with its workers.
pub(super) struct Shared {
    /// Where a frame that is made alone has its stages shared out. Not the pool that draws: a picture must not wait for a
    /// frame that is not even in it.
    pub(super) pool: rayon::ThreadPool,
    pub(super) sequence: Arc<Sequence>,
    pub(super) queue: Mutex<Queue>,
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

/// Threads for the stages of frames.
pub(super) fn pool(threads: usize) -> Result<rayon::ThreadPool, SequenceError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|number| format!("frame stages {number}"))
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
        match catch_panic(index, &source.path, || make(shared, job)) {
            Ok(None) => {
                shared.queue().cancel(index);
                shared.work.notify_all();
            }
            outcome => {
                // `Ok(None)` was handled above, so transposing always finds a frame or an error.
                if let Some(outcome) = outcome.map_err(Arc::new).transpose() {
                    shared.queue().finish(index, outcome.map(Arc::new));
                }
                shared.work.notify_all();
                shared.finished.notify_all();
                (shared.wake)();
            }
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
fn make(shared: &Shared, job: Job) -> Result<Option<PreparedFrame>, FrameError> {
    if let Some(existing) = job.existing {
        let completed = || complete(&existing, &job.needs, &shared.counters);
        return Ok(Some(shared.run_stages(completed)));
    }
    let loaded = shared.sequence.load(job.index)?;
    let bytes = expected_bytes(&loaded.frame, &job.needs);
    let Some(needs) = shared.queue().still_wanted(job.index, bytes) else {
        return Ok(None);
    };
    let frame = Arc::new(loaded.frame);
    let prepared = || prepare(job.index, frame, loaded.decode_ms, &needs, &shared.counters);
    Ok(Some(shared.run_stages(prepared)))
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
