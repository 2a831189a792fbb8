//! Option value parsers shared by files of several subcommands.

use crate::messages::missing_frames;
use anyhow::bail;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// A number that `is_valid`, or an error with the expectation.
pub(super) fn number_in<T>(text: &str, is_valid: impl Fn(&T) -> bool, expected: &str) -> Result<T, String>
where
    T: std::str::FromStr,
{
    text.parse()
        .ok()
        .filter(is_valid)
        .ok_or_else(|| format!("expected {expected}"))
}

pub(in crate::cli) fn positive_f64(text: &str) -> Result<f64, String> {
    number_in(
        text,
        |value: &f64| value.is_finite() && *value > 0.0,
        "a number above 0",
    )
}

pub(in crate::cli) fn not_negative_f64(text: &str) -> Result<f64, String> {
    number_in(
        text,
        |value: &f64| value.is_finite() && *value >= 0.0,
        "a number from 0 up",
    )
}

/// Frames `first` to `last`, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cli) struct FrameRange {
    pub(in crate::cli) first: usize,
    pub(in crate::cli) last: usize,
}

impl FrameRange {
    /// Both ends included.
    pub(in crate::cli) fn bounds(self) -> RangeInclusive<usize> {
        self.first..=self.last
    }

    /// Fails unless a sequence of `count` frames has all of them; `option` asked for them.
    pub(in crate::cli) fn check(self, option: &str, count: usize) -> anyhow::Result<()> {
        match missing_frames(option, self.first, self.last, count) {
            Some(missing) => bail!(missing),
            None => Ok(()),
        }
    }

    /// One frame.
    pub(in crate::cli) fn one(frame: usize) -> Self {
        Self {
            first: frame,
            last: frame,
        }
    }
}

/// A frame that is counted from either end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FramePlace {
    FromFirst(usize),
    /// 0 is the last one.
    FromLast(usize),
}

impl FramePlace {
    fn parse(text: &str) -> Option<Self> {
        match (text, text.strip_prefix('-')) {
            ("last", _) => Some(Self::FromLast(0)),
            ("first", _) => Some(Self::FromFirst(0)),
            (_, Some(number)) => Some(Self::FromLast(number.parse::<usize>().ok()?.checked_sub(1)?)),
            (number, None) => number.parse().ok().map(Self::FromFirst),
        }
    }

    /// The index in a sequence of `count` frames; one beyond it if there is no such frame.
    fn index(self, count: usize) -> usize {
        match self {
            Self::FromFirst(index) => index,
            Self::FromLast(back) => count.checked_sub(back + 1).unwrap_or(count + back),
        }
    }
}

/// A frame or a range as typed: `7`, `2..5`, `last`, `-1`, `3..last`. The length of the sequence makes it a
/// [`FrameRange`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cli) struct FrameChoice {
    first: FramePlace,
    last: FramePlace,
}

impl FrameChoice {
    /// The frames in a sequence of `count`. Fails unless it has all of them; `option` asked for them.
    pub(in crate::cli) fn of(self, option: &str, count: usize) -> anyhow::Result<FrameRange> {
        let range = FrameRange {
            first: self.first.index(count),
            last: self.last.index(count),
        };
        range.check(option, count)?;
        if range.first > range.last {
            bail!("{option}: frame {} comes after frame {}", range.first, range.last);
        }
        Ok(range)
    }

    /// The one frame in a sequence of `count`.
    pub(in crate::cli) fn one_of(self, option: &str, count: usize) -> anyhow::Result<usize> {
        let range = self.of(option, count)?;
        if range.first != range.last {
            bail!("{option} takes one frame, not a range");
        }
        Ok(range.first)
    }

    /// True if it is one frame, whatever the length of the sequence.
    pub(in crate::cli) fn is_one(self) -> bool {
        self.first == self.last
    }
}

impl fmt::Display for FramePlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FromFirst(index) => write!(formatter, "{index}"),
            Self::FromLast(0) => write!(formatter, "last"),
            Self::FromLast(back) => write!(formatter, "-{}", back + 1),
        }
    }
}

impl fmt::Display for FrameChoice {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}..{}", self.first, self.last)
    }
}

impl From<FrameRange> for FrameChoice {
    fn from(range: FrameRange) -> Self {
        Self {
            first: FramePlace::FromFirst(range.first),
            last: FramePlace::FromFirst(range.last),
        }
    }
}

impl FromStr for FrameChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let range = match text.split_once("..") {
            Some((first, last)) => FramePlace::parse(first).zip(FramePlace::parse(last)),
            None => FramePlace::parse(text).map(|frame| (frame, frame)),
        };
        let is_backward = |range: &(FramePlace, FramePlace)| match *range {
            (FramePlace::FromFirst(first), FramePlace::FromFirst(last)) => first > last,
            (FramePlace::FromLast(first), FramePlace::FromLast(last)) => first < last,
            _ => false,
        };
        range
            .filter(|range| !is_backward(range))
            .map(|(first, last)| Self { first, last })
            .ok_or_else(|| {
                "expected a frame such as 0, last or -1, or a range such as 0..23 or 5..last with both ends included"
                    .to_owned()
            })
    }
}

/// Words of a switch.
pub(in crate::cli) const ON_OFF: [&str; 2] = ["on", "off"];

/// A word of a switch.
pub(in crate::cli) fn on_or_off(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err("expected on or off".to_owned()),
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parse = |number: &str| number.parse::<usize>().ok();
        let range = match text.split_once("..") {
            Some((first, last)) => parse(first).zip(parse(last)),
            None => parse(text).map(|frame| (frame, frame)),
        };
        match range {
            Some((first, last)) if first <= last => Ok(Self { first, last }),
            _ => Err("expected a frame such as 0, or a range such as 0..23 with both ends included".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_from_either_end() {
        let of = |text: &str| {
            let range = text.parse::<FrameChoice>().unwrap().of("--frame", 24);
            range.map(|range| (range.first, range.last)).ok()
        };
        assert_eq!(of("7"), Some((7, 7)));
        assert_eq!(of("last"), Some((23, 23)));
        assert_eq!(of("-2"), Some((22, 22)));
        assert_eq!(of("5..last"), Some((5, 23)));
        assert_eq!(of("-3..-1"), Some((21, 23)));
        assert_eq!(of("24"), None);
        assert_eq!(of("-25"), None);
        assert_eq!(of("20..-10"), None);
        for wrong in ["", "a", "5..2", "1..", "..3", "-0", "-1..-3", "1...3"] {
            assert!(wrong.parse::<FrameChoice>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn ranges_include_both_ends() {
        assert_eq!("7".parse(), Ok(FrameRange { first: 7, last: 7 }));
        assert_eq!("2..5".parse(), Ok(FrameRange { first: 2, last: 5 }));
        for wrong in ["", "a", "5..2", "1..", "..3", "-1", "1...3"] {
            assert!(wrong.parse::<FrameRange>().is_err(), "{wrong}");
        }
    }
}
