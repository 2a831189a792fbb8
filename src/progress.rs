//! How much of some long work is done, and whether it is still wanted: what a thread that works shares with those who
//! wait for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How much of some work is done, and whether it is still wanted. Clones are of the same work.
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

/// Looks at what has become of the work.
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
    /// Of work of which `tell` hears whenever something is said of it, on the thread that says it. It must not block.
    pub fn told_to(tell: impl Fn(&Self) + Send + Sync + 'static) -> Self {
        Self(Arc::new(Shared {
            tell: Some(Box::new(tell)),
            ..Shared::default()
        }))
    }

    /// Says that `done` steps of `of` are done; `of` is 0 while nobody knows.
    pub fn set(&self, done: usize, of: usize) {
        self.0.of.store(of, Ordering::Relaxed);
        self.0.done.store(done, Ordering::Relaxed);
        self.0.has_begun.store(true, Ordering::Relaxed);
        self.tell();
    }

    /// Says that so many more steps are done. Threads may share the work.
    pub fn advance(&self, steps: usize) {
        self.0.done.fetch_add(steps, Ordering::Relaxed);
        self.tell();
    }

    fn tell(&self) {
        if let Some(tell) = &self.0.tell {
            tell(self);
        }
    }

    /// Whether anything was ever said of it.
    pub fn has_begun(&self) -> bool {
        self.0.has_begun.load(Ordering::Relaxed)
    }

    /// How many steps are done.
    pub fn done(&self) -> usize {
        self.0.done.load(Ordering::Relaxed)
    }

    /// How many steps there are; `None` while nobody knows.
    pub fn of(&self) -> Option<usize> {
        Some(self.0.of.load(Ordering::Relaxed)).filter(|&of| of > 0)
    }

    /// Asks whoever works to stop.
    pub fn cancel(&self) {
        self.0.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// True after [`Progress::cancel`].
    pub fn is_cancelled(&self) -> bool {
        self.0.is_cancelled.load(Ordering::Relaxed)
    }

    /// Whether both are of the same work.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Whether nobody else has to do with the work any more.
    pub(crate) fn is_alone(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }
}
