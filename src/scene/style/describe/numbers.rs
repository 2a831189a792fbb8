//! Numeric ranges of settings, and how the numbers are written.

use crate::spelling::is_same_word;

/// Numeric range of a setting.
#[derive(Debug)]
pub struct Numbers {
    /// In files; the nearest one is taken.
    pub retained: [f32; 2],
    /// On the slider.
    pub offered: [f32; 2],
    /// On the command line.
    pub typed: Typed,
    /// Display unit of the numbers.
    pub unit: Unit,
    /// Digits behind the point at most.
    pub decimals: usize,
    /// Equal distances on the slider are equal factors.
    pub is_logarithmic: bool,
    /// Word for 0 where that is not a number like the others; empty where it is.
    pub zero: &'static str,
}

/// Numbers that the command line accepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Typed {
    /// Finite ones above 0.
    Positive,
    /// Finite ones from 0 up.
    NotNegative,
    /// Range that files may hold; the text describes it.
    Retained(&'static str),
    /// Whole ones that files may hold.
    Whole,
    /// Whole ones from 1 up.
    WholePositive,
}

/// Display unit of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// As they are, and this after them.
    Is(&'static str),
    /// In percent, and moved in steps of five.
    Share,
    /// In percent, which the slider moves, and rounded to tenths of them.
    Percent,
}

impl Numbers {
    /// Any number above 0 from the command line, without unit.
    pub const USUAL: Self = Self {
        retained: [0.0, 1.0],
        offered: [0.0, 1.0],
        typed: Typed::Positive,
        unit: Unit::Is(""),
        decimals: 2,
        is_logarithmic: false,
        zero: "",
    };

    /// Returns true if the numbers are integers.
    pub fn are_whole(&self) -> bool {
        matches!(self.typed, Typed::Whole | Typed::WholePositive)
    }

    /// The nearest number that files may hold.
    pub(super) fn nearest(&self, number: f64) -> f64 {
        let [min, max] = self.retained.map(f64::from);
        number.clamp(min, max)
    }

    /// A number of the command line. `Err` states the expected input.
    pub fn parse(&self, text: &str) -> Result<f64, String> {
        let [min, max] = self.retained;
        if self.is_zero_word(text) {
            return Ok(0.0);
        }
        let number = || match self.typed {
            Typed::Whole | Typed::WholePositive => text.parse::<u32>().ok().map(f64::from),
            _ => text.parse::<f32>().ok().map(f64::from),
        };
        let is_taken = |number: &f64| match self.typed {
            Typed::Positive => number.is_finite() && *number > 0.0,
            Typed::NotNegative => number.is_finite() && *number >= 0.0,
            Typed::Retained(_) | Typed::Whole => self.nearest(*number) == *number,
            Typed::WholePositive => *number >= 1.0,
        };
        number().filter(is_taken).ok_or_else(|| match self.typed {
            Typed::Positive => "expected a number above 0".to_owned(),
            Typed::NotNegative => "expected a number from 0 up".to_owned(),
            Typed::Retained(expected) if self.zero.is_empty() => format!("expected {expected}"),
            Typed::Retained(expected) => format!("expected {} or {expected}", self.zero),
            Typed::Whole if self.zero.is_empty() => format!("expected a whole number from {min} to {max}"),
            Typed::Whole => format!("expected {} or a whole number up to {max}", self.zero),
            Typed::WholePositive => "expected a whole number from 1 up".to_owned(),
        })
    }

    /// Returns true if a text is the word for 0.
    pub fn is_zero_word(&self, text: &str) -> bool {
        !self.zero.is_empty() && is_same_word(self.zero, text)
    }

    /// A number as the command line takes it.
    pub fn typed_text(&self, number: f64) -> String {
        if number == 0.0 && !self.zero.is_empty() {
            return self.zero.to_owned();
        }
        (number as f32).to_string()
    }

    /// A number in a label.
    pub fn told(&self, number: f64) -> String {
        match self.unit {
            Unit::Is(_) => self.typed_text(number),
            Unit::Share | Unit::Percent => format!("{:.0} %", number * 100.0),
        }
    }
}
