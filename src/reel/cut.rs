//! Messages about a truncated file.

use super::file::{Directory, FrameCut, FrameRecord};
use std::path::Path;

/// Describes how much of a truncated frame is present, and which levels of it are drawn.
pub(super) fn share_there(frame: &FrameRecord, cut: FrameCut) -> String {
    // Never rounded up to 100 %.
    let percent = (100 * cut.bytes_there).checked_div(cut.bytes).unwrap_or(0).min(99);
    let (levels, all) = (frame.counts_there().len(), frame.counts.len());
    let of_levels = if levels == all {
        format!("all {all} levels of cells, without the points in them")
    } else {
        format!("the first {levels} of {all} levels")
    };
    format!("{percent} % of the frame is there, drawn from {of_levels}")
}

/// Returns the note on the truncated last group of the file at `path`, whose first frame is `first`, with `missing`
/// frames absent.
pub(super) fn note_of_group(path: &Path, directory: &Directory, first: usize, missing: usize) -> String {
    let cut: Vec<(usize, &FrameRecord, FrameCut)> = (first..)
        .zip(&directory.frames)
        .filter_map(|(index, frame)| Some((index, frame, frame.cut?)))
        .collect();
    let mut said = Vec::new();
    if let [(index, frame, of_frame), rest @ ..] = cut.as_slice() {
        let drawn = frame.counts_there().last().copied().unwrap_or(0);
        let share = share_there(frame, *of_frame);
        said.push(format!(
            "frame {index}: {share} ({drawn} of {} points)",
            of_frame.points
        ));
        if let [.., (last, ..)] = rest {
            said.push(format!("{} drawn coarsely too", are(index + 1, last - index)));
        }
    }
    if missing > 0 {
        let from = first + directory.frames.len();
        said.push(format!("{} missing", are(from, missing)));
    }
    format!("{} ends early: {}", path.display(), said.join("; "))
}

fn frames(first: usize, last: usize) -> String {
    if first == last {
        format!("frame {first}")
    } else {
        format!("frames {first} to {last}")
    }
}

fn are(first: usize, count: usize) -> String {
    let subcommand = if count == 1 { "is" } else { "are" };
    format!("{} {subcommand}", frames(first, first + count - 1))
}
