//! Frames in one table: by a column of frames or times, or by separators between blocks of rows.
//!
//! **How it works.** A column named `frame` or the like is one value per frame. A column of times counts only if its
//! values repeat as in a sequence: a LiDAR stamps each point, or the few of one firing. Blocks between empty lines are
//! frames if they lie on each other, as the pieces of one scan do not; lines of constant x or y are a surface, as
//! gnuplot writes it.

use super::rows::Break;
use crate::io::columns::column_names::{Words, plain_name};
use std::collections::HashMap;
use std::ops::Range;
use std::time::Duration;

/// Max number of frames of a real sequence.
const MAX_FRAMES: usize = 1_000_000;

/// Rows of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Rows {
    /// One after the other.
    Range(Range<usize>),
    /// Anywhere.
    List(Vec<u32>),
}

/// A frame of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Frame {
    pub(super) rows: Rows,
    /// For people, and for its number.
    pub(super) name: String,
    pub(super) time: Option<Duration>,
}

/// Meaning of a column for frames, by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Counter {
    /// It numbers frames.
    Frames,
    /// It holds times in this unit, seconds.
    Times(Option<f64>),
    /// It holds times of points in this unit, seconds: they are frames only if the user says so.
    Points(Option<f64>),
}

const FRAME_WORDS: [&str; 10] = [
    "frame",
    "frames",
    "frameid",
    "framenumber",
    "step",
    "timestep",
    "snapshot",
    "sweep",
    "scanid",
    "timeframe",
];
const FRAME_SUFFIXES: [&str; 8] = ["id", "no", "nr", "number", "index", "idx", "num", "count"];
const TIME_WORDS: [&str; 7] = ["time", "timestamp", "timestamps", "t", "stamp", "datetime", "sec"];
const TIME_UNITS: [(f64, &[&str]); 5] = [
    (60.0, &["min", "minutes"]),
    (1.0, &["s", "sec", "secs", "second", "seconds"]),
    (1e-3, &["ms", "msec", "milliseconds"]),
    (1e-6, &["us", "µs", "usec", "microseconds"]),
    (1e-9, &["ns", "nsec", "nanoseconds"]),
];

impl Counter {
    /// By the name of a column as the file has it.
    pub(super) fn of(name: &str) -> Option<Self> {
        let bracket = name
            .split_once(['[', '('])
            .map(|(_, inside)| inside.trim_end_matches([']', ')', ' ', '"']));
        let unit_of = |word: &str| {
            let is = |(_, names): &&(f64, &[&str])| names.contains(&word.to_lowercase().as_str());
            TIME_UNITS.iter().find(is).map(|(seconds, _)| *seconds)
        };
        let words = Words::of(plain_name(name)).words;
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let unit = bracket.and_then(unit_of);
        match words.as_slice() {
            [first] if FRAME_WORDS.contains(first) => Some(Self::Frames),
            [first, second] if FRAME_WORDS.contains(first) && FRAME_SUFFIXES.contains(second) => Some(Self::Frames),
            ["time", "step" | "frame"] | ["scan", "id" | "index" | "number"] => Some(Self::Frames),
            [first] if TIME_WORDS.contains(first) => Some(Self::Times(unit)),
            ["time", "stamp"] | ["date", "time"] => Some(Self::Times(unit)),
            // The clock of a LiDAR stamps points, whatever its number of digits suggests.
            ["gpstime"] | ["gps", "time"] => Some(Self::Points(unit)),
            [first, second] if TIME_WORDS.contains(first) => unit_of(second).map(|unit| Self::Times(Some(unit))),
            _ => None,
        }
    }
}

/// Signs of the columns of LiDAR sensors, which stamp their points.
const LIDAR_WORDS: [&str; 12] = [
    "intensity",
    "reflectance",
    "reflectivity",
    "ring",
    "laser",
    "azimuth",
    "channel",
    "beam",
    "return",
    "echo",
    "line",
    "gps",
];

