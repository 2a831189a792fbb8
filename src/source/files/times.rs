//! Times of frames, in order of precedence: those of their files, of their names, of a list next to them, and decimals
//! in their names.

use super::names::{decimals_of, is_folder_per_frame, telling_name};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::timestamps::{times_of_lines, times_of_names};
use crate::source::FrameEntry;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A list for a million scans is not as long.
const MAX_LIST_BYTES: u64 = 64 << 20;

/// Times of frames, and what was found out about lists of them.
#[derive(Debug, Default)]
pub(super) struct FoundTimes {
    pub(super) assumption: Option<Assumption>,
    /// The list that was used.
    pub(super) used: Option<PathBuf>,
    /// Sentences about lists that were not.
    pub(super) notes: Vec<String>,
}

/// Gives all `entries` a time, or none. Lists are looked for in `folders`.
pub(super) fn stamp(entries: &mut [FrameEntry], folders: &[PathBuf]) -> FoundTimes {
    let mut found = FoundTimes::default();
    if entries.iter().any(|entry| entry.time.is_some()) {
        return found;
    }
    let paths: Vec<PathBuf> = entries.iter().map(|entry| entry.path.clone()).collect();
    let is_folder_per_frame = is_folder_per_frame(&paths);
    let names: Vec<String> = entries
        .iter()
        .map(|entry| {
            if is_folder_per_frame {
                telling_name(&entry.path, true)
            } else {
                entry.name.clone()
            }
        })
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut times = times_of_names(&names);
    if times.iter().all(Option::is_none)
        && let Some((listed, list)) = times_of_list(entries, folders, &mut found.notes)
    {
        let why = format!("{} lists them", list.display());
        found.assumption = Some(assumption(&listed, why, Evidence::File));
        found.used = Some(list);
        times = listed.into_iter().map(Some).collect();
    }
    if times.iter().all(Option::is_none)
        && let Some(decimals) = times_of_decimals(&paths)
    {
        let why = "the decimals in the file names grow by plausible steps";
        found.assumption = Some(assumption(&decimals, why.to_owned(), Evidence::Statistics));
        times = decimals.into_iter().map(Some).collect();
    }
    for (entry, time) in entries.iter_mut().zip(times) {
        entry.time = time;
    }
    found
}

fn assumption(times: &[Duration], why: String, evidence: Evidence) -> Assumption {
    let [first, last] = [times.first(), times.last()].map(|time| time.copied().unwrap_or_default());
    let value = format!(
        "{:.3} s for {} frames",
        last.saturating_sub(first).as_secs_f64(),
        times.len()
    );
    Assumption::new(Subject::FrameTimes, value, why, evidence)
}

/// The times in the first list in `folders` that has one for each of `entries`: `velodyne_points/timestamps.txt` of
/// KITTI's raw recordings, `sequences/00/times.txt` of its odometry. A line per frame, by the number in its name, as
/// some recordings lack frames.
fn times_of_list(
    entries: &[FrameEntry],
    folders: &[PathBuf],
    notes: &mut Vec<String>,
) -> Option<(Vec<Duration>, PathBuf)> {
    for list in folders.iter().flat_map(|folder| lists_in(folder)) {
        let times = match read_list(&list) {
            Ok(times) => times,
            Err(reason) => {
                notes.push(format!("{} is not used for times: {reason}", list.display()));
                continue;
            }
        };
        let time_of = |entry: &FrameEntry| times.get(usize::try_from(entry.number?).ok()?).copied();
        let by_number: Option<Vec<Duration>> = entries.iter().map(time_of).collect();
        // Numbers that begin elsewhere: the first line is of the first frame, if there is one for each.
        let count = times.len();
        let Some(times) = by_number.or_else(|| (count == entries.len()).then_some(times)) else {
            notes.push(format!(
                "{} is not used for times: it has {count} lines for {} frames",
                list.display(),
                entries.len()
            ));
            continue;
        };
        return Some((times, list));
    }
    None
}

/// Lists of times in `folder` by their names, `timestamps.txt` first.
fn lists_in(folder: &Path) -> Vec<PathBuf> {
    let is_list = |path: &PathBuf| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
        let is_text = path
            .extension()
            .is_some_and(|extension| extension == "txt" || extension == "csv");
        is_text && (stem.contains("time") || stem.contains("stamp")) && !stem.contains("pose") && !stem.contains("traj")
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut lists: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_list).collect();
    let rank = |path: &PathBuf| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
        let known = ["timestamps", "times", "timestamp", "time"];
        known.iter().position(|name| *name == stem).unwrap_or(known.len())
    };
    lists.sort_by_key(|list| (rank(list), list.clone()));
    lists
}

fn read_list(path: &Path) -> Result<Vec<Duration>, String> {
    let metadata = fs::metadata(path).map_err(|error| error.to_string())?;
    if !metadata.is_file() || metadata.len() > MAX_LIST_BYTES {
        return Err("it is not a file of up to 64 MiB".to_owned());
    }
    let text = crate::regular_file::read_to_string(path).map_err(|error| error.to_string())?;
    let times = times_of_text(&text).ok_or("a line of it is not a time")?;
    if times.is_empty() || times.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err("its times do not grow".to_owned());
    }
    Ok(times)
}

