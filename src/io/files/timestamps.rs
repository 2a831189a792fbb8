//! Times in file names, and in lists of times.
//!
//! Recorders name frames by their times; other programs number them. A number is taken for a time only if it is
//! unlikely to be a counter:
//!
//! - a date and a time of day, `20121214T142255.814212` or `2012-12-14_14-22-55-814`, in range (no month 13). Eight
//!   digits alone may be a date, but a day is not the time of a frame, and may be a counter as well.
//! - seconds with a fraction, `1305031102.175304`: seven or more digits, a point, three to nine digits. Counters have
//!   no fraction; versions (`v1.25`) and sizes (`0.5`) are shorter.
//! - seconds and nanoseconds, `1583836591_182590976`: ten digits and nine.
//! - a time of day, `12-59-58`: three numbers of two digits and no others, each a few minutes after the one before at
//!   most.
//! - 16 or 19 digits: micro- or nanoseconds since 1970, from 2001 on (a first digit that is not 0): counters are padded
//!   to ten digits at most. Ten and thirteen digits (seconds, milliseconds) are not accepted: padded counters and
//!   serial numbers are as long.
//!
//! All names must have a time of the same kind and the times must grow in the order of the names; else the numbers are
//! not times, as one of a thousand clouds with a date in its name says nothing about the others.

use std::path::Path;
use std::time::Duration;

/// Notation of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TimeNotation {
    Date,
    Seconds,
    SecondsNanos,
    Digits(usize),
    TimeOfDay,
}

impl TimeNotation {
    const ALL: [Self; 6] = [
        Self::Date,
        Self::Seconds,
        Self::SecondsNanos,
        Self::Digits(16),
        Self::Digits(19),
        Self::TimeOfDay,
    ];
}

/// Times of day further apart are not times of frames.
const MAX_STEP: Duration = Duration::from_mins(5);

/// Returns the timestamps in `names`, which are in order: since 1970, or since another epoch. All are `None` unless all
/// are times that increase.
pub(crate) fn times_of_names(names: &[&str]) -> Vec<Option<Duration>> {
    let of_notation = |notation: TimeNotation| -> Option<Vec<Option<Duration>>> {
        let times: Vec<Duration> = names
            .iter()
            .map(|name| time_of_name(name, notation))
            .collect::<Option<_>>()?;
        let grow = times.windows(2).all(|pair| pair[0] < pair[1]);
        // If they are three two-digit counters, there is a step of more than a few minutes somewhere.
        let is_close = |pair: &[Duration]| pair[1].saturating_sub(pair[0]) <= MAX_STEP;
        let grow = grow && (notation != TimeNotation::TimeOfDay || times.windows(2).all(is_close));
        // The name of a single file has its recording time, not its place among frames.
        (grow && times.len() > 1).then(|| times.into_iter().map(Some).collect())
    };
    // A date may belong to the whole recording: then another number in the names is the time.
    let found = TimeNotation::ALL.into_iter().find_map(of_notation);
    found.unwrap_or_else(|| vec![None; names.len()])
}

/// The times in `text`, one a line: seconds, `1.037359e-01`, or a date with a time of day, `2011-09-26
/// 13:02:25.964389445`. `None` where a line is neither.
pub(crate) fn times_of_lines(text: &str) -> Option<Vec<Duration>> {
    let time = |line: &str| match line.trim().parse() {
        Ok(seconds) => Duration::try_from_secs_f64(seconds).ok(),
        Err(_) => date(&runs(line)),
    };
    text.trim_end().lines().map(time).collect()
}