/// Returns true if `names` are typical of LiDAR points.
pub(super) fn is_of_lidar(names: &[String]) -> bool {
    let has_word = |name: &String| {
        Words::of(name)
            .words
            .iter()
            .any(|word| LIDAR_WORDS.contains(&word.as_str()))
    };
    names.iter().any(has_word)
}

/// Rows of each value of a column, by value.
pub(super) struct Groups {
    by_value: Vec<(f64, Vec<u32>)>,
    /// Rows without a value.
    pub(super) without: usize,
    /// True if each value is one contiguous block of rows.
    is_sorted: bool,
    /// The value rises from most rows to the next, as in tracks one after the other.
    is_rising: bool,
}

impl Groups {
    /// `None` if there are fewer than two values, or more than a sequence has.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        let mut places: HashMap<u64, usize> = HashMap::new();
        let mut groups: Vec<(f64, Vec<u32>)> = Vec::new();
        let (mut without, mut runs, mut rises) = (0, 0, 0);
        let mut before = f64::NAN;
        for (row, &value) in values.iter().enumerate() {
            let row = u32::try_from(row).ok()?;
            if value.is_nan() {
                without += 1;
                continue;
            }
            // Normalises minus zero.
            let value = value + 0.0;
            runs += usize::from(value != before);
            rises += usize::from(value > before);
            before = value;
            let place = *places.entry(value.to_bits()).or_insert_with(|| {
                groups.push((value, Vec::new()));
                groups.len() - 1
            });
            if place >= MAX_FRAMES {
                return None;
            }
            groups[place].1.push(row);
        }
        let is_sorted = runs == groups.len();
        groups.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        (groups.len() > 1).then_some(Self {
            by_value: groups,
            without,
            is_sorted,
            is_rising: rises * 2 > values.len(),
        })
    }

    pub(super) fn len(&self) -> usize {
        self.by_value.len()
    }

    /// Rows per value.
    pub(super) fn mean_rows(&self) -> f64 {
        let rows: usize = self.by_value.iter().map(|(_, rows)| rows.len()).sum();
        rows as f64 / self.by_value.len() as f64
    }

    /// Returns true if nearly all values have the same number of rows.
    fn are_equal(&self) -> bool {
        let mut sizes: Vec<usize> = self.by_value.iter().map(|(_, rows)| rows.len()).collect();
        sizes.sort_unstable();
        let median = sizes[sizes.len() / 2];
        sizes.iter().filter(|&&size| size == median).count() * 10 >= sizes.len() * 9
    }

    /// Returns true if the values are frame numbers.
    pub(super) fn are_numbers_of_frames(&self) -> bool {
        /// Below that a path of one point per frame is meant.
        const MIN_ROWS: f64 = 1.5;
        self.mean_rows() >= MIN_ROWS
    }

    /// Returns true if at least half of the frames have about the same number of rows as the median one.
    fn are_similar(&self) -> bool {
        const MAX_RATIO: usize = 4;
        let mut sizes: Vec<usize> = self.by_value.iter().map(|(_, rows)| rows.len()).collect();
        sizes.sort_unstable();
        let median = sizes[sizes.len() / 2];
        let is_similar = |size: &&usize| **size * MAX_RATIO >= median && **size <= median * MAX_RATIO;
        sizes.iter().filter(is_similar).count() * 2 >= sizes.len()
    }

    /// Returns true if the values are evenly spaced, and no closer than frames are: rounded times of points are as
    /// even.
    fn are_even(&self, seconds: f64) -> bool {
        /// 200 frames per second.
        const MIN_STEP_SECONDS: f64 = 0.005;
        const TOLERANCE: f64 = 0.1;
        let mut steps: Vec<f64> = self.by_value.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        steps.sort_by(f64::total_cmp);
        let Some(&median) = steps.get(steps.len() / 2) else {
            return false;
        };
        let is_even = |step: &&f64| (**step - median).abs() <= TOLERANCE * median;
        let even = steps.iter().filter(is_even).count();
        median * seconds >= MIN_STEP_SECONDS && even * 10 >= steps.len() * 9
    }

    /// Returns true if the values, in units of `seconds`, are timestamps of frames, not of single points. A LiDAR
    /// stamps firings and packets, each of which sees a part of its surroundings.
    pub(super) fn are_times_of_frames(&self, seconds: f64, is_of_lidar: bool, positions: [&[f64]; 3]) -> bool {
        /// Part of the width and breadth of everything that a frame has.
        const MIN_COVERAGE: f64 = 0.4;
        const MIN_ROWS: f64 = 64.0;
        /// Minimum number of rows of frames at uneven times.
        const MIN_ROWS_OF_UNEVEN: f64 = 500.0;
        /// Tracks of a few points.
        const MIN_TRACKS: f64 = 2.0;
        const MAX_TRACK_FRAMES: usize = 20_000;
        let mean = self.mean_rows();
        if is_of_lidar {
            return mean >= MIN_ROWS && self.coverage(positions) >= MIN_COVERAGE;
        }
        // A clock that restarts repeatedly stamps points in no order: nothing moves during its periods.
        if self.is_rising && !self.is_sorted && !moves_little(positions) {
            return false;
        }
        let are_tracks = mean >= MIN_TRACKS && self.are_equal() && self.len() <= MAX_TRACK_FRAMES;
        let is_even = mean >= MIN_ROWS && self.are_even(seconds);
        is_even || (mean >= MIN_ROWS_OF_UNEVEN && self.are_similar()) || are_tracks
    }

    /// Median over the groups of the part of the rectangle around all points that the rectangle around theirs is.
    fn coverage(&self, positions: [&[f64]; 3]) -> f64 {
        let area = |rows: &mut dyn Iterator<Item = usize>| {
            let mut sides = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
            for row in rows {
                for (side, values) in sides.iter_mut().zip(positions) {
                    if values[row].is_finite() {
                        *side = [side[0].min(values[row]), side[1].max(values[row])];
                    }
                }
            }
            sides.iter().map(|[low, high]| (high - low).max(0.0)).product::<f64>()
        };
        let whole = area(&mut (0..positions[0].len()));
        let of_group = |(_, rows): &(f64, Vec<u32>)| area(&mut rows.iter().map(|&row| row as usize)) / whole;
        let mut parts: Vec<f64> = self.by_value.iter().map(of_group).collect();
        parts.sort_by(f64::total_cmp);
        parts[parts.len() / 2]
    }

    /// A frame per value; `seconds` of a step of it where it is a time, and words where the column has such.
    pub(super) fn frames(self, label: &str, seconds: Option<f64>, words: &[String]) -> Vec<Frame> {
        let first = self.by_value.first().map_or(0.0, |(value, _)| *value);
        // Times before the first day count from the first of them.
        let start = if first < 0.0 { first } else { 0.0 };
        let is_sorted = self.is_sorted;
        let frame = |(value, rows): (f64, Vec<u32>)| {
            let time = seconds.and_then(|seconds| Duration::try_from_secs_f64((value - start) * seconds).ok());
            let text = words
                .get(value as usize)
                .map_or_else(|| value.to_string(), Clone::clone);
            let range = (rows.first().copied(), rows.last().copied());
            let rows = match range {
                (Some(first), Some(last)) if is_sorted && (last - first) as usize + 1 == rows.len() => {
                    Rows::Range(first as usize..last as usize + 1)
                }
                _ => Rows::List(rows),
            };
            Frame {
                rows,
                name: format!("{label} {text}"),
                time,
            }
        };
        self.by_value.into_iter().map(frame).collect()
    }
}

