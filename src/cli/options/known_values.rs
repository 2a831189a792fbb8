//! Values of options where all, or the best known ones, are words.

use clap::builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser};
use clap::{Arg, Command, Error};
use std::ffi::OsStr;
use std::str::FromStr;
use std::sync::Arc;

/// A parser of values whose words clap knows: it lists and completes them, and suggests a similar one.
#[derive(Clone)]
pub(in crate::cli) struct KnownValues<T> {
    words: Vec<&'static str>,
    parse: Arc<Parse<T>>,
}

type Parse<T> = dyn Fn(&str) -> Result<T, String> + Send + Sync;

impl<T> KnownValues<T> {
    /// Values that `parse` reads. `words` are the known ones; `parse` may accept other spellings, numbers or names too.
    pub(in crate::cli) fn new(
        words: impl IntoIterator<Item = &'static str>,
        parse: impl Fn(&str) -> Result<T, String> + Send + Sync + 'static,
    ) -> Self {
        Self {
            words: words.into_iter().collect(),
            parse: Arc::new(parse),
        }
    }
}

impl<T> KnownValues<T>
where
    T: FromStr<Err: ToString>,
{
    /// Values that are parsed as their type is.
    pub(in crate::cli) fn of(words: impl IntoIterator<Item = &'static str>) -> Self {
        Self::new(words, |text| text.parse::<T>().map_err(|error| error.to_string()))
    }
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for KnownValues<T> {
    type Value = T;

    fn parse_ref(&self, command: &Command, argument: Option<&Arg>, value: &OsStr) -> Result<T, Error> {
        let text = StringValueParser::new().parse_ref(command, argument, value)?;
        let expected = match (self.parse)(&text) {
            Ok(parsed) => return Ok(parsed),
            Err(expected) => expected,
        };
        // A word that is not a number, a name or a path is a misspelt known value.
        let is_word = text.chars().all(|letter| letter.is_ascii_alphabetic() || letter == '-');
        if is_word && !self.words.is_empty() {
            PossibleValuesParser::new(&self.words).parse_ref(command, argument, value)?;
        }
        let fail = move |_: &str| Err::<T, String>(expected.clone());
        fail.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        if self.words.is_empty() {
            return None;
        }
        Some(Box::new(self.words.iter().map(|word| PossibleValue::new(*word))))
    }
}
