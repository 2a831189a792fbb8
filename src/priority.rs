//! Which threads go first where there are more than processors.

use thread_priority::{ThreadPriority, ThreadPriorityValue, set_current_thread_priority};

/// Below the middle, which is 50, in the crate's hundred steps: niceness 10 on Linux, a tenth of the time of a thread that draws.
const BEHIND_DRAWING: u8 = 25;

/// Lets other threads of the program go before this one: it prepares what is drawn later. A picture that waits for threads which prepare
/// others is late; those have until they are due.
pub(crate) fn go_behind_drawing() {
    let lowered = ThreadPriorityValue::try_from(BEHIND_DRAWING)
        .ok()
        .map(|value| set_current_thread_priority(ThreadPriority::Crossplatform(value)));
    if let Some(Err(reason)) = lowered {
        log::debug!("a thread keeps its priority: {reason:?}");
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_system_knows_of_it() {
        // Field 19 of the thread's line in /proc, 17 after the name in brackets.
        let niceness = || -> i32 {
            let line = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
            let after_name = line.rsplit_once(')').unwrap().1;
            after_name
                .split_whitespace()
                .nth(16)
                .unwrap()
                .parse()
                .unwrap()
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
