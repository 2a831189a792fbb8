//! A file per frame in a folder.

use super::conversion::{Conversion, Converted};
use super::error::ConvertError;
use super::frame::{WrittenFrame, write_frame};
use super::lock;
use super::names::FileNames;
use super::record::{self, FrameState, Ledger, Record, StateBefore};
use crate::progress::Progress;
use crate::sequence::Sequence;
use rayon::prelude::*;
use std::fs;
use std::path::Path;

/// Converts `frames` of `sequence` into files of `folder`.
pub(super) fn convert(
    sequence: &Sequence,
    conversion: &Conversion,
    folder: &Path,
    frames: &[usize],
    progress: &Progress,
) -> Result<Converted, ConvertError> {
    let names = FileNames::of(sequence, conversion.format.extension());
    let record = Record::of(conversion, sequence);
    if !conversion.overwrites {
        record.check(folder)?;
    }
    fs::create_dir_all(folder).map_err(|reason| ConvertError::Write {
        path: folder.to_owned(),
        reason,
    })?;
    let _lock = lock::lock(&record::lock_of(folder, conversion.shard), folder)?;
    // Another process may have written to it before this one got the lock.
    let mut ledger = Ledger::read(folder, &record);
    let left = if conversion.overwrites {
        Vec::new()
    } else {
        record.check(folder)?;
        finished_frames(sequence, &ledger, &names, folder, frames)?
    };
    record.keep_in(folder)?;
    ledger.open(conversion.shard)?;
    progress.set(left.len(), frames.len());
    let rest: Vec<usize> = frames
        .iter()
        .copied()
        .filter(|frame| left.binary_search(frame).is_err())
        .collect();
    let convert_one = |frame: usize| -> Option<Result<WrittenFrame, ConvertError>> {
        if progress.is_cancelled() {
            return None;
        }
        let entry = sequence.entry(frame);
        let before = StateBefore::of(&entry);
        let name = names.name(frame);
        let note = |bytes: u64| ledger.note(name, bytes, &entry, before);
        let written = write_frame(sequence, conversion, frame, &folder.join(name), note);
        progress.advance(1);
        Some(written)
    };
    let outcomes: Vec<_> = rest.par_iter().map(|&frame| (frame, convert_one(frame))).collect();
    let mut converted = Converted {
        left: left.len(),
        notes: names.note.into_iter().collect(),
        ..Converted::default()
    };
    for (frame, outcome) in outcomes {
        match outcome {
            Some(Ok(written)) => converted.take(frame, written),
            Some(Err(error)) => converted.failed.push((frame, error)),
            None => converted.is_cancelled = true,
        }
    }
    Ok(converted)
}

/// The frames that need not be written again, in their order. Fails if a foreign file has the name of a frame.
fn finished_frames(
    sequence: &Sequence,
    ledger: &Ledger,
    names: &FileNames,
    folder: &Path,
    frames: &[usize],
) -> Result<Vec<usize>, ConvertError> {
    let mut finished = Vec::new();
    let mut foreign = Vec::new();
    for &frame in frames {
        match ledger.state(names.name(frame), &sequence.entry(frame)) {
            FrameState::Finished => finished.push(frame),
            FrameState::Foreign => foreign.push(frame),
            FrameState::Free | FrameState::Outdated => {}
        }
    }
    match foreign.as_slice() {
        [] => Ok(finished),
        [first, more @ ..] => Err(ConvertError::Exists {
            path: folder.join(names.name(*first)),
            more: more.len(),
        }),
    }
}
