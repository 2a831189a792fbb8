//! A setting that may be left open.

use super::ParseChoiceError;
use super::describe::{Setting, Value, Words};
use std::fmt;
use std::str::FromStr;

/// Choices that settings may leave open.
pub trait Automatic: Setting<Decided = Self> + Copy + PartialEq + 'static {
    /// Default value for a choice that is left open and that nothing else decides.
    const USUAL: Self;

    /// The words of [`Choice`]: one for the open choice, and one per value.
    const OPEN_WORDS: &'static Words;
}

/// A choice that the user may leave to the program. Resolved styles have none: see
/// [`Settings::resolved`](super::Settings).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Choice<T> {
    /// Left open.
    #[default]
    Auto,
    /// Made.
    Is(T),
}

impl<T: Automatic> Choice<T> {
    /// Titles and hints, in the order of [`Choice::all`].
    pub const WORDS: &'static Words = T::OPEN_WORDS;

    /// The choice that was made, if it is not left open.
    pub fn chosen(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Is(chosen) => Some(chosen),
        }
    }

    /// Returns true if the choice is left open.
    pub fn is_open(self) -> bool {
        self.chosen().is_none()
    }

    /// The choice that was made, or `otherwise`.
    pub fn or(self, otherwise: T) -> T {
        self.chosen().unwrap_or(otherwise)
    }

    /// The word for it on the command line and in reports.
    pub fn name(self) -> &'static str {
        Self::WORDS.list[self.place()].word
    }

    /// Every choice: the open one first, and then in the order the window lists them.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::WORDS.list.len()).filter_map(Self::at)
    }

    fn place(self) -> usize {
        match self.chosen().map(|chosen| chosen.value()) {
            Some(Value::Word(place)) => place + 1,
            _ => 0,
        }
    }

    fn at(place: usize) -> Option<Self> {
        match place.checked_sub(1) {
            None => Some(Self::Auto),
            Some(place) => T::from_value(Value::Word(place)).map(Self::Is),
        }
    }
}

impl<T> From<T> for Choice<T> {
    fn from(chosen: T) -> Self {
        Self::Is(chosen)
    }
}

impl<T: Automatic> PartialEq<T> for Choice<T> {
    fn eq(&self, other: &T) -> bool {
        self.chosen().as_ref() == Some(other)
    }
}

impl<T: Automatic> Setting for Choice<T> {
    type Decided = T;

    fn decided(&self) -> T {
        self.or(T::USUAL)
    }

    fn value(&self) -> Value {
        Value::Word(self.place())
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Word(place) => Self::at(place),
            _ => None,
        }
    }
}

impl<T: Automatic> fmt::Display for Choice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl<T: Automatic> FromStr for Choice<T> {
    type Err = ParseChoiceError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::WORDS
            .place_of(text)
            .map(|place| Self::at(place).unwrap_or_default())
    }
}

impl<T: Automatic> serde::Serialize for Choice<T> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de, T: Automatic> serde::Deserialize<'de> for Choice<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}
