//! A value that the palette offers for a command.

use std::borrow::Cow;

/// A value that the palette offers for a command that takes one.
#[derive(Debug, Clone)]
pub(in crate::app) struct Offer {
    /// Its entry: *Go to frame 12*.
    pub text: Cow<'static, str>,
    /// The value, as a script gives it; the beginning of another query where [`Offer::is_begun`].
    pub value: Cow<'static, str>,
    /// A sentence about it; empty where the text suffices.
    pub hint: &'static str,
    /// Words of people and of other programs that find it.
    pub also: &'static [&'static str],
    /// The reason why it cannot be chosen now.
    pub why_not: Option<&'static str>,
    /// Its use of the number that was typed.
    pub number: NumberUse,
    /// True if the value is incomplete: the user is still typing.
    pub is_begun: bool,
}

/// Use of the number that was typed, by an entry of the palette.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum NumberUse {
    /// None: the number is a word.
    None,
    /// Its value, if other words ask for the entry.
    WithWords,
    /// Its value, also where the number is all that was typed.
    Alone,
}

impl Offer {
    /// An offer without further words.
    pub(in crate::app) fn new(text: impl Into<Cow<'static, str>>, value: impl Into<Cow<'static, str>>) -> Self {
        Self {
            text: text.into(),
            value: value.into(),
            hint: "",
            also: &[],
            why_not: None,
            number: NumberUse::None,
            is_begun: false,
        }
    }

    /// An entry that waits for a number: choosing it begins the query `query`.
    pub(in crate::app) fn begun(text: &'static str, query: &'static str) -> Self {
        Self {
            is_begun: true,
            ..Self::new(text, query)
        }
    }

    /// Adds a one-sentence hint.
    #[must_use]
    pub(in crate::app) fn hint(self, hint: &'static str) -> Self {
        Self { hint, ..self }
    }

    /// Adds synonyms: words of users and of other programs.
    #[must_use]
    pub(in crate::app) fn also(self, also: &'static [&'static str]) -> Self {
        Self { also, ..self }
    }

    /// Marks the offer as one that takes the number that was typed.
    #[must_use]
    pub(in crate::app) fn of_number(self, number: NumberUse) -> Self {
        Self { number, ..self }
    }
}