/// True if a row is much closer to the next one, as the places of a track are, than to one far away in the table.
fn moves_little(positions: [&[f64]; 3]) -> bool {
    /// Maximum step as a fraction of the distance between rows that are far away from each other.
    const MAX_STEP: f64 = 0.5;
    /// Row offset of far points as a fraction of the rows. In no simple ratio to the length of tracks.
    const FAR: f64 = 0.618;
    let rows = positions[0].len();
    let far = (rows as f64 * FAR) as usize;
    let median = |offset: usize| {
        let distance = |row: usize| {
            let squares = positions.map(|values| (values[row] - values[(row + offset) % rows]).powi(2));
            squares.into_iter().sum::<f64>().sqrt()
        };
        let distances = (0..rows).map(distance);
        let mut known: Vec<f64> = distances.filter(|distance| distance.is_finite()).collect();
        let center = known.len() / 2;
        (!known.is_empty()).then(|| *known.select_nth_unstable_by(center, f64::total_cmp).1)
    };
    let steps = median(1).zip(median(far));
    steps.is_none_or(|(next, far)| next <= MAX_STEP * far)
}

/// Seconds of a step of times that do not say their unit: counts since 1970 are as long as their unit is short.
pub(super) fn guessed_seconds(values: &[f64]) -> (f64, &'static str) {
    let largest = values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .fold(0.0, f64::max);
    match largest {
        1e17.. => (1e-9, "ns"),
        1e14.. => (1e-6, "µs"),
        1e11.. => (1e-3, "ms"),
        _ => (1.0, "s"),
    }
}