/// The time that `text` is: seconds, a date, or whole nanoseconds, microseconds or milliseconds since 1970.
pub(crate) fn time_of_number(text: &str) -> Option<Duration> {
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

/// The time in `text`: a date with a time of day, or that alone, `13:02:25.964`. `None` of other words.
pub(crate) fn time_of_text(text: &str) -> Option<Duration> {
    date(&runs(text)).or_else(|| time_of_day(text))
}

/// Hours, minutes and seconds since midnight.
fn time_of_day(text: &str) -> Option<Duration> {
    let mut parts = text.trim_end_matches(['Z', 'z']).split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() || hours.len() > 2 || minutes.len() != 2 {
        return None;
    }
    let [hours, minutes]: [u8; 2] = [hours.parse().ok()?, minutes.parse().ok()?];
    let seconds: f64 = seconds.parse().ok().filter(|seconds| (0.0..=60.0).contains(seconds))?;
    let whole = u32::from(hours) * 3600 + u32::from(minutes) * 60;
    (hours < 24 && minutes < 60).then(|| Duration::from_secs(u64::from(whole)) + Duration::from_secs_f64(seconds))
}

fn time_of_name(name: &str, notation: TimeNotation) -> Option<Duration> {
    let path = Path::new(name);
    let file = path.file_name()?.to_str()?;
    // The part after the last dot is an extension unless it is a number.
    let stem = match file.rsplit_once('.') {
        Some((stem, extension)) if !extension.bytes().all(|byte| byte.is_ascii_digit()) => stem,
        _ => file,
    };
    let runs = runs(stem);
    // A time may start at any number in the name: `frame_2_20121214T142255.814212`.
    (0..runs.len()).find_map(|first| {
        let runs = &runs[first..];
        match notation {
            TimeNotation::Date => date(runs),
            TimeNotation::Seconds => seconds(runs),
            TimeNotation::SecondsNanos => seconds_nanos(runs),
            TimeNotation::TimeOfDay => hours(runs),
            TimeNotation::Digits(count) => digits(runs, count),
        }
    })
}

/// A number, and the one character behind it where another number follows.
#[derive(Debug, Clone, Copy)]
struct NumberRun<'a> {
    digits: &'a str,
    separator: Option<char>,
}

fn runs(text: &str) -> Vec<NumberRun<'_>> {
    /// Max runs of digits in the name of a frame.
    const MAX_RUNS: usize = 32;
    let mut runs = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let found = &rest[start..];
        let end = found.find(|c: char| !c.is_ascii_digit()).unwrap_or(found.len());
        let mut behind = found[end..].chars();
        let separator = behind.next();
        let is_digit_next = behind.next().is_some_and(|c| c.is_ascii_digit());
        runs.push(NumberRun {
            digits: &found[..end],
            separator: separator.filter(|_| is_digit_next),
        });
        rest = &found[end..];
        if runs.len() == MAX_RUNS {
            break;
        }
    }
    runs
}

