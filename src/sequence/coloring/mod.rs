//! Where the colours of points come from, as a person chooses it.
//!
//! [`Coloring`] is the choice. Together with [`ColorHints`] and a frame it becomes a [`Paint`](super::Paint), in which
//! nothing is open any more (`resolve.rs`), and that becomes the colours of records (`sequence/records.rs`).

mod field_name;
mod resolve;
mod source;
mod stored;

pub use field_name::{FieldName, plain as plain_field_name};
pub use resolve::{ColorHints, Paint, PaintValues, value_kind};
pub use source::{ColorSource, DistanceFrom, HeightAxis};

use crate::analysis::ColorMap;
use std::fmt;
use std::str::FromStr;

/// How points are coloured. What is not there to be coloured by is replaced as [`ColorSource::Auto`] would.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(from = "stored::Stored")]
pub struct Coloring {
    /// What colours show.
    pub source: ColorSource,
    /// How numbers become colours.
    pub map: ColorMap,
    /// The numbers in the first and the last colour.
    pub range: ColorRange,
    /// Steps of colour are steps of the logarithm; evenly where no number is above zero.
    pub is_logarithmic: bool,
    /// Red, green and blue of [`ColorSource::Uniform`].
    pub one_color: [u8; 3],
}

impl Coloring {
    /// A source, and the rest as usual.
    pub const fn of(source: ColorSource) -> Self {
        Self {
            source,
            map: ColorMap::Viridis,
            range: ColorRange::USUAL,
            is_logarithmic: false,
            one_color: super::records::UNIFORM_RGB,
        }
    }
}

impl Default for Coloring {
    fn default() -> Self {
        Self::of(ColorSource::Auto)
    }
}

impl From<ColorSource> for Coloring {
    fn from(source: ColorSource) -> Self {
        Self::of(source)
    }
}

/// The numbers in the first and the last colour; what is beyond has the colour of the nearer end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColorRange {
    /// So many percent of the values are below the first, and below the last. They are counted in the first frame of a
    /// sequence, so that a number has the same colour in all frames.
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
    pub const USUAL: Self = Self::Percentiles {
        low: 1.0,
        high: 99.0,
    };
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

/// A text that is no way to colour.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is no {what}: expected {expected}")]
pub struct ParseColoringError {
    pub(super) what: &'static str,
    pub(super) text: String,
    pub(super) expected: &'static str,
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
            what: "range of colours",
            text: text.to_owned(),
            expected: "two numbers such as 0..255, or percentiles such as p1..p99",
        })
    }
}

impl FromStr for ColorMap {
    type Err = ParseColoringError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|map| map.name() == text);
        found.ok_or_else(|| ParseColoringError {
            what: "map of colours",
            text: text.to_owned(),
            expected: "viridis, turbo, magma, grey or diverging",
        })
    }
}
