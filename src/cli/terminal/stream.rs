//! Connection events of a live stream, on stderr.

use super::output::say;
use crate::sequence::Sequence;
use crate::source::{ConnectionWatch, Live};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// Between looks at the connection.
const LOOK: Duration = Duration::from_millis(200);

/// Says when the connection breaks and when it is back, as long as `sequence` is there; nothing of others than streams.
/// A window says that itself.
pub(in crate::cli) fn tell_of_connection(sequence: &Sequence) {
    let source = sequence.source();
    if source.live().is_none() {
        return;
    }
    let stream = source.inputs().first().map(|input| input.display().to_string());
    let (stream, source) = (stream.unwrap_or_default(), Arc::downgrade(source));
    let watching = thread::Builder::new().name("stream watch".to_owned()).spawn(move || {
        let (begun, mut watch) = (Instant::now(), ConnectionWatch::default());
        loop {
            // A stream that is closed in the meantime is not kept alive.
            let Some(source) = source.upgrade() else { return };
            let status = source.live().map(Live::status);
            drop(source);
            let change = status.and_then(|status| watch.look(&status, begun.elapsed()));
            if let Some(change) = change {
                say(&format!("{stream}: {change}"));
            }
            thread::sleep(LOOK);
        }
    });
    if let Err(error) = watching {
        log::debug!("the connection is not watched: {error}");
    }
}
