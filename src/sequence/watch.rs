//! Takes frames that come while a sequence is open: from a folder that a scanner writes into, or from a stream.

use super::{Sequence, SequenceError};
use crate::source::{ConnectionWatch, Live};
use std::sync::{Arc, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// Polling interval of folders: listing a folder of 10,000 files takes a few milliseconds.
const INTERVAL: Duration = Duration::from_secs(1);

/// Takes frames that come behind the last one of `sequence`, and calls `wake` then, or when the connection of a live
/// stream breaks or is back. Ends by itself some time after the sequence is dropped.
pub fn watch(sequence: &Arc<Sequence>, wake: Arc<dyn Fn() + Send + Sync>) -> Result<(), SequenceError> {
    if !sequence.source().may_grow() {
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
    let (begun, mut connection) = (Instant::now(), ConnectionWatch::default());
    let mut changes = 0;
    loop {
        // A sequence that is closed in the meantime is not kept alive.
        let Some(source) = sequence.upgrade().map(|sequence| Arc::clone(sequence.source())) else {
            return;
        };
        match source.wait_for_more(INTERVAL) {
            Ok(0) => {}
            Ok(_) => wake(),
            // A network folder comes and goes; open sequences stay.
            Err(error) => log::debug!("{error}"),
        }
        let changed = source.changed_since(changes).len();
        if changed > 0 {
            changes += changed;
            wake();
        }
        let status = source.live().map(Live::status);
        let change = status.and_then(|status| connection.look(&status, begun.elapsed()));
        if change.is_some() {
            wake();
        }
    }
}