/// Frames of consecutive blocks of rows; `starts` are the starts of all but the first.
pub(super) fn of_blocks(starts: &[usize], rows: usize, names: &[String]) -> Vec<Frame> {
    let bounds: Vec<usize> = std::iter::once(0).chain(starts.iter().copied()).chain([rows]).collect();
    let frame = |(index, ends): (usize, &[usize])| {
        let label = names.get(index).filter(|name| !name.is_empty());
        let name = match label {
            Some(label) => format!("frame {} ({label})", index + 1),
            None => format!("frame {}", index + 1),
        };
        Frame {
            rows: Rows::Range(ends[0]..ends[1]),
            name,
            time: None,
        }
    };
    bounds.windows(2).enumerate().map(frame).collect()
}

/// The time that comments of all blocks say, such as `t = 0.5` or `Time=0.5 ps`.
pub(super) fn times_in(comments: &[String]) -> Option<Vec<Duration>> {
    let time = |comment: &String| {
        let lower = comment.to_ascii_lowercase();
        let mut words = lower.split([' ', ',', ';', '\t']).filter(|word| !word.is_empty());
        while let Some(word) = words.next() {
            let (key, value) = match word.split_once(['=', ':']) {
                Some((key, value)) => (key, value),
                None => (word, ""),
            };
            if !["t", "time", "timestamp"].contains(&key) {
                continue;
            }
            let value = if value.is_empty() {
                words.find(|word| *word != "=")?
            } else {
                value
            };
            let number: f64 = value.trim_end_matches('s').parse().ok()?;
            return Duration::try_from_secs_f64(number).ok();
        }
        None
    };
    comments.iter().map(time).collect()
}

/// Rows that start a block behind an empty line or a comment.
pub(super) fn starts_of(breaks: &[Break], rows: usize) -> Vec<usize> {
    let starts = breaks.iter().map(|found| found.row);
    starts.filter(|&row| row > 0 && row < rows).collect()
}

/// Why blocks of rows are frames, or are not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BlockEvidence {
    /// They lie on each other.
    Overlap,
    /// Each is a line of constant x or y.
    Isolines,
    /// They lie at different places, or are of one frame that was cut in two.
    Apart,
}

