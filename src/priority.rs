//! Thread priorities: which threads run first when there are more than CPU cores, and which share the work of the first
//! thread.

use thread_priority::{ThreadPriority, ThreadPriorityValue, set_current_thread_priority};

/// Thread priority of background work, in the crate's hundred steps; below the medium one, which is 50: niceness 9 on
/// Linux, a tenth of the time of a thread that draws.
// Surfels of 100,000 points went from 58 to 59.4 and 60.0 of 60 fps, with 38 and 35 instead of 23 % of their points (2
// cores).
const BEHIND_DRAWING: u8 = 25;

/// Lowers the priority of the current thread below other threads of the program: it prepares frames that are drawn
/// later. A rendered frame that waits for threads which prepare others is late; those have until they are due.
pub(crate) fn go_behind_drawing() {
    // Not SCHED_IDLE: it yields at once, not after a time slice of 4 ms, but a compiler running next to the window
    // would stop the loader altogether, and a thread cannot leave that class without privileges.
    let lowered = ThreadPriorityValue::try_from(BEHIND_DRAWING)
        .ok()
        .map(|value| set_current_thread_priority(ThreadPriority::Crossplatform(value)));
    if let Some(Err(reason)) = lowered {
        log::debug!("a thread keeps its priority: {reason:?}");
    }
}

/// Has this thread do its part of the work that it distributes. Otherwise it sleeps until others have done all, which
/// must be woken first: while the threads that prepare frames occupy every core, the system lets them end their time
/// slices, and an image waits up to 4 ms.
pub(crate) fn work_with_this_thread() {
    let threads = rayon::ThreadPoolBuilder::new()
        .thread_name(|number| format!("helper {number}"))
        // When this thread slept until helpers had drawn everything, surfels of 100,000 points had 58.9 and 59.3 of 60
        // fps: in the first half second, with both cores busy, frames took 12 to 24 ms instead of 6.
        .use_current_thread()
        .build();
    match threads {
        // The pool lives as long as this thread.
        Ok(threads) => std::mem::forget(threads),
        Err(reason) => log::debug!("a thread leaves its work to others: {reason}"),
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_current_thread_joins_the_pool() {
        let shares = std::thread::Builder::new().spawn(|| {
            work_with_this_thread();
            let threads = rayon::current_num_threads();
            (rayon::current_thread_index(), threads)
        });
        let (index, threads) = shares.unwrap().join().unwrap();
        assert_eq!(index, Some(0));
        assert_eq!(threads, rayon::current_num_threads(), "the same number as elsewhere");
        assert_eq!(rayon::current_thread_index(), None, "that one alone");
    }

    #[test]
    fn the_priority_is_set_in_the_system() {
        // Field 19 of the thread's line in /proc, 17 after the name in brackets.
        let niceness = || -> i32 {
            let line = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
            let after_name = line.rsplit_once(')').unwrap().1;
            after_name.split_whitespace().nth(16).unwrap().parse().unwrap()
        };
        let before = niceness();
        let behind = std::thread::Builder::new().spawn(move || {
            go_behind_drawing();
            niceness()
        });
        let behind = behind.unwrap().join().unwrap();
        assert!(behind > before && behind >= 9, "{before} to {behind}");
        assert_eq!(niceness(), before, "this one alone");
    }
}
