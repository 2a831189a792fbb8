//! Frames of one sequence written anew: in another format, moved, thinned out, with normals.
//!
//! **How it works.** Each frame is read, edited ([`Edit`]) and written by itself, as many at a time as there are cores,
//! so that a sequence of any length takes the memory of a few frames. A frame is written under a hidden name and
//! renamed when it is whole: what stands in the folder is finished. Who is interrupted and starts again finds finished
//! frames and leaves them, unless their source has changed since, or the options: those are kept beside the frames
//! ([`Record`]), and a folder that holds a conversion with others is refused. Shards take every n-th frame, whoever
//! runs them.
//!
//! Or all frames go into one sequence file (`convert::reel`). What either comes to is estimated beforehand, by a few
//! frames (`convert::estimate`), and looked for where it would be written ([`Place`]).

mod conversion;
mod edit;
mod error;
mod estimate;
mod place;
mod record;
mod reel;

pub use conversion::{Conversion, Converted, Output, Shard};
pub use edit::{Edit, EditError};
pub use error::ConvertError;
pub use estimate::{Estimate, EstimatedErrors, SampleEstimate, SampleFrame, Target, source_bytes};
pub use place::Place;
pub use record::Record;
pub use reel::join;

use self::conversion::is_finished;
use crate::kept;
use crate::progress::Progress;
use crate::sequence::Sequence;
use rayon::prelude::*;
use std::fs;

/// Converts frames of `sequence`; `progress` counts those that are done, on several threads, and may be cancelled.
///
/// # Errors
/// What concerns all frames; what concerns one is in [`Converted::failed`].
pub fn convert(sequence: &Sequence, conversion: &Conversion, progress: &Progress) -> Result<Converted, ConvertError> {
    if let Output::Folder(folder) = &conversion.output {
        fs::create_dir_all(folder).map_err(|reason| ConvertError::Write {
            path: folder.clone(),
            reason,
        })?;
        Record::of(conversion, sequence).keep_in(folder, conversion.overwrites)?;
    }
    let last = sequence.len().saturating_sub(1);
    let range = conversion.frames.clone().unwrap_or(0..=last);
    let Shard { index, count } = conversion.shard;
    let frames: Vec<usize> = range.filter(|frame| *frame <= last).collect();
    if let Output::Reel(path, options) = &conversion.output {
        let share = reel::share(&frames, conversion.shard);
        return reel::convert(sequence, conversion, (path, options), share, progress);
    }
    let frames: Vec<usize> = frames.into_iter().filter(|frame| frame % count == index).collect();
    progress.set(0, frames.len());
    let outcomes: Vec<(usize, Option<Result<FrameOutcome, ConvertError>>)> = frames
        .par_iter()
        .map(|&frame| {
            if progress.is_cancelled() {
                return (frame, None);
            }
            let outcome = convert_frame(sequence, frame, conversion);
            progress.advance(1);
            (frame, Some(outcome))
        })
        .collect();
    let mut converted = Converted::default();
    for (frame, outcome) in outcomes {
        match outcome {
            Some(Ok(FrameOutcome::Written { warnings, lost })) => {
                converted.written += 1;
                converted.lost.extend(lost);
                let warnings = warnings.into_iter().map(|warning| (frame, warning));
                converted.warnings.extend(warnings);
            }
            Some(Ok(FrameOutcome::Left)) => converted.left += 1,
            Some(Err(error)) => converted.failed.push((frame, error)),
            None => converted.is_cancelled = true,
        }
    }
    Ok(converted)
}

/// What became of a frame.
enum FrameOutcome {
    /// It was written, without what the warnings name, and what the format has no place for.
    Written {
        warnings: Vec<String>,
        lost: Vec<&'static str>,
    },
    /// It was finished before.
    Left,
}

fn convert_frame(sequence: &Sequence, index: usize, conversion: &Conversion) -> Result<FrameOutcome, ConvertError> {
    let entry = sequence.entry(index);
    let path = match &conversion.output {
        Output::File(path) | Output::Reel(path, _) => path.clone(),
        Output::Folder(folder) => {
            let stem = match entry.time {
                // As long as seconds since 1970, so that it is read as a time and not as a number.
                Some(time) => format!("frame_{index:06}_{:010}.{:09}", time.as_secs(), time.subsec_nanos()),
                None => format!("frame_{index:06}"),
            };
            folder.join(format!("{stem}.{}", conversion.format.extension()))
        }
    };
    if !conversion.overwrites && is_finished(&path, &entry) {
        return Ok(FrameOutcome::Left);
    }
    let cloud = conversion.edited(sequence, index)?;
    kept::write_whole_with(&path, |file| {
        crate::io::write(&mut *file, conversion.format, &cloud)?;
        // On the disk before it has its name: what stands in the folder is finished, whatever happens to the machine.
        file.sync_data()
    })
    .map_err(|reason| ConvertError::Write { path, reason })?;
    let lost = conversion.format.lost(&cloud).collect();
    Ok(FrameOutcome::Written {
        warnings: cloud.warnings,
        lost,
    })
}

#[cfg(test)]
mod tests;