/// Returns the evidence for the meaning of the blocks that begin at `starts` and at 0, by the coordinates of their
/// points.
pub(super) fn evidence(starts: &[usize], positions: [&[f64]; 3]) -> BlockEvidence {
    /// Part of the space of two blocks that both fill.
    const MIN_OVERLAP: f64 = 0.3;
    let rows = positions[0].len();
    let whole = bounds(positions, 0..rows);
    let boxes: Vec<Bounds> = std::iter::once(0)
        .chain(starts.iter().copied())
        .zip(starts.iter().copied().chain([rows]))
        .map(|(start, end)| bounds(positions, start..end))
        .collect();
    let size = |[low, high]: [f64; 2]| (high - low).max(0.0);
    let is_isoline =
        |block: &&Bounds| (0..2).any(|axis| size(whole[axis]) > 0.0 && size(block[axis]) <= 1e-9 * size(whole[axis]));
    if boxes.iter().filter(is_isoline).count() * 10 >= boxes.len() * 9 {
        return BlockEvidence::Isolines;
    }
    let overlap = |pair: &[Bounds]| -> f64 {
        (0..3)
            .map(|axis| {
                // Flat blocks have no extent: a small margin is added.
                let margin = 0.02 * size(whole[axis]);
                let [one, other] = [pair[0][axis], pair[1][axis]].map(|[low, high]| [low - margin, high + margin]);
                let common = size([one[0].max(other[0]), one[1].min(other[1])]);
                let both = size([one[0].min(other[0]), one[1].max(other[1])]);
                if both > 0.0 { common / both } else { 1.0 }
            })
            .product()
    };
    let mut overlaps: Vec<f64> = boxes.windows(2).map(overlap).collect();
    overlaps.sort_by(f64::total_cmp);
    let is_cut_in_two = boxes.len() == 2 && starts[0] * 2 != rows;
    match overlaps.get(overlaps.len() / 2) {
        Some(median) if *median >= MIN_OVERLAP && !is_cut_in_two => BlockEvidence::Overlap,
        _ => BlockEvidence::Apart,
    }
}

type Bounds = [[f64; 2]; 3];

