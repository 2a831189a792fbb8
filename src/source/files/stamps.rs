//! When frames were taken, where their files do not say: by their names, or by the list that KITTI keeps beside its
//! scans.

use super::FrameEntry;
use crate::io::Format;
use crate::io::timestamps::{times_of_lines, times_of_names};
use std::fs;
use std::path::Path;
use std::time::Duration;

/// A list for a million scans is not as long.
const MOST_LIST_BYTES: u64 = 64 << 20;

/// Gives all `entries` a time, or none.
pub(super) fn stamp(entries: &mut [FrameEntry]) {
    if entries.iter().any(|entry| entry.time.is_some()) {
        return;
    }
    let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    let mut times = times_of_names(&names);
    if times.iter().all(Option::is_none)
        && let Some(listed) = times_beside(entries)
    {
        times = listed.into_iter().map(Some).collect();
    }
    for (entry, time) in entries.iter_mut().zip(times) {
        entry.time = time;
    }
}

/// The times of scans in one folder from the list beside it: `velodyne_points/timestamps.txt` of the raw recordings,
/// `sequences/00/times.txt` of the odometry. A line a scan, by the number in its name, as some lack scans.
fn times_beside(entries: &[FrameEntry]) -> Option<Vec<Duration>> {
    let folder = entries.first()?.path.parent()?;
    let is_scan = |entry: &FrameEntry| {
        entry.path.parent() == Some(folder) && Format::of_extension(&entry.path).is_some_and(Format::has_times_beside)
    };
    if !entries.iter().all(is_scan) {
        return None;
    }
    let lists = ["timestamps.txt", "times.txt"].map(|name| folder.join("..").join(name));
    lists.iter().find_map(|list| {
        let times = read_list(list)?;
        let time_of = |entry: &FrameEntry| times.get(usize::try_from(entry.number?).ok()?).copied();
        let by_number: Option<Vec<Duration>> = entries.iter().map(time_of).collect();
        // Numbers that begin elsewhere: the first line is of the first scan, if there is one for each.
        by_number.or((times.len() == entries.len()).then_some(times))
    })
}

fn read_list(path: &Path) -> Option<Vec<Duration>> {
    let metadata = fs::metadata(path).ok()?;
    if !metadata.is_file() || metadata.len() > MOST_LIST_BYTES {
        return None;
    }
    times_of_lines(&fs::read_to_string(path).ok()?)
}
