//! Reports waits for other machines on stderr, so that they are not mistaken for a hang.

use super::output::say;
use crate::waiting::waits;
use std::thread;
use std::time::Duration;

/// Shorter waits are not reported.
const MIN_SHOWN: Duration = Duration::from_secs(2);

/// Between looks.
const LOOK: Duration = Duration::from_millis(500);

/// Starts to report waits, each once.
pub(in crate::cli) fn say_them() {
    let watching = thread::Builder::new().name("waits".to_owned()).spawn(|| {
        let mut next = 0;
        loop {
            thread::sleep(LOOK);
            let waits = waits(MIN_SHOWN);
            // A wait that began later has a higher number, and is reported later.
            for wait in waits.iter().filter(|wait| wait.number >= next) {
                say(&format!("waiting for {}", wait.what));
            }
            next = waits.iter().map(|wait| wait.number + 1).fold(next, u64::max);
        }
    });
    if let Err(error) = watching {
        log::debug!("waits are not reported: {error}");
    }
}