/// Year, month, day, hour, minute, second and its fraction.
fn date(runs: &[NumberRun<'_>]) -> Option<Duration> {
    let mut fields = Vec::new();
    let mut runs = runs.iter();
    // Date and time of day are one number each, or one number for each of their three parts.
    for widths in [[4, 2, 2], [2, 2, 2]] {
        let run = runs.next()?;
        let separator = if run.digits.len() == widths.iter().sum::<usize>() {
            let mut rest = run.digits;
            for width in widths {
                let (field, behind) = rest.split_at(width);
                fields.push(field);
                rest = behind;
            }
            run.separator
        } else {
            let [second, third] = [runs.next()?, runs.next()?];
            let parts = [run, second, third];
            if parts.iter().zip(widths).any(|(part, width)| part.digits.len() != width) {
                return None;
            }
            fields.extend(parts.map(|part| part.digits));
            third.separator
        };
        let expected: &[char] = if fields.len() == 3 {
            &['T', 't', '_', '-', ' ']
        } else {
            &['.', '-', '_', ',']
        };
        if fields.len() == 3 && !separator.is_some_and(|found| expected.contains(&found)) {
            return None;
        }
        if fields.len() == 6 && separator.is_some_and(|found| expected.contains(&found)) {
            fields.push(runs.next()?.digits);
        }
    }
    let number = |index: usize| fields[index].parse::<u32>().ok();
    let [year, month, day] = [number(0)?, number(1)?, number(2)?];
    let [hour, minute, second] = [number(3)?, number(4)?, number(5)?];
    let is_in_range = (1970..=2199).contains(&year)
        && (1..=12).contains(&month)
        && (1..=31).contains(&day)
        && hour < 24
        && minute < 60
        && second <= 60;
    let nanos = match fields.get(6) {
        Some(fraction) => fraction_nanos(fraction)?,
        None => 0,
    };
    let day_seconds = u64::from(hour * 3600 + minute * 60 + second);
    is_in_range.then(|| Duration::new(days_since_1970(year, month, day) * 86_400 + day_seconds, nanos))
}

/// Days from the first of January 1970. Precondition: the year is none before it.
fn days_since_1970(year: u32, month: u32, day: u32) -> u64 {
    let is_leap = |year: u32| (year.is_multiple_of(4) && !year.is_multiple_of(100)) || year.is_multiple_of(400);
    let years: u64 = (1970..year).map(|year| if is_leap(year) { 366 } else { 365 }).sum();
    let months: u64 = (1..month)
        .map(|month| match month {
            2 => 28 + u64::from(is_leap(year)),
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        })
        .sum();
    years + months + u64::from(day) - 1
}

/// Parses the fractional digits of a second.
fn fraction_nanos(digits: &str) -> Option<u32> {
    const NANO_DIGITS: usize = 9;
    if digits.len() > NANO_DIGITS {
        return None;
    }
    format!("{digits:0<NANO_DIGITS$}").parse().ok()
}

fn seconds(runs: &[NumberRun<'_>]) -> Option<Duration> {
    let [whole, fraction, ..] = runs else {
        return None;
    };
    let is_time = (7..=11).contains(&whole.digits.len())
        && whole.separator == Some('.')
        && (3..=9).contains(&fraction.digits.len());
    let seconds = whole.digits.parse().ok()?;
    is_time.then(|| Some(Duration::new(seconds, fraction_nanos(fraction.digits)?)))?
}

/// Ten digits of seconds since 1970, from 2001 on, and nine of nanoseconds: `1583836591_182590976`, as ROS counts.
fn seconds_nanos(runs: &[NumberRun<'_>]) -> Option<Duration> {
    let [whole, nanos, ..] = runs else {
        return None;
    };
    let is_time = whole.digits.len() == 10
        && whole.digits.starts_with('1')
        && matches!(whole.separator, Some('_' | '-' | '.'))
        && nanos.digits.len() == 9;
    let (seconds, nanos) = (whole.digits.parse().ok()?, nanos.digits.parse().ok()?);
    is_time.then(|| Duration::new(seconds, nanos))
}

/// Hours, minutes and seconds of two digits each, and nothing else: `12-59-58`.
fn hours(runs: &[NumberRun<'_>]) -> Option<Duration> {
    let [hour, minute, second] = runs else { return None };
    let is_pair = |run: &&NumberRun<'_>| run.digits.len() == 2;
    let is_joined = hour.separator == minute.separator && matches!(hour.separator, Some('-' | '_' | '.'));
    if ![hour, minute, second].iter().all(is_pair) || !is_joined {
        return None;
    }
    let [hours, minutes, seconds]: [u64; 3] = [
        hour.digits.parse().ok()?,
        minute.digits.parse().ok()?,
        second.digits.parse().ok()?,
    ];
    let is_in_range = hours < 24 && minutes < 60 && seconds < 60;
    is_in_range.then(|| Duration::from_secs(3600 * hours + 60 * minutes + seconds))
}

fn digits(runs: &[NumberRun<'_>], count: usize) -> Option<Duration> {
    let digits = runs.first()?.digits;
    let number: u64 = digits.parse().ok()?;
    match digits.len() {
        length if length != count || digits.starts_with('0') => None,
        16 => Some(Duration::from_micros(number)),
        19 => Some(Duration::from_nanos(number)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds of the names, rounded to microseconds.
    fn seconds_of(names: &[&str]) -> Option<Vec<f64>> {
        times_of_names(names)
            .into_iter()
            .map(|time| time.map(|time| time.as_micros() as f64 / 1e6))
            .collect()
    }

    #[test]
    fn recorder_file_names_contain_times() {
        for (names, expected) in [
            (
                ["frame_20121214T142255.814212.pcd", "frame_20121214T142256.068683.pcd"],
                [1_355_494_975.814_212, 1_355_494_976.068_683],
            ),
            (
                ["2012-12-14_14-22-55-814.ply", "2012-12-14_14-22-55-914.ply"],
                [1_355_494_975.814, 1_355_494_975.914],
            ),
            (
                ["a/20240229_235959.ply", "a/20240301_000001.ply"],
                [1_709_251_199.0, 1_709_251_201.0],
            ),
            (
                ["1305031102.175304.png", "1305031102.211214.png"],
                [1_305_031_102.175_304, 1_305_031_102.211_214],
            ),
            (
                ["1351492.123456.pcd", "1351493.023456.pcd"],
                [1_351_492.123_456, 1_351_493.023_456],
            ),
            (
                ["scan_1403636579763555584.ply", "scan_1403636579863555584.ply"],
                [1_403_636_579.763_555, 1_403_636_579.863_555],
            ),
            (
                ["1403636579763555.bin", "1403636579863555.bin"],
                [1_403_636_579.763_555, 1_403_636_579.863_555],
            ),
            // In a name without extension, the fraction is not one.
            (
                ["1305031102.175304", "1305031102.211214"],
                [1_305_031_102.175_304, 1_305_031_102.211_214],
            ),
        ] {
            assert_eq!(seconds_of(&names), Some(expected.to_vec()), "{names:?}");
        }
    }

    #[test]
    fn lists_have_one_time_per_line() {
        let list = times_of_lines("0.000000e+00\n1.037359e-01\r\n 2.5\n\n");
        let expected = [0, 103_735_900, 2_500_000_000].map(Duration::from_nanos);
        assert_eq!(list, Some(expected.to_vec()));
        let list = times_of_lines("2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26");
        let expected = [(1_317_042_145, 964_389_445), (1_317_042_146, 0)];
        let expected = expected.map(|(seconds, nanos)| Duration::new(seconds, nanos));
        assert_eq!(list, Some(expected.to_vec()));
        for wrong in ["1\n\n2", "a", "-1", "nan", "1e30", "2011-13-26 13:02:25", ""] {
            assert_eq!(times_of_lines(wrong).filter(|times| !times.is_empty()), None, "{wrong}");
        }
    }

    #[test]
    fn counters_and_odd_names_are_not_times() {
        for names in [
            ["frame_0001.ply", "frame_0002.ply"],
            ["0000000001.bin", "0000000002.bin"],
            ["0000000000000001.bin", "0000000000000002.bin"],
            ["scan_20121214_1.ply", "scan_20121214_2.ply"],
            ["20121214.ply", "20121215.ply"],
            ["20121314T142255.ply", "20121314T142256.ply"],
            ["v1.25_a.ply", "v1.26_b.ply"],
            // Times, but not increasing, not all of one kind, not for all names.
            ["1305031102.275304.ply", "1305031102.211214.ply"],
            ["1305031102.211214.ply", "1305031102.211214.ply"],
            ["1305031102.175304.ply", "2024-12-14_14-22-55.ply"],
            ["1305031102.175304.ply", "last.ply"],
            ["99999999999999999999999.ply", "999999999999999999999999.ply"],
        ] {
            assert_eq!(times_of_names(&names), [None, None], "{names:?}");
        }
        assert_eq!(times_of_names(&["1305031102.175304.ply"]), [None]);
        assert_eq!(times_of_names(&[]), []);
        assert_eq!(times_of_names(&["é1.2é3", "\u{1F600}4"]), [None, None]);
    }
}
