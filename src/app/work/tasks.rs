//! Tasks on their own threads.
//!
//! **How it works.** The result of a task is converted into the one type `T` that the window understands, and goes
//! through one bounded channel; then the window is woken. Each feature knows only the results of its own tasks, and
//! requires that `T` can be made of them; the window's is [`super::outcome::Outcome`].

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

/// Wakes the event loop from any thread. Must not block.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Outcomes that wait for the window; a task that finds it full waits in its own thread.
const CHANNEL_LENGTH: usize = 64;

/// A task failed; the text names it and the reason, for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskFailed(pub String);

/// Outcome of a task. Every task may fail.
pub trait TaskOutcome: From<TaskFailed> + Send + 'static {}

impl<T: From<TaskFailed> + Send + 'static> TaskOutcome for T {}

/// Starts tasks and collects their results.
pub struct Tasks<T> {
    sender: SyncSender<T>,
    receiver: Receiver<T>,
    wake: Wake,
    /// Tasks that were started and have not been taken.
    under_way: AtomicUsize,
}

impl<T> std::fmt::Debug for Tasks<T> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Tasks").finish_non_exhaustive()
    }
}

impl<T: TaskOutcome> Tasks<T> {
    /// No tasks yet; `wake` is called after each one.
    pub fn new(wake: Wake) -> Self {
        let (sender, receiver) = sync_channel(CHANNEL_LENGTH);
        let under_way = AtomicUsize::new(0);
        Self {
            sender,
            receiver,
            wake,
            under_way,
        }
    }

    /// Returns the wake callback of the window, for a task that has news before it ends.
    pub(in crate::app) fn wake(&self) -> Wake {
        Arc::clone(&self.wake)
    }

    /// Runs `task` on a thread called `name`.
    pub fn start<O>(&self, name: &str, task: impl FnOnce() -> O + Send + 'static)
    where
        T: From<O>,
    {
        self.under_way.fetch_add(1, Ordering::Relaxed);
        let sender = self.sender.clone();
        let wake = Arc::clone(&self.wake);
        let started = thread::Builder::new().name(name.to_owned()).spawn(move || {
            // If the window was closed in the meantime, there is no receiver any more.
            if sender.send(task().into()).is_ok() {
                wake();
            }
        });
        if let Err(reason) = started {
            let failed = TaskFailed(format!(
                "no thread could be started for {name} ({reason}): close other programs"
            ));
            if self.sender.try_send(failed.into()).is_ok() {
                (self.wake)();
            }
        }
    }

    /// Runs `task`, which may fail, on a thread called `name`.
    pub(in crate::app) fn try_start<O>(&self, name: &str, task: impl FnOnce() -> Result<O, TaskFailed> + Send + 'static)
    where
        T: From<O>,
    {
        self.start(name, move || match task() {
            Ok(outcome) => T::from(outcome),
            Err(failed) => failed.into(),
        });
    }

    /// Runs `task` on a thread of `pool`, where the work that it distributes stays.
    pub(in crate::app) fn start_in<O>(&self, pool: &rayon::ThreadPool, task: impl FnOnce() -> O + Send + 'static)
    where
        T: From<O>,
    {
        self.under_way.fetch_add(1, Ordering::Relaxed);
        let sender = self.sender.clone();
        let wake = Arc::clone(&self.wake);
        pool.spawn(move || {
            if sender.send(task().into()).is_ok() {
                wake();
            }
        });
    }

    /// Takes the outcomes received since the last call.
    pub(in crate::app) fn take(&mut self) -> Vec<T> {
        let taken: Vec<T> = self.receiver.try_iter().collect();
        self.under_way.fetch_sub(taken.len(), Ordering::Relaxed);
        taken
    }

    /// Returns true if all started tasks have ended and their outcomes were taken.
    pub(in crate::app) fn are_done(&self) -> bool {
        self.under_way.load(Ordering::Relaxed) == 0
    }
}

/// Drops `value` on a thread, so that waits in its destructor do not block the window.
pub(in crate::app) fn close(value: impl Send + 'static) {
    let started = thread::Builder::new()
        .name("close sequence".to_owned())
        .spawn(move || drop(value));
    if let Err(reason) = started {
        log::warn!("no thread for closing a sequence: {reason}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq)]
    enum TestOutcome {
        Number(u8),
        Failed(String),
    }

    impl From<u8> for TestOutcome {
        fn from(number: u8) -> Self {
            Self::Number(number)
        }
    }

    impl From<TaskFailed> for TestOutcome {
        fn from(TaskFailed(text): TaskFailed) -> Self {
            Self::Failed(text)
        }
    }

    #[test]
    fn outcomes_arrive_with_a_wake_up() {
        let (woken, wakes) = sync_channel(1);
        let mut tasks = Tasks::<TestOutcome>::new(Arc::new(move || woken.send(()).unwrap()));
        tasks.start("number", || 7);
        wakes.recv().unwrap();
        assert!(!tasks.are_done());
        assert_eq!(tasks.take(), [TestOutcome::Number(7)]);
        assert!(tasks.are_done());
        tasks.try_start("nothing", || -> Result<u8, _> {
            Err(TaskFailed("it is too late".to_owned()))
        });
        wakes.recv().unwrap();
        assert_eq!(tasks.take(), [TestOutcome::Failed("it is too late".to_owned())]);
        assert_eq!(tasks.take(), []);
    }
}
