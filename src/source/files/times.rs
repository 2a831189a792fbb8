//! Times of frames, in order of precedence: from their files, from their names, from a list next to them, and decimals
//! in their names.

use super::names::{decimals_of, is_folder_per_frame, telling_name};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::files::timestamps::{time_of_number, times_of_names};
use crate::messages::grouped;
use crate::source::FrameEntry;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A list for a million scans is not as long.
const MAX_LIST_BYTES: u64 = 64 << 20;

/// Times of frames, and the findings about lists of them.
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
    let named: Vec<Duration> = times.iter().copied().flatten().collect();
    if !named.is_empty() {
        let why = "the file names are times".to_owned();
        found.assumption = Some(assumption(&named, why, Evidence::Convention));
    }
    if times.iter().all(Option::is_none)
        && let Some((listed, list)) = times_of_list(entries, folders, &mut found.notes)
    {
        found.assumption = Some(self::listed(&listed, &list));
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

/// Returns the assumption reported for timestamps read from the file `list`.
pub(super) fn listed(times: &[Duration], list: &Path) -> Assumption {
    assumption(times, format!("{} lists them", list.display()), Evidence::File)
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
            Ok((times, bad)) => {
                notes.extend(bad.map(|lines| format!("{}: {lines}", list.display())));
                times
            }
            Err(reason) => {
                notes.push(format!("{} is not used for times: {reason}", list.display()));
                continue;
            }
        };
        let time_of = |entry: &FrameEntry| times.get(usize::try_from(entry.number?).ok()?).copied();
        let by_number: Option<Vec<Duration>> = entries.iter().map(time_of).collect();
        // If numbers start elsewhere, the first line is for the first frame, provided that there is one for each.
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

/// The times in a list, and a sentence about those missing from it.
fn read_list(path: &Path) -> Result<(Vec<Duration>, Option<String>), String> {
    let metadata = fs::metadata(path).map_err(|error| error.to_string())?;
    if !metadata.is_file() || metadata.len() > MAX_LIST_BYTES {
        return Err("it is not a file of up to 64 MiB".to_owned());
    }
    let text = crate::regular_file::read_to_string(path).map_err(|error| error.to_string())?;
    let mut times = times_of_text(&text).ok_or("a line of it is not a time")?;
    let bad = mend(&mut times).ok_or("its times do not grow")?;
    let times: Vec<Duration> = times.into_iter().flatten().collect();
    if times.is_empty() {
        return Err("its times do not grow".to_owned());
    }
    let note = match bad.as_slice() {
        [] => None,
        [one] => Some(format!(
            "time {} of {} is none, or before the one in front of it: its frame is shown between its neighbours",
            grouped(one),
            grouped(times.len())
        )),
        many => Some(format!(
            "{} of {} times are none, or before those in front of them, the first is time {}: their frames are shown \
             between their neighbours",
            grouped(many.len()),
            grouped(times.len()),
            grouped(many[0])
        )),
    };
    Ok((times, note))
}

/// Puts times between their neighbours that are none or go back, if they are few: at most a tenth, or one. Which
/// these are, from 1; `None` if they are many.
fn mend(times: &mut [Option<Duration>]) -> Option<Vec<usize>> {
    let max = (times.len() / 10).max(usize::from(times.len() > 3));
    let grows = longest_growth(times);
    let mut bad = Vec::new();
    for (at, time) in times.iter_mut().enumerate().filter(|(at, _)| !grows.contains(at)) {
        *time = None;
        bad.push(at + 1);
    }
    if bad.len() > max {
        return None;
    }
    let known: Vec<(usize, Duration)> = times
        .iter()
        .enumerate()
        .filter_map(|(at, time)| Some((at, (*time)?)))
        .collect();
    if bad.is_empty() || known.len() < 2 {
        return bad.is_empty().then_some(bad);
    }
    for number in &bad {
        let at = number - 1;
        let later = known
            .iter()
            .position(|(other, _)| *other > at)
            .unwrap_or(known.len() - 1)
            .max(1);
        let ((first, from), (last, to)) = (known[later - 1], known[later]);
        let step = to.saturating_sub(from).as_secs_f64() / (last - first) as f64;
        let seconds = from.as_secs_f64() + step * (at as f64 - first as f64);
        times[at] = Duration::try_from_secs_f64(seconds.max(0.0)).ok();
    }
    let all: Vec<Duration> = times.iter().copied().collect::<Option<_>>()?;
    all.windows(2).all(|pair| pair[0] < pair[1]).then_some(bad)
}

/// The places of the longest list of `times` that grow.
fn longest_growth(times: &[Option<Duration>]) -> HashSet<usize> {
    // For increasing lists of each length, the last place of the one with the smallest end, and for each place its
    // predecessor.
    let mut ends: Vec<usize> = Vec::new();
    let mut before: Vec<Option<usize>> = vec![None; times.len()];
    for (at, time) in times.iter().enumerate() {
        if time.is_none() {
            continue;
        }
        let length = ends.partition_point(|&end| times[end] < *time);
        before[at] = length.checked_sub(1).map(|shorter| ends[shorter]);
        if length == ends.len() {
            ends.push(at);
        } else {
            ends[length] = at;
        }
    }
    let mut places = HashSet::new();
    let mut at = ends.last().copied();
    while let Some(place) = at {
        places.insert(place);
        at = before[place];
    }
    places
}

/// A time per line: seconds, a date, or integer nanoseconds, microseconds or milliseconds since 1970. A file name or an
/// index may stand in front of it or after it; lines that begin with `#` and a header are not read.
fn times_of_text(text: &str) -> Option<Vec<Option<Duration>>> {
    let is_comment = |line: &str| line.trim_start().starts_with('#');
    let mut lines: Vec<&str> = text.trim_end().lines().filter(|line| !is_comment(line)).collect();
    let has_digit = |line: &&str| line.contains(|c: char| c.is_ascii_digit());
    if lines.first().is_some_and(|first| !has_digit(first)) {
        lines.remove(0);
    }
    let whole: Vec<Option<Duration>> = lines.iter().map(|line| time_of_number(line)).collect();
    let max = (lines.len() / 10).max(usize::from(lines.len() > 3));
    let is_whole = whole.iter().filter(|time| time.is_none()).count() <= max;
    let column = |from_end: bool| -> Option<Vec<Duration>> {
        let word = |line: &&str| {
            let mut words = line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty());
            let (first, last) = (words.next()?, words.next_back()?);
            time_of_number(if from_end { last } else { first })
        };
        let times: Vec<Duration> = lines.iter().map(word).collect::<Option<_>>()?;
        // The index of each line increases as well.
        let is_index = (0u64..)
            .zip(&times)
            .all(|(index, time)| *time == Duration::from_secs(index) || *time == Duration::from_secs(index + 1));
        (!is_index).then_some(times)
    };
    if is_whole {
        return Some(whole);
    }
    let times = column(false).or_else(|| column(true))?;
    Some(times.into_iter().map(Some).collect())
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
    // A sign alone, or a fraction that is the same in each name, does not turn integers into decimals.
    let is_decimal = |column: usize| names.iter().any(|name| name.numbers[column].is_decimal());
    let mut columns = (0..names.first()?.numbers.len()).filter(changes);
    let (column, None) = (columns.next()?, columns.next()) else {
        return None;
    };
    if !is_decimal(column) {
        return None;
    }
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
    fn time_lists_of_many_programs_are_read() {
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
            let times = times_of_text(text).unwrap().into_iter().collect();
            assert_eq!(seconds(times), Some(vec![0.5, 1.5]), "{text}");
        }
        let epoch = times_of_text("1403636579763555584\n1403636579863555584").unwrap();
        assert_eq!(epoch[0].unwrap().as_secs(), 1_403_636_579);
        let epoch = times_of_text("1403636579763\n1403636579863").unwrap();
        assert_eq!(epoch[1].unwrap().as_millis(), 1_403_636_579_863);
        for wrong in ["a b\nc d 1", "12 x\ny"] {
            assert_eq!(times_of_text(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn one_bad_time_is_interpolated_between_its_neighbours() {
        let mended = |text: &str| {
            let mut times = times_of_text(text)?;
            let bad = mend(&mut times)?;
            Some((seconds(times.into_iter().collect())?, bad))
        };
        let expected = vec![0.0, 0.5, 1.0, 1.5, 2.0];
        assert_eq!(mended("0\n0.5\nfoo\n1.5\n2\n"), Some((expected.clone(), vec![3])));
        assert_eq!(mended("0\n0.5\n0.25\n1.5\n2\n").unwrap().1.len(), 1);
        assert_eq!(mended("0\n0.5\n9\n1.5\n2\n"), Some((expected.clone(), vec![3])));
        assert_eq!(mended("0x\n0.5\n1\n1.5\n2\n"), Some((expected.clone(), vec![1])));
        assert_eq!(mended("0\n0.5\n1\n1.5\nfoo\n"), Some((expected, vec![5])));
        assert_eq!(mended("2\n1.5\n1\n0.5\n0\n"), None);
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
        assert_eq!(times(&["t_-1.ply", "t_0.ply", "t_1.ply"]), None, "counters with a sign");
        let steps = ["s0_dt0.1.ply", "s5_dt0.1.ply", "s10_dt0.1.ply"];
        assert_eq!(times(&steps), None, "the fraction is the same in each name");
    }
}
