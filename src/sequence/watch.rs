//! Looks for frames that come while a sequence is open: a folder that a scanner writes into is a live source.

use super::{Sequence, SequenceError};
use std::sync::{Arc, Weak};
use std::thread;
use std::time::Duration;

/// How often the inputs are looked at: listing a folder of 10,000 files takes a few milliseconds.
const INTERVAL: Duration = Duration::from_secs(1);

/// Looks at the inputs of `sequence` every second and calls `wake` when frames came behind the last one. Ends by itself some time
/// after the sequence is dropped.
pub fn watch(
    sequence: &Arc<Sequence>,
    wake: Arc<dyn Fn() + Send + Sync>,
) -> Result<(), SequenceError> {
    if !sequence.may_grow() {
        return Ok(());
    }
    let sequence = Arc::downgrade(sequence);
    thread::Builder::new()
        .name("folder watch".to_owned())
        .spawn(move || look(&sequence, &wake))
        .map(drop)
        .map_err(|reason| SequenceError::NoThread { reason })
}

fn look(sequence: &Weak<Sequence>, wake: &Arc<dyn Fn() + Send + Sync>) {
    loop {
        thread::sleep(INTERVAL);
        let Some(sequence) = sequence.upgrade() else {
            return;
        };
        match sequence.look_again() {
            Ok(0) => {}
            Ok(_) => wake(),
            // A folder on a network comes and goes; what is open stays.
            Err(error) => log::debug!("{error}"),
        }
    }
}
