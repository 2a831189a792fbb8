//! Division of a table into frames.

use super::frames::{self, BlockEvidence, Counter, Frame, Groups, guessed_seconds, is_of_lidar};
use super::parsed::Parsed;
use crate::assumption::{Assumption, Evidence, Subject};

/// The frames of a table; none where all rows are one.
pub(super) fn divide(parsed: &Parsed, assumptions: &mut Vec<Assumption>, warnings: &mut Vec<String>) -> Vec<Frame> {
    let assume = |value: String, why: &str, evidence| {
        Assumption::new(Subject::Frames, value, why, evidence).with_option(Some("--columns"))
    };
    if parsed.naming.frame == Some(None) {
        return Vec::new();
    }
    if let Some(counted) = &parsed.counted {
        let mut starts = Vec::new();
        let mut rows = 0;
        for block in &counted.blocks {
            rows += block.rows;
            starts.push(rows);
        }
        starts.pop();
        // Unusual lines are not counted: blocks cannot be distinguished then.
        if starts.is_empty() || rows != parsed.rows.len() {
            return Vec::new();
        }
        let comments: Vec<String> = counted.blocks.iter().map(|block| block.comment.clone()).collect();
        // Extended XYZ comments that describe all frames do not name any of them.
        let is_name = |comment: &&String| !comment.contains("Lattice=") && !comment.contains("Properties=");
        let name = |comment: &String| Some(comment).filter(is_name).cloned().unwrap_or_default();
        let names: Vec<String> = comments.iter().map(name).collect();
        let mut found = frames::of_blocks(&starts, rows, &names);
        if let Some(times) = frames::times_in(&comments) {
            for (frame, time) in found.iter_mut().zip(times) {
                frame.time = Some(time);
            }
        }
        let why = "each block has a line that counts its points before it";
        assumptions.push(assume(format!("{} blocks of rows", found.len()), why, Evidence::File));
        return found;
    }
    if let Some(found) = by_column(parsed, assumptions, warnings) {
        return found;
    }
    by_breaks(parsed, assumptions)
}

/// Frames by a column, if there is one for them.
fn by_column(parsed: &Parsed, assumptions: &mut Vec<Assumption>, warnings: &mut Vec<String>) -> Option<Vec<Frame>> {
    let given = parsed.naming.frame.flatten();
    let counter = |column: usize| {
        let raw = parsed
            .raw_names
            .get(column)
            .filter(|_| parsed.raw_names.len() == parsed.names.len());
        Counter::of(raw.unwrap_or(&parsed.names[column]))
    };
    let columns = || (0..parsed.names.len()).filter(|column| !parsed.naming.positions.contains(column));
    let of_kind = |is: fn(Counter) -> bool| columns().find(|&column| counter(column).is_some_and(is));
    let numbered = of_kind(|counter| counter == Counter::Frames);
    let timed = of_kind(|counter| matches!(counter, Counter::Times(_)));
    let stamped = of_kind(|counter| matches!(counter, Counter::Points(_)));
    let positions = parsed.naming.positions.map(|axis| parsed.rows.columns[axis].as_slice());
    for column in given.into_iter().chain(numbered).chain(timed).chain(stamped) {
        let name = &parsed.names[column];
        let Some(groups) = Groups::of(&parsed.rows.columns[column]) else {
            continue;
        };
        let count = groups.len();
        let mean = groups.mean_rows();
        let (is_sequence, evidence) = match counter(column) {
            _ if given == Some(column) => (true, Evidence::File),
            Some(Counter::Times(unit)) => {
                let is_of_lidar = is_of_lidar(&parsed.names);
                let seconds = unit.unwrap_or_else(|| guessed_seconds(&parsed.rows.columns[column]).0);
                let are_frames = groups.are_times_of_frames(seconds, is_of_lidar, positions);
                (are_frames, Evidence::Statistics)
            }
            Some(Counter::Points(_)) => (false, Evidence::Convention),
            _ => (groups.are_numbers_of_frames(), Evidence::File),
        };
        if !is_sequence {
            let mut assumption = Assumption::new(
                Subject::Frames,
                "one",
                format!(
                    "column `{name}` has {count} values for {} points: they are those of points",
                    parsed.rows.len()
                ),
                // One value per point has only one interpretation, and the clock of a LiDAR stamps points.
                if mean < 1.5 || evidence == Evidence::Convention {
                    Evidence::Convention
                } else {
                    Evidence::Statistics
                },
            );
            assumption.option = Some("--columns");
            assumptions.push(assumption);
            continue;
        }
        let seconds = match counter(column) {
            Some(Counter::Times(unit) | Counter::Points(unit)) => Some(unit.unwrap_or_else(|| {
                let (seconds, unit) = guessed_seconds(&parsed.rows.columns[column]);
                assumptions.push(Assumption::new(
                    Subject::FrameTimes,
                    format!("`{name}` is in {unit}"),
                    "the size of its values",
                    Evidence::Statistics,
                ));
                seconds
            })),
            _ => None,
        };
        if groups.without > 0 {
            warnings.push(format!(
                "{} points have no `{name}` and are in no frame",
                groups.without
            ));
        }
        // A choice of the user is not an assumption.
        if given != Some(column) {
            let why = format!("column `{name}` has {count} values, for {mean:.0} points each");
            let assumption = Assumption::new(Subject::Frames, count.to_string(), why, evidence);
            assumptions.push(assumption.with_option(Some("--columns")));
        }
        let no_words = Vec::new();
        let words = parsed.rows.words.get(column).unwrap_or(&no_words);
        let mut found = groups.frames(name, seconds, words);
        // A frame column may have a time column next to it.
        if seconds.is_none()
            && let Some(timed) = timed.filter(|timed| *timed != column)
        {
            take_times(&mut found, &parsed.rows.columns[timed], counter(timed));
        }
        return Some(found);
    }
    None
}

