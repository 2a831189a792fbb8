//! Values of options that files of several verbs parse.

use crate::messages::missing_frames;
use anyhow::bail;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// A number that `is_valid`, or what was expected.
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
    fn ranges_include_both_ends() {
        assert_eq!("7".parse(), Ok(FrameRange { first: 7, last: 7 }));
        assert_eq!("2..5".parse(), Ok(FrameRange { first: 2, last: 5 }));
        for wrong in ["", "a", "5..2", "1..", "..3", "-1", "1...3"] {
            assert!(wrong.parse::<FrameRange>().is_err(), "{wrong}");
        }
    }
}
