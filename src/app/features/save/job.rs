//! Writing, on its own threads.

use crate::app::work::outcome::Message;
use crate::app::work::pool::PoolBehindDrawing;
use crate::app::work::works::Progress;
use crate::convert::{Conversion, ConvertError, Converted, convert};
use crate::sequence::Sequence;
use std::sync::Arc;

impl Message for SaveEnded {}

/// Outcome of writing.
#[derive(Debug)]
pub struct SaveEnded {
    pub(in crate::app) conversion: Conversion,
    pub(in crate::app) result: Result<Converted, ConvertError>,
}

/// Writes `conversion`, tells `progress` of each frame, and stops soon after that was cancelled.
pub(in crate::app) fn run(sequence: &Arc<Sequence>, conversion: Conversion, progress: &Progress) -> SaveEnded {
    let write = || convert(sequence, &conversion, progress);
    // Its threads have lower priority than drawing and playback.
    let mut pool = PoolBehindDrawing::default();
    let result = match pool.get("save", 0) {
        Some(threads) => threads.install(write),
        None => write(),
    };
    SaveEnded { conversion, result }
}