/// A time per line: seconds, a date, or integer nanoseconds, microseconds or milliseconds since 1970. A file name or an
/// index may stand in front of it or after it; lines that begin with `#` and a header are not read.
fn times_of_text(text: &str) -> Option<Vec<Duration>> {
    let is_comment = |line: &str| line.trim_start().starts_with('#');
    let mut lines: Vec<&str> = text.trim_end().lines().filter(|line| !is_comment(line)).collect();
    let has_digit = |line: &&str| line.contains(|c: char| c.is_ascii_digit());
    if lines.first().is_some_and(|first| !has_digit(first)) {
        lines.remove(0);
    }
    let whole: Option<Vec<Duration>> = lines.iter().map(|line| time_of(line)).collect();
    let column = |from_end: bool| -> Option<Vec<Duration>> {
        let word = |line: &&str| {
            let mut words = line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty());
            let (first, last) = (words.next()?, words.next_back()?);
            time_of(if from_end { last } else { first })
        };
        let times: Vec<Duration> = lines.iter().map(word).collect::<Option<_>>()?;
        // The index of each line grows as well.
        let is_index = (0u64..)
            .zip(&times)
            .all(|(index, time)| *time == Duration::from_secs(index) || *time == Duration::from_secs(index + 1));
        (!is_index).then_some(times)
    };
    whole.or_else(|| column(false)).or_else(|| column(true))
}

fn time_of(text: &str) -> Option<Duration> {
    let text = text.trim();
    match text.parse::<u64>() {
        Ok(integer) => Some(match text.len() {
            18.. => Duration::from_nanos(integer),
            15..18 => Duration::from_micros(integer),
            12..15 => Duration::from_millis(integer),
            _ => Duration::from_secs(integer),
        }),
        Err(_) => times_of_lines(text)?.first().copied(),
    }
}

/// Seconds, if decimals in the names of `files` can be such: one number per name, which grows by steps of a
/// millisecond to a minute.
fn times_of_decimals(files: &[PathBuf]) -> Option<Vec<Duration>> {
    const STEPS: std::ops::RangeInclusive<f64> = 1e-3..=60.0;
    const MIN_FRAMES: usize = 3;
    let names = decimals_of(files)?;
    let changes = |column: &usize| {
        let first = names[0].numbers[*column].value;
        names.iter().any(|name| name.numbers[*column].value != first)
    };
    let mut columns = (0..names.first()?.numbers.len()).filter(changes);
    let (column, None) = (columns.next()?, columns.next()) else {
        return None;
    };
    let values: Vec<f64> = names.iter().map(|name| name.numbers[column].value).collect();
    let mut steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    let is_plausible = values.len() >= MIN_FRAMES && steps[0] > 0.0 && STEPS.contains(&steps[steps.len() / 2]);
    if !is_plausible {
        return None;
    }
    let begin = values[0].min(0.0);
    let since = |value: &f64| Duration::try_from_secs_f64(value - begin).ok();
    values.iter().map(since).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(times: Option<Vec<Duration>>) -> Option<Vec<f64>> {
        Some(times?.iter().map(Duration::as_secs_f64).collect())
    }

    #[test]
    fn lists_of_many_programs_are_read() {
        for text in [
            "0.5\n1.5\n",
            "# t\n0.5\n1.5",
            "timestamp\n0.5\n1.5",
            "0.5 a.pcd\n1.5 b.pcd",
            "0 0.5\n1 1.5",
            "0,0.5\n1,1.5\n",
            "000000.pcd 0.5\n000001.pcd 1.5",
            "0.5, 000000.pcd\n1.5, 000001.pcd",
        ] {
            assert_eq!(seconds(times_of_text(text)), Some(vec![0.5, 1.5]), "{text}");
        }
        let epoch = times_of_text("1403636579763555584\n1403636579863555584").unwrap();
        assert_eq!(epoch[0].as_secs(), 1_403_636_579);
        let epoch = times_of_text("1403636579763\n1403636579863").unwrap();
        assert_eq!(epoch[1].as_millis(), 1_403_636_579_863);
        for wrong in ["a b\nc d 1", "12 x\ny"] {
            assert_eq!(times_of_text(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn decimals_are_times_if_their_steps_are_plausible() {
        let times = |names: &[&str]| {
            let files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
            seconds(times_of_decimals(&files))
        };
        assert_eq!(
            times(&["c_0.ply", "c_0.25.ply", "c_0.5.ply"]),
            Some(vec![0.0, 0.25, 0.5])
        );
        assert_eq!(times(&["-0.5.ply", "0.ply", "0.5.ply"]), Some(vec![0.0, 0.5, 1.0]));
        assert_eq!(times(&["c_0.ply", "c_1e-05.ply", "c_2e-05.ply"]), None, "microseconds");
        assert_eq!(times(&["c_0.5.ply", "c_300.ply", "c_9000.ply"]), None);
        assert_eq!(times(&["c_0.5.ply", "c_1.5.ply"]), None, "two");
        assert_eq!(times(&["c_1.ply", "c_2.ply", "c_3.ply"]), None, "counters");
    }
}
