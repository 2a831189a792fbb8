//! Progress and cancellation of long work, shared between the thread that does the work and those that wait for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Progress and cancellation state of some work. Clones refer to the same work.
#[derive(Debug, Clone, Default)]
pub struct Progress(Arc<Shared>);

#[derive(Default)]
struct Shared {
    has_begun: AtomicBool,
    done: AtomicUsize,
    of: AtomicUsize,
    is_cancelled: AtomicBool,
    tell: Option<Box<Tell>>,
}

/// Observer of the progress.
type Tell = dyn Fn(&Progress) + Send + Sync;

impl std::fmt::Debug for Shared {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Shared")
            .field("done", &self.done)
            .field("of", &self.of)
            .field("is_cancelled", &self.is_cancelled)
            .finish_non_exhaustive()
    }
}

impl Progress {
    /// Creates the progress of work with a callback: `tell` is called whenever progress is reported, on the reporting
    /// thread. It must not block.
    pub fn told_to(tell: impl Fn(&Self) + Send + Sync + 'static) -> Self {
        Self(Arc::new(Shared {
            tell: Some(Box::new(tell)),
            ..Shared::default()
        }))
    }

    /// Reports that `done` of `of` steps are done; `of` is 0 while unknown.
    pub fn set(&self, done: usize, of: usize) {
        self.0.of.store(of, Ordering::Relaxed);
        self.0.done.store(done, Ordering::Relaxed);
        self.0.has_begun.store(true, Ordering::Relaxed);
        self.tell();
    }

    /// Reports that `steps` more steps are done. Threads may share the work.
    pub fn advance(&self, steps: usize) {
        self.0.done.fetch_add(steps, Ordering::Relaxed);
        self.tell();
    }

    fn tell(&self) {
        if let Some(tell) = &self.0.tell {
            tell(self);
        }
    }

    /// Returns true if any progress was ever reported.
    pub fn has_begun(&self) -> bool {
        self.0.has_begun.load(Ordering::Relaxed)
    }

    /// Returns the number of completed steps.
    pub fn done(&self) -> usize {
        self.0.done.load(Ordering::Relaxed)
    }

    /// Returns the total number of steps; `None` while it is unknown.
    pub fn of(&self) -> Option<usize> {
        Some(self.0.of.load(Ordering::Relaxed)).filter(|&of| of > 0)
    }

    /// Asks the workers to stop.
    pub fn cancel(&self) {
        self.0.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// True after [`Progress::cancel`].
    pub fn is_cancelled(&self) -> bool {
        self.0.is_cancelled.load(Ordering::Relaxed)
    }

    /// Returns true if both track the progress of the same work.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Returns true if no other clone of the progress exists any more.
    pub(crate) fn is_alone(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }
}
