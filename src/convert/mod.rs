//! Conversion of the frames of a sequence: to another format, transformed, downsampled, with normals.
//!
//! **How it works.** Each frame is read, edited ([`Edit`]) and written on its own, with as many frames in parallel as
//! there are cores, so that a sequence of any length takes the memory of a few frames. A frame is written under a
//! hidden name and renamed when it is complete: visible files are complete. Files keep the names of their sources
//! (`convert::names`). Options and finished frames are recorded next to the frames ([`Record`]): a conversion that was
//! interrupted and is started again resumes; a folder of another conversion, a foreign file, and an output that is the
//! input are refused before anything is written. Shards take every n-th frame, on any machine.
//!
//! Alternatively all frames go into one sequence file (`convert::reel`). The size and error of either is estimated
//! beforehand, from a few frames (`convert::estimate`), and the output location is checked ([`Place`]). What a target
//! cannot hold is counted ([`crate::io::Losses`]).

mod conversion;
mod edit;
mod error;
mod estimate;
mod folder;
mod frame;
mod join;
mod lock;
mod merging;
mod names;
mod place;
mod rate_control;
mod rate_goal;
mod record;
mod reel;

pub use conversion::{Conversion, Converted, Output, Shard};
pub use edit::{Edit, EditError};
pub use error::ConvertError;
pub use estimate::{Estimate, EstimatedErrors, OtherWay, SampleEstimate, SampleFrame, Target, source_bytes};
pub use join::{Joined, join, parts_of};
pub use merging::MergePrice;
pub use place::{Place, SourceFiles, source_at};
pub use rate_control::ChosenRate;
pub use rate_goal::RateGoal;
pub use record::Record;

use self::frame::write_frame;
use crate::messages::missing_frames;
use crate::progress::Progress;
use crate::sequence::Sequence;
use std::path::Path;
use std::time::Duration;

/// Converts frames of `sequence`; `progress` counts those that are done, on several threads, and may be cancelled.
///
/// # Errors
/// Errors of all frames; errors of single frames are in [`Converted::failed`].
pub fn convert(sequence: &Sequence, conversion: &Conversion, progress: &Progress) -> Result<Converted, ConvertError> {
    let frames = chosen_frames(sequence, conversion)?;
    if let Some(input) = source_at(&conversion.output, sequence) {
        let (Output::File(path) | Output::Folder(path) | Output::Reel(path, _)) = &conversion.output;
        return Err(ConvertError::OutputIsInput {
            path: path.clone(),
            input,
        });
    }
    let mut converted = match conversion.goal {
        Some(goal) => convert_to_goal(sequence, conversion, goal, frames, progress)?,
        None => convert_frames(sequence, conversion, frames, progress)?,
    };
    converted.notes.extend(cameras_note(sequence));
    Ok(converted)
}

/// Chooses the precision of a sequence file for a goal, and writes with it; other files have none.
fn convert_to_goal(
    sequence: &Sequence,
    conversion: &Conversion,
    goal: RateGoal,
    frames: Vec<usize>,
    progress: &Progress,
) -> Result<Converted, ConvertError> {
    let Output::Reel(path, options) = &conversion.output else {
        return convert_frames(sequence, conversion, frames, progress);
    };
    let Some(chosen) = goal.choose(sequence, &frames, &conversion.edit, options, progress)? else {
        return Ok(Converted {
            is_cancelled: true,
            ..Converted::default()
        });
    };
    let note = goal.note(&chosen, frames.len());
    let conversion = Conversion {
        output: Output::Reel(path.to_owned(), chosen.options),
        ..conversion.clone()
    };
    let mut converted = convert_frames(sequence, &conversion, frames, progress)?;
    converted.notes.push(note);
    if conversion.shard == Shard::WHOLE && !converted.is_cancelled {
        let written = path.metadata().ok();
        let excess = written.and_then(|file| rate_control::excess_note(goal, file.len()));
        converted.notes.extend(excess);
    }
    Ok(converted)
}

/// Returns a note about the data of a whole input that no target holds.
fn cameras_note(sequence: &Sequence) -> Option<String> {
    let source = sequence.source();
    if sequence.is_empty() {
        return None;
    }
    let first = source.frames().start.min(sequence.len() - 1);
    let what = if source.posed_images(first).is_some() {
        "images and their cameras"
    } else if source.sensor(first).is_some() {
        "images, intrinsics and poses of the depth camera"
    } else {
        return None;
    };
    Some(format!(
        "{what} are not written: only points are, in the coordinates of each frame"
    ))
}

fn convert_frames(
    sequence: &Sequence,
    conversion: &Conversion,
    frames: Vec<usize>,
    progress: &Progress,
) -> Result<Converted, ConvertError> {
    let Shard { index, count } = conversion.shard;
    match &conversion.output {
        Output::Reel(path, options) => reel::convert(sequence, conversion, path, options, &frames, progress),
        Output::Folder(folder) => {
            let frames: Vec<usize> = frames.into_iter().filter(|frame| frame % count == index).collect();
            folder::convert(sequence, conversion, folder, &frames, progress)
        }
        Output::File(path) => {
            let frames: Vec<usize> = frames.into_iter().filter(|frame| frame % count == index).collect();
            convert_to_file(sequence, conversion, path, &frames, progress)
        }
    }
}

/// The requested frames, all of which exist.
fn chosen_frames(sequence: &Sequence, conversion: &Conversion) -> Result<Vec<usize>, ConvertError> {
    let Some(range) = &conversion.frames else {
        return Ok((0..sequence.len()).collect());
    };
    let missing = missing_frames("--frames", *range.start(), *range.end(), sequence.len());
    match missing {
        Some(missing) => Err(ConvertError::NoSuchFrames(missing)),
        None => Ok(range.clone().collect()),
    }
}

/// The one frame of a file.
fn convert_to_file(
    sequence: &Sequence,
    conversion: &Conversion,
    path: &Path,
    frames: &[usize],
    progress: &Progress,
) -> Result<Converted, ConvertError> {
    if !conversion.overwrites && path.symlink_metadata().is_ok() {
        return Err(ConvertError::Exists {
            path: path.to_owned(),
            more: 0,
        });
    }
    progress.set(0, frames.len());
    let mut converted = Converted::default();
    for &frame in frames {
        match write_frame(sequence, conversion, frame, path, |_| Ok(())) {
            Ok(written) => {
                converted.take(frame, written);
                let note =
                    |time: Duration| format!("the time of the frame, {} s, is not in the file", time.as_secs_f64());
                converted.notes.extend(sequence.entry(frame).time.map(note));
            }
            Err(error) => converted.failed.push((frame, error)),
        }
        progress.advance(1);
    }
    Ok(converted)
}

#[cfg(test)]
mod tests;
