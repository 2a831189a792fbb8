//! Waits for other machines that are currently in progress, so that they can be shown to the user.
//!
//! **How it works.** Code that waits on a network holds a `Waiting`; there are few, as there are few connections. The
//! command line reports waits that take longer than an instant, and the window shows them.

use crate::locks::lock;
use std::sync::Mutex;
use std::time::{Duration, Instant};

static ALL: Mutex<Waits> = Mutex::new(Waits {
    current: Vec::new(),
    next: 0,
});

struct Waits {
    current: Vec<Wait>,
    next: u64,
}

/// Something that is waited for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wait {
    /// Another wait for the same data has another number.
    pub number: u64,
    /// The end of a sentence that begins with *waiting for*: the data, its source, and the timeout.
    pub what: String,
    begun: Instant,
}

/// Something is waited for until this is dropped.
#[derive(Debug)]
pub(crate) struct Waiting(u64);

impl Waiting {
    /// Starts a wait for `what`: the end of a sentence that begins with *waiting for*.
    pub(crate) fn for_(what: impl Into<String>) -> Self {
        let mut all = lock(&ALL);
        let number = all.next;
        all.next += 1;
        all.current.push(Wait {
            number,
            what: what.into(),
            begun: Instant::now(),
        });
        Self(number)
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        lock(&ALL).current.retain(|wait| wait.number != self.0);
    }
}

/// Waits that last at least so long, the longest first.
pub fn waits(at_least: Duration) -> Vec<Wait> {
    let all = lock(&ALL);
    let long = all.current.iter().filter(|wait| wait.begun.elapsed() >= at_least);
    long.cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_are_listed_until_they_end() {
        let is_there = |at_least| waits(at_least).iter().any(|wait| wait.what == "the test");
        let waiting = Waiting::for_("the test");
        assert!(is_there(Duration::ZERO) && !is_there(Duration::from_hours(1)));
        drop(waiting);
        assert!(!is_there(Duration::ZERO));
    }
}
