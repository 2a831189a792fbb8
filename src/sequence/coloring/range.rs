//! Value range: the numbers that have the first and the last colour.

use super::parse_error::ParseColoringError;
use crate::analysis::ColorMap;
use crate::spelling::is_same_word;
use std::fmt;
use std::str::FromStr;

/// The numbers in the first and the last colour; numbers beyond have the colour of the nearer end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColorRange {
    /// This percentage of the values is below the first, and below the last. They are counted in the first frame of a
    /// sequence and points of a few others, so that a number has the same colour in all frames.
    Percentiles {
        /// From 0 to 100.
        low: f64,
        /// From `low` to 100.
        high: f64,
    },
    /// These numbers, finite and in this order.
    Fixed {
        /// In the first colour.
        low: f64,
        /// In the last colour.
        high: f64,
    },
}

impl ColorRange {
    /// All but a hundredth at either end: reflectors and dropouts.
    pub const USUAL: Self = Self::Percentiles { low: 1.0, high: 99.0 };
}

impl Default for ColorRange {
    fn default() -> Self {
        Self::USUAL
    }
}

impl fmt::Display for ColorRange {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Percentiles { low, high } => write!(formatter, "p{low}..p{high}"),
            Self::Fixed { low, high } => write!(formatter, "{low}..{high}"),
        }
    }
}

impl FromStr for ColorRange {
    type Err = ParseColoringError;

    /// `A..B`, or `pA..pB` in percent.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parse = || {
            let (low, high) = text.split_once("..")?;
            let percent = |text: &str| text.trim().strip_prefix('p')?.parse().ok();
            if let (Some(low), Some(high)) = (percent(low), percent(high)) {
                let is_percent = |value: f64| (0.0..=100.0).contains(&value);
                let range = Self::Percentiles { low, high };
                return (is_percent(low) && is_percent(high) && low <= high).then_some(range);
            }
            let [low, high]: [f64; 2] = [low.trim().parse().ok()?, high.trim().parse().ok()?];
            let is_range = low.is_finite() && high.is_finite() && low <= high;
            is_range.then_some(Self::Fixed { low, high })
        };
        parse().ok_or_else(|| ParseColoringError {
            what: "colour range",
            text: text.to_owned(),
            expected: "two numbers such as 0..255, or percentiles such as p1..p99",
        })
    }
}

impl FromStr for ColorMap {
    type Err = ParseColoringError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|map| is_same_word(map.name(), text));
        found.ok_or_else(|| ParseColoringError {
            what: "colour map",
            text: text.to_owned(),
            expected: "viridis, turbo, magma, grey or diverging",
        })
    }
}
