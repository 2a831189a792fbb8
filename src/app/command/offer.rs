//! A value that the palette offers for a command.

use std::borrow::Cow;

/// A value that the palette offers for a command that takes one.
#[derive(Debug, Clone)]
pub(in crate::app) struct Offer {
    /// Its entry: *Go to frame 12*.
    pub text: Cow<'static, str>,
    /// The value, as a script gives it; the beginning of another query where [`Offer::is_begun`].
    pub value: Cow<'static, str>,
    /// A sentence about it; empty where the text says it.
    pub hint: &'static str,
    /// Words of people and of other programs that find it.
    pub also: &'static [&'static str],
    /// The reason why it cannot be chosen now.
    pub why_not: Option<&'static str>,
    /// Whether the value is the number that was typed.
    pub number: OfferNumber,
    /// Whether the value is only begun: a person goes on typing.
    pub is_begun: bool,
}

/// The part of a typed number in an offer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum OfferNumber {
    /// None.
    None,
    /// It is the value; other words have to ask for the command.
    WithWords,
    /// It is the value, also where it is all that was typed.
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
            number: OfferNumber::None,
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

    /// The same with a sentence about it.
    #[must_use]
    pub(in crate::app) fn hint(self, hint: &'static str) -> Self {
        Self { hint, ..self }
    }

    /// The same with words of people and of other programs.
    #[must_use]
    pub(in crate::app) fn also(self, also: &'static [&'static str]) -> Self {
        Self { also, ..self }
    }

    /// The same as one that takes the number that was typed.
    #[must_use]
    pub(in crate::app) fn of_number(self, number: OfferNumber) -> Self {
        Self { number, ..self }
    }
}
