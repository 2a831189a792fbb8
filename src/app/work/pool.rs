//! Threads that prepare frames that are drawn later.

use crate::priority;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads with a lower priority than those that draw. They are created on demand.
#[derive(Debug, Default)]
pub(in crate::app) struct PoolBehindDrawing(Option<ThreadPool>);

impl PoolBehindDrawing {
    /// A pool of `threads` threads, or one per CPU with 0, all of them called `name`; `None` where the system has no
    /// more.
    pub(in crate::app) fn get(&mut self, name: &'static str, threads: usize) -> Option<&ThreadPool> {
        if self.0.is_none() {
            self.0 = ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(move |_| name.to_owned())
                .start_handler(|_| priority::go_behind_drawing())
                .build()
                .inspect_err(|reason| log::warn!("no thread for {name}: {reason}"))
                .ok();
        }
        self.0.as_ref()
    }
}