/// The times of frames in another column, if they are one for each, and grow.
fn take_times(frames: &mut [Frame], values: &[f64], counter: Option<Counter>) {
    let seconds = match counter {
        Some(Counter::Times(Some(seconds))) => seconds,
        _ => guessed_seconds(values).0,
    };
    let time = |frame: &Frame| {
        let row = match &frame.rows {
            frames::Rows::Range(range) => range.start,
            frames::Rows::List(rows) => *rows.first()? as usize,
        };
        std::time::Duration::try_from_secs_f64(values[row] * seconds).ok()
    };
    let times: Option<Vec<std::time::Duration>> = frames.iter().map(time).collect();
    if let Some(times) = times.filter(|times| times.is_sorted_by(|one, next| one < next)) {
        for (frame, time) in frames.iter_mut().zip(times) {
            frame.time = Some(time);
        }
    }
}

/// Frames between empty lines, comments or counts.
fn by_breaks(parsed: &Parsed, assumptions: &mut Vec<Assumption>) -> Vec<Frame> {
    /// Fewer comments are remarks.
    const MIN_COMMENTS: usize = 2;
    let rows = parsed.rows.len();
    let counts: Vec<usize> = parsed.rows.lones.iter().map(|lone| lone.row).collect();
    let breaks = &parsed.rows.breaks;
    let is_inside = |row: usize| row > 0 && row < rows;
    let comments = breaks
        .iter()
        .filter(|found| is_inside(found.row) && !found.label.is_empty())
        .count();
    let has_counts = !counts.is_empty() && !parsed.is_one_cloud;
    let starts = if has_counts {
        counts
    } else {
        frames::starts_of(breaks, rows)
    };
    if starts.is_empty() || (comments > 0 && comments < MIN_COMMENTS && !has_counts) {
        return Vec::new();
    }
    let positions = parsed.naming.positions.map(|axis| parsed.rows.columns[axis].as_slice());
    let between = if has_counts {
        "counts of points"
    } else {
        "empty lines or comments"
    };
    let evidence = frames::evidence(&starts, positions);
    let blocks = starts.len() + 1;
    let (value, why) = match evidence {
        BlockEvidence::Overlap => (
            blocks.to_string(),
            format!("blocks of rows between {between} lie on each other"),
        ),
        BlockEvidence::Isolines => (
            "one".to_owned(),
            format!("{blocks} blocks of rows are lines of constant x or y"),
        ),
        BlockEvidence::Apart => (
            "one".to_owned(),
            format!("{blocks} blocks of rows between {between} lie apart"),
        ),
    };
    let assumption = Assumption::new(Subject::Frames, value, why, Evidence::Statistics);
    let option = if evidence == BlockEvidence::Overlap {
        Some("--columns")
    } else {
        None
    };
    assumptions.push(assumption.with_option(option));
    if evidence != BlockEvidence::Overlap {
        return Vec::new();
    }
    // The comment before a block names it, including the first one.
    let label = |row: usize| {
        let before = breaks.iter().find(|found| found.row == row);
        before.map_or_else(String::new, |found| found.label.clone())
    };
    let mut labels: Vec<String> = std::iter::once(0).chain(starts.iter().copied()).map(label).collect();
    if labels[1..].iter().all(|label| !label.is_empty()) {
        labels[0].clone_from(&parsed.title);
    }
    let mut found = frames::of_blocks(&starts, rows, &labels);
    if let Some(times) = frames::times_in(&labels) {
        for (frame, time) in found.iter_mut().zip(times) {
            frame.time = Some(time);
        }
    }
    found
}