fn bounds(positions: [&[f64]; 3], rows: Range<usize>) -> Bounds {
    positions.map(|values| {
        let known = values[rows.clone()].iter().copied().filter(|value| value.is_finite());
        known.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_and_time_columns_are_recognised_by_name() {
        for (name, expected) in [
            ("frame", Some(Counter::Frames)),
            ("Frame_ID", Some(Counter::Frames)),
            ("frameNumber", Some(Counter::Frames)),
            ("timestep", Some(Counter::Frames)),
            ("t", Some(Counter::Times(None))),
            ("time [ms]", Some(Counter::Times(Some(1e-3)))),
            ("timestamp_us", Some(Counter::Times(Some(1e-6)))),
            ("RelativeTime", None),
            ("adjustedtime", None),
            ("GpsTime", Some(Counter::Points(None))),
            ("gps_time", Some(Counter::Points(None))),
            ("intensity", None),
            ("frame_rate_hz", None),
        ] {
            assert_eq!(Counter::of(name), expected, "{name}");
        }
    }

    #[test]
    fn point_times_are_not_frames() {
        let flat = vec![0.0; 64_000];
        let groups = |values: Vec<f64>| {
            let groups = Groups::of(&values)?;
            Some((
                groups.len(),
                groups.are_times_of_frames(1.0, false, [&flat, &flat, &flat]),
            ))
        };
        // Each point has its own time.
        assert_eq!(groups((0..1000).map(f64::from).collect()), Some((1000, false)));
        assert_eq!(
            groups((0..1000).map(|i| f64::from(i / 100)).collect()),
            Some((10, true))
        );
        // About a hundred points per time, rounded to milliseconds.
        let rounded = |i: i32| (f64::from(i) / 99.7).round() / 1000.0;
        assert_eq!(groups((0..2000).map(rounded).collect()), Some((21, false)));
        // Tracks one after another.
        assert_eq!(
            groups((0..1000).map(|i| f64::from(i % 100)).collect()),
            Some((100, true))
        );
        // Each track moves by 1 at a time and begins 50 after the one before; the other points are anywhere.
        let turns = Groups::of(&(0..6000).map(|i| f64::from(i % 60)).collect::<Vec<f64>>()).unwrap();
        let moving: Vec<f64> = (0..6000).map(|i| f64::from(i % 60 + 50 * (i / 60))).collect();
        let scattered: Vec<f64> = (0..6000).map(|i| f64::from((i * 7919) % 6007)).collect();
        let zeros = vec![0.0; 6000];
        assert!(turns.are_times_of_frames(1.0, false, [&moving, &zeros, &zeros]));
        assert!(!turns.are_times_of_frames(1.0, false, [&scattered, &zeros, &zeros]));
        assert_eq!(groups(vec![1.0; 10]), None);
        // The packets of a LiDAR are sectors of a circle, its revolutions cover all of it.
        let angle = |i: i32| f64::from(i) * std::f64::consts::TAU / 8000.0;
        let [x, y]: [Vec<f64>; 2] = [
            (0..64_000).map(|i| angle(i).cos()).collect(),
            (0..64_000).map(|i| angle(i).sin()).collect(),
        ];
        let of = |rows: i32| Groups::of(&(0..64_000).map(|i| f64::from(i / rows)).collect::<Vec<f64>>()).unwrap();
        assert!(!of(64).are_times_of_frames(1.0, true, [&x, &y, &flat]));
        assert!(!of(400).are_times_of_frames(1.0, true, [&x, &y, &flat]));
        assert!(of(8000).are_times_of_frames(1.0, true, [&x, &y, &flat]));
    }

    #[test]
    fn rows_are_grouped_into_frames_by_value() {
        let frames = Groups::of(&[2.0, 1.0, 2.0, f64::NAN, 1.0])
            .unwrap()
            .frames("t", Some(0.5), &[]);
        assert_eq!(frames[0].rows, Rows::List(vec![1, 4]));
        assert_eq!(
            (frames[1].name.as_str(), frames[1].time),
            ("t 2", Some(Duration::from_secs(1)))
        );
        let frames = Groups::of(&[1.0, 1.0, 2.0]).unwrap().frames("frame", None, &[]);
        assert_eq!(
            (frames[0].rows.clone(), frames[1].rows.clone()),
            (Rows::Range(0..2), Rows::Range(2..3))
        );
    }

    #[test]
    fn comments_may_give_times() {
        let times = |comments: &[&str]| times_in(&comments.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>());
        assert_eq!(
            times(&["t = 0.5", "t=1.5 s"]),
            Some(vec![Duration::from_millis(500), Duration::from_millis(1500)])
        );
        assert_eq!(times(&["Step 1, Time: 0.5", "x"]), None);
    }

    #[test]
    fn overlapping_blocks_are_frames() {
        let cloud = |block: usize, i: usize| [(i % 7) as f64 + 0.1 * block as f64, (i % 5) as f64, (i % 3) as f64];
        let pieces = |block: usize, i: usize| [(i % 7) as f64, (i % 5) as f64 + 100.0 * block as f64, (i % 3) as f64];
        let lines = |block: usize, i: usize| [block as f64, i as f64, (i % 3) as f64];
        let of = |place: fn(usize, usize) -> [f64; 3], blocks: usize| {
            let points: Vec<[f64; 3]> = (0..blocks * 20).map(|row| place(row / 20, row % 20)).collect();
            let axes = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
            let starts: Vec<usize> = (1..blocks).map(|block| block * 20).collect();
            evidence(&starts, [&axes[0], &axes[1], &axes[2]])
        };
        assert_eq!(of(cloud, 5), BlockEvidence::Overlap);
        assert_eq!(of(cloud, 2), BlockEvidence::Overlap);
        assert_eq!(of(pieces, 5), BlockEvidence::Apart);
        assert_eq!(of(lines, 5), BlockEvidence::Isolines);
    }
}
